//! Ions that overlap.

use corpuscle_core::Invalid;

use super::exponential::exp;
use super::{PairPotential, finite, not_negative, positive};

/// `U(r) = epsilon exp((sigma - r)/rho) - C/r^6 - D/r^8`, cut at the range: closed shells that overlap repel each other, beside the
/// charges' own force (Born and Mayer 1932, doi:10.1007/BF01340511; Fumi and Tosi 1964, doi:10.1016/0022-3697(64)90159-3).
///
/// With `C` or `D` it attracts without bound at distances far below `sigma`, where no particle belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BornMayer {
    /// Repulsive energy `epsilon` at the distance `sigma`.
    pub epsilon: f64,
    /// The sum of the ions' radii.
    pub sigma: f64,
    /// Length `rho` in which the repulsion falls to `1/e`.
    pub hardness: f64,
    /// Dispersion between dipoles, `C`.
    pub dispersion: f64,
    /// Dispersion between dipole and quadrupole, `D`.
    pub higher_dispersion: f64,
    /// Range.
    pub cutoff: f64,
}

impl PairPotential for BornMayer {
    fn name(&self) -> &'static str {
        "Born-Mayer"
    }

    fn cutoff(&self) -> f64 {
        self.cutoff
    }

    fn length(&self) -> f64 {
        self.hardness
    }

    fn depth(&self) -> f64 {
        self.epsilon
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        let inverse = 1.0 / r_squared;
        let sixth = inverse * inverse * inverse;
        let repulsion = self.epsilon * exp((self.sigma - r_squared.sqrt()) / self.hardness);
        repulsion - sixth * (self.dispersion + self.higher_dispersion * inverse)
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        let r = r_squared.sqrt();
        let inverse = 1.0 / r_squared;
        let eighth = inverse * inverse * inverse * inverse;
        let repulsion = self.epsilon * exp((self.sigma - r) / self.hardness) / (self.hardness * r);
        repulsion - eighth * (6.0 * self.dispersion + 8.0 * self.higher_dispersion * inverse)
    }

    fn validate(&self) -> Result<(), Invalid> {
        not_negative("epsilon", self.epsilon)?;
        finite("sigma", self.sigma)?;
        positive("hardness", self.hardness)?;
        not_negative("dispersion", self.dispersion)?;
        not_negative("higher dispersion", self.higher_dispersion)?;
        positive("cutoff", self.cutoff)
    }
}
