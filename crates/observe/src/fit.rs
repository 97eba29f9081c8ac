//! Straight lines through measured points, and power laws through their logarithms.

use crate::distribution::normal_score_of_chi_squared;
use crate::{Check, Estimate};

/// A fitted line `y = intercept + slope x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Slope with its standard error.
    pub slope: Estimate,
    /// Intercept with its standard error; exactly zero for a line through the origin.
    pub intercept: Estimate,
    /// Covariance of slope and intercept.
    pub covariance: f64,
    /// Sum of squared residuals, each over the square of its point's standard error.
    pub chi_squared: f64,
    /// Points less fitted parameters.
    pub degrees_of_freedom: f64,
}

impl Line {
    /// Value of the line at `x` with its standard error.
    pub fn at(&self, x: f64) -> Estimate {
        let (a, b) = (self.intercept.standard_error, self.slope.standard_error);
        let variance = a * a + 2.0 * x * self.covariance + x * x * b * b;
        Estimate { mean: self.intercept.mean + self.slope.mean * x, standard_error: variance.max(0.0).sqrt(), ..self.slope }
    }

    /// Whether the points lie on a line: `chi^2` per degree of freedom against 1.
    pub fn check_straight(&self, quantity: impl Into<String>, reference: impl Into<String>) -> Check {
        let nu = self.degrees_of_freedom;
        let z = normal_score_of_chi_squared(self.chi_squared, nu);
        Check::scored(quantity, self.chi_squared / nu, (2.0 / nu).sqrt(), 1.0, z, reference)
    }
}

/// The line of least `chi^2` through points `(x, y, standard error of y)` whose errors are known and independent.
///
/// None when there are fewer than two different abscissae, or an error that is not a positive number.
pub fn line(points: &[(f64, f64, f64)]) -> Option<Line> {
    let weights = weights(points)?;
    let s: f64 = weights.iter().sum();
    let mean_x = points.iter().zip(&weights).map(|(p, w)| w * p.0).sum::<f64>() / s;
    // About the weighted mean, slope and value are uncorrelated, and nothing cancels.
    let spread: f64 = points.iter().zip(&weights).map(|(p, w)| w * (p.0 - mean_x) * (p.0 - mean_x)).sum();
    if spread <= 0.0 || spread.is_nan() {
        return None;
    }
    let mean_y = points.iter().zip(&weights).map(|(p, w)| w * p.1).sum::<f64>() / s;
    let slope = points.iter().zip(&weights).map(|(p, w)| w * (p.0 - mean_x) * (p.1 - mean_y)).sum::<f64>() / spread;
    let intercept = mean_y - slope * mean_x;
    Some(Line {
        slope: Estimate::new(slope, (1.0 / spread).sqrt()),
        intercept: Estimate::new(intercept, (1.0 / s + mean_x * mean_x / spread).sqrt()),
        covariance: -mean_x / spread,
        chi_squared: chi_squared(points, intercept, slope),
        degrees_of_freedom: points.len() as f64 - 2.0,
    })
}

/// The line through the origin of least `chi^2`, `y = slope x`; otherwise as [`line`].
pub fn proportion(points: &[(f64, f64, f64)]) -> Option<Line> {
    let weights = weights(points)?;
    let spread: f64 = points.iter().zip(&weights).map(|(p, w)| w * p.0 * p.0).sum();
    if spread <= 0.0 || spread.is_nan() {
        return None;
    }
    let slope = points.iter().zip(&weights).map(|(p, w)| w * p.0 * p.1).sum::<f64>() / spread;
    Some(Line {
        slope: Estimate::new(slope, (1.0 / spread).sqrt()),
        intercept: Estimate::exact(0.0),
        covariance: 0.0,
        chi_squared: chi_squared(points, 0.0, slope),
        degrees_of_freedom: points.len() as f64 - 1.0,
    })
}

/// The least-squares line through points of equal but unknown error, which their scatter about the line estimates with
/// `n - 2` degrees of freedom. Such a line cannot be asked whether it is straight: its `chi^2` is `n - 2` by construction.
pub fn line_by_scatter(points: &[(f64, f64)]) -> Option<Line> {
    let unit: Vec<_> = points.iter().map(|&(x, y)| (x, y, 1.0)).collect();
    let fit = line(&unit)?;
    let nu = fit.degrees_of_freedom;
    let variance = fit.chi_squared / nu;
    let scale = |e: Estimate| Estimate { mean: e.mean, standard_error: e.standard_error * variance.sqrt(), degrees_of_freedom: nu };
    Some(Line {
        slope: scale(fit.slope),
        intercept: scale(fit.intercept),
        covariance: fit.covariance * variance,
        chi_squared: nu,
        degrees_of_freedom: nu,
    })
}

