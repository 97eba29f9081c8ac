//! Linear springs arranged regularly, as in strings and membranes: every particle gathers what pulls at it.
//!
//! A spring is worked out twice, once for each end. In return nothing is written but the sum, which never leaves the processor's
//! nearest cache. Particles with the same neighbours are treated as one, also where few others interrupt them, as the ends of the rows
//! of a membrane do: these are put right afterwards.

use std::ops::Range;

use corpuscle_core::{Instructions, Particles, Vector};
use rayon::prelude::*;

use super::Spring;
use super::gather::{Action, Add, Kick, Soon};
use super::masses::{InverseMass, Masses};
use super::plan::Plan;
use super::walk::{Block, Exception, Walk};
use crate::threads::{self, CHUNK};

/// Particles whose accelerations are found together.
const BLOCK: usize = 256;
/// Particles that must have the same neighbours, one after the other, in the mean.
const REGULAR: usize = 16;
/// The most springs at a particle: kernels are compiled for each number of them.
const MOST: usize = 8;
/// The most particles between two stretches that are treated as one.
const EXCEPTIONS: usize = 8;
/// So many particles has the second of them for each exception, at least.
const TO_AN_EXCEPTION: usize = 4;

/// For each particle the springs at it, in the order of their other ends; stretches of particles whose springs are alike share them.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    pub(super) stretches: Vec<Stretch>,
    exceptions: Vec<Exception>,
    neighbours: Vec<Neighbour>,
    /// The farthest apart in memory that two ends are.
    pub(super) reach: usize,
    pub(super) instructions: Instructions,
}

#[derive(Clone, Debug)]
pub(super) struct Stretch {
    pub(super) particles: Range<usize>,
    pub(super) neighbours: Range<usize>,
}

/// What pulls at a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neighbour {
    /// How much farther in memory.
    pub(super) offset: isize,
    pub(super) stiffness: f64,
}

impl Lattice {
    /// These springs, if they all are linear and follow one another regularly enough.
    pub(super) fn new(springs: &[Spring]) -> Option<Self> {
        if !springs.iter().all(Spring::is_linear) {
            return None;
        }
        let both_ways =
            |spring: &Spring| [(spring.first, spring.second), (spring.second, spring.first)].map(|(i, j)| (i, j, spring.stiffness));
        let mut ends: Vec<(usize, usize, f64)> = springs.iter().flat_map(both_ways).collect();
        ends.sort_by_key(|&(i, j, _)| (i, j));
        let (mut stretches, mut neighbours) = (Vec::<Stretch>::new(), Vec::<Neighbour>::new());
        let (mut particles, mut reach) = (0, 0);
        for of_one in ends.chunk_by(|one, other| one.0 == other.0) {
            if of_one.len() > MOST {
                return None;
            }
            let (i, known) = (of_one[0].0, neighbours.len());
            neighbours.extend(of_one.iter().map(|&(i, j, stiffness)| Neighbour { offset: j as isize - i as isize, stiffness }));
            reach = neighbours[known..].iter().map(|neighbour| neighbour.offset.unsigned_abs()).fold(reach, usize::max);
            particles += 1;
            match stretches.last_mut() {
                Some(last) if last.particles.end == i && neighbours[last.neighbours.clone()] == neighbours[known..] => {
                    last.particles.end += 1;
                    neighbours.truncate(known);
                }
                _ => stretches.push(Stretch { particles: i..i + 1, neighbours: known..neighbours.len() }),
            }
        }
        if stretches.len() * REGULAR > particles {
            return None;
        }
        let (stretches, exceptions) = join(&stretches, &neighbours);
        Some(Self { stretches, exceptions, neighbours, reach, instructions: Instructions::detect() })
    }

    /// Adds the accelerations.
    pub(super) fn accelerate<const D: usize>(&self, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        let Particles { position, mass, .. } = particles;
        self.everywhere(position, Masses { each: mass, of_all: None }, &self.exceptions, acceleration, Add);
    }

