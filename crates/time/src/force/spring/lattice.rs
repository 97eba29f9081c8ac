//! Linear springs arranged regularly, as in strings and membranes: every particle gathers what pulls at it.
//!
//! A spring is worked out twice, once for each end. In return nothing is written but the sum, which never leaves the processor's
//! nearest cache.

use std::ops::Range;

use corpuscle_core::{Instructions, Particles, Vector};
use rayon::prelude::*;

use super::Spring;
use super::gather::{Add, Gather, Sink};
use crate::lanes::eight;
use crate::threads::{self, CHUNK};

/// Particles handled together.
pub(super) const BLOCK: usize = 256;
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
        let one = |(number, acceleration): (usize, &mut [Vector<D>])| {
            let from = number * CHUNK;
            let mut inverse_mass = InverseMass::<D>::new(&mass[from..from + acceleration.len()], BLOCK);
            let mut first = self.first_stretch(from);
            for (block, acceleration) in acceleration.chunks_mut(BLOCK).enumerate() {
                let start = from + block * BLOCK;
                let end = start + acceleration.len();
                inverse_mass.see(start - from..end - from);
                for (piece, neighbours) in self.pieces(start..end, &mut first) {
                    let of_piece = Vector::components_mut(&mut acceleration[piece.start - start..piece.end - start]);
                    let inverse_mass = inverse_mass.from(piece.start - start);
                    let place = Place { around: Around { position, own: piece.start }, inverse_mass };
                    self.gather(neighbours, place, Add(of_piece));
                }
            }
        };
        if threads::are_worth_it(acceleration.len()) {
            acceleration.par_chunks_mut(CHUNK).enumerate().for_each(one);
        } else {
            acceleration.chunks_mut(CHUNK).enumerate().for_each(one);
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

    pub(super) fn gather<const D: usize, S: Sink>(&self, neighbours: &[Neighbour], place: Place<'_, D>, sink: S) -> S::Output {
        match *neighbours {
            [] => self.gather_from::<D, S, 0>([], place, sink),
            [a] => self.gather_from([a], place, sink),
            [a, b] => self.gather_from([a, b], place, sink),
            [a, b, c] => self.gather_from([a, b, c], place, sink),
            [a, b, c, d] => self.gather_from([a, b, c, d], place, sink),
            [a, b, c, d, e] => self.gather_from([a, b, c, d, e], place, sink),
            [a, b, c, d, e, f] => self.gather_from([a, b, c, d, e, f], place, sink),
            [a, b, c, d, e, f, g] => self.gather_from([a, b, c, d, e, f, g], place, sink),
            [a, b, c, d, e, f, g, h, ..] => self.gather_from([a, b, c, d, e, f, g, h], place, sink),
        }
    }

    fn gather_from<const D: usize, S: Sink, const N: usize>(
        &self,
        neighbours: [Neighbour; N],
        place: Place<'_, D>,
        sink: S,
    ) -> S::Output {
        let Place { around, inverse_mass } = place;
        let components = |first: usize| &Vector::components(&around.position[first..])[..sink.len()];
        let near = neighbours.map(|neighbour| components(around.at(neighbour.offset)));
        let stiffness = neighbours.map(|neighbour| neighbour.stiffness);
        let inverse_mass = &inverse_mass[..sink.len()];
        eight::run(self.instructions, Gather { stiffness, near, own: components(around.own), inverse_mass, sink })
    }
}

/// The particles of a piece.
#[derive(Clone, Copy)]
pub(super) struct Place<'a, const D: usize> {
    pub(super) around: Around<'a, D>,
    /// For each component.
    pub(super) inverse_mass: &'a [f64],
}

/// Where particles that follow one another are, and their neighbours.
#[derive(Clone, Copy)]
pub(super) struct Around<'a, const D: usize> {
    /// After the last they follow from the first on again.
    pub(super) position: &'a [Vector<D>],
    /// Which of these positions is that of the first particle.
    pub(super) own: usize,
}

impl<const D: usize> Around<'_, D> {
    /// Without the first few, which are in one piece.
    pub(super) fn from(self, first: usize) -> Self {
        Self { own: self.own + first, ..self }
    }

    /// Of `most` particles, so many have their neighbours, none farther than `reach`, in one piece.
    pub(super) fn straight(self, neighbours: &[Neighbour], reach: usize, most: usize) -> usize {
        let count = self.position.len();
        if self.own >= reach && self.own + most + reach <= count {
            return most;
        }
        neighbours.iter().map(|neighbour| count - self.at(neighbour.offset)).fold(most.min(count - self.own), usize::min)
    }

    /// Where the position is that is so much farther on in memory.
    #[inline]
    fn at(self, offset: isize) -> usize {
        let (at, room) = (self.own as isize + offset, self.position.len() as isize);
        (at + if at < 0 {
            room
        } else if at < room {
            0
        } else {
            -room
        }) as usize
    }
}

/// `1/m` for each component of the particles of a block; 0 without mass, which nothing pulls at.
pub(super) struct InverseMass<'a, const D: usize> {
    mass: &'a [f64],
    components: Vec<[f64; D]>,
    /// The mass they are all of, if they are.
    alike: Option<f64>,
    /// Whether that is the mass of all particles. Most chains and membranes are of equal masses: nothing is to be done then.
    all: bool,
}

impl<'a, const D: usize> InverseMass<'a, D> {
    /// For blocks of at most so many of particles of these masses.
    pub(super) fn new(mass: &'a [f64], block: usize) -> Self {
        let mut seen = Self { mass, components: vec![], alike: None, all: false };
        if let Some(alike) = alike(mass) {
            seen.take_in(&mass[..block.min(mass.len())], Some(alike));
            seen.all = true;
        }
        seen
    }

    /// Takes in the masses of a block.
    pub(super) fn see(&mut self, block: Range<usize>) {
        if self.all {
            return;
        }
        let mass = &self.mass[block];
        let alike = alike(mass);
        if alike.is_none() || alike != self.alike || mass.len() > self.components.len() {
            self.take_in(mass, alike);
        }
    }

    fn take_in(&mut self, mass: &[f64], alike: Option<f64>) {
        self.alike = alike;
        let inverse = |mass: f64| if mass == 0.0 { 0.0 } else { 1.0 / mass };
        self.components.clear();
        if let Some(alike) = alike {
            self.components.resize(mass.len(), [inverse(alike); D]);
        } else {
            self.components.extend(mass.iter().map(|&mass| [inverse(mass); D]));
        }
    }

    pub(super) fn from(&self, particle: usize) -> &[f64] {
        self.components[particle..].as_flattened()
    }
}

/// The one mass that all of these are.
fn alike(mass: &[f64]) -> Option<f64> {
    let &first = mass.first()?;
    let differences = mass.iter().fold(0, |bits, mass| bits | (mass.to_bits() ^ first.to_bits()));
    (differences == 0).then_some(first)
}
