//! Round numbers, and numbers as people read them.

/// The largest of ..., 0.5, 1, 2, 5, 10, 20, ... that is not above `x > 0`.
pub(crate) fn one_two_five_below(x: f64) -> f64 {
    let power = power_of_ten(x.log10().floor());
    // The last factor covers a logarithm that was rounded up.
    [10.0, 5.0, 2.0, 1.0, 0.5].into_iter().map(|f| f * power).find(|n| *n <= x * (1.0 + 1e-12)).unwrap_or(power)
}

/// Decimal text is the only way to the nearest double of every power of ten.
fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

/// Round values from `least` to `most`: as few as possible, but three.
pub(crate) fn ticks(least: f64, most: f64) -> Vec<f64> {
    let extent = most - least;
    if !(extent.is_finite() && extent > 0.0) {
        return vec![least];
    }
    let mut step = one_two_five_below(extent);
    loop {
        let first = (least / step - 1e-9).ceil();
        let last = (most / step + 1e-9).floor();
        // Values so near to each other that rounding has taken their steps end here too.
        if last - first >= 2.0 || step < 1e-3 * extent {
            return (0..=(last - first) as usize).map(|n| (first + n as f64) * step).collect();
        }
        step = one_two_five_below(0.7 * step);
    }
}

/// The power of ten to be taken out of values up to `most`, 0 when they read well as they are.
pub(crate) fn common_exponent(most: f64) -> i32 {
    if most == 0.0 || !most.is_finite() {
        return 0;
    }
    let exponent = most.abs().log10().floor() as i32;
    if (-2..5).contains(&exponent) { 0 } else { exponent }
}

/// Decimals that tell multiples of `step` apart.
pub(crate) fn decimals(step: f64) -> usize {
    (0..12).find(|&d| (step * 10f64.powi(d) - (step * 10f64.powi(d)).round()).abs() < 1e-6 * step * 10f64.powi(d)).unwrap_or(12)
        as usize
}

/// A value with a minus sign that has the width of a plus, and no negative zero.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().any(|c| c.is_ascii_digit() && c != '0') => format!("−{digits}"),
        Some(digits) => digits.to_owned(),
        None => text,
    }
}

/// `10ⁿ`.
pub(crate) fn power_text(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |d| RAISED[d as usize]);
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

/// A length or a time, as short as it can be said.
pub(crate) fn short(value: f64) -> String {
    let exponent = common_exponent(value);
    if exponent == 0 {
        return fixed(value, decimals(value));
    }
    let mantissa = value / power_of_ten(f64::from(exponent));
    if (mantissa - 1.0).abs() < 1e-9 {
        return power_text(exponent);
    }
    format!("{} × {}", fixed(mantissa, decimals(mantissa)), power_text(exponent))
}

/// A running time, with a number of decimals that does not jump while it runs.
pub(crate) fn clock(time: f64) -> String {
    let exponent = common_exponent(time);
    if time != 0.0 && exponent != 0 {
        return format!("{} × {}", fixed(time / power_of_ten(f64::from(exponent)), 3), power_text(exponent));
    }
    fixed(time, if time.abs() < 1.0 { 3 } else { 2 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers() {
        for (x, expected) in [(7.0, 5.0), (1.0, 1.0), (0.0199, 0.01), (0.02, 0.02), (4.999e8, 2.0e8), (3e-12, 2e-12)] {
            assert_eq!(one_two_five_below(x), expected, "{x}");
        }
    }

    #[test]
    fn a_scale_has_a_few_round_ticks() {
        assert_eq!(ticks(0.0, 3.0), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(ticks(-1.0, 1.0), [-1.0, 0.0, 1.0]);
        let mut most = 1.0;
        while most < 1000.0 {
            for least in [0.0, -0.3 * most] {
                let n = ticks(least, most).len();
                assert!((3..=8).contains(&n), "{least} to {most}: {n} ticks");
            }
            most *= 1.07;
        }
        assert_eq!(ticks(2.0, 2.0), [2.0]);
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(short(0.05), "0.05");
        assert_eq!(short(200.0), "200");
        assert_eq!(short(2.0e-9), "2 × 10⁻⁹");
        assert_eq!(short(1.0e6), "10⁶");
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(-0.5, 1), "−0.5");
        assert_eq!(clock(12.345), "12.35");
        assert_eq!(clock(0.0), "0.000");
    }
}
