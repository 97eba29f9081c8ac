//! Variational equations: a small deviation from a grain's path, advanced with it.

use corpuscle_core::{Boundary, Invalid, Particles, Vector};
use corpuscle_time::Force;

/// The pull of a mass, `G m d/s^3`, at the end of the arrow `d`, with `s^2 = d^2 + epsilon^2` softened by the length `epsilon`. `strength` is
/// `G m`.
pub(super) fn pull(strength: f64, d: Vector<2>, softening: f64) -> Vector<2> {
    let s2 = d.norm_squared() + softening * softening;
    d * (strength / (s2 * s2.sqrt()))
}

/// By how much the [`pull`] changes with a small change `delta` of `d`: `G m (delta - 3 d (d.delta)/s^2)/s^3`.
pub(super) fn tide(strength: f64, d: Vector<2>, delta: Vector<2>, softening: f64) -> Vector<2> {
    let s2 = d.norm_squared() + softening * softening;
    (delta - d * (3.0 * d.dot(delta) / s2)) * (strength / (s2 * s2.sqrt()))
}

/// Places in the list of particles: two or more stars, then these three.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    /// The grain.
    pub(super) grain: usize,
    /// Another one, that starts beside it.
    pub(super) twin: usize,
    /// The deviation: its "position" is `delta`, its "velocity" `d delta/dt`.
    pub(super) deviation: usize,
}

/// Newton's gravity of some stars on each other, a grain and its twin, and the tidal field at the grain on the deviation,
/// `delta'' = sum_k G m_k (3 (d.delta) d/d^2 - delta)/d^3` with `d = r_k - r`: the linearised equation of motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangent {
    pub(super) constant: f64,
    pub(super) stars: usize,
    pub(super) places: Places,
}

impl Force<2> for Tangent {
    fn name(&self) -> &'static str {
        "gravity with its tides"
    }

    fn accelerate(&mut self, time: f64, boundary: &Boundary<2>, particles: &Particles<2>, acceleration: &mut [Vector<2>]) {
        self.accelerate_precisely(time, boundary, particles, &[], acceleration);
    }

    /// Near a star the grain's distance from it has to be known better than its place.
    fn accelerate_precisely(
        &mut self,
        _: f64,
        _: &Boundary<2>,
        particles: &Particles<2>,
        remainder: &[Vector<2>],
        acceleration: &mut [Vector<2>],
    ) {
        let Self { constant, stars, places: Places { grain, twin, deviation } } = *self;
        let r = &particles.position;
        let lost = |i: usize| remainder.get(i).copied().unwrap_or(Vector::ZERO);
        let arrow = |from: usize, to: usize| (r[to] - r[from]) + (lost(to) - lost(from));
        for (k, &mass) in particles.mass.iter().enumerate().take(stars) {
            let strength = constant * mass;
            for i in (0..stars).filter(|&i| i != k).chain([grain, twin]) {
                acceleration[i] += pull(strength, arrow(i, k), 0.0);
            }
            // The star has no deviation.
            let delta = r[deviation] + lost(deviation);
            acceleration[deviation] += tide(strength, arrow(grain, k), -delta, 0.0);
        }
    }

    fn energy(&self, _: f64, _: &Boundary<2>, _: &Particles<2>) -> f64 {
        0.0 // the deviation's is none that anybody would ask for
    }

    fn virial(&self, _: f64, _: &Boundary<2>, _: &Particles<2>) -> f64 {
        0.0
    }

    fn validate(&self, _: &Boundary<2>, particles: &Particles<2>) -> Result<(), Invalid> {
        let Places { grain, twin, deviation } = self.places;
        let last = grain.max(twin).max(deviation);
        if last < particles.len() {
            Ok(())
        } else {
            Err(Invalid::new("particles", particles.len(), "a grain, a twin, a deviation"))
        }
    }
}
