//! A force from outside on one particle.

use corpuscle_core::{Boundary, Invalid, Particles, Vector};

use super::{Force, Tensor, finite, massive};
use crate::constraint::Signal;

/// The force `F(t) = s(t) n` on one particle. To prescribe a displacement instead, see [`Drive`](crate::Drive).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivingForce<const D: usize> {
    /// Index of the particle.
    pub particle: usize,
    /// Direction `n`; its length multiplies the signal.
    pub direction: Vector<D>,
    /// The signal `s(t)`, a force.
    pub signal: Signal,
}

impl<const D: usize> Force<D> for DrivingForce<D> {
    fn name(&self) -> &'static str {
        "driving force"
    }

    fn accelerate(&mut self, time: f64, _: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        acceleration[self.particle] += self.direction * (self.signal.at(time).0 / particles.mass[self.particle]);
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

    fn validate(&self, _: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        massive("driving force", self.particle, particles)?;
        self.direction.0.iter().try_for_each(|&x| finite("direction of the driving force", x))?;
        self.signal.validate()
    }

    fn longest_step(&self) -> f64 {
        self.signal.longest_step()
    }
}
