//! Soft repulsion by a power of the distance.

use corpuscle_core::Invalid;

use super::{PairPotential, positive};

/// `U(r) = epsilon (sigma/r)^p`, cut at the range. With growing `p` the particles become hard spheres of diameter `sigma`
/// (Hoover and others 1970, doi:10.1063/1.1672728).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InversePower {
    /// Energy at the distance `sigma`.
    pub epsilon: f64,
    /// Length.
    pub sigma: f64,
    /// Power `p`, 1 to 255.
    pub exponent: u8,
    /// Range.
    pub cutoff: f64,
}

/// `x^n` by squaring: always eight steps, so that all lanes take the same.
#[inline(always)]
fn power(x: f64, n: u8) -> f64 {
    let (mut result, mut square) = (1.0, x);
    for bit in 0..8 {
        result = if n >> bit & 1 == 1 { result * square } else { result };
        square *= square;
    }
    result
}

impl PairPotential for InversePower {
    fn name(&self) -> &'static str {
        "inverse power"
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
        self.epsilon * power(self.sigma / r_squared.sqrt(), self.exponent)
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        f64::from(self.exponent) * self.energy(r_squared) / r_squared
    }

    fn validate(&self) -> Result<(), Invalid> {
        positive("epsilon", self.epsilon)?;
        positive("sigma", self.sigma)?;
        positive("exponent", f64::from(self.exponent))?;
        positive("cutoff", self.cutoff)
    }
}
