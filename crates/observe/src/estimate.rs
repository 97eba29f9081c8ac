//! A measured value with its standard error, and the arithmetic of both.

use std::ops::{Add, Div, Mul, Sub};

use serde::Serialize;

use crate::Check;
use crate::distribution::normal_score_of_student;

/// A mean and its standard error, and how well the error itself is known.
///
/// Errors propagate to first order through the operators, both operands being independent; the degrees of freedom then
/// combine as Welch and Satterthwaite have it (doi:10.2307/3002019). For correlated operands use [`Estimate::jackknife`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Estimate {
    /// The value.
    pub mean: f64,
    /// Standard error of the value; not a number where it cannot be known.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error: `R - 1` from `R` replicas, infinite when the error is known.
    pub degrees_of_freedom: f64,
}

impl Estimate {
    /// A value whose standard error is known.
    pub const fn new(mean: f64, standard_error: f64) -> Self {
        Self { mean, standard_error, degrees_of_freedom: f64::INFINITY }
    }

    /// A value without error.
    pub const fn exact(value: f64) -> Self {
        Self::new(value, 0.0)
    }

    /// The same value with an error that rests on so many degrees of freedom.
    #[must_use]
    pub const fn with_degrees_of_freedom(mut self, degrees_of_freedom: f64) -> Self {
        self.degrees_of_freedom = degrees_of_freedom;
        self
    }

    /// Mean of independent replicas, its standard error `s / sqrt(R)` and `R - 1` degrees of freedom.
    ///
    /// Fewer than two replicas have no standard error: it is then not a number, and no check built on it passes.
    pub fn from_replicas(replicas: &[f64]) -> Self {
        let count = replicas.len() as f64;
        let (mean, variance) = mean_and_variance(replicas);
        Self { mean, standard_error: (variance / count).sqrt(), degrees_of_freedom: count - 1.0 }
    }

    /// A function of the means of `K` quantities measured together in each replica, such as a ratio, however they are
    /// correlated: the delete-one jackknife, with its bias of order `1/R` removed (Miller 1974, doi:10.1093/biomet/61.1.1).
    pub fn jackknife<const K: usize>(replicas: &[[f64; K]], function: impl Fn([f64; K]) -> f64) -> Self {
        let count = replicas.len() as f64;
        let mut total = [0.0; K];
        for replica in replicas {
            for (sum, value) in total.iter_mut().zip(replica) {
                *sum += value;
            }
        }
        let whole = function(total.map(|sum| sum / count));
        let without: Vec<f64> =
            replicas.iter().map(|r| function(std::array::from_fn(|k| (total[k] - r[k]) / (count - 1.0)))).collect();
        let (mean, variance) = mean_and_variance(&without);
        Self {
            mean: count * whole - (count - 1.0) * mean,
            standard_error: ((count - 1.0) * (count - 1.0) / count * variance).sqrt(),
            degrees_of_freedom: count - 1.0,
        }
    }

    /// `f(self)` where `derivative` is `f'` at the mean: the error to first order.
    #[must_use]
    pub fn map(self, value: f64, derivative: f64) -> Self {
        Self { mean: value, standard_error: self.standard_error * derivative.abs(), ..self }
    }

    /// Standard error over the value's magnitude.
    pub fn relative_error(self) -> f64 {
        self.standard_error / self.mean.abs()
    }

    /// The score of this estimate against an expectation: a standard normal deviate if the expectation is right.
    ///
    /// `(mean - expected) / standard_error` follows Student's distribution; it is converted to the normal deviate that is
    /// exceeded with the same probability, so that scores from two and from two hundred replicas mean the same.
    pub fn score(self, expected: f64) -> f64 {
        if self.mean == expected {
            return 0.0;
        }
        normal_score_of_student((self.mean - expected) / self.standard_error, self.degrees_of_freedom)
    }

    /// The check of this estimate against what theory says.
    pub fn check(self, quantity: impl Into<String>, expected: f64, reference: impl Into<String>) -> Check {
        let Self { mean, standard_error, degrees_of_freedom } = self;
        Check::agreement_with_dof(quantity, mean, standard_error, degrees_of_freedom, expected, reference)
    }

    /// The check of this estimate against another, independent one: their difference against zero.
    pub fn check_against(self, other: Self, quantity: impl Into<String>, reference: impl Into<String>) -> Check {
        let difference = self - other;
        let mut check = difference.check(quantity, 0.0, reference);
        (check.measured, check.expected) = (self.mean, other.mean);
        check
    }

    /// The sum of two independent errors in quadrature and its degrees of freedom (Welch and Satterthwaite).
    fn combine(mean: f64, first: (f64, f64), second: (f64, f64)) -> Self {
        let (a, b) = (first.0 * first.0, second.0 * second.0);
        let spread = a * a / first.1 + b * b / second.1;
        let degrees_of_freedom = if spread == 0.0 { f64::INFINITY } else { (a + b) * (a + b) / spread };
        Self { mean, standard_error: (a + b).sqrt(), degrees_of_freedom }
    }
}

