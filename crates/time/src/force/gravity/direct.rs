//! Every pair of masses once, in blocks that meet as the teams of a tournament.

use corpuscle_core::{Particles, Vector};
use rayon::prelude::*;

use super::lanes::{LANES, Lanes, dispatch, inverse_cube_of_root, sum};

/// Eight masses side by side.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Chunk<const D: usize> {
    pub(super) position: [Lanes; D],
    /// `G m`; zero in lanes that fill up the last chunk.
    pub(super) strength: Lanes,
    pub(super) acceleration: [Lanes; D],
    /// What rounding took from the positions.
    pub(super) remainder: [Lanes; D],
}

/// Chunks of a block. Two blocks of 256 masses fit the first-level cache.
const BLOCK: usize = 32;
/// Blocks are smaller where there would be fewer than this many, so that threads find enough to do.
const LEAST_BLOCKS: usize = 16;
/// Masses from which more than one thread is worth the waiting at the end of a round.
const WORTH_THREADS: usize = 1024;
/// Masses attracted at a time, so that each number loaded serves more than once.
const ROWS: usize = 2;

/// A power of two by which lengths are multiplied, so that the squares of distances stay within single precision: the
/// largest coordinate becomes about `2^60`, and distances down to `2^-123` of it count. Powers of two round nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub(super) length: f64,
}

impl Scale {
    pub(super) fn new<const D: usize>(softening: f64, positions: &[Vector<D>]) -> Self {
        let mut largest = [0.0; D];
        for r in positions {
            for k in 0..D {
                largest[k] = if r[k].abs() > largest[k] { r[k].abs() } else { largest[k] };
            }
        }
        let largest = largest.into_iter().fold(softening, f64::max);
        // The exponent alone: a power of two at most twice too small.
        let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        Self { length: if largest > 0.0 { power_of_two((60 - exponent).clamp(-500, 500)) } else { 1.0 } }
    }

    /// What accelerations `G m r / r^3` of scaled lengths are multiplied by.
    pub(super) fn acceleration(self) -> f64 {
        self.length * self.length
    }
}

fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The masses of a system, and how they attract each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Masses<const D: usize> {
    pub(super) index: Vec<usize>,
    pub(super) chunks: Vec<Chunk<D>>,
}

impl<const D: usize> Masses<D> {
    /// Takes the particles that have mass.
    pub(super) fn load(&mut self, constant: f64, scale: Scale, particles: &Particles<D>, remainder: &[Vector<D>]) {
        self.index.clear();
        self.index.extend((0..particles.len()).filter(|&i| particles.mass[i] > 0.0));
        self.chunks.clear();
        for indices in self.index.chunks(LANES) {
            // Lanes without a mass are outside the system, where they coincide with nobody.
            let mut chunk = Chunk {
                position: [[power_of_two(62); LANES]; D],
                strength: [0.0; LANES],
                acceleration: [[0.0; LANES]; D],
                remainder: [[0.0; LANES]; D],
            };
            for (lane, &i) in indices.iter().enumerate() {
                chunk.strength[lane] = constant * particles.mass[i];
                for k in 0..D {
                    chunk.position[k][lane] = particles.position[i][k] * scale.length;
                    chunk.remainder[k][lane] = remainder.get(i).map_or(0.0, |remainder| remainder[k] * scale.length);
                }
            }
            self.chunks.push(chunk);
        }
    }

    /// Adds up the pulls of every pair.
    ///
    /// Blocks meet in rounds, all blocks in each round, no block twice: threads may share a round without ever writing to the
    /// same place, and each sum is made in the order of the rounds, however many threads there are.
    pub(super) fn attract_each_other(&mut self, softening_squared: f64, precise: bool) {
        let many = self.index.len() >= WORTH_THREADS;
        let size = self.chunks.len().div_ceil(LEAST_BLOCKS).clamp(1, BLOCK);
        let mut blocks: Vec<&mut [Chunk<D>]> = self.chunks.chunks_mut(size).collect();
        let meet = |first: &mut [Chunk<D>], second: &mut [Chunk<D>]| {
            if precise { meet::<D, true>(first, second, softening_squared) } else { meet::<D, false>(first, second, softening_squared) }
        };
        let alone = |block: &mut &mut [Chunk<D>]| {
            for i in 0..block.len() {
                let (own, others) = block[i..].split_at_mut(1);
                within(&mut own[0], softening_squared, precise);
                meet(own, others);
            }
        };
        if many { blocks.par_iter_mut().for_each(alone) } else { blocks.iter_mut().for_each(alone) }
        if blocks.len() % 2 == 1 {
            blocks.push(&mut []);
        }
        for _ in 1..blocks.len() {
            let half = blocks.len() / 2;
            let (front, back) = blocks.split_at_mut(half);
            if many {
                front.par_iter_mut().zip(back.par_iter_mut().rev()).for_each(|(first, second)| meet(first, second));
            } else {
                front.iter_mut().zip(back.iter_mut().rev()).for_each(|(first, second)| meet(first, second));
            }
            blocks[1..].rotate_right(1);
        }
    }

