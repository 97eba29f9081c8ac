//! Bonds between given particles.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

fn once() -> usize {
    1
}

/// Springs between two particles, or along a row of them.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elastic {
    /// Index of one end.
    pub first: usize,
    /// Index of the other.
    pub second: usize,
    /// How many: the ends of each are the next particles after those of the one before.
    #[serde(default = "once")]
    pub count: usize,
    /// Stiffness `kappa`.
    pub stiffness: f64,
    /// Length at rest.
    #[serde(default)]
    pub rest_length: f64,
    /// Damping coefficient along the spring.
    #[serde(default)]
    pub damping: f64,
    /// `alpha` of the tension `kappa (x + alpha x^2 + beta x^3)`.
    #[serde(default)]
    pub quadratic: f64,
    /// `beta` of it.
    #[serde(default)]
    pub cubic: f64,
}

/// FENE bonds: springs that nothing stretches to a certain length.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Finite {
    /// Index of one end.
    pub first: usize,
    /// Index of the other.
    pub second: usize,
    /// How many, as of springs.
    #[serde(default = "once")]
    pub count: usize,
    /// Stiffness of short bonds.
    pub stiffness: f64,
    /// The length never reached.
    pub longest: f64,
}

/// Springs of the Toda lattice.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Exponential {
    /// Index of one end.
    pub first: usize,
    /// Index of the other.
    pub second: usize,
    /// How many, as of springs.
    #[serde(default = "once")]
    pub count: usize,
    /// Stiffness at rest.
    pub stiffness: f64,
    /// Inverse of the length on which it falls with the extension.
    pub steepness: f64,
    /// Length at rest.
    pub rest_length: f64,
}
