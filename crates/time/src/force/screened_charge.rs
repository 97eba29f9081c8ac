//! The near part of the interaction of two charges: what is left of `1/r` beside the smooth part that Ewald sums by waves.

use corpuscle_core::Invalid;

use super::complementary_error::{TWO_OVER_ROOT_PI, erfc_and_gaussian};
use super::{PairPotential, finite, positive};

/// `U(r) = s erfc(alpha r)/r`: two charges, each in a Gaussian cloud of the opposite charge (Ewald 1921,
/// doi:10.1002/andp.19213690304).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ScreenedCharge {
    /// `s = k q_1 q_2`.
    pub(super) strength: f64,
    /// `alpha`, an inverse length.
    pub(super) screening: f64,
    pub(super) cutoff: f64,
}

impl PairPotential for ScreenedCharge {
    fn name(&self) -> &'static str {
        "Coulomb"
    }

    fn cutoff(&self) -> f64 {
        self.cutoff
    }

    fn length(&self) -> f64 {
        1.0 / self.screening
    }

    /// A 256th of the energy at that length, for sums in quanta as fine as the accuracy Ewald's sum can have.
    fn depth(&self) -> f64 {
        self.strength * self.screening / 256.0
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        let r = r_squared.sqrt();
        let (erfc, _) = erfc_and_gaussian(self.screening * r);
        self.strength * erfc / r
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        let r = r_squared.sqrt();
        let (erfc, gaussian) = erfc_and_gaussian(self.screening * r);
        self.strength * (erfc / r + TWO_OVER_ROOT_PI * self.screening * gaussian) / r_squared
    }

    fn validate(&self) -> Result<(), Invalid> {
        finite("charge", self.strength)?;
        positive("screening", self.screening)?;
        positive("cutoff", self.cutoff)
    }
}
