//! Bonds of polymers, that cannot be stretched beyond a length.

use corpuscle_core::Invalid;

use super::{BondLaw, positive};

/// The finitely extensible nonlinear elastic bond, FENE: `U(r) = -(k R^2/2) ln(1 - (r/R)^2)`, of tension `k r/(1 - (r/R)^2)`, a spring
/// `k` for small lengths that nothing stretches to `R` (Warner 1972, doi:10.1021/i160043a017).
///
/// Beside a Weeks-Chandler-Andersen force of all pairs, with `k = 30 epsilon/sigma^2` and `R = 1.5 sigma`, it makes the chains of
/// Kremer and Grest (1990, doi:10.1063/1.458541), whose bonds keep a length of 0.97 and never cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiniteExtension {
    /// Stiffness `k`, energy per length squared.
    pub stiffness: f64,
    /// The length `R` it never reaches.
    pub longest: f64,
}

impl BondLaw for FiniteExtension {
    fn name(&self) -> &'static str {
        "FENE bonds"
    }

    fn longest(&self) -> f64 {
        self.longest
    }

    fn tension_over_length(&self, r_squared: f64) -> f64 {
        self.stiffness / (1.0 - r_squared / (self.longest * self.longest))
    }

    fn energy(&self, r_squared: f64) -> f64 {
        let square = self.longest * self.longest;
        -0.5 * self.stiffness * square * libm::log1p(-r_squared / square)
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("stiffness of FENE bonds", self.stiffness)?;
        positive("longest of FENE bonds", self.longest)
    }
}
