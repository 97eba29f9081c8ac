//! Clips are read back with the crates that read them, and with ffprobe where there is one.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot write has failed")]

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;
use std::process::Command;

use corpuscle_render::{Clip, Picture};

const SIZE: [u32; 2] = [96, 64];
const FRAMES: u32 = 12;

/// A bright square that moves to the right on a dark ground.
fn picture(frame: u32) -> Picture {
    let [width, height] = SIZE;
    let inside = |x: u32, y: u32| (20..44).contains(&y) && (4 * frame..4 * frame + 24).contains(&x);
    let rgba = (0..height)
        .flat_map(|y| (0..width).flat_map(move |x| if inside(x, y) { [230, 159, 0, 255] } else { [14, 17, 22, 255] }))
        .collect();
    Picture { width, height, rgba }
}

/// A folder of the test's own.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn write(path: &PathBuf, fps: f64) {
    let mut clip = Clip::create(path, SIZE[0], SIZE[1], fps).unwrap();
    for frame in 0..FRAMES {
        clip.frame(&picture(frame)).unwrap();
        assert!(!path.is_file(), "nothing half-written under the name asked for");
    }
    clip.finish().unwrap();
}

fn entries(folder: &PathBuf) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn decode(path: PathBuf) -> Vec<u8> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}

#[test]
fn png_folders_hold_every_picture_exactly() {
    let folder = folder("png");
    write(&folder.join("frames"), 30.0);
    let names = entries(&folder.join("frames"));
    assert_eq!(names.len() as u32, FRAMES);
    assert_eq!(names[11], "00011.png");
    for (frame, name) in (0..).zip(&names) {
        let expected: Vec<u8> = picture(frame).rgba.chunks_exact(4).flat_map(|p| p[..3].to_vec()).collect();
        assert_eq!(decode(folder.join("frames").join(name)), expected);
    }
    assert_eq!(entries(&folder), ["frames"]);
    assert!(Clip::create(folder.join("frames"), 10, 10, 30.0).is_err(), "a full folder is not overwritten");
}

#[test]
fn a_gif_decodes_to_its_pictures_at_its_rate() {
    let folder = folder("gif");
    let path = folder.join("clip.gif");
    write(&path, 30.0);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(File::open(&path).unwrap()).unwrap();
    let mut canvas = vec![0u8; 4 * 96 * 64];
    let (mut frames, mut duration) = (0, 0);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let (left, top, width) = (usize::from(frame.left), usize::from(frame.top), usize::from(frame.width));
        for (row, pixels) in frame.buffer.chunks_exact(4 * width).enumerate() {
            let start = 4 * (96 * (top + row) + left);
            for (old, new) in canvas[start..start + 4 * width].chunks_exact_mut(4).zip(pixels.chunks_exact(4)) {
                if new[3] > 0 {
                    old.copy_from_slice(new);
                }
            }
        }
        // Two colours fit into any palette exactly.
        assert_eq!(canvas, picture(frames).rgba, "picture {frames}");
        frames += 1;
        duration += u32::from(frame.delay);
    }
    assert_eq!((frames, duration), (FRAMES, 40), "12 pictures at 30 a second last 0.40 s");
    assert_eq!(entries(&folder), ["clip.gif"]);
}

/// The boxes of an MP4 file with their contents.
fn boxes(bytes: &[u8]) -> Vec<(String, &[u8])> {
    let mut found = Vec::new();
    let mut rest = bytes;
    while rest.len() >= 8 {
        let size = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        found.push((String::from_utf8_lossy(&rest[4..8]).into_owned(), &rest[8..size]));
        rest = &rest[size..];
    }
    found
}

fn inside<'b>(bytes: &'b [u8], path: &[&str]) -> &'b [u8] {
    path.iter().fold(bytes, |bytes, name| boxes(bytes).into_iter().find(|(n, _)| n == name).unwrap().1)
}

