//! The frame that turns with the two stars: its potential, its equilibria, and what the Jacobi constant forbids.

use corpuscle_core::Vector;
use corpuscle_scene::{Cell, Map};

/// Two stars of masses `1 - mu` and `mu` at rest at `(-mu, 0)` and `(1 - mu, 0)`, in units in which their distance, their
/// angular velocity and `G M` are 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    pub(super) mu: f64,
}

impl Turning {
    pub(super) fn stars(self) -> [(f64, Vector<2>); 2] {
        [(1.0 - self.mu, Vector([-self.mu, 0.0])), (self.mu, Vector([1.0 - self.mu, 0.0]))]
    }

    /// `Omega = (x^2 + y^2)/2 + (1 - mu)/r_1 + mu/r_2`.
    pub(super) fn potential(self, r: Vector<2>) -> f64 {
        0.5 * r.norm_squared() + self.stars().iter().map(|&(mass, star)| mass / (r - star).norm()).sum::<f64>()
    }

    /// The Jacobi constant `C = 2 Omega - v^2` (Szebehely 1967, *Theory of Orbits*, chapter 1).
    pub(super) fn jacobi(self, r: Vector<2>, v: Vector<2>) -> f64 {
        2.0 * self.potential(r) - v.norm_squared()
    }

    /// `x'' = 2 y' + dOmega/dx`, `y'' = -2 x' + dOmega/dy`.
    pub(super) fn acceleration(self, r: Vector<2>, v: Vector<2>) -> Vector<2> {
        let mut a = Vector([2.0 * v[1], -2.0 * v[0]]) + r;
        for (mass, star) in self.stars() {
            let d = star - r;
            let d2 = d.norm_squared();
            a += d * (mass / (d2 * d2.sqrt()));
        }
        a
    }

    /// The three equilibria on the axis, L1 between the stars, L2 beyond the second, L3 beyond the first, and the two that make
    /// an equilateral triangle with the stars.
    pub(super) fn equilibria(self) -> [Vector<2>; 5] {
        let slope = |x: f64| self.acceleration(Vector([x, 0.0]), Vector::ZERO)[0];
        // Along the axis the slope of Omega rises through zero between one singularity and the next, or infinity.
        let between = |mut lower: f64, mut upper: f64| {
            for _ in 0..200 {
                let middle = 0.5 * (lower + upper);
                if slope(middle) < 0.0 { lower = middle } else { upper = middle }
            }
            Vector([0.5 * (lower + upper), 0.0])
        };
        let [first, second] = [-self.mu, 1.0 - self.mu];
        let height = 0.75f64.sqrt();
        [
            between(first, second),
            between(second, 3.0),
            between(-3.0, first),
            Vector([0.5 - self.mu, height]),
            Vector([0.5 - self.mu, -height]),
        ]
    }

    /// Where a grain of this Jacobi constant cannot be, `2 Omega < C`: its border are the zero-velocity curves.
    pub(super) fn forbidden(self, jacobi: f64, half: f64, columns: usize) -> Map {
        let place = |k: usize| half * (2.0 * (k as f64 + 0.5) / columns as f64 - 1.0);
        let cell = |(column, row): (usize, usize)| {
            let out = 2.0 * self.potential(Vector([place(column), place(row)])) < jacobi;
            Cell { species: 7, strength: if out { 60 } else { 0 } }
        };
        let cells = (0..columns).flat_map(|row| (0..columns).map(move |column| (column, row))).map(cell).collect();
        Map { lower: [-half; 2], upper: [half; 2], columns, cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equilibria of Earth and Moon, as printed in many places to six decimals (Koon, Lo, Marsden and Ross 2011, *Dynamical
    /// Systems, the Three-Body Problem and Space Mission Design*): half a unit of the last one.
    #[test]
    fn earth_and_moon_have_the_known_equilibria() {
        let [one, two, three, ..] = Turning { mu: 0.012_150_585 }.equilibria();
        for (found, known) in [(one, 0.836_915), (two, 1.155_682), (three, -1.005_063)] {
            assert!((found[0] - known).abs() < 1e-6, "{found:?} for {known}");
        }
    }

    #[test]
    fn nothing_pulls_at_an_equilibrium() {
        for mu in [0.3, 0.0121, 1e-6] {
            let frame = Turning { mu };
            for r in frame.equilibria() {
                assert!(frame.acceleration(r, Vector::ZERO).norm() < 1e-9, "mu = {mu}, {r:?}");
            }
        }
    }
}
