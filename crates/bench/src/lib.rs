//! Whole engines timed by the clock, with the physics they got right beside the speed.
//!
//! A case is one file under `case/`: its parameters, its start, and what it reports. To add one, write the file and
//! name it in [`REGISTRY`]; the command line, its help and its JSON follow from the declaration.

mod case;
mod clock;
mod figure;
mod stretch;

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
    /// Which clock it reads.
    pub clock: Clock,
    /// Runs it.
    pub run: fn(&Settings) -> Result<Vec<Figure>, Trouble>,
}

/// All cases, in the order in which they are listed.
pub static REGISTRY: &[&Case] = &[&case::hard_spheres::CASE, &case::brownian::CASE];

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
