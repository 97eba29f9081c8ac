//! Friction with a medium at rest.

use corpuscle_core::{Boundary, Invalid, Particles, Vector};

use super::{Force, Tensor, not_negative};

/// Linear drag `a = -gamma v`: velocities decay as `exp(-gamma t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// Rate `gamma`.
    pub rate: f64,
}

impl<const D: usize> Force<D> for Drag {
    fn name(&self) -> &'static str {
        "drag"
    }

    fn accelerate(&mut self, _: f64, _: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        for (a, &v) in acceleration.iter_mut().zip(&particles.velocity) {
            *a -= v * self.rate;
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> f64 {
        0.0
    }

    fn virial(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> f64 {
        0.0
    }

    fn virial_tensor(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> Option<Tensor<D>> {
        Some([[0.0; D]; D])
    }

    fn validate(&self, _: &Boundary<D>, _: &Particles<D>) -> Result<(), Invalid> {
        not_negative("drag rate", self.rate)
    }

    fn depends_on_velocity(&self) -> bool {
        self.rate != 0.0
    }
}
