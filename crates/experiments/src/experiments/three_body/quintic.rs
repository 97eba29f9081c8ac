//! The polynomial of fifth degree through two states of a motion.

/// Coefficients `c_0 ... c_5` of the polynomial with value, slope and curvature `p, v, a` at 0 and `q, w, b` at 1.
pub(super) fn quintic([p, v, a]: [f64; 3], [q, w, b]: [f64; 3]) -> [f64; 6] {
    let d = q - p;
    let third = 10.0 * d - 6.0 * v - 4.0 * w - 1.5 * a + 0.5 * b;
    let fourth = -15.0 * d + 8.0 * v + 7.0 * w + 1.5 * a - b;
    [p, v, 0.5 * a, third, fourth, 6.0 * d - 3.0 * (v + w) - 0.5 * (a - b)]
}

/// Its value at `s`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a kernel")]
pub(super) fn value(c: &[f64; 6], s: f64) -> f64 {
    c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))))
}

/// Its slope at `s`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a kernel")]
pub(super) fn slope(c: &[f64; 6], s: f64) -> f64 {
    c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * (5.0 * c[5]))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights of up to 15 on numbers of up to 20 round to `300 eps`.
    #[test]
    fn a_quintic_is_found_again() {
        let c = [0.3, -1.1, 0.7, 2.0, -0.4, 0.9];
        let curvature = |s: f64| (2..6).rev().fold(0.0, |sum, k| sum * s + (k * (k - 1)) as f64 * c[k]);
        let at = |s: f64| [value(&c, s), slope(&c, s), curvature(s)];
        for (found, given) in quintic(at(0.0), at(1.0)).into_iter().zip(c) {
            assert!((found - given).abs() < 300.0 * f64::EPSILON, "{found} for {given}");
        }
    }
}
