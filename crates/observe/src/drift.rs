//! The largest departure seen of what should be conserved.

use std::ops::ControlFlow;

use corpuscle_core::{Observer, Particles, Vector};

/// Largest `|x - x_0| / scale` seen of a quantity that should keep its value.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Drift<const K: usize> {
    reference: Option<(Vector<K>, f64)>,
    largest: f64,
}

impl<const K: usize> Drift<K> {
    /// Nothing seen yet.
    pub const fn new() -> Self {
        Self { reference: None, largest: 0.0 }
    }

    /// Sees a value. The first becomes the reference, together with its scale; where the scale is zero, departures are
    /// absolute. A value that is not a number is the largest drift there is.
    pub fn see(&mut self, value: [f64; K], scale: f64) {
        let (reference, scale) = *self.reference.get_or_insert((Vector(value), if scale > 0.0 { scale } else { 1.0 }));
        let distance = value.iter().zip(reference.0).map(|(x, x0)| (x - x0) * (x - x0)).sum::<f64>().sqrt() / scale;
        // f64::max would let a value that is not a number pass unseen.
        self.largest = self.largest.max(if distance.is_nan() { f64::INFINITY } else { distance });
    }

    /// The largest drift so far; none before the first value.
    pub fn largest(&self) -> Option<f64> {
        self.reference.map(|_| self.largest)
    }
}

impl Drift<1> {
    /// Sees an energy, its own scale.
    pub fn see_energy(&mut self, energy: f64) {
        self.see([energy], energy.abs());
    }
}

/// Drift of kinetic energy, momentum and angular momentum of particles without forces between collisions. For forces, feed
/// the total energy to a [`Drift`] of one's own.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Conservation {
    /// Kinetic energy, relative to its start.
    pub energy: Drift<1>,
    /// Momentum, relative to `sum |m v|` at the start.
    pub momentum: Drift<3>,
    /// Angular momentum about the origin, relative to `sum m |r| |v|` at the start. Conserved in open space only.
    pub angular_momentum: Drift<3>,
}

impl Conservation {
    /// Sees all particles, as of one instant.
    pub fn see<const D: usize>(&mut self, particles: &Particles<D>) {
        self.energy.see_energy(particles.kinetic_energy());
        let of_each = || particles.mass.iter().zip(&particles.velocity).map(|(m, v)| m * v.norm());
        self.momentum.see(particles.momentum().to_three(), of_each().sum());
        let arms = of_each().zip(&particles.position).map(|(momentum, r)| momentum * r.norm()).sum();
        self.angular_momentum.see(particles.angular_momentum(), arms);
    }
}

impl<const D: usize> Observer<D> for Conservation {
    fn begin(&mut self, _: f64, particles: &Particles<D>) {
        self.see(particles);
    }

    fn sample(&mut self, _: f64, particles: &Particles<D>) -> ControlFlow<()> {
        self.see(particles);
        ControlFlow::Continue(())
    }

    fn finish(&mut self, _: f64, particles: &Particles<D>) {
        self.see(particles);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Vector;

    #[test]
    fn the_largest_departure_stays_and_a_lost_number_shows() {
        let mut drift = Drift::new();
        assert_eq!(drift.largest(), None);
        for energy in [2.0, 2.5, 1.9] {
            drift.see_energy(energy);
        }
        assert_eq!(drift.largest(), Some(0.25));
        drift.see_energy(f64::NAN);
        drift.see_energy(2.0);
        assert_eq!(drift.largest(), Some(f64::INFINITY));
    }

    #[test]
    fn momentum_is_measured_against_what_moves() {
        let mut pair = Particles::<2>::new();
        pair.push(Vector([1.0, 0.0]), Vector([0.0, 3.0]), 2.0, 0.1, 0);
        pair.push(Vector([-1.0, 0.0]), Vector([0.0, -3.0]), 2.0, 0.1, 0);
        let mut conservation = Conservation::default();
        conservation.see(&pair);
        pair.velocity[0][1] = 3.6;
        conservation.see(&pair);
        assert!((conservation.momentum.largest().unwrap() - 0.1).abs() < 1e-15);
        assert!((conservation.angular_momentum.largest().unwrap() - 0.1).abs() < 1e-15);
    }
}
