//! The exponential function as a few multiplications, so that loops over lanes stay vector instructions.

/// `e^x` to about one unit in the last place, for `x` up to 709; zero below -708. No branch, no call, and the same bits
/// everywhere.
#[inline(always)]
pub(super) fn exp(x: f64) -> f64 {
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52: what is added to it loses its fraction
    const LN_2_HIGH: f64 = 0.693_147_180_369_123_8; // so few bits that multiples of it are exact
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let kept = if x > -708.0 { x } else { -708.0 };
    let kept = if kept < 709.0 { kept } else { 709.0 };
    let shifted = kept * std::f64::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (kept - n * LN_2_HIGH) - n * LN_2_LOW;
    // Taylor's series for |r| <= ln(2)/2: the first term left out is below 2^-57.
    let mut sum = 1.0 / 6_227_020_800.0;
    sum = sum * r + 1.0 / 479_001_600.0;
    sum = sum * r + 1.0 / 39_916_800.0;
    sum = sum * r + 1.0 / 3_628_800.0;
    sum = sum * r + 1.0 / 362_880.0;
    sum = sum * r + 1.0 / 40_320.0;
    sum = sum * r + 1.0 / 5_040.0;
    sum = sum * r + 1.0 / 720.0;
    sum = sum * r + 1.0 / 120.0;
    sum = sum * r + 1.0 / 24.0;
    sum = sum * r + 1.0 / 6.0;
    sum = sum * r + 0.5;
    sum = (sum * r + 1.0) * r + 1.0;
    // The integer n stands in the last bits of the shifted number: shifted up, it is an exponent.
    let power = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1f64.to_bits()));
    if x > -708.0 { sum * power } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::exp;

    /// Against the platform-independent library: the polynomial adds two roundings to its one.
    #[test]
    fn it_is_the_exponential_function() {
        for i in -70_000..70_000 {
            let x = f64::from(i) * 0.01 + 1e-3;
            let (mine, library) = (exp(x), libm::exp(x));
            assert!((mine - library).abs() <= 3.0 * f64::EPSILON * library, "{x}: {mine} {library}");
        }
        assert_eq!((exp(0.0), exp(-1e300)), (1.0, 0.0));
    }
}
