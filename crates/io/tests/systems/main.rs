//! Random systems that make sense, as scenario files describe them, of both engines, in both dimensions and all kinds of boxes:
//! each runs for a short time with all invariants looked at. What once broke has a test of its own name.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

mod draft;
mod invariants;
mod regressions;

use std::collections::BTreeMap;
use std::path::Path;

use corpuscle_core::Invalid;
use corpuscle_experiments::free::{System, spec};
use corpuscle_experiments::{REGISTRY, Simulation};
use corpuscle_io::scenario::Subject;
use corpuscle_io::{Refusal, Scenario};

/// A system that runs, with its description.
struct Sample {
    text: String,
    scenario: Scenario,
    simulation: Box<dyn Simulation>,
}

impl Sample {
    fn new(text: String) -> Result<Self, Refusal> {
        let scenario = Scenario::parse(REGISTRY, &text, Path::new("random.toml"))?;
        let simulation = scenario.start()?;
        Ok(Self { text, scenario, simulation })
    }

    fn system(&self) -> &System {
        match &self.scenario.subject {
            Subject::Free(system) => system,
            Subject::Experiment(_) => unreachable!("these describe systems of their own"),
        }
    }
}

/// How many of a kind, and what they did.
#[derive(Debug, Default)]
struct Row {
    systems: u64,
    work: u64,
    halvings: u32,
}

/// What there was of each kind.
#[derive(Default)]
struct Census {
    kinds: BTreeMap<(String, usize, String), Row>,
    furniture: BTreeMap<&'static str, u64>,
    refusals: BTreeMap<String, u64>,
}

impl Census {
    fn refuse(&mut self, refusal: &Refusal) {
        let Invalid { key, expected, .. } = &refusal.invalid;
        let reason = format!("{key}: {expected}");
        let reason = reason.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).take(60).collect();
        *self.refusals.entry(reason).or_default() += 1;
    }

    fn count(&mut self, system: &System) -> &mut Row {
        let collisions = system.collisions.as_ref();
        for (name, there) in [
            ("plates", !system.partitions.is_empty()),
            ("warm walls", system.walls.iter().any(|wall| wall.temperature.is_some())),
            ("moving walls", system.walls.iter().any(|wall| wall.path.is_some() || wall.oscillation.is_some())),
            ("walls that open", system.walls.iter().any(|wall| wall.opened_at.is_some())),
            ("obstacles", !system.obstacles.is_empty()),
            ("pistons", system.piston.is_some()),
            ("fields", !system.field.is_empty()),
            ("grown starts", system.growth.is_some()),
            ("inelastic", collisions.is_some_and(|rules| rules.restitution.is_some() || rules.viscoelastic.is_some())),
            ("wells", collisions.is_some_and(|rules| rules.well.is_some())),
            ("shoulders", collisions.is_some_and(|rules| rules.shoulder.is_some())),
            ("springs", !system.springs.is_empty()),
        ] {
            *self.furniture.entry(name).or_default() += u64::from(there);
        }
        let faces = match &system.room.faces {
            spec::Faces::All(face) => format!("{face:?}"),
            spec::Faces::Each(faces) if faces.iter().all(|face| *face == faces[0]) => format!("{:?}", faces[0]),
            spec::Faces::Each(_) => "Mixed".into(),
        };
        self.kinds.entry((format!("{:?}", system.engine), system.room.lower.len(), faces)).or_default()
    }
}

fn from_environment(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|number| number.parse().ok())
}

/// As many as `FUZZ_SYSTEMS` says, from the seed `FUZZ_SEED` on.
#[test]
fn random_systems_keep_their_invariants() {
    let wanted = from_environment("FUZZ_SYSTEMS").unwrap_or(2000);
    let first = from_environment("FUZZ_SEED").unwrap_or(0);
    let (mut census, mut failures, mut done, mut seed) = (Census::default(), vec![], 0, first);
    while done < wanted {
        let text = draft::draft(seed);
        match Sample::new(text.clone()) {
            Err(refusal) => census.refuse(&refusal),
            Ok(sample) => {
                let row = census.count(sample.system());
                done += 1;
                row.systems += 1;
                match invariants::hold(sample) {
                    Ok(outcome) => {
                        row.work += outcome.work;
                        row.halvings = row.halvings.max(outcome.halvings);
                    }
                    Err(broken) => failures.push(format!("seed {seed}: {broken}\n{text}")),
                }
            }
        }
        seed += 1;
    }
    println!(
        "{wanted} systems of the seeds {first} to {seed}; of {} drafts that made no sense:",
        census.refusals.values().sum::<u64>()
    );
    let mut refusals: Vec<_> = census.refusals.iter().collect();
    refusals.sort_by(|a, b| b.1.cmp(a.1));
    for (reason, count) in refusals.iter().take(12) {
        println!("  {count:6} {reason}");
    }
    for ((engine, dimension, faces), row) in &census.kinds {
        println!("{engine}, {dimension}-D, {faces}: {row:?}");
    }
    println!("{:?}", census.furniture);
    assert!(failures.is_empty(), "{} of {wanted} broke:\n\n{}", failures.len(), failures[..failures.len().min(40)].join("\n\n"));
    assert!(census.kinds.len() == 16 || wanted < 2000, "both engines, both dimensions, all kinds of boxes: {:?}", census.kinds);
    assert!(census.furniture.values().all(|&count| count > 0) || wanted < 2000, "{:?}", census.furniture);
}
