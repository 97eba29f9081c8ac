//! One room of the experiment: a gas that starts left of a partition, or two gases either side of it.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Axis, Boundary, Engine, Failure, Hole, Invalid, Particles, Partition, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::entropy::{Cells, configurational_entropy};

use super::Set;
use crate::gas::{self, Species};
use crate::tally::Tally;

/// What the partition separates at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Process {
    /// A gas on the left, nothing on the right.
    Expansion,
    /// One gas on the left, another on the right.
    Mixing,
}

/// What one room looked like at one sampling time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    /// Coarse-grained entropy `sum over species of ln(N_s! / prod n_i!)`, in units of `k_B`.
    pub(super) entropy: f64,
    /// Number of particles in the left half.
    pub(super) left: usize,
}

/// Collisions per particle behind the partition before it opens: the start is an equilibrium, not a lattice.
const COLLISIONS_BEFORE: f64 = 15.0;

/// A box whose partition opens at time zero.
#[derive(Debug)]
pub(super) struct Room<const D: usize> {
    pub(super) process: Process,
    pub(super) engine: EventDriven<D>,
    pub(super) species: Vec<u16>,
    pub(super) samples: Vec<Sample>,
    pub(super) initial_energy: f64,
    cells: Cells<D>,
    /// Physical time of the engine at which the partition opened.
    opened: f64,
    /// Collisions of each particle, where this room is on show.
    pub(super) tally: Tally,
}

resume!(Room<const D> { values: [engine, samples], set_up: [process, species, initial_energy, cells, opened, tally] });

impl<const D: usize> Room<D> {
    /// Fills the room, lets it come to equilibrium behind the closed partition, and opens that.
    ///
    /// # Errors
    /// [`Invalid`] when the particles do not fit, or when the hole does not lie in the partition.
    pub(super) fn new(set: &Set<D>, process: Process, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let middle = 0.5 * set.boundary.upper[0];
        let plate = |hole| Partition { hole, ..Partition::new(0, middle) };
        let mut particles = Particles::new();
        for (index, count) in set.species(process).into_iter().enumerate() {
            let mut half = set.boundary.clone();
            if index == 0 {
                half.upper[0] = middle;
            } else {
                half.lower[0] = middle;
            }
            gas::add(&mut particles, &half, Species { count, radius: set.radius, mass: 1.0, index: index as u16 }, &mut random)?;
        }
        gas::heat(&mut particles, set.temperature, &mut random);

        let mut closed = set.boundary.clone();
        closed.partitions.push(plate(None));
        let species = particles.species.clone();
        let mut engine = EventDriven::new(closed, particles, Rules::default())?;
        let wait = COLLISIONS_BEFORE / set.collision_rate;
        engine.advance(wait, &mut ()).map_err(|failure| Invalid::new("particles", set.particles, failure.to_string()))?;
        let mut open = set.boundary.clone();
        if set.hole_width > 0.0 {
            let centre = 0.5 * (open.lower[1] + open.upper[1]);
            open.partitions.push(plate(Some(Hole {
                along: 1,
                from: centre - 0.5 * set.hole_width,
                to: centre + 0.5 * set.hole_width,
            })));
        }
        engine.set_boundary(open)?;
        let cells = set.cells();
        let initial_energy = engine.kinetic_energy();
        let tally = Tally::default();
        let mut room = Self { process, engine, species, samples: vec![], initial_energy, cells, opened: wait, tally };
        room.sample();
        Ok(room)
    }

    /// Time on the engine's clock at which the partition opened.
    pub(super) fn opened(&self) -> f64 {
        self.opened
    }

    /// Advances to `time` after the opening.
    ///
    /// # Errors
    /// [`Failure`] of the engine.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.engine.advance(self.opened + time, &mut self.tally)
    }

    /// Takes a sample now.
    pub(super) fn sample(&mut self) {
        let middle = 0.5 * (self.engine.boundary().lower[0] + self.engine.boundary().upper[0]);
        let groups = if self.process == Process::Mixing { 2 } else { 1 };
        let mut left = 0;
        let mut entropy = 0.0;
        for group in 0..groups {
            let places: Vec<Vector<D>> =
                (0..self.species.len()).filter(|&i| self.species[i] == group).map(|i| self.engine.position(i)).collect();
            left += places.iter().filter(|place| place[0] < middle).count();
            entropy += configurational_entropy(&self.cells.occupation(&places));
        }
        self.samples.push(Sample { entropy, left });
    }

    /// Positions of all particles now.
    pub(super) fn places(&self) -> Vec<Vector<D>> {
        (0..self.species.len()).map(|i| self.engine.position(i)).collect()
    }
}

/// The box of the experiment: twice as long as wide, its volume set by the packing fraction.
pub(super) fn boundary<const D: usize>(particles: usize, radius: f64, packing_fraction: f64) -> Boundary<D> {
    // Two cubes (squares) side by side, each with half of the volume.
    let width = gas::side::<D>(particles, radius, 2.0 * packing_fraction);
    let mut upper = [width; D];
    upper[0] *= 2.0;
    Boundary::new([0.0; D], upper, Axis::Walls)
}