    /// What is to be added to the acceleration of each particle with mass.
    pub(super) fn add_to(&self, scale: Scale, acceleration: &mut [Vector<D>]) {
        let factor = scale.acceleration();
        for (indices, chunk) in self.index.chunks(LANES).zip(&self.chunks) {
            for (lane, &i) in indices.iter().enumerate() {
                acceleration[i] += Vector::from_fn(|k| chunk.acceleration[k][lane] * factor);
            }
        }
    }
}

dispatch! {
    /// Every pair of one mass of the first block and one of the second.
    fn meet<const D: usize, const PRECISE: bool>(first: &mut [Chunk<D>], second: &mut [Chunk<D>], softening_squared: f64) = meet_body
}

#[inline(always)]
fn meet_body<const D: usize, const PRECISE: bool>(first: &mut [Chunk<D>], second: &mut [Chunk<D>], softening_squared: f64) {
    for chunk in first {
        let mut pull = [[0.0; LANES]; D];
        for pair in 0..LANES / ROWS {
            let row: [usize; ROWS] = std::array::from_fn(|r| pair * ROWS + r);
            let mut total = [[[0.0; LANES]; D]; ROWS];
            for other in second.iter_mut() {
                for r in 0..ROWS {
                    let mut arrow = [[0.0; LANES]; D];
                    let mut d2 = [softening_squared; LANES];
                    for k in 0..D {
                        let (x, lost) = (chunk.position[k][row[r]], chunk.remainder[k][row[r]]);
                        for lane in 0..LANES {
                            arrow[k][lane] = other.position[k][lane] - x;
                            if PRECISE {
                                arrow[k][lane] += other.remainder[k][lane] - lost;
                            }
                            d2[lane] += arrow[k][lane] * arrow[k][lane];
                        }
                    }
                    let w = inverse_cube_of_root(&d2);
                    let own = chunk.strength[row[r]];
                    let (mut given, mut taken) = ([0.0; LANES], [0.0; LANES]);
                    for lane in 0..LANES {
                        given[lane] = own * w[lane];
                        taken[lane] = other.strength[lane] * w[lane];
                    }
                    for k in 0..D {
                        for lane in 0..LANES {
                            other.acceleration[k][lane] -= given[lane] * arrow[k][lane];
                            total[r][k][lane] += taken[lane] * arrow[k][lane];
                        }
                    }
                }
            }
            for r in 0..ROWS {
                for k in 0..D {
                    pull[k][row[r]] = sum(&total[r][k]);
                }
            }
        }
        for k in 0..D {
            for lane in 0..LANES {
                chunk.acceleration[k][lane] += pull[k][lane];
            }
        }
    }
}

/// The pairs within a chunk, each seen from both sides.
fn within<const D: usize>(chunk: &mut Chunk<D>, softening_squared: f64, precise: bool) {
    for i in 0..LANES {
        let mut arrow = [[0.0; LANES]; D];
        let mut d2 = [softening_squared; LANES];
        for k in 0..D {
            for lane in 0..LANES {
                arrow[k][lane] = chunk.position[k][lane] - chunk.position[k][i];
                if precise {
                    arrow[k][lane] += chunk.remainder[k][lane] - chunk.remainder[k][i];
                }
                d2[lane] += arrow[k][lane] * arrow[k][lane];
            }
        }
        d2[i] = 1.0; // itself, with no arrow to pull along
        for lane in 0..LANES {
            // Lanes without a mass coincide with each other.
            d2[lane] = if chunk.strength[lane] == 0.0 { 1.0 } else { d2[lane] };
        }
        let w = inverse_cube_of_root(&d2);
        for k in 0..D {
            let pulls = std::array::from_fn(|lane| chunk.strength[lane] * w[lane] * arrow[k][lane]);
            chunk.acceleration[k][i] += sum(&pulls);
        }
    }
}
