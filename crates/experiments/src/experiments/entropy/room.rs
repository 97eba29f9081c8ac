//! One room of the experiment: a gas that starts left of a partition, or two gases either side of it.

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Axis, Boundary, Failure, Invalid, Particles, Random, Vector};
use corpuscle_observe::entropy::{Cells, configurational_entropy};

use super::{COLLISIONS_BEFORE, Set};
use crate::gas::{self, Species};
use crate::study::Vessel;

/// What the partition separates at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Process {
    /// A gas on the left, nothing on the right.
    Expansion,
    /// One gas on the left, another on the right.
    Mixing,
}

/// What one room looked like at one sampling time.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    /// Coarse-grained entropy `sum over species of ln(N_s! / prod n_i!)`, in units of `k_B`, for each of the room's grids.
    pub(super) entropies: Vec<f64>,
    /// Number of particles in the left half.
    pub(super) left: usize,
}

impl Sample {
    /// The entropy over the cells that were asked for.
    pub(super) fn entropy(&self) -> f64 {
        self.entropies[0]
    }
}

/// A box whose partition opens at time zero.
pub(super) struct Room<const D: usize> {
    pub(super) process: Process,
    pub(super) vessel: Vessel<D>,
    pub(super) species: Vec<u16>,
    pub(super) samples: Vec<Sample>,
    grids: Vec<Cells<D>>,
    middle: f64,
}

resume!(Room<const D> { values: [samples], parts: [vessel], set_up: [process, species, grids, middle] });

impl<const D: usize> Room<D> {
    /// Fills the room, lets it come to equilibrium behind the closed partition, and opens that: a hole of this width, or all
    /// of it. The entropy is taken over grids of so many cells along the box.
    ///
    /// # Errors
    /// [`Invalid`] when the particles do not fit, or when the hole does not lie in the partition.
    pub(super) fn new(
        set: &Set<D>,
        process: Process,
        hole_width: Option<f64>,
        cells_along: &[usize],
        stream: u64,
    ) -> Result<Self, Invalid> {
        let mut random = Random::new(set.seed, stream);
        let particles = apart(set, process, &mut random)?;
        let species = particles.species.clone();
        let mut closed = set.boundary.clone();
        closed.partitions.push(set.plate(None));
        let mut vessel = Vessel::new(closed, particles, COLLISIONS_BEFORE / set.collision_rate, &mut random)?;
        let mut open = set.boundary.clone();
        open.partitions.extend(hole_width.map(|width| set.plate(Some(width))));
        vessel.engine.set_boundary(open)?;
        let grids = cells_along.iter().map(|&along| set.cells(along)).collect();
        Ok(Self { process, vessel, species, samples: vec![], grids, middle: set.middle() })
    }

    /// Advances to `time` after the opening.
    ///
    /// # Errors
    /// [`Failure`] of the engine.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.vessel.advance(time, &mut |_| ControlFlow::Continue(()))
    }

    /// Takes a sample now.
    pub(super) fn sample(&mut self) {
        let places = self.places();
        let left = places.iter().filter(|place| place[0] < self.middle).count();
        let entropies = self.grids.iter().map(|cells| self.entropy(cells, &places)).collect();
        self.samples.push(Sample { entropies, left });
    }

    /// Entropy of the particles at these places, over the cells that were asked for.
    pub(super) fn entropy_of(&self, places: &[Vector<D>]) -> f64 {
        self.entropy(&self.grids[0], places)
    }

    fn entropy(&self, cells: &Cells<D>, places: &[Vector<D>]) -> f64 {
        let of_group = |group: u16| places.iter().zip(&self.species).filter(move |(_, s)| **s == group).map(|(place, _)| place);
        let groups = if self.process == Process::Mixing { 2 } else { 1 };
        (0..groups).map(|group| configurational_entropy(&cells.occupation(of_group(group)))).sum()
    }

    /// Rise of the entropy from the first sample to this one, over the cells that were asked for.
    pub(super) fn rise(&self, sample: &Sample) -> f64 {
        sample.entropy() - self.samples[0].entropy()
    }

    /// Positions of all particles now.
    pub(super) fn places(&self) -> Vec<Vector<D>> {
        (0..self.species.len()).map(|i| self.vessel.engine.position(i)).collect()
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

/// The particles of a process, each species on its own side.
pub(super) fn apart<const D: usize>(set: &Set<D>, process: Process, random: &mut Random) -> Result<Particles<D>, Invalid> {
    let mut particles = Particles::new();
    for (index, count) in set.species(process).into_iter().enumerate() {
        let mut half = set.boundary.clone();
        if index == 0 {
            half.upper[0] = set.middle();
        } else {
            half.lower[0] = set.middle();
        }
        gas::add(&mut particles, &half, Species { count, radius: set.radius, mass: 1.0, index: index as u16 }, random)?;
    }
    gas::heat(&mut particles, set.temperature, random);
    Ok(particles)
}
