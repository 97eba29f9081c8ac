//! `corpuscle view`: a window onto a running experiment, or a picture of what it would show.

mod driver;
mod window;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use corpuscle_experiments::Simulation;
use corpuscle_io::{Registry, write};
use corpuscle_render::window::Options;

use super::target::{extension, refuse, vacant};
use super::{Subject, physical_time};
use crate::console;
use crate::picture::{Artist, PaletteName, Size};
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
    /// Ground and ink.
    #[arg(long, value_enum, default_value_t)]
    palette: PaletteName,
}

pub(crate) fn view(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let scenario = arguments.subject.scenario(registry)?;
    let (name, seed) = (scenario.name().to_owned(), scenario.settings.seed);
    if let Some(path) = &arguments.screenshot {
        if extension(path).as_deref() != Some("png") || path.is_dir() {
            return Err(refuse("screenshot", path.display(), "the name of a file that ends in .png").into());
        }
        vacant("screenshot", path, arguments.force)?;
        screenshot(arguments, scenario.start()?.as_mut(), path)?;
        console::print(&format!("{name}, seed {seed}: {}\n", path.display()))?;
    } else {
        let Size { width, height } = arguments.size;
        let title = format!("{} · Corpuscle", scenario.title());
        window::open(registry, scenario, Options { title, width, height, palette: arguments.palette.into() })?;
    }
    Ok(ExitCode::SUCCESS)
}

fn screenshot(arguments: &Arguments, simulation: &mut dyn Simulation, path: &Path) -> Result<(), Trouble> {
    let mut artist = Artist::new(arguments.size, arguments.palette.into())?;
    let start = simulation.time();
    let to = arguments.at.max(start);
    let mut progress = Progress::new(simulation, to, false, Stop::listen());
    for look in 1..=LOOKS {
        let part = if look == LOOKS { to } else { start + (to - start) * f64::from(look) / f64::from(LOOKS) };
        if !progress.advance(simulation, part)? {
            return Err(Trouble::Interrupted("stopped before the picture; nothing was written".into()));
        }
        artist.look(simulation);
    }
    progress.finish();
    Ok(write::atomically(path, &artist.picture(simulation)?.png)?)
}
