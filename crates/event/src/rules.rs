//! What an event-driven run is told besides its box, and what it tells about its work.

use corpuscle_core::{Invalid, Vector};

use crate::{Pair, Restitution};

/// The law of contact and the field in which particles fly.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Rules<const D: usize> {
    /// How much of the normal relative speed a contact leaves: of particles, with walls without a temperature, partitions,
    /// obstacles and the piston alike.
    pub restitution: Restitution,
    /// Contacts that approach more slowly than this are elastic. Without such a rule inelastic spheres may collide
    /// infinitely often in a finite time (McNamara and Young, Phys. Fluids A 4, 496 (1992), doi:10.1063/1.858323).
    pub elastic_below: f64,
    /// Acceleration `g` of every particle, the same everywhere.
    pub field: Vector<D>,
    /// What two particles do to one another.
    pub pair: Pair,
    /// Seed of the random numbers of walls with a temperature. The `n`-th such contact of a particle (from 0) draws from
    /// `Random::at(seed, Rules::THERMAL, n, particle)`, so that it does not depend on what other particles do.
    pub seed: u64,
}

impl<const D: usize> Default for Rules<D> {
    /// Elastic contacts, no field.
    fn default() -> Self {
        Self { restitution: Restitution::Constant(1.0), elastic_below: 0.0, field: Vector::ZERO, pair: Pair::Hard, seed: 0 }
    }
}

impl<const D: usize> Rules<D> {
    /// Stream of the random numbers of walls with a temperature.
    pub const THERMAL: u64 = 0x7468_6572_6d61_6c00;

    /// Checks that every number makes sense.
    ///
    /// # Errors
    /// Names the first that does not.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.restitution.validate()?;
        if !(self.elastic_below >= 0.0 && self.elastic_below.is_finite()) {
            return Err(Invalid::new("elastic_below", self.elastic_below, "a speed, zero or more"));
        }
        if !self.field.is_finite() {
            return Err(Invalid::new("field", format!("{:?}", self.field.0), "finite numbers"));
        }
        self.pair.validate()
    }

    /// Restitution of a contact approached at this normal speed, of two radii and a reduced mass.
    #[inline]
    pub(crate) fn restitution_at(&self, speed: f64, radii: [f64; 2], mass: f64) -> f64 {
        if speed < self.elastic_below { 1.0 } else { self.restitution.at(speed, radii, mass) }
    }
}

/// What an engine has done so far: physics first, then the work it cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Counts {
    /// Collisions between two particles.
    pub collisions: u64,
    /// Passages of pairs over the edges of their wells, either way, and reflections there.
    pub edges: u64,
    /// Contacts with walls, partitions and their rims, obstacles and the piston.
    pub wall_collisions: u64,
    /// Passages from cell to cell, where neighbours are found through cells.
    pub crossings: u64,
    /// Neighbour lists made anew, where neighbours are found through lists.
    pub rebuilds: u64,
    /// Events found obsolete when their time came, because the partner (a particle or the piston) had a contact meanwhile.
    pub stale: u64,
    /// Searches of a particle's whole neighbourhood for its next collision.
    pub predictions: u64,
}

/// A particle as the engine keeps it: where it was at its own time.
///
/// At another time `t` it is at `position + velocity (t - time) + field (t - time)^2 / 2`, until its next event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lazy<const D: usize> {
    /// Position of the centre at `time`.
    pub position: Vector<D>,
    /// Velocity at `time`.
    pub velocity: Vector<D>,
    /// The particle's own physical time.
    pub time: f64,
}
