//! The description of a free system, as a scenario file spells it.

mod bonds;
mod forces;
mod start;
mod stepper;
mod walls;

use std::fmt;
use std::sync::Arc;

pub use bonds::{Elastic, Exponential, Finite};
pub use forces::{Between, Charges, Contact, Forces, Friction, Grain, Gravitation, PowerLaw, Push, Screened, Shaker, Trap, Valley};
use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
pub use start::{Imported, Start};
pub use stepper::Stepper;
pub use walls::{Cylinder, Grown, Peg, Side, Swing, Wall};

/// A system of the user's own: box, particles, interactions, engine, and what to observe for how long.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct System {
    /// Title shown on pictures and the report.
    #[serde(default = "default_title")]
    pub title: String,
    /// Which dynamics.
    pub engine: EngineKind,
    /// Physical time to run.
    pub duration: f64,
    /// Physical time between samples; a five-hundredth of the duration when not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_interval: Option<f64>,
    /// The box; its corners have two or three coordinates, which sets the dimension.
    #[serde(rename = "box")]
    pub room: Room,
    /// Thin hard plates in the box (event-driven engine).
    #[serde(default, rename = "partition", skip_serializing_if = "Vec::is_empty")]
    pub partitions: Vec<Plate>,
    /// Walls of the box that are warm, move, or open (event-driven engine).
    #[serde(default, rename = "face", skip_serializing_if = "Vec::is_empty")]
    pub walls: Vec<Wall>,
    /// Fixed round bodies (event-driven engine).
    #[serde(default, rename = "obstacle", skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Peg>,
    /// A movable plane across the box (event-driven engine).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub piston: Option<Cylinder>,
    /// How generated particles come to their places: on a lattice when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<Grown>,
    /// Particles of a frame of a trajectory; then no others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Start>,
    /// Those particles, once the file has been read.
    #[serde(skip)]
    pub imported: Option<Arc<Imported>>,
    /// Particles generated in number, without overlap.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub species: Vec<Species>,
    /// Particles placed one by one; their indices come before those of generated ones.
    #[serde(default, rename = "particle", skip_serializing_if = "Vec::is_empty")]
    pub particles: Vec<Single>,
    /// Springs between particles (time-driven engine).
    #[serde(default, rename = "spring", skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<Elastic>,
    /// Bonds of polymers (time-driven engine).
    #[serde(default, rename = "fene", skip_serializing_if = "Vec::is_empty")]
    pub finite: Vec<Finite>,
    /// Exponential springs (time-driven engine).
    #[serde(default, rename = "toda", skip_serializing_if = "Vec::is_empty")]
    pub exponential: Vec<Exponential>,
    /// Coordinates moved as prescribed (time-driven engine).
    #[serde(default, rename = "drive", skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<Shaker>,
    /// Uniform acceleration of all particles; none when left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub field: Vec<f64>,
    /// Rules of collision (event-driven engine).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub collisions: Option<Collisions>,
    /// Forces between particles and from outside (time-driven engine).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forces: Option<Forces>,
    /// Integrator and its step (time-driven engine).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integrator: Option<Stepper>,
    /// What to measure beside energy and momentum.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub observe: Vec<Observable>,
}

fn default_title() -> String {
    "A system of one's own".into()
}

/// The two engines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EngineKind {
    /// Hard particles, from collision to collision.
    Event,
    /// Soft particles, in steps of time.
    Time,
}

/// The box.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Room {
    /// Lower corner.
    pub lower: Vec<f64>,
    /// Upper corner.
    pub upper: Vec<f64>,
    /// Kind of the faces: one word for all axes, or one word an axis.
    pub faces: Faces,
}

/// One word for all axes, or one word an axis.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Faces {
    /// The same across every axis.
    All(Face),
    /// One an axis.
    Each(Vec<Face>),
}

