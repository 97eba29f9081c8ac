//! Every pair of masses once, in blocks that meet as the teams of a tournament.

use corpuscle_core::instructions::{Instructions, Kernel};
use corpuscle_core::{Particles, Vector};
use rayon::prelude::*;

use super::lanes::{LANES, guess, inverse_cube_of_root, sum};
use super::scale::Scale;

/// Masses in a block, at most: what is needed of one block fits the first-level cache.
pub(super) const BLOCK: usize = 256;
/// Blocks are smaller where there would be fewer than this many, so that threads find enough to do.
const LEAST_BLOCKS: usize = 16;
/// Masses from which more than one thread is worth the waiting at the end of a round.
const WORTH_THREADS: usize = 1024;
/// Masses attracted at a time, so that each number loaded serves more than once.
const ROWS: usize = 2;

/// A number of each mass of a block.
type Column = [f64; BLOCK];

/// Some of the masses, one array a component. Only whole groups of lanes are used; places that hold no mass have strength zero
/// and are outside the system, where they coincide with nobody.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Block<const D: usize> {
    /// Groups of lanes in use.
    groups: usize,
    places: Places<D>,
    /// `G m`.
    strength: Column,
    acceleration: [Column; D],
}

/// Positions to twice the precision.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Places<const D: usize> {
    position: [Column; D],
    /// What rounding took from the positions.
    remainder: [Column; D],
}

/// The masses of a system, and how they attract each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Masses<const D: usize> {
    pub(super) index: Vec<usize>,
    blocks: Vec<Block<D>>,
    /// Masses in each block but the last.
    size: usize,
}

impl<const D: usize> Masses<D> {
    /// Takes the particles that have mass.
    pub(super) fn load(&mut self, constant: f64, scale: Scale, particles: &Particles<D>, remainder: &[Vector<D>]) {
        self.index.clear();
        for (chunk, masses) in particles.mass.chunks(LANES).enumerate() {
            // Among grains most chunks have no mass at all: all bits are zero, which vectors see at a glance.
            if masses.iter().fold(0, |bits, mass| bits | mass.to_bits()) != 0 {
                let indices = (0..masses.len()).filter(|&lane| masses[lane] > 0.0);
                self.index.extend(indices.map(|lane| chunk * LANES + lane));
            }
        }
        self.size = (self.index.len().div_ceil(LEAST_BLOCKS * LANES) * LANES).clamp(LANES, BLOCK);
        let empty = || Block {
            groups: 0,
            places: Places { position: [[0.0; BLOCK]; D], remainder: [[0.0; BLOCK]; D] },
            strength: [0.0; BLOCK],
            acceleration: [[0.0; BLOCK]; D],
        };
        self.blocks.resize_with(self.index.len().div_ceil(self.size), empty);
        for (indices, block) in self.index.chunks(self.size).zip(&mut self.blocks) {
            block.groups = indices.len().div_ceil(LANES);
            for place in 0..block.groups * LANES {
                let i = indices.get(place);
                block.strength[place] = i.map_or(0.0, |&i| constant * particles.mass[i]);
                for k in 0..D {
                    block.places.position[k][place] = i.map_or(Scale::OUTSIDE, |&i| particles.position[i][k] * scale.length);
                    block.places.remainder[k][place] = i.and_then(|&i| remainder.get(i)).map_or(0.0, |r| r[k] * scale.length);
                    block.acceleration[k][place] = 0.0;
                }
            }
        }
    }

    /// Adds up the pulls of every pair.
    ///
    /// Blocks meet in rounds, all blocks in each round, no block twice: threads may share a round without ever writing to the
    /// same place, and each sum is made in the order of the rounds, however many threads there are.
    pub(super) fn attract_each_other(&mut self, softening_squared: f64, precise: bool, instructions: Instructions) {
        let threads = self.index.len() >= WORTH_THREADS;
        let alone = |block: &mut Block<D>| {
            if precise {
                instructions.run(Seclusion::<D, true> { block, softening_squared });
            } else {
                instructions.run(Seclusion::<D, false> { block, softening_squared });
            }
        };
        let meet = |(first, second): (&mut Option<&mut Block<D>>, &mut Option<&mut Block<D>>)| {
            let (Some(first), Some(second)) = (first, second) else { return };
            if precise {
                instructions.run(Meeting::<D, true> { first, second, softening_squared });
            } else {
                instructions.run(Meeting::<D, false> { first, second, softening_squared });
            }
        };
        if threads {
            self.blocks.par_iter_mut().for_each(alone);
        } else {
            self.blocks.iter_mut().for_each(alone);
        }
        let mut teams: Vec<Option<&mut Block<D>>> = self.blocks.iter_mut().map(Some).collect();
        if teams.len() % 2 == 1 {
            teams.push(None); // whoever meets nobody rests
        }
        for _ in 1..teams.len() {
            let half = teams.len() / 2;
            let (front, back) = teams.split_at_mut(half);
            if threads {
                front.par_iter_mut().zip(back.par_iter_mut().rev()).for_each(meet);
            } else {
                front.iter_mut().zip(back.iter_mut().rev()).for_each(meet);
            }
            teams[1..].rotate_right(1);
        }
    }

    /// Adds the sums to the accelerations of the particles with mass.
    pub(super) fn add_to(&self, scale: Scale, acceleration: &mut [Vector<D>]) {
        let factor = scale.acceleration();
        for (indices, block) in self.index.chunks(self.size).zip(&self.blocks) {
            for (place, &i) in indices.iter().enumerate() {
                acceleration[i] += Vector::from_fn(|k| block.acceleration[k][place] * factor);
            }
        }
    }
}

/// Every pair of one mass of the first block and one of the second.
struct Meeting<'a, const D: usize, const PRECISE: bool> {
    first: &'a mut Block<D>,
    second: &'a mut Block<D>,
    softening_squared: f64,
}

