//! Whole engines timed by the clock, with the physics they got right beside the speed.
//!
//! A case is one file under `case/`: its parameters, its start, and what it reports. To add one, write the file and
//! name it in [`REGISTRY`]; the command line, its help and its JSON follow from the declaration.

mod case;
mod clock;
mod figure;
mod stretch;
mod threads;

pub use clock::Clock;
pub use corpuscle_experiments::{Parameter, Settings, Value};
pub use figure::Figure;

use corpuscle_core::{Failure, Invalid};
use corpuscle_experiments::Kind;

/// What the registry knows of a case before it runs.
pub struct Case {
    /// Name on the command line: lower case, words joined by hyphens.
    pub name: &'static str,
    /// What it times, in one sentence.
    pub summary: &'static str,
    /// Its parameters, in the order in which they are shown.
    pub parameters: &'static [Parameter],
    /// Runs it.
    pub run: fn(&Settings) -> Result<Vec<Figure>, Trouble>,
}

impl Case {
    /// Which clock it reads: that of its thread, or where several work together, that on the wall.
    pub fn clock(&self, settings: &Settings) -> Clock {
        let alone = !self.parameters.iter().any(|parameter| parameter.name == THREADS.name) || settings.whole(THREADS.name) == 1;
        if alone { Clock::Thread } else { Clock::Wall }
    }
}

/// All cases, in the order in which they are listed.
pub static REGISTRY: &[&Case] = &[
    &case::hard_spheres::CASE,
    &case::brownian::CASE,
    &case::lennard_jones::CASE,
    &case::wca::CASE,
    &case::gravity::CASE,
    &case::tree::CASE,
    &case::grains::CASE,
    &case::three_body::CASE,
    &case::membrane::CASE,
];

/// Why a case could not be run.
#[derive(Debug, thiserror::Error)]
pub enum Trouble {
    /// Its parameters do not go together.
    #[error(transparent)]
    Refused(#[from] Invalid),
    /// The dynamics broke down.
    #[error(transparent)]
    Failed(#[from] Failure),
}

/// How long to measure, a parameter of every case.
pub const SECONDS: Parameter = Parameter {
    name: "seconds",
    unit: "s",
    help: "Time to measure for, by the clock of the case; coming to equilibrium before takes up to five times as long.",
    kind: Kind::Real { default: 3.0, least: 1e-3, most: 86_400.0 },
};

/// On how many threads, a parameter of the cases that can use several.
pub const THREADS: Parameter = Parameter {
    name: "threads",
    unit: "",
    help: "Threads that work together; the clock is then the wall's.",
    kind: Kind::Whole { default: 1, least: 1, most: 256 },
};