/// By hand: of a word that is none of the kinds, serde's untagged enumerations only say that nothing fits.
impl<'de> Deserialize<'de> for Faces {
    fn deserialize<S: Deserializer<'de>>(source: S) -> Result<Self, S::Error> {
        struct Words;
        impl<'de> Visitor<'de> for Words {
            type Value = Faces;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("one of periodic, walls, open, or a list of these, one an axis")
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<Faces, E> {
                Face::deserialize(word.into_deserializer()).map(Faces::All)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Faces, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Faces::Each)
            }
        }
        source.deserialize_any(Words)
    }
}

/// Kind of the two faces across an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Face {
    /// Out at one side, in at the other.
    Periodic,
    /// Hard walls.
    Walls,
    /// None.
    Open,
}

/// Name of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AxisName {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

impl AxisName {
    /// As the file spells it.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

/// A thin hard plate.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    /// Axis the plate is perpendicular to.
    pub axis: AxisName,
    /// Its coordinate along that axis.
    pub position: f64,
    /// Its opening.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hole: Option<Opening>,
    /// Physical time from which on it is gone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removed_at: Option<f64>,
}

/// An opening in a plate.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Opening {
    /// Axis along which it is measured.
    pub along: AxisName,
    /// Where it starts.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

/// Particles generated in number.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Species {
    /// Name shown in the legend.
    #[serde(default = "default_name")]
    pub name: String,
    /// How many.
    pub count: usize,
    /// Mass of each.
    #[serde(default = "one")]
    pub mass: f64,
    /// Radius of each.
    pub radius: f64,
    /// Temperature of their start, `k_B T`.
    #[serde(default = "one")]
    pub temperature: f64,
    /// Lower corner of the part of the box they start in; the box's own when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<Vec<f64>>,
    /// Upper corner of that part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper: Option<Vec<f64>>,
}

fn default_name() -> String {
    "particles".into()
}

fn one() -> f64 {
    1.0
}

/// A particle placed by hand.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Single {
    /// Name of its species shown in the legend.
    #[serde(default = "default_name")]
    pub name: String,
    /// Position.
    pub position: Vec<f64>,
    /// Velocity; at rest when left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub velocity: Vec<f64>,
    /// Mass.
    #[serde(default = "one")]
    pub mass: f64,
    /// Radius.
    #[serde(default)]
    pub radius: f64,
    /// Axes along which it is held in place (time-driven engine).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<AxisName>,
    /// Whether its path is drawn.
    #[serde(default)]
    pub trail: bool,
}

/// Rules of collision.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Collisions {
    /// Coefficient of restitution; 1, elastic, when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub restitution: Option<f64>,
    /// In its place that of viscoelastic spheres, which depends on the speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscoelastic: Option<Viscoelastic>,
    /// Normal approach speed below which a contact is elastic whatever the restitution, against inelastic collapse.
    #[serde(default)]
    pub elastic_below: f64,
    /// A square well around each hard core.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub well: Option<Well>,
    /// A square shoulder around each hard core.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shoulder: Option<Shoulder>,
}

/// The material of viscoelastic spheres.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Viscoelastic {
    /// `2 Y / (3 (1 - nu^2))` of Young's modulus and Poisson's ratio.
    pub stiffness: f64,
    /// Dissipation over stiffness, a time.
    pub dissipation_time: f64,
}

/// A square well.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Well {
    /// Where it ends, over the contact distance.
    pub range: f64,
    /// Energy set free when a pair enters.
    pub depth: f64,
}

/// A square shoulder.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shoulder {
    /// Where it ends, over the contact distance.
    pub range: f64,
    /// Energy a pair needs to enter.
    pub height: f64,
}

/// What can be measured in a free system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Observable {
    /// Kinetic temperature against time.
    Temperature,
    /// Pressure on the walls and from the virial.
    Pressure,
    /// Distribution of speeds against Maxwell's.
    Speeds,
    /// Mean squared displacement.
    MeanSquaredDisplacement,
    /// Radial distribution function.
    RadialDistribution,
}
