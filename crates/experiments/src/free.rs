//! Free systems: whatever box, particles and interactions a scenario file describes, run on either engine and observed
//! beside the theory that applies.

mod build;
mod charts;
mod given;
mod picture;
mod run;
mod sample;
pub mod spec;
mod verdict;

pub use spec::System;

use corpuscle_core::Invalid;

use crate::Simulation;

/// Starts a free system; the seed places generated particles and draws their velocities.
///
/// # Errors
/// [`Invalid`] with a key that is a path into the file, such as `species[0].radius` or `box.lower`.
pub fn start(system: &System, seed: u64) -> Result<Box<dyn Simulation>, Invalid> {
    match system.room.lower.len() {
        2 => Ok(Box::new(run::Free::<2>::new(system, seed)?)),
        3 => Ok(Box::new(run::Free::<3>::new(system, seed)?)),
        n => Err(Invalid::new("box.lower", format!("{n} coordinates"), "two coordinates, or three")),
    }
}

#[cfg(test)]
mod tests;
