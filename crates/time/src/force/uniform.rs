//! A uniform field.

use corpuscle_core::{Boundary, Invalid, Particles, Vector};

use super::{Force, Tensor, finite};

/// The same acceleration `g` everywhere, as gravity near the ground: `U = -sum m g . r`.
///
/// The energy is measured from the origin; along a periodic axis it would jump, so the field has no component there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformField<const D: usize> {
    /// Acceleration `g`.
    pub acceleration: Vector<D>,
}

impl<const D: usize> UniformField<D> {
    /// A field of this acceleration.
    pub fn new(acceleration: Vector<D>) -> Self {
        Self { acceleration }
    }
}

impl<const D: usize> Force<D> for UniformField<D> {
    fn name(&self) -> &'static str {
        "uniform field"
    }

    fn accelerate(&mut self, _: f64, _: &Boundary<D>, _: &Particles<D>, acceleration: &mut [Vector<D>]) {
        for a in acceleration {
            *a += self.acceleration;
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        -particles.mass.iter().zip(&particles.position).map(|(m, r)| m * self.acceleration.dot(*r)).sum::<f64>()
    }

    fn virial(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> f64 {
        0.0
    }

    fn virial_tensor(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> Option<Tensor<D>> {
        Some([[0.0; D]; D])
    }

    fn validate(&self, boundary: &Boundary<D>, _: &Particles<D>) -> Result<(), Invalid> {
        for k in 0..D {
            finite("uniform field", self.acceleration[k])?;
            if self.acceleration[k] != 0.0 && boundary.axes[k] == corpuscle_core::Axis::Periodic {
                return Err(Invalid::new(
                    format!("uniform field along axis {k}"),
                    self.acceleration[k],
                    "zero along a periodic axis: energy would not be conserved",
                ));
            }
        }
        Ok(())
    }
}
