//! The experiments: each is one file that declares its parameters, sets the system up, says how to draw it, and checks
//! what it measures against theory.
//!
//! To add one, write the file and name it in [`REGISTRY`].

pub mod deeds;
mod drawing;
mod ensemble;
mod experiments;
pub mod frame;
pub mod free;
mod gas;
mod hand;
mod horizon;
pub mod parameter;
mod peek;
pub mod probe;
mod replicas;
pub mod settings;
pub mod simulation;
mod study;
mod tally;

pub use deeds::{Deed, with_deeds};
pub use frame::Frame;
pub use parameter::{Kind, Parameter, Situation, Value};
pub use probe::Probed;
pub use settings::Settings;
pub use simulation::{Action, Honesty, Simulation, Table};

use corpuscle_core::Invalid;

/// What the registry knows of an experiment before it runs.
pub struct Experiment {
    /// Name on the command line: lower case, words joined by hyphens.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// What it shows, in one or two sentences.
    pub summary: &'static str,
    /// Dimensions it can run in.
    pub dimensions: &'static [usize],
    /// Engines it runs on.
    pub engines: &'static [&'static str],
    /// Its parameters, in the order in which they are shown.
    pub parameters: &'static [Parameter],
    /// Starts it.
    pub start: fn(&Settings) -> Result<Box<dyn Simulation>, Invalid>,
}

/// All experiments, in the order in which they are listed.
pub static REGISTRY: &[&Experiment] = &[
    &experiments::brownian::EXPERIMENT,
    &experiments::entropy::EXPERIMENT,
    &experiments::ideal_gas::EXPERIMENT,
    &experiments::three_body::EXPERIMENT,
    &experiments::wave::EXPERIMENT,
    &experiments::atmosphere::EXPERIMENT,
    &experiments::billiard::EXPERIMENT,
    &experiments::newton_cradle::EXPERIMENT,
    &experiments::granular::EXPERIMENT,
    &experiments::sound::EXPERIMENT,
    &experiments::lennard_jones::EXPERIMENT,
    &experiments::galton::EXPERIMENT,
    &experiments::diffusion::EXPERIMENT,
    &experiments::engines::EXPERIMENT,
    &experiments::hard_disk_melting::EXPERIMENT,
];

/// The experiment of this name.
///
/// # Errors
/// Names the experiments there are.
pub fn find(name: &str) -> Result<&'static Experiment, Invalid> {
    REGISTRY.iter().copied().find(|experiment| experiment.name == name).ok_or_else(|| {
        let names: Vec<&str> = REGISTRY.iter().map(|experiment| experiment.name).collect();
        Invalid::new("experiment", name, format!("one of {}", names.join(", ")))
    })
}
