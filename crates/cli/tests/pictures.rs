//! Clips and pictures made without a display, and what happens where there is no OpenGL.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use std::collections::HashSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corpuscle"));
    command.args(arguments).current_dir(folder).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    command
}

fn corpuscle(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("the command starts")
}

fn succeeded(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// What lies in a folder, by name.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Width, height and number of different colours of a PNG file.
fn look(path: &Path) -> (u32, u32, usize) {
    let mut reader = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let colours: HashSet<&[u8]> = pixels.chunks_exact(info.color_type.samples()).collect();
    (info.width, info.height, colours.len())
}

/// Number of pictures in an MP4 file, from its table of sample sizes: version and flags, common size, count.
fn pictures_of_mp4(bytes: &[u8]) -> u32 {
    assert_eq!(&bytes[4..8], b"ftyp");
    let tables: Vec<usize> = (0..bytes.len() - 4).filter(|&i| &bytes[i..i + 4] == b"stsz").collect();
    let table = tables.last().unwrap() + 4;
    u32::from_be_bytes(bytes[table + 8..table + 12].try_into().unwrap())
}

fn pictures_of_gif(path: &Path) -> usize {
    let mut decoder = gif::DecodeOptions::new().read_info(fs::File::open(path).unwrap()).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (160, 120));
    let mut count = 0;
    while decoder.read_next_frame().unwrap().is_some() {
        count += 1;
    }
    count
}

#[test]
fn a_clip_has_exactly_the_pictures_it_should() {
    let folder = tempfile::tempdir().unwrap();
    // From 1 to 2 at a speed of 0.5: two seconds, eight pictures each, and the one at the end.
    let clip = |out: &str, more: &[&str]| {
        let arguments = ["record", "three-body", "--size", "160x120", "--fps", "8", "--speed", "0.5", "--from", "1", "--to", "2s"];
        corpuscle(folder.path(), &[&arguments, &["--out", out][..], more].concat())
    };
    for out in ["clip.mp4", "clip.gif", "pictures", "again/"] {
        succeeded(&clip(out, &[]));
    }
    let film = fs::read(folder.path().join("clip.mp4")).unwrap();
    assert_eq!(pictures_of_mp4(&film), 17);
    assert_eq!(pictures_of_gif(&folder.path().join("clip.gif")), 17);
    let pictures = names(&folder.path().join("pictures"));
    assert_eq!(pictures, (0..17).map(|number| format!("{number:05}.png")).collect::<Vec<_>>());
    for name in &pictures {
        let path = folder.path().join("pictures").join(name);
        let (width, height, colours) = look(&path);
        assert_eq!((width, height), (160, 120));
        assert!(colours > 20, "{name} is blank");
        assert_eq!(fs::read(path).unwrap(), fs::read(folder.path().join("again").join(name)).unwrap(), "{name}");
    }

    // What is there stays, unless told otherwise; then the same film has the same bytes.
    let refused = clip("clip.mp4", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("out = clip.mp4: expected a new file, or --force"));
    assert_eq!(clip("pictures", &[]).status.code(), Some(2));
    succeeded(&clip("clip.mp4", &["--force"]));
    assert!(fs::read(folder.path().join("clip.mp4")).unwrap() == film, "another film from the same scenario");
    assert_eq!(names(folder.path()), ["again", "clip.gif", "clip.mp4", "pictures"], "nothing half-finished is left");
}

#[test]
fn every_experiment_has_a_picture_of_the_size_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["brownian", "entropy", "ideal-gas", "three-body", "wave"] {
        let file = format!("{name}.png");
        let arguments = ["view", name, "--no-panels", "--screenshot", &file, "--at", "2s", "--size", "640x400"];
        succeeded(&corpuscle(folder.path(), &arguments));
        let path = folder.path().join(&file);
        let (width, height, colours) = look(&path);
        assert_eq!((width, height), (640, 400));
        assert!(colours > 50, "{name}: only {colours} colours");
        let bytes = fs::read(&path).unwrap();
        assert_eq!(corpuscle(folder.path(), &arguments).status.code(), Some(2), "{name}: overwritten unasked");
        succeeded(&corpuscle(folder.path(), &[&arguments[..], &["--force"]].concat()));
        assert!(fs::read(&path).unwrap() == bytes, "{name}: another picture of the same moment");
    }
    assert_eq!(names(folder.path()).len(), 5);
}

