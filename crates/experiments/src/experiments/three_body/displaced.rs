//! Stars that turn like a rigid body, displaced at random by very little: how far they stray from the undisturbed ones.

use corpuscle_core::{Engine, Failure, Random, Vector};
use corpuscle_observe::Estimate;

use super::failure;
use super::start::{PRECISE, Start};
use crate::ensemble;

/// Displaced at random, each on its own.
const REPLICAS: u64 = 12;
/// Displacement at the start: small enough to stay linear to the end, large against rounding.
const DISPLACEMENT: f64 = 1e-13;

/// Displaced stars.
#[derive(Clone)]
pub(super) struct Displaced {
    start: Start,
    random: Random,
    /// Angle turned by, and distance from the undisturbed stars over the displacement.
    pub(super) deviation: Vec<(f64, f64)>,
}

impl Displaced {
    /// Replicas of a start that turns with an angular velocity, looked at when it has turned by these angles.
    pub(super) fn follow(
        start: &Start,
        angular_velocity: f64,
        angles: &[f64],
        random: impl Fn(u64) -> Random,
    ) -> Result<Vec<Self>, Failure> {
        let mut replicas: Vec<Self> =
            (0..REPLICAS).map(|k| Self { start: start.clone(), random: random(k), deviation: vec![] }).collect();
        ensemble::for_each(&mut replicas, |replica| replica.measure(angular_velocity, angles))?;
        Ok(replicas)
    }

    fn measure(&mut self, angular_velocity: f64, angles: &[f64]) -> Result<(), Failure> {
        let exact = self.start.particles.position.clone();
        let star = self.random.below(3) as usize;
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * self.random.uniform());
        self.start.particles.position[star] += Vector([cosine, sine]) * DISPLACEMENT;
        let mut engine = self.start.engine(PRECISE).map_err(failure)?;
        for &angle in angles {
            engine.advance(angle / angular_velocity, &mut ())?;
            let (sine, cosine) = libm::sincos(angle);
            let turn = |r: Vector<2>| Vector([cosine * r[0] - sine * r[1], sine * r[0] + cosine * r[1]]);
            let squares = engine.particles().position.iter().zip(&exact).map(|(r, &e)| (*r - turn(e)).norm_squared());
            self.deviation.push((angle, squares.sum::<f64>().sqrt() / DISPLACEMENT));
        }
        Ok(())
    }

    /// Angle, geometric mean of the deviations, and its standard error.
    pub(super) fn mean(replicas: &[Self]) -> Vec<(f64, f64, f64)> {
        let count = replicas.first().map_or(0, |replica| replica.deviation.len());
        let at = |k: usize| {
            let of_each: Vec<f64> = replicas.iter().map(|replica| libm::log(replica.deviation[k].1)).collect();
            let mean = Estimate::from_replicas(&of_each);
            let value = libm::exp(mean.mean);
            (replicas[0].deviation[k].0, value, value * mean.standard_error)
        };
        (0..count).map(at).collect()
    }
}
