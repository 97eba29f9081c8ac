//! The Lennard-Jones potential.

use corpuscle_core::Invalid;

use super::{PairPotential, positive};

/// Lennard-Jones, cut and shifted: `U(r) = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) - U_c` for `r < r_c`, zero beyond, with
/// `U_c` such that `U(r_c) = 0` (Lennard-Jones 1924, doi:10.1098/rspa.1924.0082). The force jumps at the cutoff, the
/// energy does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LennardJones {
    /// Depth of the well.
    pub epsilon: f64,
    /// Distance at which the uncut potential is zero.
    pub sigma: f64,
    /// Cutoff `r_c`, usually `2.5 sigma`.
    pub cutoff: f64,
}

impl LennardJones {
    /// Energy before the shift.
    #[inline]
    pub(super) fn uncut(&self, r_squared: f64) -> f64 {
        let s2 = self.sigma * self.sigma / r_squared;
        let s6 = s2 * s2 * s2;
        4.0 * self.epsilon * (s6 * s6 - s6)
    }
}

impl PairPotential for LennardJones {
    fn name(&self) -> &'static str {
        "Lennard-Jones"
    }

    fn cutoff(&self) -> f64 {
        self.cutoff
    }

    fn length(&self) -> f64 {
        self.sigma
    }

    fn energy(&self, r_squared: f64) -> f64 {
        self.uncut(r_squared) - self.uncut(self.cutoff * self.cutoff)
    }

    #[inline]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        let inverse = 1.0 / r_squared;
        let s2 = self.sigma * self.sigma * inverse;
        let s6 = s2 * s2 * s2;
        24.0 * self.epsilon * inverse * s6 * (2.0 * s6 - 1.0)
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("epsilon", self.epsilon)?;
        positive("sigma", self.sigma)?;
        positive("cutoff", self.cutoff)
    }
}
