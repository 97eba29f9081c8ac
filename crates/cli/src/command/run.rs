//! `corpuscle run`: an experiment from start to end, its checks on the terminal, its report in a folder.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use corpuscle_io::{Folder, Registry};

use super::{Subject, positive};
use crate::session::Session;
use crate::trouble::Trouble;
use crate::{console, keeper};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// Folder to write into [default: results/NAME, or results/NAME-2, ... when that exists].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite files in a folder that is not empty.
    #[arg(long, requires = "out")]
    force: bool,
    /// Threads to use [default: all cores]. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// How long to run, as the parameter `duration` where the experiment has one [default: what it needs].
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true)]
    duration: Option<f64>,
    /// Leave out the pictures.
    #[arg(long)]
    no_pictures: bool,
    /// Print one line only.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    checkpoints: keeper::Options,
}

pub(crate) fn run(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let mut scenario = arguments.subject.scenario(registry)?;
    if let Some(duration) = arguments.duration {
        scenario.set_duration(duration)?;
    }
    use_threads(arguments.threads);
    let simulation = scenario.start()?;
    let folder = match &arguments.out {
        Some(path) => Folder::at(path, arguments.force)?,
        None => Folder::fresh(Path::new("results"), scenario.name())?,
    };
    if !arguments.quiet {
        console::print(&format!("{} ({}), seed {}\n", scenario.title(), scenario.name(), scenario.settings.seed))?;
    }
    let policy = arguments.checkpoints.policy(!arguments.no_pictures);
    Session::begin(scenario, simulation, folder, policy, arguments.quiet)?.conduct()
}

/// So many threads, or one for each core.
pub(super) fn use_threads(threads: Option<u16>) {
    if let Some(threads) = threads {
        // Fails only when a pool exists already; none does before this line.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
    }
}
