//! Numbers for people: as many digits as the standard error supports.

/// A measurement in words: mantissa and error to the same decimal place, and a common power of ten where that reads
/// better.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rounded {
    /// The value, divided by the power of ten.
    pub value: String,
    /// The standard error, likewise; absent where there is none.
    pub error: Option<String>,
    /// The power of ten, zero when there is none.
    pub exponent: i32,
}

/// Rounds a measurement: the standard error to two significant digits, the value to the same place.
///
/// ```
/// use corpuscle_io::number::{plain, rounded};
/// assert_eq!(plain(&rounded(1.023_41, Some(0.001_23))), "1.0234 ± 0.0012");
/// assert_eq!(plain(&rounded(3.214e-6, Some(0.12e-6))), "(3.21 ± 0.12)e-6");
/// assert_eq!(plain(&rounded(2.5, None)), "2.5");
/// ```
pub fn rounded(value: f64, error: Option<f64>) -> Rounded {
    match error {
        Some(error) if error > 0.0 && error.is_finite() && value.is_finite() => {
            let leading = exponent_of(error, 2);
            let top = exponent_of(value, 2).max(leading);
            let exponent = if (-3..=5).contains(&top) { 0 } else { top };
            let decimals = (1 - leading + exponent).clamp(0, 17) as usize;
            let scale = |x: f64| format!("{:.decimals$}", scaled(x, exponent));
            Rounded { value: scale(value), error: Some(scale(error)), exponent }
        }
        _ => Rounded { error: error.map(|error| significant(error, 2)), ..alone(value, 5) },
    }
}

/// A value to so many significant digits, without trailing zeros, in scientific notation where that is shorter.
///
/// ```
/// use corpuscle_io::number::significant;
/// assert_eq!(significant(0.1 + 0.2, 5), "0.3");
/// assert_eq!(significant(1.5e-13, 3), "1.5e-13");
/// assert_eq!(significant(-1234567.0, 4), "-1.235e6");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    plain(&alone(value, digits))
}

/// Plain text, for a terminal.
pub fn plain(number: &Rounded) -> String {
    let power = if number.exponent == 0 { String::new() } else { format!("e{}", number.exponent) };
    join(number, &power)
}

/// Typeset text with the minus sign and superscripts of Unicode.
///
/// ```
/// use corpuscle_io::number::{rounded, typeset};
/// assert_eq!(typeset(&rounded(-3.2e-6, Some(0.1e-6))), "(−3.20 ± 0.10) × 10⁻⁶");
/// ```
pub fn typeset(number: &Rounded) -> String {
    if number.exponent == 0 {
        return join(number, "").replace('-', "−");
    }
    let power = format!("10{}", superscript(number.exponent));
    if number.error.is_none() && number.value == "1" {
        return power;
    }
    let power = format!(" × {power}");
    join(number, &power).replace('-', "−")
}

/// A whole number in superscript digits.
pub fn superscript(number: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    number.to_string().chars().map(|c| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])).collect()
}

/// A whole number in groups of three digits, with thin spaces.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join("\u{202f}")
}

fn join(number: &Rounded, power: &str) -> String {
    match &number.error {
        None => format!("{}{power}", number.value),
        Some(error) if power.is_empty() => format!("{} ± {error}", number.value),
        Some(error) => format!("({} ± {error}){power}", number.value),
    }
}

/// A value without error.
fn alone(value: f64, digits: usize) -> Rounded {
    if !value.is_finite() {
        return Rounded { value: value.to_string(), error: None, exponent: 0 };
    }
    let top = exponent_of(value, digits);
    let exponent = if value == 0.0 || (-3..=5).contains(&top) { 0 } else { top };
    let decimals = (digits as i32 - 1 - top + exponent).clamp(0, 17) as usize;
    let text = format!("{:.decimals$}", scaled(value, exponent));
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    Rounded { value: if text == "-0" { "0".into() } else { text.into() }, error: None, exponent }
}

/// Decimal exponent of a value once rounded to so many digits: 0.999 becomes 1.0.
fn exponent_of(value: f64, digits: usize) -> i32 {
    let text = format!("{:.*e}", digits - 1, value.abs());
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// `value / 10^exponent`, in decimal so that it is neither lost nor rounded twice for tiny values.
fn scaled(value: f64, exponent: i32) -> f64 {
    if exponent == 0 {
        return value;
    }
    let text = format!("{value:e}");
    let Some((mantissa, own)) = text.split_once('e') else { return value };
    let own: i32 = own.parse().unwrap_or(0);
    format!("{mantissa}e{}", own - exponent).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_decides_the_digits() {
        for (value, error, text) in [
            (0.999_96, 0.000_096, "0.999960 ± 0.000096"),
            (9.99, 0.0996, "9.99 ± 0.10"),
            (1234.5, 12.0, "1234 ± 12"),
            (1.5e7, 2.0e5, "(1.500 ± 0.020)e7"),
            (0.0, 0.5, "0.00 ± 0.50"),
            (-1e-12, 3e-12, "(-1.0 ± 3.0)e-12"),
        ] {
            assert_eq!(plain(&rounded(value, Some(error))), text);
        }
        assert_eq!(plain(&rounded(f64::NAN, Some(0.1))), "NaN ± 0.1");
        assert_eq!(plain(&rounded(1.0, Some(f64::INFINITY))), "1 ± inf");
    }

    #[test]
    fn values_alone_keep_what_matters() {
        for (value, text) in [(0.0, "0"), (1.0, "1"), (999_999.0, "1e6"), (0.000_999_99, "9.9999e-4"), (5e-324, "5e-324")] {
            assert_eq!(significant(value, 5), text);
        }
        assert_eq!(significant(f64::MAX, 3), "1.8e308");
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(grouped(12), "12");
        assert_eq!(superscript(-12), "⁻¹²");
    }
}