impl<const D: usize, const PRECISE: bool> Kernel for Meeting<'_, D, PRECISE> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { first, second, softening_squared } = self;
        let count = (second.groups * LANES).min(BLOCK);
        let Block { places, strength, acceleration, .. } = second;
        let (mut weights, mut guesses) = ([[0.0; BLOCK]; ROWS], [[0.0; BLOCK]; ROWS]);
        for rows in 0..first.groups * LANES / ROWS {
            let rows: [Row<D>; ROWS] = std::array::from_fn(|r| first.row(rows * ROWS + r));
            measure::<D, PRECISE>(&rows, softening_squared, count, places, &mut weights, &mut guesses);
            give::<D, PRECISE>(&rows, count, places, strength, &guesses, &mut weights, acceleration);
            for (row, weights) in rows.iter().zip(&weights) {
                let taken = take::<D, PRECISE>(row, count, places, weights);
                for k in 0..D {
                    first.acceleration[k][row.place] += taken[k];
                }
            }
        }
    }
}

/// The pairs within a block, each seen from both sides.
struct Seclusion<'a, const D: usize, const PRECISE: bool> {
    block: &'a mut Block<D>,
    softening_squared: f64,
}

impl<const D: usize, const PRECISE: bool> Kernel for Seclusion<'_, D, PRECISE> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { block, softening_squared } = self;
        let count = (block.groups * LANES).min(BLOCK);
        let (mut weights, mut guesses) = ([[0.0; BLOCK]; ROWS], [[0.0; BLOCK]; ROWS]);
        for rows in 0..count / ROWS {
            let rows: [Row<D>; ROWS] = std::array::from_fn(|r| block.row(rows * ROWS + r));
            let Block { places, strength, acceleration, .. } = &mut *block;
            measure::<D, PRECISE>(&rows, softening_squared, count, places, &mut weights, &mut guesses);
            for ((row, weights), guesses) in rows.iter().zip(&mut weights).zip(&guesses) {
                for place in 0..count {
                    weights[place] = strength[place] * inverse_cube_of_root(weights[place], guesses[place]);
                }
                weights[row.place] = 0.0; // itself
                let taken = take::<D, PRECISE>(row, count, places, weights);
                for k in 0..D {
                    acceleration[k][row.place] += taken[k];
                }
            }
        }
    }
}

/// One mass of a block.
#[derive(Clone, Copy)]
struct Row<const D: usize> {
    place: usize,
    position: [f64; D],
    remainder: [f64; D],
    strength: f64,
}

impl<const D: usize> Row<D> {
    /// Component `k` of the arrow to a mass of another block.
    #[inline(always)]
    fn arrow<const PRECISE: bool>(&self, k: usize, place: usize, places: &Places<D>) -> f64 {
        let x = places.position[k][place] - self.position[k];
        if PRECISE { x + (places.remainder[k][place] - self.remainder[k]) } else { x }
    }
}

/// Squares of the distances of some masses from those of a block, and guesses of the inverse distances.
#[inline(always)]
fn measure<const D: usize, const PRECISE: bool>(
    rows: &[Row<D>; ROWS],
    softening_squared: f64,
    count: usize,
    places: &Places<D>,
    squares: &mut [Column; ROWS],
    guesses: &mut [[f32; BLOCK]; ROWS],
) {
    for place in 0..count {
        for r in 0..ROWS {
            let mut square = softening_squared;
            for k in 0..D {
                let x = rows[r].arrow::<PRECISE>(k, place, places);
                square += x * x;
            }
            squares[r][place] = square;
            guesses[r][place] = guess(square);
        }
    }
}

/// What the masses of the block get from the rows; squares become what the rows take, per length of the arrow.
#[inline(always)]
fn give<const D: usize, const PRECISE: bool>(
    rows: &[Row<D>; ROWS],
    count: usize,
    places: &Places<D>,
    strength: &Column,
    guesses: &[[f32; BLOCK]; ROWS],
    weights: &mut [Column; ROWS],
    acceleration: &mut [Column; D],
) {
    for place in 0..count {
        let mut given = [0.0; D];
        for r in 0..ROWS {
            let w = inverse_cube_of_root(weights[r][place], guesses[r][place]);
            weights[r][place] = strength[place] * w;
            let give = rows[r].strength * w;
            for k in 0..D {
                given[k] += give * rows[r].arrow::<PRECISE>(k, place, places);
            }
        }
        for k in 0..D {
            acceleration[k][place] -= given[k];
        }
    }
}

/// What a row gets from the masses of the block, lane by lane.
#[inline(always)]
fn take<const D: usize, const PRECISE: bool>(row: &Row<D>, count: usize, places: &Places<D>, weights: &Column) -> [f64; D] {
    let (weights, _) = weights[..count].as_chunks::<LANES>();
    std::array::from_fn(|k| {
        let (position, _) = places.position[k][..count].as_chunks::<LANES>();
        let (remainder, _) = places.remainder[k][..count].as_chunks::<LANES>();
        let mut taken = [0.0; LANES];
        for ((weight, x), lost) in weights.iter().zip(position).zip(remainder) {
            for lane in 0..LANES {
                let mut arrow = x[lane] - row.position[k];
                if PRECISE {
                    arrow += lost[lane] - row.remainder[k];
                }
                taken[lane] += weight[lane] * arrow;
            }
        }
        sum(&taken)
    })
}

impl<const D: usize> Block<D> {
    fn row(&self, place: usize) -> Row<D> {
        Row {
            place,
            position: std::array::from_fn(|k| self.places.position[k][place]),
            remainder: std::array::from_fn(|k| self.places.remainder[k][place]),
            strength: self.strength[place],
        }
    }
}
