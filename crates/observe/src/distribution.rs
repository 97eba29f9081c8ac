//! The distributions that errors are judged by. All of them rest on `libm`, so that a score has the same bits everywhere.

use std::f64::consts::{FRAC_1_SQRT_2, LN_2, PI};

/// `ln Gamma(x)` for `x > 0`.
pub fn ln_gamma(x: f64) -> f64 {
    libm::lgamma(x)
}

/// `ln n!`
pub fn ln_factorial(n: u64) -> f64 {
    ln_gamma(n as f64 + 1.0)
}

/// Probability that a standard normal deviate is at most `x`.
pub fn normal_cdf(x: f64) -> f64 {
    normal_upper_tail(-x)
}

/// Probability that a standard normal deviate exceeds `x`, without cancellation far out.
pub fn normal_upper_tail(x: f64) -> f64 {
    0.5 * libm::erfc(x * FRAC_1_SQRT_2)
}

/// The `x` below which a standard normal deviate lies with probability `p`.
pub fn normal_quantile(p: f64) -> f64 {
    if p < 0.5 { -normal_upper_quantile(p) } else { normal_upper_quantile(1.0 - p) }
}

/// The `x` that a standard normal deviate exceeds with probability `tail`: accurate for the smallest tails, down to
/// 1e-300, where it saturates at 37.05.
///
/// Newton's method on `ln Q(x) = ln tail`. `ln Q` is concave and `Q(x) <= exp(-x^2/2) / 2`, so that from the root of the
/// bound the iteration descends monotonically on the root of `Q`.
pub fn normal_upper_quantile(tail: f64) -> f64 {
    if !(0.0..=1.0).contains(&tail) {
        return f64::NAN;
    }
    if tail > 0.5 {
        return -normal_upper_quantile(1.0 - tail);
    }
    let tail = tail.max(1e-300);
    let mut x = (-2.0 * (LN_2 + libm::log(tail))).max(0.0).sqrt();
    for _ in 0..60 {
        let q = normal_upper_tail(x);
        let density = libm::exp(-0.5 * x * x) / (2.0 * PI).sqrt();
        let step = libm::log(q / tail) * q / density;
        x += step;
        if step.abs() <= 1e-15 * (1.0 + x) {
            break;
        }
    }
    x
}

/// Probability that Student's `t` with `degrees_of_freedom` (any positive number) exceeds `t`:
/// `I_x(nu/2, 1/2) / 2` with `x = nu / (nu + t^2)` (Student 1908, doi:10.1093/biomet/6.1.1).
pub fn student_upper_tail(t: f64, degrees_of_freedom: f64) -> f64 {
    let nu = degrees_of_freedom;
    let whole = nu + t * t;
    let tail = 0.5 * incomplete_beta_with_complement(nu / whole, t * t / whole, 0.5 * nu, 0.5);
    if t < 0.0 { 1.0 - tail } else { tail }
}

/// The standard normal deviate that is exceeded with the same probability as Student's `t`.
///
/// With it a mean over few replicas gives a score that is standard normal, whatever their number: `t = 4` from three
/// replicas is a score of 1.9 only. Infinitely many degrees of freedom return `t` itself.
pub fn normal_score_of_student(t: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom > 1e7 {
        return t; // the two differ by t^3 / (4 nu), below 1e-5 up to t = 7
    }
    if t.is_nan() || degrees_of_freedom.is_nan() || degrees_of_freedom <= 0.0 {
        return f64::NAN;
    }
    normal_upper_quantile(student_upper_tail(t.abs(), degrees_of_freedom)).copysign(t)
}

/// The standard normal score of `chi^2` with `nu` degrees of freedom (Wilson and Hilferty 1931, doi:10.1073/pnas.17.12.684):
/// `z = ((chi^2/nu)^(1/3) - 1 + 2/(9 nu)) / sqrt(2/(9 nu))`. Good to some hundredths for `nu >= 3` and `|z| < 4`.
pub fn normal_score_of_chi_squared(chi_squared: f64, degrees_of_freedom: f64) -> f64 {
    let v = 2.0 / (9.0 * degrees_of_freedom);
    (libm::cbrt(chi_squared / degrees_of_freedom) - 1.0 + v) / v.sqrt()
}

/// The regularised incomplete beta function `I_x(a, b)` for `0 <= x <= 1`, `a, b > 0`.
pub fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    incomplete_beta_with_complement(x, 1.0 - x, a, b)
}

