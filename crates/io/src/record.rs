//! What came of a run: gathered once, written down in several formats.

use std::time::Duration;

use corpuscle_core::Failure;
use corpuscle_experiments::{Honesty, Simulation, Table};
use corpuscle_observe::{Chart, Check};

use crate::Scenario;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// It is on its way: what stands there was true when the last checkpoint was written.
    Running,
    /// It reached its end.
    Finished,
    /// It was stopped before its end, by a signal.
    Interrupted,
    /// The dynamics broke down; what was measured until then stands.
    Failed(Failure),
}

impl Ending {
    /// One word for `summary.json`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Finished => "finished",
            Self::Interrupted => "interrupted",
            Self::Failed(_) => "failed",
        }
    }
}

/// A picture of the system at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Physical time of the picture.
    pub time: f64,
    /// What there is to see, in one line.
    pub caption: String,
    /// The picture in PNG.
    pub png: Vec<u8>,
}

/// A run: what was asked, how it ended, what was measured.
pub struct Record<'a> {
    /// What was asked for.
    pub scenario: &'a Scenario,
    /// How it ended.
    pub ending: Ending,
    /// Physical time reached.
    pub time: f64,
    /// Physical time it was to reach.
    pub end: f64,
    /// Time on the clock spent in the engine.
    pub wall: Duration,
    /// Verdicts.
    pub checks: Vec<Check>,
    /// Measurement beside theory.
    pub charts: Vec<Chart>,
    /// Further results.
    pub tables: Vec<Table>,
    /// Numerical quality.
    pub honesty: Honesty,
    /// Pictures, in the order of their times.
    pub pictures: Vec<Picture>,
}

impl<'a> Record<'a> {
    /// Takes down what a simulation has to say now.
    pub fn of(scenario: &'a Scenario, simulation: &dyn Simulation, end: f64, ending: Ending, wall: Duration) -> Self {
        Self {
            scenario,
            ending,
            time: simulation.time(),
            end,
            wall,
            checks: simulation.checks(),
            charts: simulation.charts(),
            tables: simulation.tables(),
            honesty: simulation.honesty(),
            pictures: vec![],
        }
    }

    /// Number of checks that passed.
    pub fn passed(&self) -> usize {
        self.checks.iter().filter(|check| check.passed).count()
    }

    /// Collisions or steps a second on the clock; none when no time was spent.
    pub fn rate(&self) -> Option<f64> {
        let seconds = self.wall.as_secs_f64();
        (seconds > 0.0).then(|| self.honesty.work as f64 / seconds)
    }
}
