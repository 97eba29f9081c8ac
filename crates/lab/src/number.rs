//! Numbers as people read them on the stage and on axes.

use corpuscle_io::number::superscript;

/// The largest of ..., 0.5, 1, 2, 5, 10, ... that is not above `x > 0`.
pub(crate) fn one_two_five_below(x: f64) -> f64 {
    let power = power_of_ten(x.log10().floor());
    // The last factor covers a logarithm that was rounded up.
    [10.0, 5.0, 2.0, 1.0, 0.5].into_iter().map(|factor| factor * power).find(|&n| n <= x * (1.0 + 1e-12)).unwrap_or(power)
}

/// Decimal text is the only way to the nearest double of every power of ten.
pub(crate) fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

/// A value in as few digits as tell multiples of `step` apart, with a typographic minus; as a product with a power of ten
/// where the largest value of the axis is very large or very small, so that all of an axis look alike.
pub(crate) fn tick(value: f64, step: f64, largest: f64) -> String {
    if value == 0.0 || value.abs() < 1e-9 * step {
        return "0".into();
    }
    if !(1e-3..1e5).contains(&largest.abs()) {
        let top = value.abs().log10().floor();
        let mantissa = value / power_of_ten(top);
        let digits = (top - step.abs().log10().floor()).clamp(0.0, 6.0) as usize;
        let text = format!("{mantissa:.digits$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return match text {
            "1" => format!("10{}", superscript(top as i32)),
            "-1" => format!("−10{}", superscript(top as i32)),
            text => format!("{}·10{}", text.replace('-', "−"), superscript(top as i32)),
        };
    }
    let decimals = (0..12).find(|&d| {
        let scaled = step * 10f64.powi(d);
        (scaled - scaled.round()).abs() < 1e-6 * scaled.abs()
    });
    let decimals = decimals.unwrap_or(12) as usize;
    format!("{value:.decimals$}").replace('-', "−")
}

/// A value to so many significant digits, with a typographic minus.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    let text = corpuscle_io::number::significant(value, digits);
    match text.split_once('e') {
        Some((mantissa, exponent)) if exponent.parse::<i32>().is_ok() => {
            let power = superscript(exponent.parse().unwrap_or(0));
            let mantissa = mantissa.replace('-', "−");
            if mantissa == "1" { format!("10{power}") } else { format!("{mantissa}·10{power}") }
        }
        _ => text.replace('-', "−"),
    }
}

/// A measurement with its error, rounded by it.
pub(crate) fn with_error(value: f64, error: Option<f64>) -> String {
    corpuscle_io::number::typeset(&corpuscle_io::number::rounded(value, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_read_well() {
        for (value, step, largest, text) in [
            (0.25, 0.05, 1.0, "0.25"),
            (-3.0, 1.0, 5.0, "−3"),
            (1e-17, 0.1, 1.0, "0"),
            (5e-4, 5e-4, 3e-3, "0.0005"),
            (2e-7, 1e-7, 5e-7, "2·10⁻⁷"),
            (1e6, 5e5, 2e6, "10⁶"),
            (1.5e6, 5e5, 2e6, "1.5·10⁶"),
            (1200.0, 100.0, 2000.0, "1200"),
        ] {
            assert_eq!(tick(value, step, largest), text);
        }
    }

    #[test]
    fn round_lengths_are_below() {
        for (x, round) in [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (0.049, 0.02), (7e5, 5e5)] {
            assert_eq!(one_two_five_below(x), round);
        }
    }

    #[test]
    fn numbers_have_their_minus_and_powers() {
        assert_eq!(significant(-1.5e-13, 3), "−1.5·10⁻¹³");
        assert_eq!(significant(1e-6, 3), "10⁻⁶");
        assert_eq!(significant(0.25, 3), "0.25");
    }
}
