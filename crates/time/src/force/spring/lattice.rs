//! Linear springs arranged regularly, as in strings and membranes: every particle gathers what pulls at it.
//!
//! A spring is worked out twice, once for each end. In return nothing is written but the sum, which never leaves the processor's
//! nearest cache.

use std::ops::Range;

use corpuscle_core::{Instructions, Particles, Vector};
use rayon::prelude::*;

use super::Spring;
use super::gather::{Add, Ahead, Gather, Move, Sink};
use super::sweep::{Sweep, in_parts};
use crate::constraint::Held;
use crate::lanes;
use crate::motion::{Moves, both};
use crate::threads::{self, CHUNK};

/// Particles handled together.
const BLOCK: usize = 256;
/// Particles that must have the same neighbours, one after the other, in the mean.
const REGULAR: usize = 16;
/// The most springs at a particle: kernels are compiled for each number of them.
const MOST: usize = 8;
/// Places kept before the window starts anew.
const WINDOW: usize = 4096;

/// For each particle the springs at it, in the order of their other ends; stretches of particles whose springs are alike share them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lattice {
    stretches: Vec<Stretch>,
    neighbours: Vec<Neighbour>,
    /// The farthest apart in memory that two ends are.
    reach: usize,
    pub(super) instructions: Instructions,
}

#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    particles: Range<usize>,
    neighbours: Range<usize>,
}

/// What pulls at a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Neighbour {
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
            let (mut inverse_mass, mut first) = (InverseMass::<D>::new(), self.first_stretch(number * CHUNK));
            for (block, acceleration) in acceleration.chunks_mut(BLOCK).enumerate() {
                let start = number * CHUNK + block * BLOCK;
                let end = start + acceleration.len();
                inverse_mass.see(&mass[start..end]);
                for (piece, neighbours) in self.pieces(start..end, &mut first) {
                    let of_piece = Vector::components_mut(&mut acceleration[piece.start - start..piece.end - start]);
                    let place = Place { position, own: piece.start, inverse_mass: inverse_mass.from(piece.start - start) };
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

    /// Kicks and drifts by the accelerations at the present positions, as [`Springs::sweep`](super::Springs::sweep).
    pub(super) fn sweep<const D: usize>(&self, particles: &mut Particles<D>, held: &[Held], moves: Moves) -> [bool; 2] {
        let Particles { position, velocity, mass, .. } = particles;
        let sweep = Gathering { lattice: self, mass, held, moves };
        in_parts(&sweep, position, velocity, BLOCK, self.reach)
    }

    /// The first stretch that ends behind this particle.
    fn first_stretch(&self, particle: usize) -> usize {
        self.stretches.partition_point(|stretch| stretch.particles.end <= particle)
    }

    /// These particles in pieces whose neighbours are alike, none of which may be left out. `first` is the
    /// [`first_stretch`](Self::first_stretch) of the first of them, and becomes that of the next after the last.
    fn pieces<'a>(
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

    fn gather<const D: usize, S: Sink>(&self, neighbours: &[Neighbour], place: Place<'_, D>, sink: S) -> S::Output {
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
        let Place { position, own, inverse_mass } = place;
        let components = |first: usize| &Vector::components(&position[first..])[..sink.len()];
        let near = neighbours.map(|neighbour| components(own.wrapping_add_signed(neighbour.offset)));
        let stiffness = neighbours.map(|neighbour| neighbour.stiffness);
        let inverse_mass = &inverse_mass[..sink.len()];
        lanes::run(self.instructions, Gather { stiffness, near, own: components(own), inverse_mass, sink })
    }
}

/// Where the particles of a piece are.
#[derive(Clone, Copy)]
struct Place<'a, const D: usize> {
    position: &'a [Vector<D>],
    /// Which of these positions is that of the first; those of all others are as far from it as in memory.
    own: usize,
    /// For each component.
    inverse_mass: &'a [f64],
}

/// `1/m` for each component of the particles of a block; 0 without mass, which nothing pulls at.
struct InverseMass<const D: usize> {
    components: [[f64; D]; BLOCK],
    /// The mass they are all of, if they are.
    alike: Option<f64>,
}

