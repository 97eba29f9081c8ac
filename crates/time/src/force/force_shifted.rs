//! A truncation without a jump of the force.

use corpuscle_core::Invalid;

use super::PairPotential;

/// Another potential with its force shifted to vanish at the range: `U(r) + (r - r_c) F(r_c)`, and hence `F(r) - F(r_c)`
/// (Toxvaerd and Dyre 2011, doi:10.1063/1.3558787). [`PairForce`](super::PairForce) takes `U(r_c)` off the energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceShifted<P>(pub P);

impl<P: PairPotential> ForceShifted<P> {
    /// `F(r_c)`.
    #[inline(always)]
    fn force_at_range(&self) -> f64 {
        let cutoff = self.0.cutoff();
        self.0.force_over_distance(cutoff * cutoff) * cutoff
    }
}

impl<P: PairPotential> PairPotential for ForceShifted<P> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn cutoff(&self) -> f64 {
        self.0.cutoff()
    }

    fn length(&self) -> f64 {
        self.0.length()
    }

    fn depth(&self) -> f64 {
        self.0.depth()
    }

    #[inline(always)]
    fn energy(&self, r_squared: f64) -> f64 {
        self.0.energy(r_squared) + (r_squared.sqrt() - self.0.cutoff()) * self.force_at_range()
    }

    #[inline(always)]
    fn force_over_distance(&self, r_squared: f64) -> f64 {
        self.0.force_over_distance(r_squared) - self.force_at_range() / r_squared.sqrt()
    }

    fn validate(&self) -> Result<(), Invalid> {
        self.0.validate()
    }
}
