//! The complementary error function as products and sums, so that loops over lanes stay vector instructions.

use super::exponential::exp;

/// `2/sqrt(pi)`.
pub(super) const TWO_OVER_ROOT_PI: f64 = std::f64::consts::FRAC_2_SQRT_PI;

/// `erfc(x)` and `exp(-x^2)` for `x >= 0`. The first is `exp(-x^2) p(s) t` with `t = 1/(x + 2)`, which changes little, and `s` in
/// `[-1, 1]` for `x` up to 6.5: Chebyshev's expansion there, cut after degree 18, leaves out `2e-15`. Beyond, both are below
/// `1e-18`, with fewer correct digits.
#[inline(always)]
pub(super) fn erfc_and_gaussian(x: f64) -> (f64, f64) {
    let gaussian = exp(-(x * x));
    let t = 1.0 / (x + 2.0);
    let s = 21.0 / 13.0 - 68.0 / 13.0 * t;
    let mut p = 2.242_973_042_038_154_4e-10;
    p = p * s + 2.908_310_031_556_637e-9;
    p = p * s + 5.791_705_863_283_025e-9;
    p = p * s - 1.548_917_808_394_280_4e-8;
    p = p * s - 8.854_177_073_246_66e-8;
    p = p * s - 1.137_097_737_900_728_7e-7;
    p = p * s + 4.134_168_196_691_284e-7;
    p = p * s + 2.124_183_854_191_892_8e-6;
    p = p * s + 1.918_838_855_905_856_6e-6;
    p = p * s - 1.528_099_674_909_031_4e-5;
    p = p * s - 5.479_290_421_244_101e-5;
    p = p * s + 4.527_573_333_926_831e-5;
    p = p * s + 6.965_883_960_442_968e-4;
    p = p * s + 4.226_906_609_179_93e-4;
    p = p * s - 9.002_369_904_590_575e-3;
    p = p * s - 6.027_195_647_773_683e-3;
    p = p * s + 0.173_887_679_771_447_05;
    p = p * s - 0.629_753_389_697_143_6;
    p = p * s + 1.199_144_742_857_206_2;
    (gaussian * p * t, gaussian)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the platform-independent library. Rounding `x^2` counts `x^2` times, the polynomial a few.
    #[test]
    fn it_is_the_complementary_error_function() {
        for i in 0..65_000 {
            let x = f64::from(i) * 1e-4;
            let (mine, gaussian) = erfc_and_gaussian(x);
            let library = libm::erfc(x);
            let bound = 2.2e-15 + (x * x + 6.0) * f64::EPSILON;
            assert!((mine - library).abs() <= bound * library, "{x}: {mine} {library}");
            assert!((gaussian - libm::exp(-x * x)).abs() <= bound * gaussian);
        }
        let (beyond, _) = erfc_and_gaussian(9.0);
        assert!(beyond > 0.0 && beyond < 1e-35);
    }
}
