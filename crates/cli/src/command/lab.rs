//! `corpuscle lab`, and `corpuscle` alone: the laboratory's window.

use std::process::ExitCode;

use clap::Args;
use corpuscle_io::{Registry, Scenario};
use corpuscle_lab::Options;
use corpuscle_render::{RenderError, window};

use super::{assignment, seed};
use crate::picture::{LanguageName, PaletteName, Size};
use crate::trouble::Trouble;
use crate::usage;
use crate::{console, memory};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Name of an experiment, or a scenario file [default: the experiment of last time].
    #[arg(value_name = "NAME|FILE")]
    name: Option<String>,
    /// Set a parameter; may be given several times.
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment, allow_hyphen_values = true, requires = "name")]
    set: Vec<(String, String)>,
    /// Seed of all random numbers [default: the file's, or 1].
    #[arg(long, value_parser = seed, allow_hyphen_values = true, requires = "name")]
    seed: Option<u64>,
    #[command(flatten)]
    look: Look,
}

/// How the window opens; what is not given is as it was last time.
#[derive(Args, Clone, Copy)]
pub(crate) struct Look {
    /// Colours.
    #[arg(long, value_enum)]
    pub(super) palette: Option<PaletteName>,
    /// Language of the window.
    #[arg(long, value_enum)]
    pub(super) language: Option<LanguageName>,
}

pub(crate) fn lab(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let mut scenario = arguments.name.as_deref().map(|name| Scenario::find(registry, name)).transpose()?;
    if let Some(scenario) = &mut scenario {
        for (key, value) in &arguments.set {
            scenario.set(key, value)?;
        }
        scenario.settings.seed = arguments.seed.unwrap_or(scenario.settings.seed);
        memory::admit(scenario)?;
    }
    open(registry, scenario, None, arguments.look)
}

/// Opens the window.
pub(super) fn open(registry: Registry, scenario: Option<Scenario>, size: Option<Size>, look: Look) -> Result<ExitCode, Trouble> {
    let size = size.map(|Size { width, height }| [width as f32, height as f32]);
    let (theme, language) = (look.palette.map(Into::into), look.language.map(Into::into));
    corpuscle_lab::open(registry, Options { scenario, size, theme, language })?;
    Ok(ExitCode::SUCCESS)
}

/// `corpuscle` alone: the window where there is a display, and what to type where there is none.
pub(crate) fn welcome(registry: Registry) -> Result<ExitCode, Trouble> {
    if let Err(RenderError::NoDisplay { cause }) = window::check() {
        console::print(&usage::welcome(registry, &cause))?;
        return Ok(ExitCode::SUCCESS);
    }
    open(registry, None, None, Look { palette: None, language: None })
}
