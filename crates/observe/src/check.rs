//! A check against theory is data: the same one feeds the live chart, the report, `summary.json`, the exit code and the tests.

use serde::Serialize;

use crate::distribution::normal_score_of_student;

/// How a measurement is held against its expectation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// A statistical estimate: its standard score `z` must lie within [`Check::Z_LIMIT`].
    Agreement,
    /// A bound that is derived, not statistical, such as the energy error of an integrator: `measured <= expected`.
    AtMost,
    /// The same in the other direction: `measured >= expected`.
    AtLeast,
}

/// One quantity beside its theory.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// What was measured, in words with its symbol.
    pub quantity: String,
    /// Unit; empty when reduced or dimensionless.
    pub unit: String,
    /// The measured value.
    pub measured: f64,
    /// Its standard error, from blocking or over replicas; absent where the verdict is a bound.
    pub standard_error: Option<f64>,
    /// Degrees of freedom of that error; absent where it is known or there is none.
    pub degrees_of_freedom: Option<f64>,
    /// What theory says, or the bound.
    pub expected: f64,
    /// Standard normal score of the difference; absent where the verdict is a bound. It is `(measured - expected) /
    /// standard_error` when the error is known; from few replicas or blocks, the normal deviate as improbable as that `t`.
    pub z: Option<f64>,
    /// How the two are compared.
    pub verdict: Verdict,
    /// Whether the check holds.
    pub passed: bool,
    /// Where the expectation comes from: a formula, a citation, a limit.
    pub reference: String,
}

impl Check {
    /// Standard scores beyond which agreement is denied. A normal deviate exceeds 4 once in 15,787: a class of thirty
    /// that prints five tables of ten checks sees one false alarm in about ten such afternoons.
    pub const Z_LIMIT: f64 = 4.0;

    /// A measurement with a standard error beside its expectation.
    ///
    /// It fails when `|z| >` [`Check::Z_LIMIT`], and also when value or error are not finite or the error is zero where
    /// the values differ: an estimate without an error is not an agreement.
    pub fn agreement(
        quantity: impl Into<String>,
        measured: f64,
        standard_error: f64,
        expected: f64,
        reference: impl Into<String>,
    ) -> Self {
        Self::agreement_with_dof(quantity, measured, standard_error, f64::INFINITY, expected, reference)
    }

    /// The same with a standard error that was itself estimated, from `degrees_of_freedom + 1` replicas or blocks:
    /// Student's `t` is converted to the normal deviate that is exceeded with the same probability, so that
    /// [`Check::Z_LIMIT`] stands for the same probability whatever the number of replicas.
    pub fn agreement_with_dof(
        quantity: impl Into<String>,
        measured: f64,
        standard_error: f64,
        degrees_of_freedom: f64,
        expected: f64,
        reference: impl Into<String>,
    ) -> Self {
        let t = if measured == expected { 0.0 } else { (measured - expected) / standard_error };
        let z = normal_score_of_student(t, degrees_of_freedom);
        let mut check = Self::scored(quantity, measured, standard_error, expected, z, reference);
        check.degrees_of_freedom = degrees_of_freedom.is_finite().then_some(degrees_of_freedom);
        check
    }

    /// A statistic whose distribution is not the normal one, with the normal score `z` that is as improbable.
    pub fn scored(
        quantity: impl Into<String>,
        measured: f64,
        standard_error: f64,
        expected: f64,
        z: f64,
        reference: impl Into<String>,
    ) -> Self {
        let passed = z.abs() <= Self::Z_LIMIT && standard_error.is_finite();
        Self::new(quantity.into(), measured, Some(standard_error), expected, Some(z), Verdict::Agreement, passed, reference.into())
    }

    /// A numerical error that may not exceed `bound`.
    pub fn at_most(quantity: impl Into<String>, measured: f64, bound: f64, reference: impl Into<String>) -> Self {
        Self::new(quantity.into(), measured, None, bound, None, Verdict::AtMost, measured <= bound, reference.into())
    }

    /// A value that must reach `bound`.
    pub fn at_least(quantity: impl Into<String>, measured: f64, bound: f64, reference: impl Into<String>) -> Self {
        Self::new(quantity.into(), measured, None, bound, None, Verdict::AtLeast, measured >= bound, reference.into())
    }

    /// The same check with a unit.
    #[must_use]
    pub fn with_unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }

    #[allow(clippy::too_many_arguments)] // private: the constructors above name what they pass
    fn new(
        quantity: String,
        measured: f64,
        standard_error: Option<f64>,
        expected: f64,
        z: Option<f64>,
        verdict: Verdict,
        passed: bool,
        reference: String,
    ) -> Self {
        let (unit, degrees_of_freedom) = (String::new(), None);
        Self { quantity, unit, measured, standard_error, degrees_of_freedom, expected, z, verdict, passed, reference }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_agreement_is_judged_by_its_standard_scores() {
        assert!(Check::agreement("Z", 1.03, 0.01, 1.0, "").passed);
        assert!(!Check::agreement("Z", 1.05, 0.01, 1.0, "").passed);
        assert_eq!(Check::agreement("Z", 1.02, 0.01, 1.0, "").z.map(f64::round), Some(2.0));
    }

    #[test]
    fn few_replicas_weigh_less() {
        let check = |dof| Check::agreement_with_dof("Z", 1.1, 0.01, dof, 1.0, "");
        assert!(check(1.0).passed && !check(20.0).passed && !check(f64::INFINITY).passed);
    }

    #[test]
    fn a_measurement_without_error_or_without_value_never_passes() {
        assert!(!Check::agreement("Z", 1.0 + 1e-9, 0.0, 1.0, "").passed);
        assert!(!Check::agreement("Z", f64::NAN, 0.1, 1.0, "").passed);
        assert!(!Check::agreement("Z", 1.1, f64::INFINITY, 1.0, "").passed);
        assert!(!Check::agreement_with_dof("Z", 1.1, 0.1, 0.0, 1.0, "").passed);
        assert!(!Check::at_most("drift", f64::NAN, 1.0, "").passed);
    }
}
