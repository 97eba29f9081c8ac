//! Roots of low polynomials, found so that none can be skipped.

/// Value of the polynomial with these coefficients, lowest order first, at `t`.
#[inline]
pub fn evaluate(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |value, c| value * t + c)
}

/// All real roots in the open interval `(from, to)` where the polynomial changes its sign, in ascending order.
///
/// Between two neighbouring roots of its derivative a polynomial is monotone, so that a sign change brackets exactly
/// one root, which bisection finds to the last bit. The derivative's roots come from the same rule, down to degree 1:
/// no root can be skipped, however close together they are.
pub fn roots(coefficients: &[f64], from: f64, to: f64) -> Vec<f64> {
    if coefficients.len() < 2 {
        return vec![];
    }
    let derivative: Vec<f64> = coefficients.iter().enumerate().skip(1).map(|(power, c)| c * power as f64).collect();
    let mut knots = vec![from];
    knots.extend(roots(&derivative, from, to));
    knots.push(to);
    knots.windows(2).filter_map(|ends| bracketed(coefficients, ends[0], ends[1])).collect()
}

/// The root in a bracket on which the polynomial is monotone.
fn bracketed(coefficients: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let rising = evaluate(coefficients, high) > 0.0;
    if (evaluate(coefficients, low) > 0.0) == rising {
        return None;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Some(high);
        }
        if (evaluate(coefficients, middle) > 0.0) == rising {
            high = middle;
        } else {
            low = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn from_roots(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |polynomial, root| {
            let mut product = vec![0.0; polynomial.len() + 1];
            for (power, c) in polynomial.iter().enumerate() {
                product[power + 1] += c;
                product[power] -= root * c;
            }
            product
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
