//! Friction that differs from mass to mass.

use corpuscle_core::{Boundary, Invalid, Particles, Vector};
use corpuscle_time::Force;

/// Friction `a_i = -gamma_i v_i`; particles beyond the last rate have none.
#[derive(Clone, Debug)]
pub(super) struct Sponge {
    pub(super) rates: Vec<f64>,
}

impl<const D: usize> Force<D> for Sponge {
    fn name(&self) -> &'static str {
        "sponge"
    }

    fn accelerate(&mut self, _: f64, _: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        for ((a, v), rate) in acceleration.iter_mut().zip(&particles.velocity).zip(&self.rates) {
            *a -= *v * *rate;
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> f64 {
        0.0
    }

    fn virial(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> f64 {
        0.0
    }

    fn validate(&self, _: &Boundary<D>, _: &Particles<D>) -> Result<(), Invalid> {
        Ok(())
    }

    fn depends_on_velocity(&self) -> bool {
        true
    }
}