/// The power law `y = exp(intercept) x^slope` through points `(x, y, standard error of y)` with positive `x` and `y`:
/// the [`line`] through their logarithms, whose errors are the relative errors of `y`. The logarithm of a noisy value is
/// low by half its squared relative error, so relative errors should stay below a tenth.
pub fn power_law(points: &[(f64, f64, f64)]) -> Option<Line> {
    if !points.iter().all(|p| p.0 > 0.0 && p.1 > 0.0) {
        return None;
    }
    line(&points.iter().map(|&(x, y, e)| (libm::log(x), libm::log(y), e / y)).collect::<Vec<_>>())
}

fn weights(points: &[(f64, f64, f64)]) -> Option<Vec<f64>> {
    let usable = !points.is_empty() && points.iter().all(|p| p.2 > 0.0 && p.2.is_finite());
    usable.then(|| points.iter().map(|p| 1.0 / (p.2 * p.2)).collect())
}

fn chi_squared(points: &[(f64, f64, f64)], intercept: f64, slope: f64) -> f64 {
    points
        .iter()
        .map(|&(x, y, e)| {
            let residual = (y - intercept - slope * x) / e;
            residual * residual
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use corpuscle_core::Random;

    fn noisy(seed: u64, intercept: f64, slope: f64) -> Vec<(f64, f64, f64)> {
        let mut random = Random::new(seed, 11);
        (0..9u32)
            .map(|k| {
                let (x, e) = (1.0 + f64::from(k), 0.1 + 0.05 * f64::from(k));
                (x, intercept + slope * x + e * random.normal(), e)
            })
            .collect()
    }

    #[test]
    fn slopes_intercepts_values_and_chi_squared_are_standard_normal() {
        let fits: Vec<Line> = (0..3000).map(|seed| line(&noisy(seed, 2.0, -0.7)).unwrap()).collect();
        let scores = |f: &dyn Fn(&Line) -> f64| fits.iter().map(f).collect::<Vec<_>>();
        assert_standard_normal("slope", &scores(&|l| l.slope.score(-0.7)));
        assert_standard_normal("intercept", &scores(&|l| l.intercept.score(2.0)));
        assert_standard_normal("value", &scores(&|l| l.at(6.5).score(2.0 - 0.7 * 6.5)));
        let reduced: Vec<f64> = fits.iter().map(|l| (l.chi_squared - 7.0) / 14f64.sqrt()).collect();
        let (mean, _) = crate::estimate::mean_and_variance(&reduced);
        assert!((mean * 3000f64.sqrt()).abs() < 4.0, "chi^2 has mean n - 2: {mean}");
    }

    #[test]
    fn proportions_are_standard_normal() {
        let scores: Vec<f64> = (0..3000).map(|seed| proportion(&noisy(seed, 0.0, 1.3)).unwrap().slope.score(1.3)).collect();
        assert_standard_normal("proportion", &scores);
    }

    #[test]
    fn unknown_errors_are_learnt_from_the_scatter() {
        let scores: Vec<f64> = (0..3000)
            .map(|seed| {
                let mut random = Random::new(seed, 12);
                let points: Vec<_> = (0..5).map(|k| (f64::from(k), 1.0 + 2.0 * f64::from(k) + random.normal())).collect();
                line_by_scatter(&points).unwrap().slope.score(2.0)
            })
            .collect();
        assert_standard_normal("slope by scatter", &scores);
    }

    #[test]
    fn a_power_law_is_found_exactly() {
        let points: Vec<_> = (1..6).map(|k| (f64::from(k), 3.0 / f64::from(k), 0.01)).collect();
        let fit = power_law(&points).unwrap();
        assert!((fit.slope.mean + 1.0).abs() < 1e-14 && (fit.intercept.mean - libm::log(3.0)).abs() < 1e-14);
    }

    #[test]
    fn what_cannot_be_fitted_is_none() {
        assert!(line(&[]).is_none() && line(&[(1.0, 1.0, 0.1), (1.0, 2.0, 0.1)]).is_none());
        assert!(line(&[(1.0, 1.0, 0.0), (2.0, 2.0, 0.1)]).is_none() && power_law(&[(0.0, 1.0, 0.1)]).is_none());
    }
}
