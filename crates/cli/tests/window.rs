//! The window as a viewer meets it: real key presses on a real display, judged by its pixels. Needs Xvfb and xdotool.

#![cfg(target_os = "linux")] // the display in memory is X's; the window's logic is tested everywhere, in the driver's tests
#![allow(clippy::unwrap_used, clippy::panic)] // in the helpers too: a test that cannot be set up has failed

#[path = "support/display.rs"]
mod display;

use std::process::{Child, Stdio};

use display::{DEADLINE, Display, exit_code};

/// Ended with the test, whatever becomes of it.
struct Viewer(Option<Child>);

impl Viewer {
    fn open(display: &Display, arguments: &[&str]) -> Self {
        let mut command = display.command(env!("CARGO_BIN_EXE_corpuscle"));
        let child = command.args(["view", "--no-panels", "--size", "720x480"]).args(arguments).stdout(Stdio::null()).spawn();
        let viewer = Self(Some(child.unwrap()));
        display.focus("Corpuscle");
        viewer
    }

    fn exit_code(mut self) -> Option<i32> {
        exit_code(self.0.take().unwrap())
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Every key, on this experiment.
fn keys_do_what_the_help_says(experiment: &[&str]) {
    let display = Display::start();
    let viewer = Viewer::open(&display, experiment);
    let press = |key: &str| drop(display.xdotool(&["key", key]));

    let early = display.wait_for("a picture", |pixels| pixels.colours() > 20);
    display.wait_for("motion", |pixels| *pixels != early);

    press("space");
    let paused = display.wait_for_still("the pause", |_| true);
    press("r");
    let start = display.wait_for_still("the start", |pixels| *pixels != paused);

    press("period");
    let step = display.wait_for_still("a step", |pixels| *pixels != start);
    press("Right");
    display.wait_for_still("another step", |pixels| *pixels != start && *pixels != step);
    press("r");
    display.wait_for_still("the same start", |pixels| *pixels == start);

    for (there, back, what) in
        [("plus", "minus", "the speed"), ("h", "question", "the help"), ("t", "t", "the palette"), ("minus", "plus", "the speed")]
    {
        press(there);
        let changed = display.wait_for_still(what, |pixels| *pixels != start);
        if there == "t" {
            assert!(changed.brightness() > start.brightness() + 100.0, "a light palette is light");
        }
        press(back);
        display.wait_for_still(what, |pixels| *pixels == start);
    }
    // The wheel zooms, and `f` fits again.
    display.xdotool(&["click", "4"]);
    display.wait_for_still("the zoom", |pixels| *pixels != start);
    press("f");
    display.wait_for_still("the whole view", |pixels| *pixels == start);

    press("bracketright");
    let other = display.wait_for("the next experiment", |pixels| *pixels != start);
    display.wait_for("its motion", |pixels| *pixels != other);
    press("space");
    display.wait_for_still("its pause", |_| true);
    press("space");
    let again = display.pixels();
    display.wait_for("its going on", |pixels| *pixels != again);

    press("q");
    assert_eq!(viewer.exit_code(), Some(0), "q leaves within {DEADLINE:?}");
}

#[test]
fn three_bodies_under_the_keyboard() {
    keys_do_what_the_help_says(&["three-body"]);
}

#[test]
fn a_gas_under_the_keyboard() {
    keys_do_what_the_help_says(&["brownian", "--set", "particles=200"]);
}

#[test]
fn escape_leaves_while_it_runs() {
    let display = Display::start();
    let viewer = Viewer::open(&display, &["wave", "--palette", "light"]);
    display.wait_for("a light picture", |pixels| pixels.brightness() > 128.0 && pixels.colours() > 20);
    display.xdotool(&["key", "Escape"]);
    assert_eq!(viewer.exit_code(), Some(0));
}

#[test]
fn a_display_without_opengl_is_explained() {
    let display = Display::start();
    for arguments in [&["view", "wave", "--no-panels"][..], &["lab", "wave"], &["view", "wave"]] {
        let mut command = display.command(env!("CARGO_BIN_EXE_corpuscle"));
        let output = command
            .args(arguments)
            .env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
            .env("__GLX_VENDOR_LIBRARY_NAME", "nonexistent")
            .env("LIBGL_DRIVERS_PATH", "/nonexistent")
            .output()
            .unwrap();
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{complaint}");
        assert!(
            complaint.contains("OpenGL") && complaint.contains("install lib") && !complaint.contains("panicked"),
            "{complaint}"
        );
    }
}
