//! Bonds between given pairs of particles, by a law of their length.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use super::{Force, Tensor, add_product, massive};
use crate::image::NearestImage;

/// How the tension of a bond depends on its length. All that a new one needs is in its file: nearest images, virial and checks come
/// with [`Bonds`]. Linear springs, and many of them, are faster as [`Springs`](super::Springs).
pub trait BondLaw: Copy + Send + Sync {
    /// Name, as a table of energies shows it.
    fn name(&self) -> &'static str;

    /// The length at which it breaks.
    fn longest(&self) -> f64 {
        f64::INFINITY
    }

    /// `T(r)/r = U'(r)/r`, positive when it pulls.
    fn tension_over_length(&self, r_squared: f64) -> f64;

    /// Energy `U(r)`.
    fn energy(&self, r_squared: f64) -> f64;

    /// Checks the parameters.
    ///
    /// # Errors
    /// Names the parameter at fault.
    fn validate(&self) -> Result<(), Invalid>;
}

/// Bonds of one law. The forces of a bond on its ends are opposite to rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct Bonds<L> {
    law: L,
    ends: Vec<(usize, usize)>,
    /// The first bond found too long when accelerations were asked for last.
    torn: Option<(usize, f64)>,
}

impl<L: BondLaw> Bonds<L> {
    /// Bonds between these pairs of particles.
    pub fn new(law: L, ends: Vec<(usize, usize)>) -> Self {
        Self { law, ends, torn: None }
    }

    /// The pairs of particles.
    pub fn ends(&self) -> &[(usize, usize)] {
        &self.ends
    }

    /// The arrows from the first to the second ends.
    fn arrows<const D: usize>(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> impl Iterator<Item = Vector<D>> {
        let image = NearestImage::new(boundary);
        self.ends.iter().map(move |&(first, second)| image.displacement(particles.position[first], particles.position[second]))
    }
}

impl<L: BondLaw, const D: usize> Force<D> for Bonds<L> {
    fn name(&self) -> &'static str {
        self.law.name()
    }

    fn accelerate(&mut self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>, acceleration: &mut [Vector<D>]) {
        let image = NearestImage::new(boundary);
        let longest = self.law.longest() * self.law.longest();
        self.torn = None;
        for (number, &(first, second)) in self.ends.iter().enumerate() {
            let r = image.displacement(particles.position[first], particles.position[second]);
            let r_squared = r.norm_squared();
            if r_squared >= longest && self.torn.is_none() {
                self.torn = Some((number, r_squared.sqrt()));
            }
            let force = r * self.law.tension_over_length(r_squared);
            acceleration[first] += force * (1.0 / particles.mass[first]);
            acceleration[second] -= force * (1.0 / particles.mass[second]);
        }
        if let Some((number, _)) = self.torn {
            // What follows from a bond beyond its law is not a motion: the step fails here.
            acceleration[self.ends[number].0] = Vector([f64::NAN; D]);
        }
    }

    fn complaint(&self) -> Option<String> {
        let (number, length) = self.torn?;
        let ((first, second), longest) = (self.ends[number], self.law.longest());
        Some(format!(
            "its bond, of the particles {first} and {second}, was stretched to {length}, beyond {longest}, where it breaks"
        ))
    }

    fn energy(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        self.arrows(boundary, particles).map(|r| self.law.energy(r.norm_squared())).sum()
    }

    fn virial(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
        let of_bond = |r_squared: f64| -r_squared * self.law.tension_over_length(r_squared);
        self.arrows(boundary, particles).map(|r| of_bond(r.norm_squared())).sum()
    }

    fn virial_tensor(&self, _: f64, boundary: &Boundary<D>, particles: &Particles<D>) -> Option<Tensor<D>> {
        let mut tensor = [[0.0; D]; D];
        for r in self.arrows(boundary, particles) {
            add_product(&mut tensor, r, r * -self.law.tension_over_length(r.norm_squared()));
        }
        Some(tensor)
    }

