//! What stands or moves in the box besides particles, as a scenario file spells it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::AxisName;

/// One wall of the box that is more than hard and still.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Axis it is perpendicular to.
    pub axis: AxisName,
    /// Which of the two walls across that axis.
    pub side: Side,
    /// Temperature `k_B T` at which particles leave it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// Where it is: points `[time, coordinate]`, straight lines between them, at rest before and after.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<Vec<[f64; 2]>>,
    /// In place of a path, a swing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub oscillation: Option<Swing>,
    /// Physical time from which on it is gone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opened_at: Option<f64>,
}

/// Which of the two walls across an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The one with the smaller coordinate.
    Lower,
    /// The one with the larger coordinate.
    Upper,
}

impl Side {
    /// As the file spells it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
        }
    }
}

/// A coordinate that swings: `centre + amplitude sin(angular_frequency t + phase)`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Swing {
    /// Coordinate in the middle.
    pub centre: f64,
    /// Largest distance from there.
    pub amplitude: f64,
    /// Radians per time.
    pub angular_frequency: f64,
    /// Radians at time 0.
    #[serde(default)]
    pub phase: f64,
}

/// A fixed hard sphere (disc).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Peg {
    /// Its centre.
    pub centre: Vec<f64>,
    /// Its radius.
    pub radius: f64,
}

/// A movable plane of finite mass across the box.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Axis it moves along.
    pub axis: AxisName,
    /// Coordinate at the start.
    pub position: f64,
    /// Velocity at the start.
    #[serde(default)]
    pub velocity: f64,
    /// Its mass.
    pub mass: f64,
    /// Constant force on it along the axis.
    #[serde(default)]
    pub force: f64,
    /// Lowest and highest coordinate; the walls of the box when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops: Option<[f64; 2]>,
}

/// Places without order: particles grow from points while they fly.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grown {
    /// Part of its radius by which a particle grows while it flies a mean diameter.
    #[serde(default = "usual_rate")]
    pub rate: f64,
}

fn usual_rate() -> f64 {
    0.01
}
