//! The purely repulsive part of Lennard-Jones.

use corpuscle_core::Invalid;

use super::{LennardJones, PairPotential};

/// Lennard-Jones cut at its minimum `2^(1/6) sigma` and shifted up by `epsilon`: soft spheres without attraction, whose
/// force vanishes smoothly (Weeks, Chandler and Andersen 1971, doi:10.1063/1.1674820).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeeksChandlerAndersen {
    whole: LennardJones,
}

/// `2^(1/6)`.
const MINIMUM: f64 = 1.122_462_048_309_373;

impl WeeksChandlerAndersen {
    /// Soft spheres with energy `epsilon` at the distance `sigma`.
    pub fn new(epsilon: f64, sigma: f64) -> Self {
        Self { whole: LennardJones { epsilon, sigma, cutoff: MINIMUM * sigma } }
    }
}

impl PairPotential for WeeksChandlerAndersen {
    fn name(&self) -> &'static str {
        "Weeks-Chandler-Andersen"
    }

    fn cutoff(&self) -> f64 {
        self.whole.cutoff
    }

    fn length(&self) -> f64 {
        self.whole.sigma
    }

    fn depth(&self) -> f64 {
        self.whole.epsilon
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        self.whole.energy(r_squared) + self.whole.epsilon
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        self.whole.force_over_distance(r_squared)
    }

    fn validate(&self) -> Result<(), Invalid> {
        self.whole.validate()
    }
}
