//! The same question asked of another integrator: grains released at random, each on an engine of its own with the stars.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Invalid, Vector};
use corpuscle_time::TimeDriven;

use super::super::start::{PRECISE, Start};
use super::flock::{Fate, Rules};

/// A probe is looked at after this share of the time in which it passes the nearest star: the closest approach is then
/// known to one part in `8/0.1^2`.
const SHARE: f64 = 0.1;

/// A grain among its own stars, advanced to rounding error.
pub(super) struct Probe {
    engine: TimeDriven<2>,
    pub(super) fate: Fate,
    pub(super) time: f64,
    /// When it is looked at next: that depends on its own way alone.
    next: f64,
    rules: Rules,
    constant: f64,
    softening: f64,
}

resume!(Probe { values: [fate, time, next], parts: [engine], set_up: [rules, constant, softening] });

impl Probe {
    pub(super) fn new(start: &Start, place: [f64; 2], velocity: [f64; 2], rules: Rules) -> Result<Self, Invalid> {
        let mut start = start.without_dust();
        start.particles.push(Vector(place), Vector(velocity), 0.0, 0.0, 3);
        let engine = start.engine(PRECISE)?;
        let (constant, softening) = (start.constant, start.softening);
        let mut probe = Self { engine, fate: Fate::Open, time: 0.0, next: 0.0, rules, constant, softening };
        probe.fate = probe.judge();
        Ok(probe)
    }

    pub(super) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while self.fate == Fate::Open && self.next <= to {
            self.engine.advance(self.next, &mut ())?;
            self.time = self.engine.time();
            self.fate = self.judge();
            self.next = self.time + SHARE / self.frequency();
        }
        Ok(())
    }

    fn judge(&self) -> Fate {
        let all = self.engine.particles();
        let stars = std::array::from_fn(|star| all.position[star].0);
        let strength = std::array::from_fn(|star| self.constant * all.mass[star]);
        self.rules.judge(all.position[3], all.velocity[3], &stars, (&strength, self.softening * self.softening))
    }

    /// Highest of `v/d` and `sqrt(G m/d^3)` over the stars.
    fn frequency(&self) -> f64 {
        let all = self.engine.particles();
        let rate = |star: usize| {
            let d2 = (all.position[star] - all.position[3]).norm_squared() + self.softening * self.softening;
            let v2 = (all.velocity[star] - all.velocity[3]).norm_squared();
            (v2 + self.constant * all.mass[star] / d2.sqrt()) / d2
        };
        (0..3).map(rate).fold(0.0, f64::max).sqrt()
    }
}
