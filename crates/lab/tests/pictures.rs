//! The whole window against pictures that somebody has looked at: made small, with a tolerance, since drivers differ in
//! the last bit and fonts in a pixel. `CORPUSCLE_REFERENCES=write cargo test -p corpuscle-lab --test pictures` makes them anew.

#![allow(clippy::unwrap_used, clippy::panic)] // in the helpers too: a test that cannot be set up has failed

use std::path::{Path, PathBuf};

use corpuscle_experiments::{REGISTRY, find};
use corpuscle_io::Scenario;
use corpuscle_lab::language::Language;
use corpuscle_lab::theme::Theme;
use corpuscle_lab::{Preferences, Studio, StudioView};
use corpuscle_render::Picture;

/// Width of a picture that is kept: a quarter of the small window's, a sixth of the large one's.
const WIDTH: u32 = 320;
/// Largest mean difference of a channel over the whole picture, of 255. A panel that is missing makes about 10, a text of
/// another size about 2; another driver's antialiasing stays below a half.
const TOLERANCE: f64 = 1.0;

/// Parameters that make a picture quickly, without touching what it shows.
fn scenario(name: &str) -> Scenario {
    let mut scenario = Scenario::new(find(name).unwrap());
    if scenario.settings.declaration("replicas").is_ok() {
        scenario.set("replicas", "4").unwrap();
    }
    scenario
}

/// Both palettes, both languages, both sizes.
const KINDS: [(Theme, Language, [u32; 2], &str); 4] = [
    (Theme::Dark, Language::English, SMALL, "dark-english"),
    (Theme::Light, Language::Chinese, SMALL, "light-chinese"),
    (Theme::Dark, Language::Chinese, LARGE, "dark-chinese-large"),
    (Theme::Light, Language::English, LARGE, "light-english-large"),
];
const SMALL: [u32; 2] = [1280, 800];
const LARGE: [u32; 2] = [1920, 1080];

fn window(name: &str, theme: Theme, language: Language, size: [u32; 2]) -> Picture {
    let scenario = scenario(name);
    let mut simulation = scenario.start().unwrap();
    let preferences = Preferences { language, theme, hints_seen: u8::MAX, ..Preferences::default() };
    let view = StudioView { size, preferences, ..StudioView::default() };
    let mut studio = Studio::new(REGISTRY, scenario, view).unwrap();
    let (start, end) = (simulation.time(), simulation.end());
    for look in 1..=50 {
        simulation.advance(start + 0.2 * (end - start) * f64::from(look) / 50.0).unwrap();
        studio.look(simulation.as_ref());
    }
    studio.picture(simulation.as_ref(), true).unwrap()
}

/// The mean colour of each block.
fn reduced(picture: &Picture) -> Picture {
    let side = picture.width / WIDTH;
    let (width, height) = (picture.width / side, picture.height / side);
    let mut rgba = vec![];
    for y in 0..height {
        for x in 0..width {
            let block = (0..side * side).map(|k| picture.pixel(x * side + k % side, y * side + k / side).unwrap());
            let sums = block.fold([0u32; 4], |sums, pixel| std::array::from_fn(|c| sums[c] + u32::from(pixel[c])));
            rgba.extend(sums.map(|sum| (sum / (side * side)) as u8));
        }
    }
    Picture { width, height, rgba }
}

fn read(path: &Path) -> Picture {
    let file = std::fs::File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let samples = info.color_type.samples();
    let rgba = bytes.chunks_exact(samples).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
    Picture { width: info.width, height: info.height, rgba }
}

fn difference(a: &Picture, b: &Picture) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let sum: u64 = a.rgba.iter().zip(&b.rgba).map(|(&a, &b)| u64::from(a.abs_diff(b))).sum();
    sum as f64 / f64::from(3 * a.width * a.height)
}

#[test]
fn every_experiment_looks_as_it_did_when_somebody_looked() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/references");
    let write = std::env::var_os("CORPUSCLE_REFERENCES").is_some();
    let mut wrong = vec![];
    for name in ["brownian", "entropy", "ideal-gas", "three-body", "wave"] {
        for (theme, language, size, kind) in KINDS {
            let now = reduced(&window(name, theme, language, size));
            let path = folder.join(format!("{name}-{kind}.png"));
            if write {
                std::fs::create_dir_all(&folder).unwrap();
                std::fs::write(&path, now.to_png().unwrap()).unwrap();
                continue;
            }
            let apart = difference(&now, &read(&path));
            if apart > TOLERANCE {
                wrong.push(format!("{name} {kind}: {apart:.2}"));
            }
        }
    }
    assert!(wrong.is_empty(), "look at them, and make the references anew if they are right: {wrong:?}");
}

/// A tolerance that nothing exceeds would be no test.
#[test]
fn another_window_is_another_picture() {
    let wave = reduced(&window("wave", Theme::Dark, Language::English, SMALL));
    for (name, theme, language) in [
        ("entropy", Theme::Dark, Language::English),
        ("wave", Theme::Light, Language::English),
        ("wave", Theme::Dark, Language::Chinese),
    ] {
        let apart = difference(&wave, &reduced(&window(name, theme, language, SMALL)));
        assert!(apart > TOLERANCE, "{name} {theme:?} {language:?}: only {apart:.2}");
    }
}
