//! Reproducible random numbers: each is a function of its address, not of how many were drawn before.

use rand_philox::{Philox, splitmix64};

/// A stream of random numbers addressed by `(seed, stream)` and, inside it, by `(step, index)`.
///
/// Philox 4x32-10 (Salmon, Moraes, Dror, Shaw, SC'11, doi:10.1145/2063384.2063405): the seed and the stream make the
/// key, step and index the counter. Draws never depend on the thread that makes them, nor on the platform's
/// mathematical library.
#[derive(Clone, Debug)]
pub struct Random {
    generator: Philox,
    spare: Option<f64>,
}

impl Random {
    /// The start of the stream `stream` of `seed`.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self::at(seed, stream, 0, 0)
    }

    /// The numbers that belong to `index` (a particle, say) in `step` of a stream.
    ///
    /// Each address holds 2^18 words before it runs into the next index.
    pub fn at(seed: u64, stream: u64, step: u64, index: u64) -> Self {
        // The golden-ratio increment keeps seed 0 and stream 0 from mapping to key 0.
        let key = splitmix64(splitmix64(seed.wrapping_add(0x9E37_79B9_7F4A_7C15)).wrapping_add(stream));
        let counter = (u128::from(step) << 64) | (u128::from(index) << 16);
        Self { generator: Philox::new([key as u32, (key >> 32) as u32], counter), spare: None }
    }

    /// Sixty-four random bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Uniform in the open interval (0, 1), with 53 random bits.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform integer in `0..n`, without bias.
    ///
    /// # Panics
    /// When `n` is zero.
    pub fn below(&mut self, n: u32) -> u32 {
        self.generator.bounded(n)
    }

    /// Standard normal deviate: mean 0, variance 1 (Box and Muller 1958, doi:10.1214/aoms/1177706645).
    ///
    /// Logarithm and sine come from `libm`, so that the bits are the same on every platform.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * self.uniform());
        self.spare = Some(radius * sine);
        radius * cosine
    }

    /// Shuffles a slice (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last as u32 + 1) as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_always_holds_the_same_numbers() {
        let mut a = Random::at(7, 1, 5, 9);
        let mut b = Random::at(7, 1, 5, 9);
        assert!((0..100).all(|_| a.bits() == b.bits()));
        assert_ne!(Random::at(7, 1, 5, 10).bits(), Random::at(7, 1, 5, 9).bits());
        assert_ne!(Random::at(7, 1, 6, 9).bits(), Random::at(7, 1, 5, 9).bits());
        assert_ne!(Random::at(7, 2, 5, 9).bits(), Random::at(7, 1, 5, 9).bits());
        assert_ne!(Random::at(8, 1, 5, 9).bits(), Random::at(7, 1, 5, 9).bits());
    }

    /// Moments of the normal distribution: mean 0, variance 1, fourth moment 3, each within 4 standard errors.
    #[test]
    fn normal_deviates_have_normal_moments() {
        let mut random = Random::new(1, 0);
        let n = 200_000;
        let draws: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let moment = |p: i32| draws.iter().map(|x| x.powi(p)).sum::<f64>() / f64::from(n);
        let root = f64::from(n).sqrt();
        assert!(moment(1).abs() < 4.0 / root);
        assert!((moment(2) - 1.0).abs() < 4.0 * 2f64.sqrt() / root);
        assert!((moment(4) - 3.0).abs() < 4.0 * 96f64.sqrt() / root);
    }
}
