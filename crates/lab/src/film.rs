//! Films and pictures of what runs. The window hands its scenario, as a file, to the command's own `record`: so the same
//! scenario and seed give the same pictures either way, and the window goes on while they are made.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// What is to be recorded, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// File (`.mp4`, `.gif`, `.png`) or folder.
    pub path: String,
    /// Physical time of the first picture.
    pub from: f64,
    /// Physical time of the last.
    pub until: f64,
    /// Seconds that the film lasts.
    pub seconds: f64,
    /// Pictures in a second of the film.
    pub fps: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether the whole window is recorded, with its panels.
    pub panels: bool,
    /// Whether the ground is light.
    pub light: bool,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            path: "film.mp4".into(),
            from: 0.0,
            until: 0.0,
            seconds: 10.0,
            fps: 30.0,
            size: [1280, 720],
            panels: false,
            light: false,
        }
    }
}

impl Film {
    /// Whether it is one picture, of the time it ends at.
    pub fn is_picture(&self) -> bool {
        Path::new(&self.path).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
    }

    /// The arguments of the command that records it.
    pub fn arguments(&self, scenario: &str) -> Vec<String> {
        let size = format!("{}x{}", self.size[0], self.size[1]);
        let palette = if self.light { "light" } else { "dark" };
        let mut words: Vec<String> = if self.is_picture() {
            ["view", scenario, "--screenshot", &self.path, "--at", &self.until.to_string()].map(Into::into).to_vec()
        } else {
            let speed = (self.until - self.from) / self.seconds;
            let (from, to) = (self.from.to_string(), self.until.to_string());
            let (speed, fps) = (speed.to_string(), self.fps.to_string());
            ["record", scenario, "--out", &self.path, "--from", &from, "--to", &to, "--speed", &speed, "--fps", &fps]
                .map(Into::into)
                .to_vec()
        };
        words.extend(["--size", &size, "--palette", palette, "--force"].map(Into::into));
        match (self.is_picture(), self.panels) {
            (true, false) => words.push("--no-panels".into()),
            (false, true) => words.push("--panels".into()),
            _ => {}
        }
        words
    }
}

/// A film in the making, in a process of its own.
pub struct Recording {
    child: Child,
    /// Holds the scenario for as long as the process needs it.
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Recording {
    /// Starts recording a scenario, given as the text of its file.
    ///
    /// # Errors
    /// The system's words, when the scenario cannot be written or the command not be started.
    pub fn start(film: &Film, scenario: &str) -> std::io::Result<Self> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("scenario.toml");
        std::fs::write(&file, scenario)?;
        let child = Command::new(std::env::current_exe()?)
            .args(film.arguments(&file.to_string_lossy()))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()?;
        Ok(Self { child, _folder: folder, path: film.path.clone().into() })
    }

    /// The file, once it is whole; or what went wrong, in the command's words. None while it is being made.
    pub fn outcome(&mut self) -> Option<Result<PathBuf, String>> {
        match self.child.try_wait() {
            Ok(None) => None,
            Ok(Some(status)) if status.success() => Some(Ok(self.path.clone())),
            Ok(Some(_)) => {
                let mut words = String::new();
                if let Some(mut pipe) = self.child.stderr.take() {
                    let _ = pipe.read_to_string(&mut words);
                }
                let last = words.lines().map(str::trim).rfind(|line| !line.is_empty()).unwrap_or_default();
                Some(Err(last.trim_start_matches("corpuscle: ").to_owned()))
            }
            Err(error) => Some(Err(error.to_string())),
        }
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        // Ended with the window; the command leaves nothing half-written under the film's name.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_is_what_the_command_would_record() {
        let film = Film { from: 1.0, until: 5.0, seconds: 8.0, panels: true, ..Film::default() };
        let words = film.arguments("a.toml").join(" ");
        assert_eq!(
            words,
            "record a.toml --out film.mp4 --from 1 --to 5 --speed 0.5 --fps 30 --size 1280x720 --palette dark --force --panels"
        );
        let picture = Film { path: "p.PNG".into(), until: 2.5, light: true, ..Film::default() };
        let words = picture.arguments("a.toml").join(" ");
        assert_eq!(words, "view a.toml --screenshot p.PNG --at 2.5 --size 1280x720 --palette light --force --no-panels");
    }
}