impl Add for Estimate {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::combine(
            self.mean + other.mean,
            (self.standard_error, self.degrees_of_freedom),
            (other.standard_error, other.degrees_of_freedom),
        )
    }
}

impl Sub for Estimate {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul for Estimate {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::combine(
            self.mean * other.mean,
            (self.standard_error * other.mean, self.degrees_of_freedom),
            (other.standard_error * self.mean, other.degrees_of_freedom),
        )
    }
}

impl Div for Estimate {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let ratio = self.mean / other.mean;
        Self::combine(
            ratio,
            (self.standard_error / other.mean, self.degrees_of_freedom),
            (other.standard_error * ratio / other.mean, other.degrees_of_freedom),
        )
    }
}

impl Mul<f64> for Estimate {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self.map(self.mean * factor, factor)
    }
}

impl Div<f64> for Estimate {
    type Output = Self;
    fn div(self, divisor: f64) -> Self {
        self.map(self.mean / divisor, 1.0 / divisor)
    }
}

/// Mean and unbiased variance, in two passes.
pub(crate) fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    (mean, if values.len() < 2 { f64::NAN } else { square / (count - 1.0) })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use corpuscle_core::Random;

    /// Asserts that scores over many seeds are standard normal: mean 0, variance 1, each within four of its own standard
    /// errors `1/sqrt(n)` and `sqrt(2/n)`.
    pub(crate) fn assert_standard_normal(what: &str, scores: &[f64]) {
        let n = scores.len() as f64;
        let (mean, variance) = mean_and_variance(scores);
        let (z_mean, z_variance) = (mean * n.sqrt(), (variance - 1.0) * (n / 2.0).sqrt());
        println!("{what}: n = {n}, mean = {mean:.4} (z = {z_mean:.2}), variance = {variance:.4} (z = {z_variance:.2})");
        assert!(z_mean.abs() < 4.0 && z_variance.abs() < 4.0, "{what}: mean {mean}, variance {variance} of {n} scores");
    }

    #[test]
    fn scores_from_few_replicas_are_standard_normal() {
        for replicas in [2, 3, 8] {
            let scores: Vec<f64> = (0..4000)
                .map(|seed| {
                    let mut random = Random::new(seed, 5);
                    let values: Vec<f64> = (0..replicas).map(|_| 3.0 + 2.0 * random.normal()).collect();
                    Estimate::from_replicas(&values).score(3.0)
                })
                .collect();
            assert_standard_normal(&format!("{replicas} replicas"), &scores);
        }
    }

    /// Two means of different spread and number: Welch's case.
    #[test]
    fn differences_of_independent_estimates_are_standard_normal() {
        let scores: Vec<f64> = (0..4000)
            .map(|seed| {
                let mut random = Random::new(seed, 6);
                let mut estimate = |n: usize, mean: f64, spread: f64| {
                    Estimate::from_replicas(&(0..n).map(|_| mean + spread * random.normal()).collect::<Vec<_>>())
                };
                (estimate(6, 5.0, 1.0) - estimate(12, 2.0, 3.0)).score(3.0)
            })
            .collect();
        assert_standard_normal("Welch", &scores);
    }

    /// A ratio of correlated means, where propagating independent errors would be wrong.
    #[test]
    fn jackknifed_ratios_are_standard_normal() {
        let scores: Vec<f64> = (0..4000)
            .map(|seed| {
                let mut random = Random::new(seed, 7);
                let pairs: Vec<[f64; 2]> = (0..20)
                    .map(|_| {
                        let common = random.normal();
                        [8.0 + common + 0.1 * random.normal(), 4.0 + 0.5 * common]
                    })
                    .collect();
                Estimate::jackknife(&pairs, |[a, b]| a / b).score(2.0)
            })
            .collect();
        assert_standard_normal("ratio", &scores);
    }

    #[test]
    fn products_and_quotients_propagate_relative_errors() {
        let (a, b) = (Estimate::new(3.0, 0.03), Estimate::new(4.0, 0.08));
        let expected = (0.01f64 * 0.01 + 0.02 * 0.02).sqrt();
        assert!(((a * b).relative_error() - expected).abs() < 1e-15);
        assert!(((a / b).relative_error() - expected).abs() < 1e-15);
        assert_eq!((a - Estimate::exact(1.0)).degrees_of_freedom, f64::INFINITY);
    }

    #[test]
    fn one_replica_has_no_error_and_passes_no_check() {
        assert!(!Estimate::from_replicas(&[1.0]).check("x", 1.0, "").passed);
        assert!(!Estimate::from_replicas(&[]).check("x", 1.0, "").passed);
    }
}