/// The laboratory's whole window: the same bytes for the same moment, another picture in another language and palette.
#[test]
fn the_whole_window_has_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    let take = |file: &str, more: &[&str]| {
        let arguments = ["view", "wave", "--screenshot", file, "--at", "2.5s", "--size", "1600x1000"];
        succeeded(&corpuscle(folder.path(), &[&arguments[..], more].concat()));
        let path = folder.path().join(file);
        let (width, height, colours) = look(&path);
        assert_eq!((width, height), (1600, 1000));
        assert!(colours > 200, "{file}: only {colours} colours");
        fs::read(path).unwrap()
    };
    let first = take("a.png", &[]);
    assert!(take("b.png", &[]) == first, "another picture of the same moment");
    assert!(take("c.png", &["--palette", "light"]) != first);
    assert!(take("d.png", &["--language", "chinese"]) != first);
    assert!(take("e.png", &["--no-panels"]) != first);
}

#[test]
fn a_film_of_the_whole_window_has_its_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        ["record", "wave", "--panels", "--size", "1280x720", "--fps", "1", "--speed", "5", "--to", "10s", "--out", "film"];
    succeeded(&corpuscle(folder.path(), &arguments));
    let pictures = names(&folder.path().join("film"));
    assert_eq!(pictures, ["00000.png", "00001.png", "00002.png"]);
    for name in &pictures {
        let (width, height, colours) = look(&folder.path().join("film").join(name));
        assert_eq!((width, height), (1280, 720));
        assert!(colours > 200, "{name}: only {colours} colours");
    }
}

#[test]
fn without_a_display_a_window_is_refused_and_pictures_are_offered() {
    let folder = tempfile::tempdir().unwrap();
    if !cfg!(target_os = "linux") {
        return; // elsewhere there is always a display
    }
    for arguments in [&["view", "wave"][..], &["view", "wave", "--no-panels"], &["lab"], &["lab", "wave"]] {
        let output = corpuscle(folder.path(), arguments);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{complaint}");
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
        for part in ["no display", "DISPLAY", "--screenshot", "record"] {
            assert!(complaint.contains(part), "{complaint}");
        }
        assert!(output.stdout.is_empty());
        // A display that is named but not there.
        let output = command(folder.path(), arguments).env("DISPLAY", ":4711").output().unwrap();
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{complaint}");
        assert!(complaint.contains("no display") && !complaint.contains("panicked"), "{complaint}");
    }
}

/// The libraries are there, and no driver behind them.
#[cfg(target_os = "linux")]
fn without_opengl(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = command(folder, arguments);
    command.env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent").env("LIBGL_DRIVERS_PATH", "/nonexistent");
    command.output().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn without_opengl_a_run_finishes_and_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let output = without_opengl(folder.path(), &["run", "three-body", "--out", "out", "--set", "preset=figure-eight"]);
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{complaint}");
    assert_eq!(complaint.lines().count(), 1, "{complaint}");
    assert!(complaint.contains("the pictures are left out") && complaint.contains("install lib"), "{complaint}");
    let written = names(&folder.path().join("out"));
    assert!(!written.contains(&"pictures".to_owned()));
    for file in ["report.html", "scenario.toml", "summary.json"] {
        assert!(written.contains(&file.to_owned()), "{written:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn without_opengl_pictures_fail_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["record", "wave", "--out", "clip.mp4"][..],
        &["record", "wave", "--out", "clip.gif"],
        &["record", "wave", "--out", "pictures/"],
        &["view", "wave", "--screenshot", "wave.png"],
    ] {
        let output = without_opengl(folder.path(), arguments);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{complaint}");
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
        assert!(complaint.contains("OpenGL") || complaint.contains("libEGL"), "{complaint}");
        assert!(complaint.contains("install lib"), "{complaint}");
        assert!(names(folder.path()).is_empty(), "{arguments:?} left something behind");
    }
}
