//! Where the stars are at any moment of a short stretch of time: what all grains of a map fall through.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Invalid, Vector};
use corpuscle_time::TimeDriven;

use super::super::quintic::{quintic, slope, value};
use super::super::start::{PRECISE, Start};

/// A stretch lasts this share of the fastest motion among the stars, over which six derivatives describe them to some
/// `0.05^6/46080 = 3e-13` of their distances.
const SHARE: f64 = 0.05;

/// The stars, advanced from stretch to stretch.
pub(super) struct Stars {
    engine: TimeDriven<2>,
    constant: f64,
    softening: f64,
    /// Longest stretch.
    longest: f64,
}

resume!(Stars { values: [], parts: [engine], set_up: [constant, softening, longest] });

/// The stars over one stretch, `r(s) = sum c_k s^k` with `0 <= s <= 1`: the quintic through positions, velocities and
/// accelerations at both ends.
#[derive(Clone, Debug)]
pub(super) struct Sky {
    /// When it begins.
    pub(super) from: f64,
    /// How long it lasts.
    pub(super) length: f64,
    /// `G m` of each star.
    pub(super) strength: [f64; 3],
    pub(super) softening_squared: f64,
    coefficients: [[[f64; 6]; 2]; 3],
}

impl Stars {
    pub(super) fn new(start: &Start, longest: f64) -> Result<Self, Invalid> {
        let engine = start.without_dust().engine(PRECISE)?;
        Ok(Self { engine, constant: start.constant, softening: start.softening, longest })
    }

    pub(super) fn time(&self) -> f64 {
        self.engine.time()
    }

    pub(super) fn steps(&self) -> u64 {
        self.engine.steps()
    }

    pub(super) fn positions(&self) -> &[Vector<2>] {
        &self.engine.particles().position
    }

    pub(super) fn velocities(&self) -> &[Vector<2>] {
        &self.engine.particles().velocity
    }

    /// The next stretch, if it ends by `to`. Where stretches end depends on the stars alone.
    pub(super) fn next(&mut self, to: f64) -> Result<Option<Sky>, Failure> {
        let from = self.engine.time();
        let length = self.longest.min(SHARE / self.frequency());
        if from + length > to * (1.0 + 1e-12) {
            return Ok(None);
        }
        let before = self.state();
        self.engine.advance(from + length, &mut ())?;
        let after = self.state();
        let coefficients = std::array::from_fn(|star| {
            std::array::from_fn(|axis| {
                let scaled = |[r, v, a]: [Vector<2>; 3]| [r[axis], v[axis] * length, a[axis] * length * length];
                quintic(scaled(before[star]), scaled(after[star]))
            })
        });
        let strength = std::array::from_fn(|star| self.constant * self.engine.particles().mass[star]);
        Ok(Some(Sky { from, length, strength, softening_squared: self.softening * self.softening, coefficients }))
    }

    /// Position, velocity and acceleration of each star.
    fn state(&self) -> [[Vector<2>; 3]; 3] {
        let stars = self.engine.particles();
        std::array::from_fn(|i| {
            let mut acceleration = Vector::ZERO;
            for k in (0..3).filter(|&k| k != i) {
                let arrow = stars.position[k] - stars.position[i];
                let d2 = arrow.norm_squared() + self.softening * self.softening;
                acceleration += arrow * (self.constant * stars.mass[k] / (d2 * d2.sqrt()));
            }
            [stars.position[i], stars.velocity[i], acceleration]
        })
    }

    /// Highest of the frequencies `v/d` and `sqrt(G M/d^3)` over the pairs.
    fn frequency(&self) -> f64 {
        let stars = self.engine.particles();
        let of_pair = |(i, j): (usize, usize)| {
            let d2 = (stars.position[j] - stars.position[i]).norm_squared() + self.softening * self.softening;
            let v2 = (stars.velocity[j] - stars.velocity[i]).norm_squared();
            (v2 / d2).max(self.constant * (stars.mass[i] + stars.mass[j]) / (d2 * d2.sqrt())).sqrt()
        };
        [(0, 1), (0, 2), (1, 2)].into_iter().map(of_pair).fold(0.0, f64::max)
    }
}

impl Sky {
    /// Positions of the stars after the share `s` of the stretch.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub(super) fn positions(&self, s: f64) -> [[f64; 2]; 3] {
        self.coefficients.map(|axes| axes.map(|c| value(&c, s)))
    }

    /// Their velocities.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub(super) fn velocities(&self, s: f64) -> [[f64; 2]; 3] {
        let inverse = 1.0 / self.length;
        self.coefficients.map(|axes| axes.map(|c| inverse * slope(&c, s)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between the ends of its stretches the sky is what a precise integrator finds there. In a fall with the frequency `f` the
    /// sixth derivative reaches `6! d f^6`, so that places may be off by `720 x 0.05^6/46080 = 2.4e-10` of their distance (at
    /// most 5 here), and velocities by some six times as much over a stretch.
    #[test]
    fn the_sky_holds_between_its_ends() {
        let start = Start::pythagorean([3.0, 4.0, 5.0], 1.0, 0.0);
        let mut stars = Stars::new(&start, 0.02).unwrap();
        let mut engine = start.engine(PRECISE).unwrap();
        let (mut off, mut drift): (f64, f64) = (0.0, 0.0);
        while let Some(sky) = stars.next(2.5).unwrap() {
            engine.advance(sky.from + 0.37 * sky.length, &mut ()).unwrap();
            let (r, v) = (sky.positions(0.37), sky.velocities(0.37));
            for star in 0..3 {
                off = off.max((Vector(r[star]) - engine.particles().position[star]).norm());
                drift = drift.max(sky.length * (Vector(v[star]) - engine.particles().velocity[star]).norm());
            }
        }
        println!("off by {off:e}, {drift:e}");
        assert!(off < 5.0 * 2.4e-10 && drift < 6.0 * 5.0 * 2.4e-10, "{off:e} {drift:e}");
    }
}
