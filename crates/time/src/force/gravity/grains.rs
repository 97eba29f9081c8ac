//! The pull of masses on massless grains.

use corpuscle_core::instructions::{Instructions, Kernel};
use corpuscle_core::{Particles, Vector};
use rayon::prelude::*;

use super::lanes::{guess, inverse_cube_of_root};
use super::scale::Scale;

/// Grains handled by one thread at a time.
const BLOCK: usize = 256;
/// Pulls from which more than one thread is worth the waiting.
pub(super) const WORTH_THREADS: usize = 1 << 17;

/// A mass as grains see it, in scaled lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<const D: usize> {
    pub(super) position: Vector<D>,
    pub(super) strength: f64,
}

impl<const D: usize> Source<D> {
    pub(super) fn new(constant: f64, scale: Scale, position: Vector<D>, mass: f64) -> Self {
        Self { position: position * scale.length, strength: constant * mass * scale.acceleration() }
    }
}

/// Adds the pull of `masses` to the acceleration of every particle without mass.
pub(super) fn attract_grains<const D: usize>(
    constant: f64,
    scale: Scale,
    softening_squared: f64,
    masses: &[usize],
    particles: &Particles<D>,
    acceleration: &mut [Vector<D>],
    instructions: Instructions,
) {
    let Particles { position, mass, .. } = particles;
    let sources: Vec<_> = masses.iter().map(|&i| Source::new(constant, scale, position[i], mass[i])).collect();
    let attract = |((position, mass), acceleration): ((&[Vector<D>], &[f64]), &mut [Vector<D>])| {
        if mass.contains(&0.0) {
            let (sources, length) = (sources.as_slice(), scale.length);
            instructions.run(Attraction { sources, length, softening_squared, position, mass, acceleration });
        }
    };
    if particles.len() * masses.len() >= WORTH_THREADS {
        let blocks = position.par_chunks(BLOCK).zip(mass.par_chunks(BLOCK));
        blocks.zip(acceleration.par_chunks_mut(BLOCK)).for_each(attract);
    } else {
        attract(((position, mass), acceleration));
    }
}

/// Blocks are laid out in lanes, attracted, and read back, in three loops: merged, they hide the lanes from a compiler.
struct Attraction<'a, const D: usize> {
    sources: &'a [Source<D>],
    length: f64,
    softening_squared: f64,
    position: &'a [Vector<D>],
    mass: &'a [f64],
    acceleration: &'a mut [Vector<D>],
}

impl<const D: usize> Kernel for Attraction<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { sources, length, softening_squared, position, mass, acceleration } = self;
        let mut places = [[0.0; BLOCK]; D];
        let mut squares = [0.0; BLOCK];
        let mut guesses = [0.0f32; BLOCK];
        let blocks = position.chunks(BLOCK).zip(mass.chunks(BLOCK)).zip(acceleration.chunks_mut(BLOCK));
        for ((position, mass), acceleration) in blocks {
            for (i, r) in position.iter().enumerate() {
                for k in 0..D {
                    places[k][i] = r[k] * length;
                }
            }
            let mut pulls = [[0.0; BLOCK]; D];
            for source in sources {
                for i in 0..position.len() {
                    let arrow: [f64; D] = std::array::from_fn(|k| source.position[k] - places[k][i]);
                    squares[i] = arrow.iter().fold(softening_squared, |sum, x| sum + x * x);
                    guesses[i] = guess(squares[i]);
                }
                for i in 0..position.len() {
                    let pull = source.strength * inverse_cube_of_root(squares[i], guesses[i]);
                    for k in 0..D {
                        pulls[k][i] += pull * (source.position[k] - places[k][i]);
                    }
                }
            }
            // A mass among the grains has met itself: its pull is no number.
            if mass.iter().fold(0, |bits, mass| bits | mass.to_bits()) == 0 {
                for (i, a) in acceleration.iter_mut().enumerate() {
                    *a += Vector::from_fn(|k| pulls[k][i]);
                }
            } else {
                for (i, a) in acceleration.iter_mut().enumerate().filter(|(i, _)| mass[*i] == 0.0) {
                    *a += Vector::from_fn(|k| pulls[k][i]);
                }
            }
        }
    }
}
