//! The example scenarios are read, started, drawn and run a little way; written out, they give the same run again.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use std::path::{Path, PathBuf};

use corpuscle_experiments::REGISTRY;
use corpuscle_io::Scenario;
use corpuscle_scene::Scene;

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn every_example_runs_and_is_reproduced_by_what_is_written() {
    let files = examples();
    assert!(files.len() >= 8);
    for path in files {
        let scenario = Scenario::read(REGISTRY, &path).unwrap();
        let again = Scenario::parse(REGISTRY, &scenario.to_toml(), &path).unwrap();
        let looks = [scenario, again].map(|scenario| {
            let mut simulation = scenario.start().unwrap();
            simulation.advance(0.02 * simulation.end()).unwrap();
            let mut scene = Scene::default();
            simulation.draw(&mut scene);
            assert!(!scene.bodies.is_empty() && !scene.title.is_empty(), "{}", path.display());
            assert!(simulation.checks().iter().filter(|check| check.z.is_none()).all(|check| check.passed), "{}", path.display());
            (scene.bodies, scene.lines.len(), scene.caption)
        });
        assert_eq!(looks[0], looks[1], "{}", path.display());
    }
}
