//! The one place of the command that draws: everything else asks for a picture and gets bytes.

use std::str::FromStr;

use corpuscle_experiments::Simulation;
use corpuscle_io::{Picture, Registry, Scenario};
use corpuscle_lab::language::Language;
use corpuscle_lab::theme::Theme;
use corpuscle_lab::{Preferences, Studio, StudioView};
use corpuscle_render::{Headless, RenderError, View};
use corpuscle_scene::{Palette, Scene};

/// Width and height in pixels, written `1280x800`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.trim().parse::<u32>().ok().filter(|&side| side > 0);
        let sides = text.split_once(['x', 'X', '×']).and_then(|(width, height)| Some((side(width)?, side(height)?)));
        sides.map(|(width, height)| Self { width, height }).ok_or_else(|| "expected WIDTHxHEIGHT in pixels, as in 1280x800".into())
    }
}

/// The palettes, by name.
#[derive(Clone, Copy, Debug, Default, clap::ValueEnum)]
pub(crate) enum PaletteName {
    /// For screens.
    #[default]
    Dark,
    /// For bright rooms and print.
    Light,
    /// For projectors: black on white, larger.
    Projector,
}

impl From<PaletteName> for Palette {
    fn from(name: PaletteName) -> Self {
        match name {
            PaletteName::Dark => Self::Dark,
            PaletteName::Light | PaletteName::Projector => Self::Light,
        }
    }
}

impl From<PaletteName> for Theme {
    fn from(name: PaletteName) -> Self {
        match name {
            PaletteName::Dark => Self::Dark,
            PaletteName::Light => Self::Light,
            PaletteName::Projector => Self::Projector,
        }
    }
}

/// The languages of the window, by name.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum LanguageName {
    /// English.
    English,
    /// Simplified Chinese.
    Chinese,
}

impl From<LanguageName> for Language {
    fn from(name: LanguageName) -> Self {
        match name {
            LanguageName::English => Self::English,
            LanguageName::Chinese => Self::Chinese,
        }
    }
}

/// A window as nobody has changed it: not even the person whose machine it is, so that a picture is the same everywhere.
pub(crate) fn studio(
    registry: Registry,
    scenario: Scenario,
    size: Size,
    theme: Theme,
    language: Language,
) -> Result<Studio, RenderError> {
    let preferences = Preferences { language, theme, hints_seen: u8::MAX, ..Preferences::default() };
    let view = StudioView { size: [size.width, size.height], scale: 1.0, preferences, ..StudioView::default() };
    Studio::new(registry, scenario, view)
}

/// Who draws a simulation without a screen: the stage alone, or the whole window.
pub(crate) trait Draws {
    /// Looks without drawing, so that trails have a point for this moment; false when looking is of no use.
    fn look(&mut self, simulation: &dyn Simulation) -> bool;

    /// The pixels of what there is to see now.
    fn draw(&mut self, simulation: &dyn Simulation) -> Result<corpuscle_render::Picture, RenderError>;
}

impl Draws for Studio {
    fn look(&mut self, simulation: &dyn Simulation) -> bool {
        Self::look(self, simulation)
    }

    fn draw(&mut self, simulation: &dyn Simulation) -> Result<corpuscle_render::Picture, RenderError> {
        self.picture(simulation, true)
    }
}

/// Draws a simulation without a screen, again and again: trails grow from one look to the next.
pub(crate) struct Artist {
    headless: Headless,
    view: View,
    scene: Scene,
}

impl Artist {
    /// An artist for pictures of this size.
    pub(crate) fn new(size: Size, palette: Palette) -> Result<Self, RenderError> {
        let headless = Headless::new(size.width, size.height)?;
        let view = headless.view().palette(palette);
        Ok(Self { headless, view, scene: Scene::default() })
    }

    /// The same with texts and lines larger by a factor, for pictures that are shown smaller than they are.
    pub(crate) fn enlarged(mut self, factor: f32) -> Self {
        self.view.scale *= factor;
        self
    }

    /// A picture of what there is to see now, for the report.
    pub(crate) fn picture(&mut self, simulation: &dyn Simulation) -> Result<Picture, RenderError> {
        let png = self.draw(simulation)?.to_png()?;
        Ok(Picture { time: simulation.time(), caption: self.scene.caption.clone(), png })
    }
}

impl Draws for Artist {
    fn look(&mut self, simulation: &dyn Simulation) -> bool {
        simulation.draw(&mut self.scene);
        !self.scene.trails.is_empty()
    }

    fn draw(&mut self, simulation: &dyn Simulation) -> Result<corpuscle_render::Picture, RenderError> {
        self.look(simulation);
        self.headless.picture(&self.scene, &self.view)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_nonsense_is_not() {
        assert_eq!("1280x800".parse(), Ok(Size { width: 1280, height: 800 }));
        for text in ["", "1280", "x", "0x10", "-1x5", "1e3x5", "axb", "1x2x3"] {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
    }
}
