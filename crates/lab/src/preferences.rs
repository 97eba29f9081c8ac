//! What the window remembers from one day to the next, in a small file of the user's.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::language::Language;
use crate::runner::Paint;
use crate::theme::Theme;

/// Preferences of a person at this machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct Preferences {
    /// Language of the window.
    pub language: Language,
    /// Colours.
    pub theme: Theme,
    /// Size of everything, 1 for the usual.
    pub scale: f32,
    /// Width and height of the window in points.
    pub size: [f32; 2],
    /// Experiment that was open last.
    pub experiment: Option<String>,
    /// What the bodies' colours tell.
    pub paint: Paint,
    /// Whether velocities are drawn as arrows.
    pub arrows: bool,
    /// Hints that were read or waved away.
    pub hints_seen: u8,
}

/// Text sizes that `Ctrl +` and `Ctrl −` go through.
const SCALES: [f32; 7] = [0.8, 0.9, 1.0, 1.15, 1.3, 1.5, 1.8];
/// A window that is smaller shows too little; a larger one is no window.
const SIDES: [f32; 2] = [640.0, 8000.0];

impl Default for Preferences {
    fn default() -> Self {
        let language = Language::of_the_system();
        Self {
            language,
            theme: Theme::default(),
            scale: 1.0,
            size: [1280.0, 800.0],
            experiment: None,
            paint: Paint::default(),
            arrows: false,
            hints_seen: 0,
        }
    }
}

impl Preferences {
    /// Where they are kept: `corpuscle/lab.toml` in the system's folder for such things; none where there is no such folder.
    pub fn place() -> Option<PathBuf> {
        let folder = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let base = if cfg!(windows) {
            folder("APPDATA")
        } else if cfg!(target_os = "macos") {
            folder("HOME").map(|home| home.join("Library/Application Support"))
        } else {
            folder("XDG_CONFIG_HOME").or_else(|| folder("HOME").map(|home| home.join(".config")))
        };
        base.map(|base| base.join("corpuscle").join("lab.toml"))
    }

    /// What is kept at `path`; the defaults where there is nothing, or nothing that can be read.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        toml::from_str::<Self>(&text).unwrap_or_default().sound()
    }

    /// Keeps them at `path`. Preferences are no results: where they cannot be kept, they are lost without a word.
    pub fn keep(&self, path: &Path) {
        if let (Some(folder), Ok(text)) = (path.parent(), toml::to_string(self)) {
            let _ = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(path, text));
        }
    }

    /// Larger (1) or smaller (-1) text.
    pub fn resize_text(&mut self, steps: isize) {
        let place = SCALES.iter().position(|&scale| scale >= self.scale - 1e-3).unwrap_or(SCALES.len() - 1);
        self.scale = SCALES[place.saturating_add_signed(steps).min(SCALES.len() - 1)];
    }

    /// A file written by hand may hold anything.
    fn sound(mut self) -> Self {
        let usual = Self::default();
        if !self.scale.is_finite() || !(SCALES[0]..=SCALES[6]).contains(&self.scale) {
            self.scale = usual.scale;
        }
        if !self.size.iter().all(|side| side.is_finite() && (SIDES[0] * 0.6..=SIDES[1]).contains(side)) {
            self.size = usual.size;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_kept_and_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("corpuscle").join("lab.toml");
        let mut preferences = Preferences { language: Language::Chinese, theme: Theme::Projector, ..Preferences::default() };
        preferences.experiment = Some("wave".into());
        preferences.keep(&path);
        assert_eq!(Preferences::read(&path), preferences);
    }

    #[test]
    fn nonsense_leaves_the_defaults() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lab.toml");
        assert_eq!(Preferences::read(&path), Preferences::default());
        for text in ["scale = nan", "size = [1.0, inf]", "scale = \"large\"", "[[", "scale = -3.0"] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(Preferences::read(&path), Preferences::default(), "{text}");
        }
    }

    #[test]
    fn text_sizes_end_somewhere() {
        let mut preferences = Preferences::default();
        (0..20).for_each(|_| preferences.resize_text(1));
        assert_eq!(preferences.scale, 1.8);
        (0..20).for_each(|_| preferences.resize_text(-1));
        assert_eq!(preferences.scale, 0.8);
    }
}
