//! Soft grains that push each other apart where they overlap.

use corpuscle_core::Invalid;

use super::{PairPotential, positive};

/// `U(r) = k (sigma - r)^2 / 2` for `r < sigma`, zero beyond: the overlap of soft grains and bubbles (Durian 1995,
/// doi:10.1103/PhysRevLett.75.4780).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HarmonicRepulsion {
    /// Stiffness `k`.
    pub stiffness: f64,
    /// Diameter `sigma`, which is the range.
    pub diameter: f64,
}

impl PairPotential for HarmonicRepulsion {
    fn name(&self) -> &'static str {
        "harmonic repulsion"
    }

    fn cutoff(&self) -> f64 {
        self.diameter
    }

    fn length(&self) -> f64 {
        self.diameter
    }

    fn depth(&self) -> f64 {
        self.stiffness * self.diameter * self.diameter
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        let overlap = self.diameter - r_squared.sqrt();
        0.5 * self.stiffness * overlap * overlap
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        self.stiffness * (self.diameter / r_squared.sqrt() - 1.0)
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("stiffness", self.stiffness)?;
        positive("diameter", self.diameter)
    }
}
