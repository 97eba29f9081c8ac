//! A bond that can break.

use corpuscle_core::Invalid;

use super::exponential::exp;
use super::{PairPotential, positive};

/// `U(r) = epsilon (e^(-2 a (r - r_0)) - 2 e^(-a (r - r_0)))`, cut at the range: a well of depth `epsilon` at `r_0` (Morse 1929,
/// doi:10.1103/PhysRev.34.57).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Morse {
    /// Depth of the well.
    pub epsilon: f64,
    /// Place of the minimum, `r_0`.
    pub equilibrium: f64,
    /// Inverse width of the well, `a`.
    pub steepness: f64,
    /// Range.
    pub cutoff: f64,
}

impl Morse {
    /// `e^(-a (r - r_0))`.
    #[inline(always)]
    fn decay(&self, r: f64) -> f64 {
        exp(self.steepness * (self.equilibrium - r))
    }
}

impl PairPotential for Morse {
    fn name(&self) -> &'static str {
        "Morse"
    }

    fn cutoff(&self) -> f64 {
        self.cutoff
    }

    fn length(&self) -> f64 {
        self.equilibrium
    }

    fn depth(&self) -> f64 {
        self.epsilon * (self.steepness * self.equilibrium).max(1.0)
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        let decay = self.decay(r_squared.sqrt());
        self.epsilon * decay * (decay - 2.0)
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        let r = r_squared.sqrt();
        let decay = self.decay(r);
        2.0 * self.epsilon * self.steepness * decay * (decay - 1.0) / r
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("epsilon", self.epsilon)?;
        positive("equilibrium", self.equilibrium)?;
        positive("steepness", self.steepness)?;
        positive("cutoff", self.cutoff)
    }
}
