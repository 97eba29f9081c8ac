//! The laboratory's window driven from the keyboard alone, with real key events on a real display. Needs Xvfb and xdotool.

#![cfg(target_os = "linux")] // the display in memory is X's; the panels are tested everywhere, in the lab's own tests
#![allow(clippy::unwrap_used, clippy::panic)] // in the helpers too: a test that cannot be set up has failed

#[path = "support/display.rs"]
mod display;

use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use display::{DEADLINE, Display, exit_code};

/// The five experiments of the paper, in the registry's order; others may stand between them.
const PAPER: [&str; 5] = ["brownian", "entropy", "ideal-gas", "three-body", "wave"];

/// The window, at home in a folder of its own.
fn open(display: &Display, folder: &Path) -> Child {
    let mut command = display.command(env!("CARGO_BIN_EXE_corpuscle"));
    command.current_dir(folder).env("XDG_CONFIG_HOME", folder).env("HOME", folder).env("LC_ALL", "C");
    let child = command.args(["lab", PAPER[0], "--set", "replicas=2"]).stdout(Stdio::null()).spawn().unwrap();
    display.focus("Corpuscle");
    child
}

/// Waits for a file to be there, and reads it.
fn wait_for_file(path: &Path) -> String {
    let start = Instant::now();
    loop {
        if let Ok(text) = fs::read_to_string(path) {
            return text;
        }
        assert!(start.elapsed() < DEADLINE, "{} has not been written", path.display());
        std::thread::sleep(Duration::from_millis(40));
    }
}

#[test]
fn the_five_experiments_from_the_keyboard_alone() {
    let folder = tempfile::tempdir().unwrap();
    let display = Display::of_size("1280x800");
    let child = open(&display, folder.path());
    let press = |keys: &[&str]| drop(display.xdotool(&[&["key", "--delay", "120"][..], keys].concat()));
    // The hints go away, and do not come back.
    display.wait_for("the window", |pixels| pixels.colours() > 200);

    let mut visited = vec![];
    while visited.len() < PAPER.len() {
        let early = display.pixels();
        display.wait_for("motion", |pixels| *pixels != early);
        press(&["space"]);
        let paused = display.wait_for_still("the pause", |_| true);
        press(&["period"]);
        let step = display.wait_for_still("a step", |pixels| *pixels != paused);
        press(&["2"]);
        display.wait_for_still("the checks", |pixels| *pixels != step);
        press(&["1"]);
        display.wait_for_still("the charts", |pixels| *pixels == step);
        // What runs is a scenario file: saved by the keyboard, read here.
        press(&["ctrl+s", "Return"]);
        let name = PAPER[visited.len()];
        let text = wait_for_file(&folder.path().join(format!("{name}.toml")));
        assert!(text.contains(&format!("experiment = \"{name}\"")), "{text}");
        visited.push(name);
        if visited.len() < PAPER.len() {
            press(&["bracketright"]);
        }
    }
    press(&["p", "l"]);
    // At once: whoever ends the window from outside loses no choice.
    let kept = folder.path().join("corpuscle/lab.toml");
    wait_for_file(&kept);
    let parts = ["theme = \"light\"", "language = \"chinese\"", "experiment = \"wave\""];
    let started = Instant::now();
    while !parts.iter().all(|part| fs::read_to_string(&kept).is_ok_and(|text| text.contains(part))) {
        assert!(started.elapsed() < Duration::from_secs(30), "{:?}", fs::read_to_string(&kept));
        std::thread::sleep(Duration::from_millis(50));
    }
    press(&["ctrl+q"]);
    assert_eq!(exit_code(child), Some(0));
}

/// Two baths of 50,000 in the engine, faster than it can be, and keys are still heard: software OpenGL and the engine share the
/// machine, so that the bound is a generous one.
#[test]
fn the_window_never_waits_for_a_saturated_engine() {
    let folder = tempfile::tempdir().unwrap();
    let display = Display::of_size("1280x800");
    let mut command = display.command(env!("CARGO_BIN_EXE_corpuscle"));
    command.current_dir(folder.path()).env("XDG_CONFIG_HOME", folder.path()).env("HOME", folder.path());
    let words = ["lab", "brownian", "--set", "particles=50000", "--set", "replicas=2"];
    let child = command.args(words).stdout(Stdio::null()).spawn().unwrap();
    display.focus("Corpuscle");
    display.wait_for("the window", |pixels| pixels.colours() > 200);
    let before = display.pixels().brightness();
    let asked = Instant::now();
    display.xdotool(&["key", "p"]);
    display.wait_for("the light palette", |pixels| pixels.brightness() > before + 60.0);
    assert!(asked.elapsed() < Duration::from_secs(5), "it took {:?} to change colours", asked.elapsed());
    display.xdotool(&["key", "ctrl+q"]);
    assert_eq!(exit_code(child), Some(0));
}
