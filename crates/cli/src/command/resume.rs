//! `corpuscle resume`: a run that was interrupted, or killed, goes on.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use corpuscle_core::Invalid;
use corpuscle_experiments::Simulation;
use corpuscle_io::number::significant;
use corpuscle_io::{Checkpoint, CheckpointError, Checkpoints, Folder, Origin, Refusal, Registry, Scenario};

use super::run::use_threads;
use crate::session::{SCENARIO, Session};
use crate::trouble::Trouble;
use crate::{console, keeper, memory};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of a run, or one of its checkpoints.
    #[arg(value_name = "FOLDER|CHECKPOINT")]
    path: PathBuf,
    /// Threads to use [default: all cores]. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Leave out the pictures.
    #[arg(long)]
    no_pictures: bool,
    /// Print one line only.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    checkpoints: keeper::Options,
}

pub(crate) fn resume(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    use_threads(arguments.threads);
    let (folder, files) = if arguments.path.is_file() {
        let folder = arguments.path.parent().and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        (folder.unwrap_or(Path::new(".")), vec![arguments.path.clone()])
    } else {
        (arguments.path.as_path(), Checkpoints::of(&arguments.path).files())
    };
    if !folder.join(SCENARIO).is_file() && files.is_empty() {
        return Err(refuse(folder, "the folder of a run, in which there are a scenario.toml and checkpoints"));
    }
    let Some((checkpoint, scenario, simulation)) = newest_good(&files, registry, &folder.join(SCENARIO)) else {
        return from_the_beginning(arguments, registry, folder, files.is_empty());
    };
    if !arguments.quiet {
        let (title, name, seed) = (scenario.title(), scenario.name(), scenario.settings.seed);
        console::print(&format!("{title} ({name}), seed {seed}, from t = {}\n", significant(checkpoint.run.time, 5)))?;
    }
    let mut policy = arguments.checkpoints.change(checkpoint.run.policy);
    policy.pictures &= !arguments.no_pictures;
    Session::go_on(scenario, simulation, Folder::again(folder)?, checkpoint.run, policy, arguments.quiet).conduct()
}

type Found = (Checkpoint, Scenario, Box<dyn Simulation>);

/// The first of these checkpoints that can be used, with a simulation that has taken it up. What is wrong with the others is
/// said.
fn newest_good(files: &[PathBuf], registry: Registry, scenario: &Path) -> Option<Found> {
    for file in files {
        let found = Checkpoint::read(file).and_then(|checkpoint| {
            let refused = |refusal: Refusal| CheckpointError::Content(corpuscle_checkpoint::Fault::new(refusal));
            let scenario = Scenario::parse(registry, &checkpoint.run.scenario, scenario).map_err(refused)?;
            memory::admit(&scenario).map_err(refused)?;
            let mut simulation = scenario.start().map_err(refused)?;
            checkpoint.load(simulation.as_mut())?;
            Ok((checkpoint, scenario, simulation))
        });
        match found {
            Ok(found) => return Some(found),
            Err(error) => console::complain(&format!("{} {error}", file.display())),
        }
    }
    None
}

/// A run that was killed before its first checkpoint begins again; one whose checkpoints are all spoilt does not do so unasked.
fn from_the_beginning(arguments: &Arguments, registry: Registry, path: &Path, fresh: bool) -> Result<ExitCode, Trouble> {
    if !fresh {
        let file = path.join(SCENARIO);
        return Err(refuse(path, &format!("a checkpoint that can be used; to begin again: corpuscle run {}", file.display())));
    }
    if path.join("report.html").is_file() {
        return Err(refuse(path, "a run that has not finished, or whose checkpoints were kept; this one left its report"));
    }
    let scenario = Scenario::read(registry, &path.join(SCENARIO))?;
    memory::admit(&scenario)?;
    let simulation = scenario.start()?;
    if !arguments.quiet {
        console::print(&format!("{} ({}), from the beginning: there is no checkpoint yet\n", scenario.title(), scenario.name()))?;
    }
    let policy = arguments.checkpoints.policy(!arguments.no_pictures);
    Session::begin(scenario, simulation, Folder::again(path)?, policy, arguments.quiet)?.conduct()
}

fn refuse(path: &Path, expected: &str) -> Trouble {
    Refusal::new(Origin::CommandLine, Invalid::new("resume", path.display(), expected)).into()
}
