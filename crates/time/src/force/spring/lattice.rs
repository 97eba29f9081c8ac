//! Linear springs arranged regularly, as in strings and membranes: every particle gathers what pulls at it.
//!
//! A spring is worked out twice, once for each end. In return nothing is written but the sum, which never leaves the processor's
//! nearest cache.

use std::ops::Range;

use corpuscle_core::{Instructions, Particles, Vector};
use rayon::prelude::*;

use super::Spring;
use super::gather::{Action, Add, Alike, Each, Gather, Kick};
use crate::constraint::Held;
use crate::lanes::eight::{self, LANES};
use crate::threads::{self, CHUNK};

/// Particles whose accelerations are found together.
const BLOCK: usize = 256;
/// Particles that must have the same neighbours, one after the other, in the mean.
const REGULAR: usize = 16;
/// The most springs at a particle: kernels are compiled for each number of them.
const MOST: usize = 8;

/// For each particle the springs at it, in the order of their other ends; stretches of particles whose springs are alike share them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lattice {
    stretches: Vec<Stretch>,
    neighbours: Vec<Neighbour>,
    /// The farthest apart in memory that two ends are.
    pub(super) reach: usize,
    pub(super) instructions: Instructions,
}

#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    particles: Range<usize>,
    neighbours: Range<usize>,
}

/// What pulls at a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neighbour {
    /// How much farther in memory.
    offset: isize,
    stiffness: f64,
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
        let regular = stretches.len() * REGULAR <= particles;
        regular.then(|| Self { stretches, neighbours, reach, instructions: Instructions::detect() })
    }

    /// Adds the accelerations.
    pub(super) fn accelerate<const D: usize>(&self, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        let Particles { position, mass, .. } = particles;
        self.everywhere(position, mass, acceleration, |neighbours, place, acceleration| {
            self.gather(neighbours, place, Vector::components_mut(acceleration), Add)
        });
    }

    /// `v += a dt` but for held coordinates; tells whether every `v` is finite.
    pub(super) fn kick<const D: usize>(&self, particles: &mut Particles<D>, held: &[Held], dt: f64) -> bool {
        let Particles { position, velocity, mass, .. } = particles;
        let before: Vec<f64> = held.iter().map(|held| velocity[held.particle][held.axis]).collect();
        let finite = self.everywhere(position, mass, velocity, |neighbours, place, velocity| {
            self.gather(neighbours, place, Vector::components_mut(velocity), Kick::one(dt, [&[]; 2]))
        });
        for (held, before) in held.iter().zip(before) {
            velocity[held.particle][held.axis] = before;
        }
        finite
    }

    /// Does something for all particles, whose share of `target` it is given; tells whether it gave true for all.
    fn everywhere<const D: usize>(
        &self,
        position: &[Vector<D>],
        mass: &[f64],
        target: &mut [Vector<D>],
        act: impl Fn(&[Neighbour], Place<'_, D>, &mut [Vector<D>]) -> bool + Sync,
    ) -> bool {
        let one = |(number, target): (usize, &mut [Vector<D>])| {
            let from = number * CHUNK;
            let mut inverse_mass = InverseMass::<D>::new(&mass[from..from + target.len()]);
            let (mut first, mut all) = (self.first_stretch(from), true);
            for (block, target) in target.chunks_mut(BLOCK).enumerate() {
                let start = from + block * BLOCK;
                let end = start + target.len();
                inverse_mass.see(start - from..end - from);
                for (piece, neighbours) in self.pieces(start..end, &mut first) {
                    let place = Place { position, own: piece.start, inverse_mass: inverse_mass.from(piece.start - start) };
                    all &= act(neighbours, place, &mut target[piece.start - start..piece.end - start]);
                }
            }
            all
        };
        if threads::are_worth_it(target.len()) {
            target.par_chunks_mut(CHUNK).enumerate().map(one).reduce(|| true, |one, other| one & other)
        } else {
            target.chunks_mut(CHUNK).enumerate().map(one).fold(true, |one, other| one & other)
        }
    }

    /// The first stretch that ends behind this particle.
    pub(super) fn first_stretch(&self, particle: usize) -> usize {
        self.stretches.partition_point(|stretch| stretch.particles.end <= particle)
    }

    /// These particles in pieces whose neighbours are alike, none of which may be left out. `first` is the
    /// [`first_stretch`](Self::first_stretch) of the first of them, and becomes that of the next after the last.
    pub(super) fn pieces<'a>(
        &'a self,
        particles: Range<usize>,
        first: &'a mut usize,
    ) -> impl Iterator<Item = (Range<usize>, &'a [Neighbour])> {
        let mut start = particles.start;
        std::iter::from_fn(move || {
            let alone = |end: usize| (start..end.min(particles.end), &[][..]);
            let piece = match self.stretches.get(*first) {
                _ if start >= particles.end => return None,
                None => alone(particles.end),
                Some(stretch) if start < stretch.particles.start => alone(stretch.particles.start),
                Some(stretch) => {
                    let piece = start..stretch.particles.end.min(particles.end);
                    *first += usize::from(piece.end == stretch.particles.end);
                    (piece, &self.neighbours[stretch.neighbours.clone()])
                }
            };
            start = piece.0.end;
            Some(piece)
        })
    }

    pub(super) fn gather<const D: usize, A: Action>(
        &self,
        neighbours: &[Neighbour],
        place: Place<'_, D>,
        target: &mut [f64],
        action: A,
    ) -> bool {
        if target.len() < LANES {
            return Self::gather_few(neighbours, place, target, action);
        }
        match *neighbours {
            [] => self.gather_from::<D, A, 0>([], place, target, action),
            [a] => self.gather_from([a], place, target, action),
            [a, b] => self.gather_from([a, b], place, target, action),
            [a, b, c] => self.gather_from([a, b, c], place, target, action),
            [a, b, c, d] => self.gather_from([a, b, c, d], place, target, action),
            [a, b, c, d, e] => self.gather_from([a, b, c, d, e], place, target, action),
            [a, b, c, d, e, f] => self.gather_from([a, b, c, d, e, f], place, target, action),
            [a, b, c, d, e, f, g] => self.gather_from([a, b, c, d, e, f, g], place, target, action),
            [a, b, c, d, e, f, g, h, ..] => self.gather_from([a, b, c, d, e, f, g, h], place, target, action),
        }
    }

    /// As [`Gather`], but for so few numbers that preparing for it would take longer.
    fn gather_few<const D: usize, A: Action>(neighbours: &[Neighbour], place: Place<'_, D>, target: &mut [f64], action: A) -> bool {
        let Place { position, own, inverse_mass } = place;
        let (position, mut doubt) = (Vector::components(position), 0.0);
        for n in 0..target.len() {
            let own = D * own + n;
            let pull = |neighbour: &Neighbour| {
                neighbour.stiffness * (position[own.wrapping_add_signed(D as isize * neighbour.offset)] - position[own])
            };
            let a = neighbours.iter().map(pull).reduce(|a, pull| a + pull).unwrap_or(0.0);
            let [x, seen] = action.act_on_one(target[n], a * inverse_mass.of(n));
            (target[n], doubt) = (x, doubt + seen);
        }
        doubt.is_finite()
    }

    fn gather_from<const D: usize, A: Action, const N: usize>(
        &self,
        neighbours: [Neighbour; N],
        place: Place<'_, D>,
        target: &mut [f64],
        action: A,
    ) -> bool {
        let Place { position, own, inverse_mass } = place;
        let components = |first: usize| &Vector::components(&position[first..])[..target.len()];
        let near = neighbours.map(|neighbour| components(own.strict_add_signed(neighbour.offset)));
        let (stiffness, own) = (neighbours.map(|neighbour| neighbour.stiffness), components(own));
        match inverse_mass {
            Inverse::Alike(one) => {
                eight::run(self.instructions, Gather { stiffness, near, own, inverse_mass: Alike(one), target, action })
            }
            Inverse::Each(all) => {
                let inverse_mass = Each(&all[..target.len()]);
                eight::run(self.instructions, Gather { stiffness, near, own, inverse_mass, target, action })
            }
        }
    }
}

