//! How long a trajectory of hard particles is known.

use corpuscle_core::Engine;
use corpuscle_event::EventDriven;

/// Time from the start after which rounding has grown to the size of a particle, so that another rounding would give other
/// collisions: averages hold beyond it, single paths do not.
///
/// Two paths part as `exp(lambda t)`. A collision turns a displacement `d` across the line of flight into an angle of about
/// `2 d / sigma`, and the free path `l` that into `d (1 + 2 l / sigma)`, so that `lambda = nu ln(1 + 2 l / sigma)` with the rate
/// `nu` of collisions of a particle (Krylov, Works on the Foundations of Statistical Physics, Princeton 1979; van Zon, van
/// Beijeren and Dellago 1998, doi:10.1103/PhysRevLett.80.2035, find the same leading logarithm): an estimate, good to a factor
/// of two or so. None before there have been collisions.
pub(crate) fn precision_horizon<const D: usize>(engine: &EventDriven<D>) -> Option<f64> {
    let (count, time, collisions) = (engine.particle_count(), engine.time(), engine.counts().collisions);
    if collisions == 0 || time <= 0.0 {
        return None;
    }
    let particles = engine.snapshot();
    let rate = 2.0 * collisions as f64 / (count as f64 * time);
    let speed = particles.velocity.iter().map(|v| v.norm()).sum::<f64>() / count as f64;
    let diameter = 2.0 * particles.radius.iter().sum::<f64>() / count as f64;
    let lyapunov = rate * libm::log(1.0 + 2.0 * speed / (rate * diameter));
    let rounding = 0.5 * f64::EPSILON * engine.boundary().extent().norm();
    let horizon = libm::log(diameter / rounding) / lyapunov;
    (horizon.is_finite() && horizon > 0.0).then_some(horizon)
}
