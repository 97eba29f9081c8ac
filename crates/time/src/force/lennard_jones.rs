//! The Lennard-Jones potential.

use corpuscle_core::Invalid;

use super::{PairPotential, positive};

/// Lennard-Jones: `U(r) = 4 epsilon ((sigma/r)^12 - (sigma/r)^6)` for `r < r_c`, zero beyond (Lennard-Jones 1924,
/// doi:10.1098/rspa.1924.0082). In a [`PairForce`](super::PairForce) it is cut and shifted, so that the force jumps at the
/// cutoff and the energy does not; [`unshifted`](super::PairForce::unshifted) it is only cut, and in a
/// [`ForceShifted`](super::ForceShifted) neither jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LennardJones {
    /// Depth of the well.
    pub epsilon: f64,
    /// Distance at which the uncut potential is zero.
    pub sigma: f64,
    /// Cutoff `r_c`, usually `2.5 sigma`.
    pub cutoff: f64,
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

    fn depth(&self) -> f64 {
        self.epsilon
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        let s2 = self.sigma * self.sigma / r_squared;
        let s6 = s2 * s2 * s2;
        4.0 * self.epsilon * (s6 * s6 - s6)
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        let inverse = 1.0 / r_squared;
        let s2 = self.sigma * self.sigma * inverse;
        let s6 = s2 * s2 * s2;
        inverse * s6 * (48.0 * self.epsilon * s6 - 24.0 * self.epsilon)
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("epsilon", self.epsilon)?;
        positive("sigma", self.sigma)?;
        positive("cutoff", self.cutoff)
    }
}
