//! The pull of masses on massless grains.

use corpuscle_core::{Particles, Vector};
use rayon::prelude::*;

use super::direct::Scale;
use super::lanes::{LANES, Lanes, dispatch, inverse_cube_of_root};

/// Grains handled by one thread at a time.
const BLOCK: usize = 512;
/// Pulls from which more than one thread is worth the waiting.
const WORTH_THREADS: usize = 1 << 17;

/// A mass as grains see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<const D: usize> {
    position: Vector<D>,
    strength: f64,
}

/// Adds the pull of `masses` to the acceleration of every particle without mass.
pub(super) fn attract_grains<const D: usize>(
    constant: f64,
    scale: Scale,
    softening_squared: f64,
    masses: &[usize],
    particles: &Particles<D>,
    acceleration: &mut [Vector<D>],
) {
    let Particles { position, mass, .. } = particles;
    let factor = scale.acceleration();
    let sources: Vec<Source<D>> = masses
        .iter()
        .map(|&i| Source { position: position[i] * scale.length, strength: constant * mass[i] * factor })
        .collect();
    let attract = |((position, mass), acceleration): ((&[Vector<D>], &[f64]), &mut [Vector<D>])| {
        if mass.contains(&0.0) {
            attract_block(&sources, scale.length, softening_squared, position, mass, acceleration);
        }
    };
    if particles.len() * masses.len() >= WORTH_THREADS {
        let blocks = position.par_chunks(BLOCK).zip(mass.par_chunks(BLOCK));
        blocks.zip(acceleration.par_chunks_mut(BLOCK)).for_each(attract);
    } else {
        attract(((position, mass), acceleration));
    }
}

dispatch! {
    /// Eight grains at a time; the last few share the lanes with copies of themselves.
    fn attract_block<const D: usize>(
        sources: &[Source<D>],
        length: f64,
        softening_squared: f64,
        position: &[Vector<D>],
        mass: &[f64],
        acceleration: &mut [Vector<D>],
    ) = attract_block_body
}

#[inline(always)]
fn attract_block_body<const D: usize>(
    sources: &[Source<D>],
    length: f64,
    softening_squared: f64,
    position: &[Vector<D>],
    mass: &[f64],
    acceleration: &mut [Vector<D>],
) {
    let (positions, last_positions) = position.as_chunks::<LANES>();
    let (masses, last_masses) = mass.as_chunks::<LANES>();
    let (accelerations, last_accelerations) = acceleration.as_chunks_mut::<LANES>();
    for ((position, mass), acceleration) in positions.iter().zip(masses).zip(accelerations) {
        attract_chunk(sources, length, softening_squared, position, mass, acceleration);
    }
    if let Some(&one) = last_positions.last() {
        let count = last_positions.len();
        let (mut position, mut mass, mut acceleration) = ([one; LANES], [1.0; LANES], [Vector::ZERO; LANES]);
        position[..count].copy_from_slice(last_positions);
        mass[..count].copy_from_slice(last_masses);
        acceleration[..count].copy_from_slice(last_accelerations);
        attract_chunk(sources, length, softening_squared, &position, &mass, &mut acceleration);
        last_accelerations.copy_from_slice(&acceleration[..count]);
    }
}

#[inline(always)]
fn attract_chunk<const D: usize>(
    sources: &[Source<D>],
    length: f64,
    softening_squared: f64,
    position: &[Vector<D>; LANES],
    mass: &Lanes,
    acceleration: &mut [Vector<D>; LANES],
) {
    let mut place = [[0.0; LANES]; D];
    for lane in 0..LANES {
        for k in 0..D {
            place[k][lane] = position[lane][k] * length;
        }
    }
    let mut pull = [[0.0; LANES]; D];
    for source in sources {
        let mut arrow = [[0.0; LANES]; D];
        let mut d2 = [softening_squared; LANES];
        for k in 0..D {
            for lane in 0..LANES {
                arrow[k][lane] = source.position[k] - place[k][lane];
                d2[lane] += arrow[k][lane] * arrow[k][lane];
            }
        }
        let w = inverse_cube_of_root(&d2);
        for k in 0..D {
            for lane in 0..LANES {
                pull[k][lane] += (source.strength * w[lane]) * arrow[k][lane];
            }
        }
    }
    // A mass among the grains meets itself here: its lane is no number, and is not used.
    for k in 0..D {
        for lane in 0..LANES {
            acceleration[lane][k] += if mass[lane] == 0.0 { pull[k][lane] } else { 0.0 };
        }
    }
}
