//! A round drop as a sum of waves, each of which fades on its own.

use std::f64::consts::TAU;

use corpuscle_core::Vector;
use corpuscle_core::particles::ball_volume;

/// A disc (ball) in the middle of a periodic box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drop<const D: usize> {
    /// Radius over the side of the box.
    pub(super) radius: f64,
    /// Side of the box.
    pub(super) side: f64,
}

impl<const D: usize> Drop<D> {
    /// Whether a place is in the drop.
    pub(super) fn holds(&self, place: Vector<D>) -> bool {
        let middle = Vector::from_fn(|_| 0.5 * self.side);
        (place - middle).norm() <= self.radius * self.side
    }

    /// Part of the box that it fills.
    pub(super) fn share(&self) -> f64 {
        ball_volume::<D>(self.radius)
    }

    /// Volume of the box.
    pub(super) fn volume(&self) -> f64 {
        self.side.powi(D as i32)
    }

    /// `k_m = 2 pi m/L`.
    pub(super) fn wave_number(&self, wave: usize) -> f64 {
        TAU * wave as f64 / self.side
    }

    /// Mean of `cos(k_m x)` over the drop: `2 J_1(q)/q` in the plane, `3 (sin q - q cos q)/q^3` in space, `q = k_m R`.
    pub(super) fn amplitude(&self, wave: usize) -> f64 {
        let q = self.wave_number(wave) * self.radius * self.side;
        if D == 2 {
            2.0 * libm::j1(q) / q
        } else {
            let (sine, cosine) = libm::sincos(q);
            3.0 * (sine - q * cosine) / (q * q * q)
        }
    }

    /// The same when each particle has walked a normal distance of this variance along each axis.
    pub(super) fn faded(&self, wave: usize, variance: f64) -> f64 {
        let k = self.wave_number(wave);
        self.amplitude(wave) * libm::exp(-0.5 * k * k * variance)
    }

    /// Concentration of the drop along an axis at a distance from the middle, over its mean: `1 + 2 sum_m faded(m) cos(k_m x)`.
    pub(super) fn profile(&self, x: f64, variance: f64) -> f64 {
        const WAVES: usize = 80;
        let wave = |m: usize| self.faded(m, variance) * libm::cos(self.wave_number(m) * x);
        1.0 + 2.0 * (1..=WAVES).map(wave).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint sums over the drop itself: discs have the length `2 sqrt(R^2 - x^2)` across, balls the area `pi (R^2 - x^2)`.
    #[test]
    fn amplitudes_are_means_over_the_drop() {
        let (flat, round) = (Drop::<2> { radius: 0.2, side: 10.0 }, Drop::<3> { radius: 0.2, side: 10.0 });
        for wave in 1..4 {
            let (mut sums, mut weights) = ([0.0; 2], [0.0; 2]);
            for step in 0..20_000 {
                let x = 2.0 * ((f64::from(step) + 0.5) / 10_000.0 - 1.0);
                let cosine = (flat.wave_number(wave) * x).cos();
                for (kind, weight) in [(4.0 - x * x).sqrt(), 4.0 - x * x].into_iter().enumerate() {
                    sums[kind] += weight * cosine;
                    weights[kind] += weight;
                }
            }
            assert!((sums[0] / weights[0] - flat.amplitude(wave)).abs() < 1e-5);
            assert!((sums[1] / weights[1] - round.amplitude(wave)).abs() < 1e-5);
        }
    }

    #[test]
    fn in_the_end_the_drop_is_everywhere() {
        let drop = Drop::<3> { radius: 0.2, side: 10.0 };
        assert!((drop.profile(0.0, 100.0) - 1.0).abs() < 1e-4 && (drop.profile(5.0, 100.0) - 1.0).abs() < 1e-4);
        assert!(drop.profile(0.0, 1.0) > 1.0 && drop.profile(5.0, 1.0) < 1.0);
    }
}