#[test]
fn an_mp4_decodes_to_its_pictures_at_its_rate() {
    let folder = folder("mp4");
    let path = folder.join("clip.mp4");
    write(&path, 25.0);
    assert_eq!(entries(&folder), ["clip.mp4"]);
    let bytes = std::fs::read(&path).unwrap();

    // The table of times: every picture lasts 1/25 s of the track's clock.
    let media = inside(&bytes, &["moov", "trak", "mdia"]);
    let number = |bytes: &[u8], at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    let clock = number(inside(media, &["mdhd"]), 12);
    let times = inside(media, &["minf", "stbl", "stts"]);
    let runs: Vec<_> = (0..number(times, 4) as usize).map(|i| [number(times, 8 + 8 * i), number(times, 12 + 8 * i)]).collect();
    assert_eq!(runs.iter().map(|[count, _]| count).sum::<u32>(), FRAMES);
    assert!(runs.iter().all(|[_, duration]| duration * 25 == clock), "{runs:?} at {clock}");

    // The pictures themselves: length-prefixed units in `mdat`, after the parameter sets in `avcC`.
    let description = inside(media, &["minf", "stbl", "stsd"]);
    let avcc = &description[description.windows(4).position(|w| w == b"avcC").unwrap() + 4..];
    let length = |at: usize| usize::from(u16::from_be_bytes([avcc[at], avcc[at + 1]]));
    let sps = &avcc[8..8 + length(6)];
    let pps_at = 8 + length(6) + 1;
    let pps = &avcc[pps_at + 2..pps_at + 2 + length(pps_at)];
    let mut decoder = openh264::decoder::Decoder::new().unwrap();
    let start = [0, 0, 0, 1];
    decoder.decode(&[&start, sps, &start[..], pps].concat()).unwrap();
    let mut units = inside(&bytes, &["mdat"]);
    let mut frames = 0;
    let mut rgb = vec![0; 3 * 96 * 64];
    while units.len() > 4 {
        let size = number(units, 0) as usize;
        let unit = &units[4..4 + size];
        units = &units[4 + size..];
        if let Some(decoded) = decoder.decode(&[&start, unit].concat()).unwrap() {
            decoded.write_rgb8(&mut rgb);
            let expected = picture(frames);
            let error: f64 = rgb
                .chunks_exact(3)
                .zip(expected.rgba.chunks_exact(4))
                .flat_map(|(a, b)| a.iter().zip(&b[..3]).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).collect::<Vec<_>>())
                .sum::<f64>();
            let ratio = 10.0 * (255.0f64.powi(2) / (error / rgb.len() as f64)).log10();
            // 30 dB is what is commonly called good; a picture early or late by one has 17 dB.
            assert!(ratio > 30.0, "picture {frames}: {ratio} dB");
            frames += 1;
        }
    }
    assert_eq!(frames, FRAMES);

    if let Ok(probe) = Command::new("ffprobe")
        .args(["-v", "error", "-count_frames", "-show_entries"])
        .args(["stream=codec_name,width,height,r_frame_rate,nb_read_frames", "-of", "csv=p=0"])
        .arg(&path)
        .output()
    {
        assert_eq!(String::from_utf8_lossy(&probe.stdout).trim(), "h264,96,64,25/1,12");
    }
}

#[test]
fn a_single_png_takes_one_picture() {
    let folder = folder("single");
    let mut clip = Clip::create(folder.join("one.png"), SIZE[0], SIZE[1], 1.0).unwrap();
    clip.frame(&picture(0)).unwrap();
    assert!(clip.frame(&picture(1)).is_err());
    clip.finish().unwrap();
    assert_eq!(entries(&folder), ["one.png"]);
}

#[test]
fn what_is_not_finished_leaves_nothing_behind() {
    let folder = folder("unfinished");
    for name in ["a.mp4", "b.gif", "c.png", "d"] {
        let mut clip = Clip::create(folder.join(name), SIZE[0], SIZE[1], 25.0).unwrap();
        clip.frame(&picture(0)).unwrap();
        drop(clip);
        // A clip without pictures is not a clip.
        assert!(Clip::create(folder.join(name), SIZE[0], SIZE[1], 25.0).unwrap().finish().is_err());
    }
    assert_eq!(entries(&folder), [""; 0]);
}

#[test]
fn what_cannot_be_written_is_refused_at_once() {
    let folder = folder("refused");
    let create = |name: &str, width, fps| Clip::create(folder.join(name), width, 64, fps);
    for (name, width, fps, word) in [
        ("a.avi", 96, 25.0, ".mp4"),
        ("a.mp4", 95, 25.0, "even"),
        ("a.gif", 96, 0.0, "above 0"),
        ("a.gif", 96, 60.0, "50"),
        ("no/a.gif", 96, 25.0, "no/"),
    ] {
        let fault = create(name, width, fps).err().unwrap().to_string();
        assert!(fault.contains(word), "{fault}");
    }
    let mut clip = create("a.gif", 96, 25.0).unwrap();
    assert!(clip.frame(&Picture { width: 1, height: 1, rgba: vec![0; 4] }).is_err());
    drop(clip);
    assert_eq!(entries(&folder), [""; 0]);
}
