//! `corpuscle view`: a window onto a running experiment, or a picture of what it would show.

mod driver;
mod window;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use corpuscle_experiments::Simulation;
use corpuscle_io::{Registry, Scenario, write};
use corpuscle_lab::language::Language;
use corpuscle_render::window::Options;

use super::lab::{self, Look};
use super::target::{extension, refuse, vacant};
use super::{Subject, physical_time};
use crate::console;
use crate::picture::{Artist, Draws, PaletteName, Size, studio};
use crate::progress::Progress;
use crate::signal::Stop;
use crate::trouble::Trouble;

/// Looks at the system on the way to a screenshot, for the trails.
const LOOKS: u32 = 600;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// Save a picture and open no window.
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<PathBuf>,
    /// Overwrite a picture that is there.
    #[arg(long, requires = "screenshot")]
    force: bool,
    /// Physical time of the picture.
    #[arg(long, default_value = "0", value_parser = physical_time, allow_hyphen_values = true)]
    at: f64,
    /// Width and height in pixels.
    #[arg(long, default_value = "1280x800", allow_hyphen_values = true)]
    size: Size,
    #[command(flatten)]
    look: Look,
    /// The picture alone, in a plain window.
    #[arg(long)]
    no_panels: bool,
}

pub(crate) fn view(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let scenario = arguments.subject.scenario(registry)?;
    let (name, seed) = (scenario.name().to_owned(), scenario.settings.seed);
    if let Some(path) = &arguments.screenshot {
        if extension(path).as_deref() != Some("png") || path.is_dir() {
            return Err(refuse("screenshot", path.display(), "the name of a file that ends in .png").into());
        }
        vacant("screenshot", path, arguments.force)?;
        let mut simulation = scenario.start()?;
        if arguments.no_panels {
            screenshot(arguments, simulation.as_mut(), path)?;
        } else {
            window_screenshot(arguments, registry, scenario, simulation.as_mut(), path)?;
        }
        console::print(&format!("{name}, seed {seed}: {}\n", path.display()))?;
    } else if !arguments.no_panels {
        return lab::open(registry, Some(scenario), Some(arguments.size), arguments.look);
    } else {
        let Size { width, height } = arguments.size;
        let title = format!("{} · Corpuscle", scenario.title());
        window::open(registry, scenario, Options { title, width, height, palette: arguments.palette().into() })?;
    }
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    fn palette(&self) -> PaletteName {
        self.look.palette.unwrap_or_default()
    }
}

/// The stage alone.
fn screenshot(arguments: &Arguments, simulation: &mut dyn Simulation, path: &Path) -> Result<(), Trouble> {
    let mut artist = Artist::new(arguments.size, arguments.palette().into())?;
    approach(arguments.at, simulation, |simulation| {
        artist.look(simulation);
    })?;
    Ok(write::atomically(path, &artist.picture(simulation)?.png)?)
}

/// The whole window.
fn window_screenshot(
    arguments: &Arguments,
    registry: Registry,
    scenario: Scenario,
    simulation: &mut dyn Simulation,
    path: &Path,
) -> Result<(), Trouble> {
    let language = arguments.look.language.map_or(Language::English, Into::into);
    let mut studio = studio(registry, scenario, arguments.size, arguments.palette().into(), language)?;
    approach(arguments.at, simulation, |simulation| {
        studio.look(simulation);
    })?;
    Ok(write::atomically(path, &studio.picture(simulation, false)?.to_png()?)?)
}

/// Advances to a time with looks on the way, for the trails.
fn approach(at: f64, simulation: &mut dyn Simulation, mut look: impl FnMut(&dyn Simulation)) -> Result<(), Trouble> {
    let start = simulation.time();
    let to = at.max(start);
    let mut progress = Progress::new(simulation, to, false, Stop::listen());
    for step in 1..=LOOKS {
        let part = if step == LOOKS { to } else { start + (to - start) * f64::from(step) / f64::from(LOOKS) };
        if !progress.advance(simulation, part)? {
            return Err(Trouble::Interrupted("stopped before the picture; nothing was written".into()));
        }
        look(simulation);
    }
    progress.finish();
    Ok(())
}
