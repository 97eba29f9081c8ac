//! Forces of all pairs, and from outside.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{AxisName, one};

/// Forces, each of all pairs or on all particles.
#[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Forces {
    /// Newton's gravity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravitation>,
    /// Charges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coulomb: Option<Charges>,
    /// The Lennard-Jones potential, truncated and shifted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lennard_jones: Option<Contact>,
    /// Its repulsive part (Weeks, Chandler, Andersen).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wca: Option<Contact>,
    /// A repulsion by a power of the distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inverse_power: Option<PowerLaw>,
    /// Screened charges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yukawa: Option<Screened>,
    /// Grains that overlap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub harmonic_repulsion: Option<Grain>,
    /// The Morse potential.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub morse: Option<Valley>,
    /// A field towards a centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub central: Option<Trap>,
    /// Friction with a medium at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drag: Option<Friction>,
    /// Forces from outside on single particles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub push: Vec<Push>,
}

/// Newton's gravity.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gravitation {
    /// Constant of gravity.
    #[serde(default = "one")]
    pub constant: f64,
    /// Plummer softening length.
    #[serde(default)]
    pub softening: f64,
    /// Opening angle of a tree; every pair by itself when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opening_angle: Option<f64>,
}

/// Charges, by the names of the particles.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Charges {
    /// Coulomb's constant.
    #[serde(default = "one")]
    pub constant: f64,
    /// Charge of each particle of a name; names left out have none.
    pub charges: BTreeMap<String, f64>,
    /// Error of the forces in a periodic box, relative to that of two charges at the mean distance; 1e-4 when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<f64>,
}

/// A pair potential of energy scale `epsilon` and length scale `sigma`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Depth.
    #[serde(default = "one")]
    pub epsilon: f64,
    /// Diameter.
    #[serde(default = "one")]
    pub sigma: f64,
    /// Cutoff in units of `sigma`; 2.5 when not given. The repulsive part has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<f64>,
    /// Whether the force, too, is shifted to vanish at the cutoff.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub force_shifted: bool,
    /// Other numbers between particles of two names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub between: Vec<Between>,
}

impl Default for Contact {
    fn default() -> Self {
        Self { epsilon: 1.0, sigma: 1.0, cutoff: None, force_shifted: false, between: vec![] }
    }
}

/// Numbers of a pair potential between particles of two names.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Between {
    /// The names: two different ones, or twice the same.
    pub names: [String; 2],
    /// Depth.
    #[serde(default = "one")]
    pub epsilon: f64,
    /// Diameter.
    #[serde(default = "one")]
    pub sigma: f64,
}

/// `epsilon (sigma/r)^exponent`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PowerLaw {
    /// Energy at the distance `sigma`.
    #[serde(default = "one")]
    pub epsilon: f64,
    /// Diameter.
    #[serde(default = "one")]
    pub sigma: f64,
    /// The power, 1 to 255.
    pub exponent: u8,
    /// Cutoff in units of `sigma`; 2.5 when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<f64>,
}

/// `epsilon (sigma/r) exp(-(r - sigma)/screening_length)`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Screened {
    /// Energy at the distance `sigma`; negative attracts.
    #[serde(default = "one")]
    pub epsilon: f64,
    /// Diameter.
    #[serde(default = "one")]
    pub sigma: f64,
    /// Length in which it falls to `1/e`, beside `1/r`.
    pub screening_length: f64,
    /// Cutoff in units of `sigma`; needed, for it depends on the screening.
    pub cutoff: f64,
}

/// `stiffness (diameter - r)^2/2` of grains that overlap.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grain {
    /// Stiffness.
    pub stiffness: f64,
    /// Distance below which they overlap.
    #[serde(default = "one")]
    pub diameter: f64,
}

/// `epsilon (exp(-2 steepness (r - equilibrium)) - 2 exp(-steepness (r - equilibrium)))`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Valley {
    /// Depth.
    #[serde(default = "one")]
    pub epsilon: f64,
    /// Place of the minimum.
    #[serde(default = "one")]
    pub equilibrium: f64,
    /// Inverse width.
    pub steepness: f64,
    /// Cutoff, in units of `equilibrium`; 2.5 when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<f64>,
}

/// The acceleration `-strength r^power` towards a centre at the distance `r`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Trap {
    /// The centre.
    pub centre: Vec<f64>,
    /// Acceleration at unit distance; negative pushes away.
    pub strength: f64,
    /// The power: 1, a harmonic trap, when not given.
    #[serde(default = "one")]
    pub power: f64,
}

/// The acceleration `-rate v`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// The rate.
    pub rate: f64,
}

/// The force `amplitude sin(angular_frequency t + phase)` on one particle, along a direction.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Push {
    /// Index of the particle.
    pub particle: usize,
    /// Direction; its length counts.
    pub direction: Vec<f64>,
    /// Amplitude.
    pub amplitude: f64,
    /// Angular frequency; 0 for a constant force, of phase pi/2.
    pub angular_frequency: f64,
    /// Phase.
    #[serde(default)]
    pub phase: f64,
    /// Time over which it is switched on smoothly.
    #[serde(default)]
    pub ramp: f64,
}

/// A coordinate that is moved, whatever the forces say: `amplitude sin(angular_frequency t + phase)` about where it would be at rest.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shaker {
    /// Index of the particle.
    pub particle: usize,
    /// The axis it is moved along.
    pub axis: AxisName,
    /// Amplitude.
    pub amplitude: f64,
    /// Angular frequency.
    pub angular_frequency: f64,
    /// Phase.
    #[serde(default)]
    pub phase: f64,
    /// Time over which it is switched on smoothly.
    #[serde(default)]
    pub ramp: f64,
}
