//! What a case reports.

use corpuscle_observe::Estimate;

/// A number with its name, and where there are such, its standard error and what theory says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Key: whole words joined by underscores, with the unit where there is one.
    pub key: &'static str,
    /// The value; not a number where it could not be measured.
    pub value: f64,
    /// Standard error of a measured mean; not a number where the run was too short to know it.
    pub standard_error: Option<f64>,
    /// The value of theory.
    pub theory: Option<f64>,
}

impl Figure {
    /// A plain number.
    pub const fn new(key: &'static str, value: f64) -> Self {
        Self { key, value, standard_error: None, theory: None }
    }

    /// A measured mean beside its theory, where theory has something to say.
    pub const fn measured(key: &'static str, estimate: Estimate, theory: Option<f64>) -> Self {
        Self { key, value: estimate.mean, standard_error: Some(estimate.standard_error), theory }
    }
}
