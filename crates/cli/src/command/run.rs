//! `corpuscle run`: an experiment from start to end, its checks on the terminal, its report in a folder.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use corpuscle_core::Invalid;
use corpuscle_experiments::Simulation;
use corpuscle_io::trajectory::Plan;
use corpuscle_io::{Folder, Origin, Refusal, Registry};

use super::conduct::Conduct;
use super::{Subject, positive};
use crate::console;
use crate::session::Session;
use crate::trouble::Trouble;

/// Frames of a trajectory after the first, unless told otherwise.
const FRAMES: f64 = 100.0;

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
    /// How long to run, as the parameter `duration` where the experiment has one [default: what it needs].
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true)]
    duration: Option<f64>,
    /// Write all particles into this file in the folder of the run: extended XYZ (.xyz), LAMMPS dump (.dump) or GSD (.gsd).
    #[arg(long, value_name = "FILE")]
    trajectory: Option<String>,
    /// Physical time from frame to frame of the trajectory [default: a hundredth of the run].
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true, requires = "trajectory")]
    every: Option<f64>,
    #[command(flatten)]
    conduct: Conduct,
}

pub(crate) fn run(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let conduct = &arguments.conduct;
    let mut scenario = arguments.subject.scenario(registry)?;
    if let Some(duration) = arguments.duration {
        scenario.set_duration(duration)?;
    }
    conduct.threads.set();
    let simulation = scenario.start()?;
    let end = scenario.duration.unwrap_or_else(|| simulation.end());
    let trajectory = trajectory(arguments, simulation.as_ref(), end)?;
    let folder = match &arguments.out {
        Some(path) => Folder::at(path, arguments.force)?,
        None => Folder::fresh(Path::new("results"), scenario.name())?,
    };
    if !conduct.quiet {
        console::print(&format!("{} ({}), seed {}\n", scenario.title(), scenario.name(), scenario.settings.seed))?;
    }
    let policy = conduct.checkpoints.policy(!conduct.no_pictures);
    Session::begin(scenario, simulation, folder, policy, trajectory, conduct.quiet)?.conduct()
}

/// The trajectory that is asked for, if one can be written.
fn trajectory(arguments: &Arguments, simulation: &dyn Simulation, end: f64) -> Result<Option<Plan>, Refusal> {
    let Some(file) = &arguments.trajectory else { return Ok(None) };
    let refuse = |invalid| Refusal::new(Origin::CommandLine, invalid);
    if simulation.frame().is_none() {
        return Err(refuse(Invalid::new("trajectory", file, "nothing: this experiment has no particles that a file could hold")));
    }
    Plan::new(file, arguments.every.unwrap_or(end / FRAMES), end).map(Some).map_err(refuse)
}
