#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::Invalid;
use corpuscle_experiments::{Experiment, Honesty, Settings};
use corpuscle_io::checkpoint::Policy;
use corpuscle_io::{Checkpoint, Checkpoints};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::Scene;

use super::*;

/// Spheres that begin to overlap after a time of 5.
static LEAKY: Experiment = Experiment {
    name: "leaky",
    title: "Leaky spheres",
    summary: "What must not be.",
    dimensions: &[2],
    engines: &["none"],
    parameters: &[],
    start,
};

#[allow(clippy::unnecessary_wraps)] // the type that an experiment starts with
fn start(_: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Leaky { time: 0.0 }))
}

struct Leaky {
    time: f64,
}

resume!(Leaky { values: [time] });

impl Simulation for Leaky {
    fn time(&self) -> f64 {
        self.time
    }
    fn end(&self) -> f64 {
        10.0
    }
    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.time = to;
        Ok(())
    }
    fn draw(&self, _: &mut Scene) {}
    fn charts(&self) -> Vec<Chart> {
        vec![]
    }
    fn checks(&self) -> Vec<Check> {
        vec![Check::at_most("everything", 0.0, 1.0, "it looks well")]
    }
    fn honesty(&self) -> Honesty {
        let overlap = if self.time > 5.0 { 0.1 } else { 1e-15 };
        Honesty { engine: "event-driven".into(), largest_overlap: Some(overlap), ..Honesty::default() }
    }
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }
    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }
}

/// All checks pass, and yet it is no result: the run ends, the last good checkpoint is kept, and the summary says so.
#[test]
fn a_run_that_breaks_its_invariant_ends_with_its_last_good_checkpoint() {
    let parent = tempfile::tempdir().unwrap();
    let folder = Folder::fresh(parent.path(), "leaky").unwrap();
    let path = folder.path().to_owned();
    let policy = Policy { wall: None, time: Some(2.0), work: None, keep: 3, stay: false, pictures: false };
    let scenario = Scenario::new(&LEAKY);
    let simulation = scenario.start().unwrap();
    let trouble = Session::begin(scenario, simulation, folder, policy, None, true).unwrap().conduct().unwrap_err();
    let words = trouble.to_string();
    assert!(words.contains("the largest overlap is 1.0e-1") && words.contains("of t = 4,"), "{words}");
    assert_eq!(format!("{:?}", trouble.exit_code()), format!("{:?}", ExitCode::from(1)));
    let files = Checkpoints::of(&path).files();
    assert_eq!(Checkpoint::read(&files[0]).unwrap().run.time, 4.0);
    let summary = std::fs::read_to_string(path.join("summary.json")).unwrap();
    assert!(summary.contains("\"ending\": \"failed\"") && summary.contains("an invariant is broken"), "{summary}");
}