/// The particles of a piece.
#[derive(Clone, Copy)]
pub(super) struct Place<'a, const D: usize> {
    /// Theirs, and those of all that pulls at them.
    pub(super) position: &'a [Vector<D>],
    /// Which of these is that of the first.
    pub(super) own: usize,
    pub(super) inverse_mass: Inverse<'a>,
}

/// `1/m`; 0 without mass, which nothing pulls at.
#[derive(Clone, Copy)]
pub(super) enum Inverse<'a> {
    Alike(f64),
    /// For each component of the particles.
    Each(&'a [f64]),
}

impl Inverse<'_> {
    fn of(self, n: usize) -> f64 {
        match self {
            Self::Alike(one) => one,
            Self::Each(all) => all[n],
        }
    }
}

/// [`Inverse`] masses of the particles of a block.
pub(super) struct InverseMass<'a, const D: usize> {
    mass: &'a [f64],
    /// That of all particles, if they are alike: most chains and membranes are of equal masses.
    alike: Option<f64>,
    /// For each component of the particles of the block.
    components: Vec<[f64; D]>,
}

impl<'a, const D: usize> InverseMass<'a, D> {
    /// Of particles of these masses.
    pub(super) fn new(mass: &'a [f64]) -> Self {
        let alike = mass.first().filter(|first| {
            let differences = mass.iter().fold(0, |bits, mass| bits | (mass.to_bits() ^ first.to_bits()));
            differences == 0
        });
        Self { mass, alike: alike.map(|&mass| inverse(mass)), components: vec![] }
    }

    /// Takes in the masses of a block.
    pub(super) fn see(&mut self, block: Range<usize>) {
        if self.alike.is_none() {
            self.components.clear();
            self.components.extend(self.mass[block].iter().map(|&mass| [inverse(mass); D]));
        }
    }

    /// Those of the particles of the block from this one on.
    pub(super) fn from(&self, particle: usize) -> Inverse<'_> {
        self.alike.map_or_else(|| Inverse::Each(self.components[particle..].as_flattened()), Inverse::Alike)
    }
}

fn inverse(mass: f64) -> f64 {
    if mass == 0.0 { 0.0 } else { 1.0 / mass }
}