impl<const D: usize> InverseMass<D> {
    fn new() -> Self {
        Self { components: [[0.0; D]; BLOCK], alike: None }
    }

    /// Takes in the masses of a block. Most chains and membranes are of equal masses: nothing is to be done then but to see that.
    fn see(&mut self, mass: &[f64]) {
        let first = mass[0];
        let differences = mass.iter().fold(0, |bits, mass| bits | (mass.to_bits() ^ first.to_bits()));
        let alike = (differences == 0).then_some(first);
        if alike.is_some() && alike == self.alike {
            return;
        }
        self.alike = alike;
        let inverse = |mass: f64| if mass == 0.0 { 0.0 } else { 1.0 / mass };
        if alike.is_some() {
            self.components.fill([inverse(first); D]);
        } else {
            for (components, mass) in self.components.iter_mut().zip(mass) {
                *components = [inverse(*mass); D];
            }
        }
    }

    fn from(&self, particle: usize) -> &[f64] {
        self.components[particle..].as_flattened()
    }
}

/// One sweep over the memory: places as they were slide by in a window, while behind it particles move.
struct Gathering<'a> {
    lattice: &'a Lattice,
    mass: &'a [f64],
    held: &'a [Held],
    moves: Moves,
}

impl<const D: usize> Sweep<D> for Gathering<'_> {
    /// Where the particles on either side are, as far as springs reach.
    type Seam = [Vec<Vector<D>>; 2];

    fn seam(&self, position: &[Vector<D>], at: usize) -> Self::Seam {
        let reach = self.lattice.reach;
        [position[at - reach..at].to_vec(), position[at..(at + reach).min(position.len())].to_vec()]
    }

    fn part(
        &self,
        position: &mut [Vector<D>],
        velocity: &mut [Vector<D>],
        [before, _]: &Self::Seam,
        [_, after]: &Self::Seam,
        from: usize,
    ) -> [bool; 2] {
        let Self { lattice, mass, held, moves } = *self;
        let (count, reach) = (position.len(), lattice.reach);
        let mut window = Vec::with_capacity(WINDOW + 4 * reach + BLOCK);
        window.extend_from_slice(before);
        // Places of the part that have come into the window, and all that have left it.
        let (mut seen, mut gone) = (0, 0);
        let (mut inverse_mass, mut finite) = (InverseMass::<D>::new(), [true; 2]);
        let (mut still, mut stretch) = (vec![], lattice.first_stretch(from));
        let mut held = &held[held.partition_point(|held| held.particle < from)..];
        for start in (0..count).step_by(BLOCK) {
            let end = (start + BLOCK).min(count);
            if window.len() > WINDOW + 2 * reach {
                let needed = (before.len() + start).saturating_sub(reach);
                window.drain(..needed - gone);
                gone = needed;
            }
            if seen < count {
                let next = (end + reach).min(count);
                window.extend_from_slice(&position[seen..next]);
                seen = next;
                if seen == count {
                    window.extend_from_slice(after);
                }
            }
            inverse_mass.see(&mass[from + start..from + end]);
            let (among, later) = held.split_at(held.iter().take_while(|held| held.particle < from + end).count());
            held = later;
            still.extend(
                among.iter().map(|held| (position[held.particle - from][held.axis], velocity[held.particle - from][held.axis])),
            );
            for (piece, neighbours) in lattice.pieces(from + start..from + end, &mut stretch) {
                let (first, last) = (piece.start - from, piece.end - from);
                let own = before.len() + first - gone;
                let place = Place { position: &window, own, inverse_mass: inverse_mass.from(first - start) };
                let (position, velocity) =
                    (Ahead::new(position, first..last, reach + BLOCK), Ahead::new(velocity, first..last, BLOCK));
                finite = both(
                    finite,
                    match moves.owed {
                        Some(_) => lattice.gather(neighbours, place, Move::<true>::new(position, velocity, moves)),
                        None => lattice.gather(neighbours, place, Move::<false>::new(position, velocity, moves)),
                    },
                );
            }
            for (held, (r, v)) in among.iter().zip(still.drain(..)) {
                (position[held.particle - from][held.axis], velocity[held.particle - from][held.axis]) = (r + v * moves.drift, v);
            }
        }
        finite
    }
}