    /// `v += a dt` but for held coordinates; tells whether every `v` is finite.
    pub(super) fn kick<const D: usize>(&self, particles: &mut Particles<D>, plan: &Plan, dt: f64) -> bool {
        let Particles { position, velocity, mass, .. } = particles;
        let before: Vec<f64> = plan.held.iter().map(|held| velocity[held.particle][held.axis]).collect();
        let masses = Masses { each: mass, of_all: plan.mass_of_all };
        let finite = self.everywhere(position, masses, &plan.exceptions, velocity, Kick::one(dt, Soon::default()));
        for (held, before) in plan.held.iter().zip(before) {
            velocity[held.particle][held.axis] = before;
        }
        finite
    }

    /// Does something to what belongs to all particles; tells whether all is well.
    fn everywhere<const D: usize>(
        &self,
        position: &[Vector<D>],
        masses: Masses<'_>,
        exceptions: &[Exception],
        target: &mut [Vector<D>],
        action: impl Action + Sync,
    ) -> bool {
        let one = |(number, target): (usize, &mut [Vector<D>])| {
            let from = number * CHUNK;
            let mut inverse_mass = InverseMass::new(masses, from..from + target.len());
            let (mut walk, mut well) = (Walk::new(self, exceptions, from), true);
            for (block, target) in target.chunks_mut(BLOCK).enumerate() {
                let start = from + block * BLOCK;
                inverse_mass.see(start - from..start - from + target.len());
                let block = Block { start, position, from: 0, inverse_mass: &inverse_mass };
                well &= walk.act(block, target, action);
            }
            well
        };
        if threads::are_worth_it(target.len()) {
            target.par_chunks_mut(CHUNK).enumerate().map(one).reduce(|| true, |one, other| one & other)
        } else {
            target.chunks_mut(CHUNK).enumerate().map(one).fold(true, |one, other| one & other)
        }
    }

    /// All particles that are not treated as those beside them, among them those given, in their order, to which nothing is done.
    pub(super) fn exceptions(&self, still: &[usize]) -> Vec<Exception> {
        let mut own = self.exceptions.iter().peekable();
        let mut all = Vec::with_capacity(self.exceptions.len() + still.len());
        for &particle in still {
            all.extend(std::iter::from_fn(|| own.next_if(|one| one.particle < particle)).cloned());
            own.next_if(|one| one.particle == particle);
            all.push(Exception { particle, neighbours: None });
        }
        all.extend(own.cloned());
        all
    }

    /// The first stretch that ends behind this particle.
    pub(super) fn first_stretch(&self, particle: usize) -> usize {
        self.stretches.partition_point(|stretch| stretch.particles.end <= particle)
    }

    pub(super) fn neighbours(&self, range: &Range<usize>) -> &[Neighbour] {
        &self.neighbours[range.clone()]
    }
}

/// Stretches whose particles have the same neighbours as one, where there are but few particles between them.
fn join(stretches: &[Stretch], neighbours: &[Neighbour]) -> (Vec<Stretch>, Vec<Exception>) {
    let (mut joined, mut exceptions) = (Vec::<Stretch>::new(), Vec::<Exception>::new());
    for stretch in stretches {
        let most = EXCEPTIONS.min(stretch.particles.len() / TO_AN_EXCEPTION);
        let near = joined.iter().rev().take_while(|one| one.particles.end + most >= stretch.particles.start).count();
        let near = joined.len() - near;
        let alike = |one: &Stretch| neighbours[one.neighbours.clone()] == neighbours[stretch.neighbours.clone()];
        let Some(number) = joined[near..].iter().position(alike) else {
            joined.push(stretch.clone());
            continue;
        };
        joined.truncate(near + number + 1);
        let first = &mut joined[near + number].particles;
        exceptions.truncate(exceptions.partition_point(|exception| exception.particle < first.end));
        exceptions.extend((first.end..stretch.particles.start).map(|particle| {
            let own = stretches.get(stretches.partition_point(|one| one.particles.end <= particle));
            let own = own.filter(|one| one.particles.contains(&particle)).map_or(0..0, |one| one.neighbours.clone());
            Exception { particle, neighbours: Some(own) }
        }));
        first.end = stretch.particles.end;
    }
    (joined, exceptions)
}
