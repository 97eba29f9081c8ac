//! The particles of a system at one instant: what a checkpoint stores and a picture shows.

use crate::{Invalid, Vector};

/// Positions, velocities and properties of `N` particles at one instant, one array a property.
///
/// Every array has the same length. Masses and radii do not change while an engine runs.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Particles<const D: usize> {
    /// Positions of the centres.
    pub position: Vec<Vector<D>>,
    /// Velocities.
    pub velocity: Vec<Vector<D>>,
    /// Masses; zero marks a massless grain, which feels fields and attracts nothing.
    pub mass: Vec<f64>,
    /// Radii; zero for point masses.
    pub radius: Vec<f64>,
    /// Species, an index into whatever table of names the owner keeps.
    pub species: Vec<u16>,
}

impl<const D: usize> Particles<D> {
    /// No particles yet.
    pub fn new() -> Self {
        Self { position: vec![], velocity: vec![], mass: vec![], radius: vec![], species: vec![] }
    }

    /// Adds a particle and returns its index.
    pub fn push(&mut self, position: Vector<D>, velocity: Vector<D>, mass: f64, radius: f64, species: u16) -> usize {
        self.position.push(position);
        self.velocity.push(velocity);
        self.mass.push(mass);
        self.radius.push(radius);
        self.species.push(species);
        self.position.len() - 1
    }

    /// Number of particles `N`.
    #[inline]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no particle at all.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Kinetic energy `sum m v^2 / 2`.
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.velocity.iter().zip(&self.mass).map(|(v, m)| m * v.norm_squared()).sum::<f64>()
    }

    /// Total momentum `sum m v`.
    pub fn momentum(&self) -> Vector<D> {
        self.velocity.iter().zip(&self.mass).fold(Vector::ZERO, |sum, (&v, &m)| sum + v * m)
    }

    /// Total angular momentum about the origin, `sum m r x v`: three components, of which a planar system fills the last.
    pub fn angular_momentum(&self) -> [f64; 3] {
        let mut total = [0.0; 3];
        for ((r, v), m) in self.position.iter().zip(&self.velocity).zip(&self.mass) {
            let (r, v) = (r.to_three(), v.to_three());
            total[0] += m * (r[1] * v[2] - r[2] * v[1]);
            total[1] += m * (r[2] * v[0] - r[0] * v[2]);
            total[2] += m * (r[0] * v[1] - r[1] * v[0]);
        }
        total
    }

    /// Kinetic temperature `2 E_kin / f` with `f` degrees of freedom: `D (N - 1)` where total momentum is
    /// conserved (periodic box), `D N` between walls.
    pub fn temperature(&self, degrees_of_freedom: usize) -> f64 {
        2.0 * self.kinetic_energy() / degrees_of_freedom as f64
    }

    /// Volume (area in 2-D) of all spheres together: `sum pi R^2` or `sum 4 pi R^3 / 3`.
    ///
    /// The volume of the unit ball follows from `V_D = V_(D-2) 2 pi / D`.
    pub fn occupied_volume(&self) -> f64 {
        self.radius.iter().map(|&r| ball_volume::<D>(r)).sum()
    }

    /// Checks that all numbers are usable: equal lengths, finite positions and velocities, masses and radii not negative.
    ///
    /// # Errors
    /// Names the first offending particle and property.
    pub fn validate(&self) -> Result<(), Invalid> {
        let n = self.len();
        for (name, length) in [
            ("velocity", self.velocity.len()),
            ("mass", self.mass.len()),
            ("radius", self.radius.len()),
            ("species", self.species.len()),
        ] {
            if length != n {
                return Err(Invalid::new(name, length, format!("{n} values, one for each position")));
            }
        }
        for i in 0..n {
            if !self.position[i].is_finite() {
                return Err(Invalid::new(
                    format!("position of particle {i}"),
                    format!("{:?}", self.position[i].0),
                    "finite numbers",
                ));
            }
            if !self.velocity[i].is_finite() {
                return Err(Invalid::new(
                    format!("velocity of particle {i}"),
                    format!("{:?}", self.velocity[i].0),
                    "finite numbers",
                ));
            }
            if !(self.mass[i] >= 0.0 && self.mass[i].is_finite()) {
                return Err(Invalid::new(format!("mass of particle {i}"), self.mass[i], "a finite number, zero or more"));
            }
            if !(self.radius[i] >= 0.0 && self.radius[i].is_finite()) {
                return Err(Invalid::new(format!("radius of particle {i}"), self.radius[i], "a finite number, zero or more"));
            }
        }
        Ok(())
    }
}

/// Volume of a ball of the given radius in `D` dimensions: `2 R`, `pi R^2`, `4 pi R^3 / 3`, ...
pub fn ball_volume<const D: usize>(radius: f64) -> f64 {
    let mut volume = if D.is_multiple_of(2) { 1.0 } else { 2.0 };
    let mut dimension = if D.is_multiple_of(2) { 2 } else { 3 };
    while dimension <= D {
        volume *= 2.0 * std::f64::consts::PI / dimension as f64;
        dimension += 2;
    }
    volume * radius.powi(D as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn ball_volumes_are_the_textbook_ones() {
        assert!((ball_volume::<1>(2.0) - 4.0).abs() < 1e-15);
        assert!((ball_volume::<2>(2.0) - 4.0 * PI).abs() < 1e-14);
        assert!((ball_volume::<3>(1.0) - 4.0 * PI / 3.0).abs() < 1e-15);
    }

    #[test]
    fn momenta_of_a_spinning_pair() {
        let mut pair = Particles::<2>::new();
        pair.push(Vector([1.0, 0.0]), Vector([0.0, 1.0]), 2.0, 0.1, 0);
        pair.push(Vector([-1.0, 0.0]), Vector([0.0, -1.0]), 2.0, 0.1, 0);
        assert_eq!(pair.momentum(), Vector::ZERO);
        assert_eq!(pair.angular_momentum(), [0.0, 0.0, 4.0]);
        assert_eq!(pair.kinetic_energy(), 2.0);
    }

    #[test]
    fn a_number_that_is_none_is_named() {
        let mut one = Particles::<3>::new();
        one.push(Vector([0.0, f64::NAN, 0.0]), Vector::ZERO, 1.0, 0.5, 0);
        assert_eq!(one.validate().unwrap_err().key, "position of particle 0");
    }
}