    fn validate(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        self.law.validate()?;
        let name = self.law.name();
        for (number, &(first, second)) in self.ends.iter().enumerate() {
            massive(name, first, particles)?;
            massive(name, second, particles)?;
            if first == second {
                return Err(Invalid::new(format!("ends of bond {number}"), second, "two different particles"));
            }
        }
        let longest = self.law.longest();
        for (number, r) in self.arrows(boundary, particles).enumerate() {
            if r.norm() >= longest {
                return Err(Invalid::new(
                    format!("length of bond {number}"),
                    r.norm(),
                    format!("less than {longest}, where it breaks"),
                ));
            }
        }
        for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Periodic && longest.is_finite()) {
            let half = 0.5 * boundary.extent()[k];
            if longest >= half {
                let expected = format!("less than half the periodic box, {half} along axis {k}");
                return Err(Invalid::new(format!("longest of {name}"), longest, expected));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FiniteExtension, Toda};
    use super::*;

    fn pair(x: f64) -> Particles<1> {
        let mut particles = Particles::<1>::new();
        particles.push(Vector([0.0]), Vector([0.0]), 1.0, 0.0, 0);
        particles.push(Vector([x]), Vector([0.0]), 0.5, 0.0, 0);
        particles
    }

    /// The force is minus the slope of the energy, to the error `h^2 U'''/6` of a central difference.
    fn check(law: impl BondLaw, lengths: &[f64]) {
        let space = Boundary::<1>::new([-5.0], [5.0], Axis::Open);
        let mut bonds = Bonds::new(law, vec![(0, 1)]);
        for &x in lengths {
            let h = 1e-4;
            let energy = |x: f64| Force::<1>::energy(&bonds, 0.0, &space, &pair(x));
            let slope = (energy(x + h) - energy(x - h)) / (2.0 * h);
            let bound =
                (energy(x + 2.0 * h) - 2.0 * energy(x + h) + 2.0 * energy(x - h) - energy(x - 2.0 * h)).abs() / (h * 6.0) + 1e-10;
            let mut acceleration = vec![Vector([0.0]); 2];
            bonds.accelerate(0.0, &space, &pair(x), &mut acceleration);
            let force = acceleration[1][0] * 0.5;
            assert!((force + slope).abs() < bound && (acceleration[0][0] + force).abs() < 1e-14, "{} at {x}: {force}", law.name());
            assert!((Force::<1>::virial(&bonds, 0.0, &space, &pair(x)) - x * force).abs() < 1e-12);
            let [[tensor]] = Force::<1>::virial_tensor(&bonds, 0.0, &space, &pair(x)).unwrap_or_default();
            assert!((tensor - x * force).abs() < 1e-12);
        }
    }

    #[test]
    fn forces_are_the_slopes_of_their_energies() {
        check(Toda { stiffness: 2.0, steepness: 1.5, rest_length: 1.0 }, &[0.4, 1.0, 1.7]);
        check(FiniteExtension { stiffness: 30.0, longest: 1.5 }, &[0.3, 0.97, 1.2]);
    }

    #[test]
    fn a_bond_too_long_is_refused_at_the_start_and_complained_of_later() {
        let space = Boundary::<1>::new([-5.0], [5.0], Axis::Open);
        let mut bonds = Bonds::new(FiniteExtension { stiffness: 30.0, longest: 1.5 }, vec![(0, 1)]);
        let refused = bonds.validate(&space, &pair(1.6)).unwrap_err();
        assert_eq!((refused.key.as_str(), refused.value.as_str()), ("length of bond 0", "1.6"));
        bonds.validate(&space, &pair(1.4)).unwrap();
        let mut acceleration = vec![Vector([0.0]); 2];
        bonds.accelerate(0.0, &space, &pair(1.6), &mut acceleration);
        assert!(acceleration[0][0].is_nan());
        let complaint = Force::<1>::complaint(&bonds).unwrap();
        assert!(complaint.contains("particles 0 and 1") && complaint.contains("beyond 1.5"), "{complaint}");
        bonds.accelerate(0.0, &space, &pair(1.4), &mut acceleration);
        assert_eq!(Force::<1>::complaint(&bonds), None);
    }
}
