//! A display in memory, with real key presses and pixels.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longer than any machine needs that works at all.
pub(crate) const DEADLINE: Duration = Duration::from_secs(90);
/// A window that shows the same for so long stands still: it draws sixty times a second where it can.
const STILL: Duration = Duration::from_millis(1200);
/// Between two looks.
const PAUSE: Duration = Duration::from_millis(40);

/// An X server that keeps its screen in a file. Ends with the value.
pub(crate) struct Display {
    server: Child,
    name: String,
    folder: tempfile::TempDir,
}

/// Red, green and blue of every pixel, row by row.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Pixels(Vec<[u8; 3]>);

impl Pixels {
    /// Mean of all channels, from 0 to 255.
    pub(crate) fn brightness(&self) -> f64 {
        let sum: u64 = self.0.iter().flatten().map(|&channel| u64::from(channel)).sum();
        sum as f64 / (3 * self.0.len()) as f64
    }

    /// Number of different colours.
    pub(crate) fn colours(&self) -> usize {
        self.0.iter().collect::<std::collections::HashSet<_>>().len()
    }
}

impl Display {
    /// Starts a server on whatever display is free.
    #[allow(dead_code, reason = "each test that shares this file uses its own part of it")]
    pub(crate) fn start() -> Self {
        Self::of_size("720x480")
    }

    /// The same with a screen of so many pixels, written `720x480`.
    pub(crate) fn of_size(size: &str) -> Self {
        let screen = format!("{size}x24");
        let folder = tempfile::tempdir().unwrap();
        // `-displayfd 1`: the server chooses the number and prints it when it is ready. `-noreset`: or it would start again
        // whenever the last client leaves, and take those with it that are just arriving.
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp", "-noreset", "-fbdir"])
            .arg(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = server.unwrap_or_else(|error| panic!("Xvfb cannot be started ({error}): install the package xvfb"));
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb ended before it was ready");
        Self { server, name: format!(":{}", number.trim()), folder }
    }

    /// A command that sees this display and no other.
    pub(crate) fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        command
    }

    /// What is on the screen now: the server maps it into a file in the format of `xwd`.
    pub(crate) fn pixels(&self) -> Pixels {
        let bytes = fs::read(self.folder.path().join("Xvfb_screen0")).unwrap();
        let field = |place: usize| u32::from_be_bytes(bytes[4 * place..4 * place + 4].try_into().unwrap()) as usize;
        let (header, width, height, bits, row, colours) = (field(0), field(4), field(5), field(11), field(12), field(19));
        assert_eq!(bits, 32);
        let start = header + 12 * colours;
        let rows = (0..height).map(|y| &bytes[start + y * row..start + y * row + 4 * width]);
        Pixels(rows.flat_map(|row| row.chunks_exact(4)).map(|pixel| [pixel[2], pixel[1], pixel[0]]).collect())
    }

    /// Waits until the screen shows something that `right` accepts.
    pub(crate) fn wait_for(&self, what: &str, right: impl Fn(&Pixels) -> bool) -> Pixels {
        let start = Instant::now();
        loop {
            let pixels = self.pixels();
            if right(&pixels) {
                return pixels;
            }
            assert!(start.elapsed() < DEADLINE, "waited in vain for: {what}");
            sleep(PAUSE);
        }
    }

    /// Waits until the screen has stood still for a while, showing something that `right` accepts.
    pub(crate) fn wait_for_still(&self, what: &str, right: impl Fn(&Pixels) -> bool) -> Pixels {
        let start = Instant::now();
        let (mut last, mut since) = (self.pixels(), Instant::now());
        loop {
            sleep(PAUSE);
            let pixels = self.pixels();
            if pixels != last {
                (last, since) = (pixels, Instant::now());
            } else if since.elapsed() > STILL && right(&last) {
                return last;
            }
            assert!(start.elapsed() < DEADLINE, "waited in vain for a still picture: {what}");
        }
    }

    /// Presses keys, or whatever else `xdotool` can do.
    pub(crate) fn xdotool(&self, arguments: &[&str]) -> String {
        let output = self.command("xdotool").args(arguments).output();
        let output = output.unwrap_or_else(|error| panic!("xdotool cannot be started ({error}): install the package xdotool"));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Waits for the window of this title and gives it the keyboard: there is no window manager to do so.
    pub(crate) fn focus(&self, title: &str) -> String {
        let start = Instant::now();
        loop {
            let found = self.xdotool(&["search", "--onlyvisible", "--name", title]);
            if let Some(window) = found.lines().last() {
                self.xdotool(&["windowfocus", window, "mousemove", "--window", window, "300", "200"]);
                if self.xdotool(&["getwindowfocus"]).trim() == window {
                    return window.to_owned();
                }
            }
            assert!(start.elapsed() < DEADLINE, "no window called {title}");
            sleep(PAUSE);
        }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Waits for a process to end by itself, and ends it when it does not.
pub(crate) fn exit_code(mut child: Child) -> Option<i32> {
    let start = Instant::now();
    while start.elapsed() < DEADLINE {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        sleep(PAUSE);
    }
    let _ = child.kill();
    panic!("the process does not end");
}
