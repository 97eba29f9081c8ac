//! Files and folders from strangers: pipes that nobody writes into, links that lead out, files that are larger than they look. None
//! makes the command wait for ever, read what is private, or write where it was not sent.

#![cfg(unix)]
#![allow(clippy::unwrap_used)] // in helpers too: a test that cannot go on has failed

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use corpuscle_io::Checkpoints;

const GAS: &str = "engine = \"event\"\nduration = 60.0\n[box]\nlower = [0.0, 0.0]\nupper = [40.0, 40.0]\nfaces = \"walls\"\n\
                   [[species]]\ncount = 500\nradius = 0.5\n";

fn corpuscle(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corpuscle"));
    command.args(arguments).current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn output(folder: &Path, arguments: &[&str]) -> Output {
    corpuscle(folder, arguments).output().unwrap()
}

/// What the command makes of a scenario that comes through standard input.
fn piped(folder: &Path, arguments: &[&str], text: &str) -> Output {
    let mut child = corpuscle(folder, arguments).spawn().unwrap();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

fn complaint(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn refused(output: &Output, code: i32, words: &str) {
    let said = complaint(output);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(said.contains(words), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

fn pipe(folder: &Path) {
    assert!(Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap().success());
}

/// The folder of a run of `GAS` with its checkpoints.
fn run(folder: &Path) {
    fs::write(folder.join("gas.toml"), GAS).unwrap();
    let often = ["--checkpoint-time", "20", "--checkpoints", "2", "--no-pictures", "--quiet"];
    let ended = output(folder, &[&["run", "gas.toml", "--out", "out"][..], &often].concat());
    assert!(matches!(ended.status.code(), Some(0 | 3)), "{}", complaint(&ended));
}

/// It once waited for ever.
#[test]
fn a_pipe_without_a_writer_is_not_waited_for_for_ever() {
    let folder = tempfile::tempdir().unwrap();
    pipe(folder.path());
    refused(&output(folder.path(), &["check", "pipe"]), 2, "pipe: file = no regular file, and it has not come to an end");
    // Somebody who opens it and writes nothing is no better.
    let path = folder.path().join("pipe");
    let _silent = std::thread::spawn(move || File::options().write(true).open(path).map(|file| (file, std::thread::park())));
    refused(&output(folder.path(), &["run", "pipe"]), 2, "somebody writes into within 10 seconds; `-` is standard input");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_scenario_comes_through_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    for word in ["-", "/dev/stdin"] {
        let checked = piped(folder.path(), &["check", word], GAS);
        assert!(checked.status.success(), "{}", complaint(&checked));
        refused(&piped(folder.path(), &["check", word], ""), 2, "experiment = (missing)");
    }
    let wrong = GAS.replace("count = 500", "count = -5");
    refused(&piped(folder.path(), &["run", "-"], &wrong), 2, "standard input:8:9: ");
    pipe(folder.path());
    let path = folder.path().join("pipe");
    let writer = std::thread::spawn(move || fs::write(path, GAS));
    let ran = output(folder.path(), &["run", "pipe", "--out", "out", "--no-pictures", "--quiet"]);
    assert!(matches!(ran.status.code(), Some(0 | 3)), "{}", complaint(&ran));
    writer.join().unwrap().unwrap();
}

/// Never more is read than a scenario can be.
#[test]
fn a_device_without_end_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    refused(&output(folder.path(), &["check", "/dev/zero"]), 2, "more than 16777216 bytes");
    refused(&output(folder.path(), &["check", "/dev/null"]), 2, "experiment = (missing)");
}

/// Checkpoints and pictures were once written to where such a link leads, and older checkpoints removed there.
#[test]
fn a_folder_whose_parts_lead_out_of_it_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path());
    let (out, elsewhere) = (folder.path().join("out"), folder.path().join("elsewhere"));
    for part in ["checkpoints", "pictures"] {
        let _ = fs::rename(out.join(part), folder.path().join("kept"));
        let _ = fs::remove_dir_all(&elsewhere);
        fs::create_dir(&elsewhere).unwrap();
        fs::write(elsewhere.join("000001.checkpoint"), "precious").unwrap();
        symlink(&elsewhere, out.join(part)).unwrap();
        for arguments in [&["resume", "out"][..], &["run", "gas.toml", "--out", "out", "--force"]] {
            refused(&output(folder.path(), arguments), 2, &format!("out/{part}: expected a folder, but this is a file or a link"));
        }
        assert_eq!(fs::read_to_string(elsewhere.join("000001.checkpoint")).unwrap(), "precious");
        assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 1);
        fs::remove_file(out.join(part)).unwrap();
        let _ = fs::rename(folder.path().join("kept"), out.join(part));
    }
}

/// A pipe with the name of a checkpoint was once waited for, and a file said to be as large as its hole was to be read whole.
#[test]
fn what_only_looks_like_a_checkpoint_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path());
    let checkpoints = folder.path().join("out/checkpoints");
    assert!(Command::new("mkfifo").arg(checkpoints.join("000091.checkpoint")).status().unwrap().success());
    fs::create_dir(checkpoints.join("000092.checkpoint")).unwrap();
    symlink("/dev/zero", checkpoints.join("000093.checkpoint")).unwrap();
    // A hole of a hundred thousand thousand million bytes, with a head that says so.
    let (hole, length) = (checkpoints.join("000094.checkpoint"), 100_000_000_000_000u64);
    let mut head = fs::read(&Checkpoints::of(&folder.path().join("out")).files()[3 + 1]).unwrap();
    head[29..37].copy_from_slice(&(length - 69).to_le_bytes());
    fs::write(&hole, &head[..69]).unwrap();
    let grown = File::options().write(true).open(&hole).unwrap().set_len(length);
    let resumed = output(folder.path(), &["resume", "out", "--no-pictures", "--quiet"]);
    let said = complaint(&resumed);
    assert!(matches!(resumed.status.code(), Some(0 | 3)), "{said}");
    for (number, words) in [(91, "it is no file"), (92, "it is no file"), (93, "it is no file")] {
        assert!(said.contains(&format!("0000{number}.checkpoint cannot be read: {words}")), "{said}");
    }
    // Not every file system has files of such a length.
    if grown.is_ok() {
        assert!(said.contains("000094.checkpoint cannot be read: it would take about 300000.0 GB of memory"), "{said}");
    }
}

