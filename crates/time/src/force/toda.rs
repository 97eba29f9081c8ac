//! Exponential springs between neighbours: the lattice that Toda solved.

use corpuscle_core::Invalid;

use super::{BondLaw, positive};

/// Bonds of tension `T(x) = (k/b) (1 - exp(-b x))`, `x = |r| - l` their extension, and energy `(k/b^2) (exp(-b x) - 1 + b x)`:
/// springs of stiffness `k` that harden when pressed and go soft when pulled (Toda 1967, doi:10.1143/JPSJ.22.431). A chain of them
/// has solitons, and is integrable. To second order they are springs with `alpha = -b/2`, `beta = b^2/6`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toda {
    /// Stiffness `k`, energy per length squared.
    pub stiffness: f64,
    /// Steepness `b > 0`, an inverse length.
    pub steepness: f64,
    /// Rest length `l`.
    pub rest_length: f64,
}

impl BondLaw for Toda {
    fn name(&self) -> &'static str {
        "Toda bonds"
    }

    fn tension_over_length(&self, r_squared: f64) -> f64 {
        let length = r_squared.sqrt();
        -self.stiffness / self.steepness * libm::expm1(-self.steepness * (length - self.rest_length)) / length
    }

    fn energy(&self, r_squared: f64) -> f64 {
        let bx = self.steepness * (r_squared.sqrt() - self.rest_length);
        self.stiffness / (self.steepness * self.steepness) * (libm::expm1(-bx) + bx)
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("stiffness of Toda bonds", self.stiffness)?;
        positive("steepness of Toda bonds", self.steepness)?;
        positive("rest length of Toda bonds", self.rest_length)
    }
}
