//! Screened charges.

use corpuscle_core::Invalid;

use super::exponential::exp;
use super::{PairPotential, finite, positive};

/// `U(r) = epsilon (sigma/r) exp(-(r - sigma)/lambda)`, cut at the range: the interaction of charges in a plasma or an
/// electrolyte of screening length `lambda` (Yukawa 1935, doi:10.11429/ppmsj1919.17.0_48).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yukawa {
    /// Energy at the distance `sigma`; negative for attraction.
    pub epsilon: f64,
    /// Distance at which the energy is `epsilon`.
    pub sigma: f64,
    /// Screening length `lambda`.
    pub screening_length: f64,
    /// Range.
    pub cutoff: f64,
}

impl PairPotential for Yukawa {
    fn name(&self) -> &'static str {
        "Yukawa"
    }

    fn cutoff(&self) -> f64 {
        self.cutoff
    }

    fn length(&self) -> f64 {
        self.sigma
    }

    fn depth(&self) -> f64 {
        self.epsilon
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        let r = r_squared.sqrt();
        self.epsilon * self.sigma / r * exp((self.sigma - r) / self.screening_length)
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        let r = r_squared.sqrt();
        self.energy(r_squared) * (1.0 / r + 1.0 / self.screening_length) / r
    }

    fn validate(&self) -> Result<(), Invalid> {
        finite("epsilon", self.epsilon)?;
        positive("sigma", self.sigma)?;
        positive("screening length", self.screening_length)?;
        positive("cutoff", self.cutoff)
    }
}
