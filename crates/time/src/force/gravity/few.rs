//! A handful of bodies: nothing to gain from lanes, everything to lose from preparing them.

use corpuscle_core::{Particles, Vector};

use super::inverse_cube;

/// Adds the acceleration of every particle; positions are `r + remainder` where there are remainders.
pub(super) fn attract<const D: usize>(
    constant: f64,
    softening: f64,
    particles: &Particles<D>,
    remainder: &[Vector<D>],
    acceleration: &mut [Vector<D>],
) {
    let Particles { position, mass, .. } = particles;
    for i in 0..position.len() {
        for j in i + 1..position.len() {
            if mass[i] == 0.0 && mass[j] == 0.0 {
                continue;
            }
            let mut arrow = position[j] - position[i];
            if !remainder.is_empty() {
                arrow += remainder[j] - remainder[i];
            }
            let pull = arrow * inverse_cube(arrow.norm_squared(), softening * softening);
            acceleration[i] += pull * (constant * mass[j]);
            acceleration[j] -= pull * (constant * mass[i]);
        }
    }
}