/// `I_x(a, b)` by its continued fraction, DLMF 8.17.22 (<https://dlmf.nist.gov/8.17.E22>), from the side on which the
/// fraction converges fast; `y = 1 - x` is handed over so that neither end loses digits.
fn incomplete_beta_with_complement(x: f64, y: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if y <= 0.0 {
        return 1.0;
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta_with_complement(y, x, b, a);
    }
    let ln_front = a * libm::log(x) + b * libm::log(y) + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b);
    let coefficient = |n: u32| {
        let m = f64::from(n / 2);
        if n.is_multiple_of(2) {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        }
    };
    // Lentz's method: numerators and denominators of neighbouring convergents as ratios, which stay near one.
    let (mut fraction, mut c, mut d) = (1.0, 1.0, 0.0);
    for n in 1..20_000 {
        let step = coefficient(n);
        d = 1.0 / (1.0 + step * d);
        c = 1.0 + step / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    libm::exp(ln_front) / (a * fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_undoes_the_tail_over_three_hundred_decades() {
        for x in [0.0, 0.1, 1.0, 2.5, 6.0, 12.0, 20.0, 36.0] {
            let back = normal_upper_quantile(normal_upper_tail(x));
            // erfc is good to some ulp, and dx = dQ/phi, which is Q/phi ~ 1/x (or 1.3 at the origin) times that.
            assert!((back - x).abs() < 1e-14 * (1.0 + x), "{x}: {back}");
        }
        assert!((normal_quantile(0.025) + normal_quantile(0.975)).abs() < 1e-14);
        assert_eq!(normal_upper_quantile(0.0), normal_upper_quantile(1e-300));
    }

    /// One, two and four degrees of freedom have closed forms.
    #[test]
    fn student_agrees_with_its_closed_forms() {
        for t in [0.0, 0.3, 1.0, 4.0, 50.0] {
            let cauchy = 0.5 - libm::atan(t) / PI;
            assert!((student_upper_tail(t, 1.0) - cauchy).abs() < 1e-14);
            let u = t / (t * t + 2.0).sqrt();
            assert!((student_upper_tail(t, 2.0) - 0.5 * (1.0 - u)).abs() < 1e-14);
            let w = t / (t * t + 4.0).sqrt();
            assert!((student_upper_tail(t, 4.0) - (0.5 - 0.75 * (w - w * w * w / 3.0))).abs() < 1e-14);
        }
    }

    /// Cornish and Fisher's first term: `t - z -> (t^3 + t) / (4 nu)`, the next being of order `1/nu^2`.
    #[test]
    fn student_tends_to_the_normal() {
        for t in [-3.0, 0.5, 3.0f64] {
            let shift = (t - normal_score_of_student(t, 1e5)) * 4e5 / (t * t * t + t);
            assert!((shift - 1.0).abs() < 1e-3, "{shift}");
        }
        assert_eq!(normal_score_of_student(2.0, f64::INFINITY), 2.0);
        assert!((normal_score_of_student(4.0, 2.0) - 1.9).abs() < 0.05);
    }

    /// With an even number of degrees of freedom the tail is a finite sum, `exp(-c/2) sum (c/2)^k / k!`.
    #[test]
    fn wilson_and_hilferty_are_good_to_hundredths() {
        for nu in [4u32, 10, 40, 100] {
            for part in [0.5, 1.0, 1.5, 2.0] {
                let half = 0.5 * part * f64::from(nu);
                let (mut term, mut sum) = (1.0, 0.0);
                for k in 0..nu / 2 {
                    sum += term;
                    term *= half / f64::from(k + 1);
                }
                let exact = normal_upper_quantile(libm::exp(-half) * sum);
                let close = normal_score_of_chi_squared(2.0 * half, f64::from(nu));
                assert!(exact.abs() > 4.5 || (exact - close).abs() < 0.05, "{nu} {part}: {exact} {close}");
            }
        }
    }

    /// For whole `a` and `b` the incomplete beta is a binomial tail.
    #[test]
    fn incomplete_beta_is_a_binomial_tail() {
        let (n, from, p) = (9u64, 4u64, 0.37f64);
        let tail: f64 = (from..=n)
            .map(|k| {
                let ln = ln_factorial(n) - ln_factorial(k) - ln_factorial(n - k);
                libm::exp(ln + k as f64 * libm::log(p) + (n - k) as f64 * libm::log(1.0 - p))
            })
            .sum();
        assert!((incomplete_beta(p, from as f64, (n - from + 1) as f64) - tail).abs() < 1e-14);
    }
}
