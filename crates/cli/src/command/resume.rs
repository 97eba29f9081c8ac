//! `corpuscle resume`: a run that was interrupted, or killed, goes on.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use corpuscle_core::Invalid;
use corpuscle_experiments::Simulation;
use corpuscle_io::number::significant;
use corpuscle_io::{Checkpoint, CheckpointError, Checkpoints, Folder, Origin, Refusal, Registry, Scenario};

use super::conduct::Conduct;
use crate::session::{SCENARIO, Session};
use crate::trouble::Trouble;
use crate::{console, memory};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of a run, or one of its checkpoints.
    #[arg(value_name = "FOLDER|CHECKPOINT")]
    path: PathBuf,
    /// Go on without the trajectory.
    #[arg(long)]
    no_trajectory: bool,
    #[command(flatten)]
    conduct: Conduct,
}

pub(crate) fn resume(arguments: &Arguments, registry: Registry) -> Result<ExitCode, Trouble> {
    let conduct = &arguments.conduct;
    conduct.threads.set();
    let (folder, files) = of_run(&arguments.path);
    if !folder.join(SCENARIO).is_file() && files.is_empty() {
        return Err(refuse(folder, "the folder of a run, in which there are a scenario.toml and checkpoints"));
    }
    let taken = Folder::again(folder)?;
    let Some((mut checkpoint, scenario, simulation)) = newest_good(&files, registry, &folder.join(SCENARIO)) else {
        return from_the_beginning(conduct, registry, taken, files.is_empty());
    };
    if arguments.no_trajectory {
        checkpoint.run.trajectory = None;
    }
    if !conduct.quiet {
        let (title, name, seed) = (scenario.title(), scenario.name(), scenario.settings.seed);
        console::print(&format!("{title} ({name}), seed {seed}, from t = {}\n", significant(checkpoint.run.time, 5)))?;
    }
    let mut policy = conduct.checkpoints.change(checkpoint.run.policy);
    policy.pictures &= !conduct.no_pictures;
    Session::go_on(scenario, simulation, taken, checkpoint.run, policy, conduct.quiet)?.conduct()
}

/// The folder of a run and its checkpoints, the newest first; of a checkpoint, its folder and itself.
pub(super) fn of_run(path: &Path) -> (&Path, Vec<PathBuf>) {
    if path.is_file() {
        let folder = path.parent().and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        (folder.unwrap_or(Path::new(".")), vec![path.into()])
    } else {
        (path, Checkpoints::of(path).files())
    }
}

type Found = (Checkpoint, Scenario, Box<dyn Simulation>);

/// The first of these checkpoints that can be used, with a simulation that has taken it up. What is wrong with the others is
/// said.
pub(super) fn newest_good(files: &[PathBuf], registry: Registry, scenario: &Path) -> Option<Found> {
    for file in files {
        let found = memory::admit_file(file).map_err(CheckpointError::from).and_then(|()| Checkpoint::read(file));
        let found = found.and_then(|checkpoint| {
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
fn from_the_beginning(conduct: &Conduct, registry: Registry, folder: Folder, fresh: bool) -> Result<ExitCode, Trouble> {
    let path = folder.path();
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
    if !conduct.quiet {
        console::print(&format!("{} ({}), from the beginning: there is no checkpoint yet\n", scenario.title(), scenario.name()))?;
    }
    let policy = conduct.checkpoints.policy(!conduct.no_pictures);
    Session::begin(scenario, simulation, folder, policy, None, conduct.quiet)?.conduct()
}

fn refuse(path: &Path, expected: &str) -> Trouble {
    Refusal::new(Origin::CommandLine, Invalid::new("resume", path.display(), expected)).into()
}