/// The frame that a run starts from was once overwritten by a trajectory of its name, which ended the run's reproducibility.
#[test]
fn the_name_of_the_start_is_no_name_for_a_trajectory() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gas.toml"), GAS).unwrap();
    for name in ["start.xyz", "Start.XYZ"] {
        let said = output(folder.path(), &["run", "gas.toml", "--out", "out", "--trajectory", name]);
        refused(&said, 2, "trajectory = ");
    }
    assert!(!folder.path().join("out").exists());
}

/// A map of fates has no particles that a file could hold.
#[test]
fn a_trajectory_of_a_map_is_refused_before_it_starts() {
    let folder = tempfile::tempdir().unwrap();
    let map = ["run", "three-body", "--set", "show=basins", "--out", "out", "--trajectory", "path.xyz"];
    refused(&output(folder.path(), &map), 2, "trajectory = path.xyz: expected nothing: this experiment has no particles");
    assert!(!folder.path().join("out").exists());
}

/// Of pictures taken before, a resumed run once put whatever had their names into its report.
#[test]
fn a_report_takes_in_nothing_private() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gas.toml"), GAS).unwrap();
    let first = ["run", "gas.toml", "--out", "out", "--checkpoint-time", "20", "--checkpoints", "2", "--quiet"];
    let ended = output(folder.path(), &first);
    let said = complaint(&ended);
    if said.contains("pictures are left out") {
        eprintln!("no OpenGL here: no pictures to replace");
        return;
    }
    let (private, picture) = (folder.path().join("private"), folder.path().join("out/pictures/01.png"));
    fs::write(&private, b"\x89PNG\r\n\x1a\nmy password is corpuscle").unwrap();
    let report = folder.path().join("out/report.html");
    let pictures = |html: &str| html.matches("data:image/png").count();
    let before = pictures(&fs::read_to_string(&report).unwrap());
    fs::remove_file(&picture).unwrap();
    symlink(&private, &picture).unwrap();
    let resumed = output(folder.path(), &["resume", "out", "--quiet"]);
    assert!(matches!(resumed.status.code(), Some(0 | 3)), "{}", complaint(&resumed));
    assert_eq!(pictures(&fs::read_to_string(&report).unwrap()), before - 1, "{said}");
}
