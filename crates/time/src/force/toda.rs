//! Exponential springs between neighbours: the lattice that Toda solved.

use corpuscle_core::{Boundary, Invalid, Particles, Vector};

use super::{Force, massive, positive};
use crate::image::NearestImage;

/// Bonds of tension `T(x) = (k/b) (1 - exp(-b x))`, `x = |r| - l` their extension, and energy `(k/b^2) (exp(-b x) - 1 + b x)`:
/// springs of stiffness `k` that harden when pressed and go soft when pulled (Toda 1967, doi:10.1143/JPSJ.22.431). A chain of them
/// has solitons, and is integrable. To second order they are springs with `alpha = -b/2`, `beta = b^2/6`.
#[derive(Clone, Debug, PartialEq)]
pub struct TodaBonds {
    bonds: Vec<(usize, usize)>,
    stiffness: f64,
    steepness: f64,
    rest_length: f64,
}

impl TodaBonds {
    /// Bonds between these pairs, with stiffness `k`, steepness `b > 0` (an inverse length) and rest length `l`.
    pub fn new(bonds: Vec<(usize, usize)>, stiffness: f64, steepness: f64, rest_length: f64) -> Self {
        Self { bonds, stiffness, steepness, rest_length }
    }

    fn tension(&self, length: f64) -> f64 {
        -self.stiffness / self.steepness * libm::expm1(-self.steepness * (length - self.rest_length))
    }
}

impl<const D: usize> Force<D> for TodaBonds {
    fn name(&self) -> &'static str {
        "Toda bonds"
    }

    fn accelerate(&mut self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        let image = NearestImage::new(boundary);
        for &(first, second) in &self.bonds {
            let r = image.displacement(particles.position[first], particles.position[second]);
            let length = r.norm();
            let force = r * (self.tension(length) / length);
            acceleration[first] += force * (1.0 / particles.mass[first]);
            acceleration[second] -= force * (1.0 / particles.mass[second]);
        }
    }

    fn energy(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let image = NearestImage::new(boundary);
        let of_bond = |&(first, second): &(usize, usize)| {
            let bx = self.steepness
                * (image.displacement(particles.position[first], particles.position[second]).norm() - self.rest_length);
            self.stiffness / (self.steepness * self.steepness) * (libm::expm1(-bx) + bx)
        };
        self.bonds.iter().map(of_bond).sum()
    }

    fn virial(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let image = NearestImage::new(boundary);
        let of_bond = |&(first, second): &(usize, usize)| {
            let length = image.displacement(particles.position[first], particles.position[second]).norm();
            -length * self.tension(length)
        };
        self.bonds.iter().map(of_bond).sum()
    }

    fn validate(&self, _: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        positive("stiffness of Toda bonds", self.stiffness)?;
        positive("steepness of Toda bonds", self.steepness)?;
        positive("rest length of Toda bonds", self.rest_length)?;
        for (number, &(first, second)) in self.bonds.iter().enumerate() {
            massive("a Toda bond", first, particles)?;
            massive("a Toda bond", second, particles)?;
            if first == second {
                return Err(Invalid::new(format!("ends of Toda bond {number}"), second, "two different particles"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Axis;

    /// The force is minus the slope of the energy, to the error `h^2/6` of a central difference.
    #[test]
    fn the_force_is_the_slope_of_the_energy() {
        let space = Boundary::<1>::new([-5.0], [5.0], Axis::Open);
        let mut bonds = TodaBonds::new(vec![(0, 1)], 2.0, 1.5, 1.0);
        let pair = |x: f64| {
            let mut particles = Particles::<1>::new();
            particles.push(Vector([0.0]), Vector([0.0]), 1.0, 0.0, 0);
            particles.push(Vector([x]), Vector([0.0]), 0.5, 0.0, 0);
            particles
        };
        for x in [0.4, 1.0, 1.7] {
            let h = 1e-4;
            let energy = |x: f64| Force::<1>::energy(&bonds, 0.0, &space, &pair(x));
            let slope = (energy(x + h) - energy(x - h)) / (2.0 * h);
            let mut acceleration = vec![Vector([0.0]); 2];
            bonds.accelerate(0.0, &space, &pair(x), &mut acceleration);
            assert!((acceleration[1][0] * 0.5 + slope).abs() < 1e-6 && (acceleration[0][0] - slope).abs() < 1e-6, "{x}");
            let virial = Force::<1>::virial(&bonds, 0.0, &space, &pair(x));
            assert!((virial - x * acceleration[1][0] * 0.5).abs() < 1e-12);
        }
    }
}
