//! A field that points to a centre.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use super::{Force, Tensor, finite};

/// The acceleration `a = -g r^n` towards a centre at the distance `r`: `U = m g r^(n+1)/(n+1)`, or `m g ln r` for `n = -1`.
///
/// `n = 1` is a harmonic trap of angular frequency `sqrt g`, `n = -2` the field of a fixed mass `g/G`. A negative `g` pushes
/// outwards. Powers and logarithms come from `libm`: the same bits on every platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentralField<const D: usize> {
    /// The centre.
    pub centre: Vector<D>,
    /// Strength `g`: the acceleration at unit distance.
    pub strength: f64,
    /// The power `n`.
    pub power: f64,
}

impl<const D: usize> CentralField<D> {
    fn potential(&self, distance: f64) -> f64 {
        if self.power == -1.0 {
            return self.strength * libm::log(distance);
        }
        self.strength * libm::pow(distance, self.power + 1.0) / (self.power + 1.0)
    }
}

impl<const D: usize> Force<D> for CentralField<D> {
    fn name(&self) -> &'static str {
        "central field"
    }

    fn accelerate(&mut self, _: f64, _: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        for (a, &r) in acceleration.iter_mut().zip(&particles.position) {
            let arrow = self.centre - r;
            // In the centre a field that vanishes there has no direction; any other has no value.
            if self.power == 1.0 {
                *a += arrow * self.strength;
            } else if self.power < 0.0 || arrow != Vector::ZERO {
                *a += arrow * (self.strength * libm::pow(arrow.norm(), self.power - 1.0));
            }
        }
    }

    fn energy(&self, _: f64, _: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let distance = |r: Vector<D>| (r - self.centre).norm();
        particles.mass.iter().zip(&particles.position).map(|(m, &r)| m * self.potential(distance(r))).sum()
    }

    fn virial(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> f64 {
        0.0
    }

    fn virial_tensor(&self, _: f64, _: &Boundary<D>, _: &Particles<D>) -> Option<Tensor<D>> {
        Some([[0.0; D]; D])
    }

    fn validate(&self, boundary: &Boundary<D>, _: &Particles<D>) -> Result<(), Invalid> {
        finite("strength of the central field", self.strength)?;
        finite("power of the central field", self.power)?;
        self.centre.0.iter().try_for_each(|&x| finite("centre of the central field", x))?;
        if let Some(k) = boundary.axes.iter().position(|&axis| axis == Axis::Periodic) {
            let expected = "open space or walls: the field of a centre does not repeat";
            return Err(Invalid::new(format!("axis {k} of the box"), "periodic", expected));
        }
        Ok(())
    }
}
