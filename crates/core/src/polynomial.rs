//! Roots of low polynomials, found so that none can be skipped.

/// Value of the polynomial with these coefficients, lowest order first, at `t`.
#[inline]
pub fn evaluate(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |value, c| value * t + c)
}

/// The roots found, in ascending order: at most `N - 1` of a polynomial with `N` coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Roots<const N: usize> {
    values: [f64; N],
    count: usize,
}

impl<const N: usize> std::ops::Deref for Roots<N> {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

/// All real roots in the open interval `(from, to)` where the polynomial changes its sign, in ascending order.
///
/// Between two neighbouring roots of its derivative a polynomial is monotone, so that a sign change brackets exactly
/// one root. The derivative's roots come from the same rule, from the last
/// derivative that is not constant upwards: no root can be skipped, however close together they are. Allocates nothing.
pub fn roots<const N: usize>(coefficients: &[f64; N], from: f64, to: f64) -> Roots<N> {
    let mut roots = Roots { values: [0.0; N], count: 0 };
    for order in (0..N.saturating_sub(1)).rev() {
        let (derivative, length) = (derivative(coefficients, order), N - order);
        let mut found = Roots { values: [0.0; N], count: 0 };
        let mut low = from;
        for knot in 0..=roots.count {
            let high = if knot < roots.count { roots.values[knot] } else { to };
            if let Some(root) = bracketed(&derivative[..length], low, high) {
                found.values[found.count] = root;
                found.count += 1;
            }
            low = high;
        }
        roots = found;
    }
    roots
}

/// Coefficients of the derivative of this order, zeros behind them.
fn derivative<const N: usize>(coefficients: &[f64; N], order: usize) -> [f64; N] {
    std::array::from_fn(|power| {
        let factor: usize = (power + 1..=power + order).product();
        coefficients.get(power + order).map_or(0.0, |c| c * factor as f64)
    })
}

/// The root in a bracket on which the polynomial is monotone: Newton's method, and bisection wherever that would leave
/// the bracket or close in too slowly.
fn bracketed(coefficients: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let rising = evaluate(coefficients, high) > 0.0;
    if (evaluate(coefficients, low) > 0.0) == rising {
        return None;
    }
    let (mut x, mut last_step) = (0.5 * (low + high), high - low);
    loop {
        let (value, slope) = coefficients.iter().rev().fold((0.0, 0.0), |(p, q), c| (p * x + c, q * x + p));
        if (value > 0.0) == rising {
            high = x;
        } else {
            low = x;
        }
        let mut next = x - value / slope;
        if !(low < next && next < high && (next - x).abs() < 0.5 * last_step) {
            next = 0.5 * (low + high);
        }
        last_step = (next - x).abs();
        if last_step <= f64::EPSILON * next.abs() || next <= low || next >= high {
            return Some(next);
        }
        x = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn from_roots(roots: &[f64; 4]) -> [f64; 5] {
        roots.iter().fold([1.0, 0.0, 0.0, 0.0, 0.0], |polynomial, root| {
            std::array::from_fn(|power| if power > 0 { polynomial[power - 1] } else { 0.0 } - root * polynomial[power])
        })
    }

    #[test]
    fn two_close_roots_are_both_found() {
        let found = roots(&from_roots(&[0.5, 0.5 + 1e-5, 3.0, 7.0]), 0.0, 10.0);
        assert_eq!(found.len(), 4);
        assert!((found[0] - 0.5).abs() < 1e-8 && (found[1] - 0.5 - 1e-5).abs() < 1e-8);
    }

    proptest! {
        #[test]
        fn four_random_roots_come_back(mut expected in prop::array::uniform4(0.1..9.9f64)) {
            expected.sort_by(f64::total_cmp);
            prop_assume!(expected.windows(2).all(|w| w[1] - w[0] > 1e-3));
            let found = roots(&from_roots(&expected), 0.0, 10.0);
            prop_assert_eq!(found.len(), 4);
            for (a, b) in found.iter().zip(expected) {
                prop_assert!((a - b).abs() < 1e-6);
            }
        }
    }
}
