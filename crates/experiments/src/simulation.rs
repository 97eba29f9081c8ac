//! A running experiment, its dimension and engine erased: what the command and the window drive.

use corpuscle_checkpoint::Resume;
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Frame, Probed};

/// A running experiment.
///
/// Where and how often a caller stops has no influence on what it computes: the experiment samples at its own times.
/// A caller asks for a time, looks, and goes on.
pub trait Simulation: Send {
    /// Physical time reached.
    fn time(&self) -> f64;

    /// Physical time at which the experiment has measured what it set out to measure. It may be continued.
    fn end(&self) -> f64;

    /// Advances to the physical time `to`.
    ///
    /// # Errors
    /// [`Failure`] when the dynamics breaks down; the state is then the last good one.
    fn advance(&mut self, to: f64) -> Result<(), Failure>;

    /// Describes what there is to see now. The scene may be the one of the last frame: replace its bodies, lines,
    /// regions and labels ([`Scene::clear`]), append to its trails.
    fn draw(&self, scene: &mut Scene);

    /// Charts of what has been measured so far, the most telling first, each beside its theory.
    fn charts(&self) -> Vec<Chart>;

    /// Checks of what has been measured so far. At [`end`](Simulation::end) they are the experiment's verdict.
    fn checks(&self) -> Vec<Check>;

    /// What can be said of the numerical quality so far.
    fn honesty(&self) -> Honesty;

    /// Further results that are tables rather than charts, saved as CSV.
    fn tables(&self) -> Vec<Table> {
        vec![]
    }

    /// Times worth a picture in the report, in ascending order; the end is always added.
    fn moments(&self) -> Vec<f64> {
        vec![0.0]
    }

    /// All particles now, of replicas those on show, for a trajectory; none of an experiment that has no particles.
    fn frame(&self) -> Option<Frame> {
        None
    }

    /// What has changed since the start, for a checkpoint; none of an experiment that cannot be taken up again.
    fn state(&self) -> Option<&dyn Resume> {
        None
    }

    /// The same, of an experiment started alike, to be put where a checkpoint left it.
    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        None
    }

    /// Physical time of the next collision of what is on show; none where nothing collides, or not before [`end`](Self::end)
    /// and half as long again.
    fn next_event(&self) -> Option<f64> {
        None
    }

    /// Lays a probe between two corners of a flat picture, or takes it up.
    fn probe(&mut self, _corners: Option<[[f64; 2]; 2]>) {}

    /// What the probe has seen since; none where contacts cannot be watched.
    fn probed(&self) -> Option<Probed> {
        None
    }

    /// What an action of this kind would need that is not here; none where it can be tried. The window says it beforehand.
    fn refusal(&self, _action: Action) -> Option<&'static str> {
        Some("another experiment: this one has no hands on it")
    }

    /// Does something to the system now.
    ///
    /// # Errors
    /// Says so when this experiment cannot do it.
    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        action.allowed(self)
    }
}

/// What a person at the window may do to a running system, between two events. Bodies are known by their places in the scene's
/// list; of vectors a flat system takes the first two components.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Action {
    /// Reverse all velocities.
    Reverse,
    /// Turn each velocity by a random angle of about `strength`, in radians; energy stays. Before a reversal it is Loschmidt's
    /// question: how exact has the reversal to be?
    Disturb {
        /// Standard deviation of the angle.
        strength: f64,
        /// Seed of the random numbers.
        seed: u64,
    },
    /// Carry a body to the legal place nearest to another one; it keeps its velocity.
    Place {
        /// The body.
        body: usize,
        /// Where to.
        at: [f64; 3],
    },
    /// Give a body another velocity.
    Throw {
        /// The body.
        body: usize,
        /// Its new velocity.
        velocity: [f64; 3],
    },
    /// Put a thin hard plate across the box, with a hole in its middle or without; what it would cut makes room.
    Partition {
        /// Axis across which it stands.
        axis: usize,
        /// Its coordinate along that axis.
        at: f64,
        /// Width of the hole.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        hole: Option<f64>,
    },
    /// Take all plates out.
    OpenPartitions,
    /// Give a wall a temperature `kT`, or take it away.
    Heat {
        /// Axis across which the wall stands.
        axis: usize,
        /// Whether it is the upper of the two.
        upper: bool,
        /// Its temperature; none for a wall that only reflects.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        temperature: Option<f64>,
    },
    /// Give the piston another velocity.
    Push {
        /// Its new velocity, of which the component along its axis counts.
        velocity: [f64; 3],
    },
    /// Add a body of the same kind as another one, at the legal place nearest to the one asked for.
    Add {
        /// Where.
        at: [f64; 3],
        /// Its velocity.
        velocity: [f64; 3],
        /// The body it is like.
        like: usize,
    },
    /// Take a body away; those behind it in the list move up.
    Remove {
        /// The body.
        body: usize,
    },
}

impl Action {
    /// Its name, for a person who is told that it cannot be done.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reverse => "reverse",
            Self::Disturb { .. } => "disturb",
            Self::Place { .. } => "place",
            Self::Throw { .. } => "throw",
            Self::Partition { .. } => "put a partition in",
            Self::OpenPartitions => "open the partitions",
            Self::Heat { .. } => "heat a wall",
            Self::Push { .. } => "push the piston",
            Self::Add { .. } => "add",
            Self::Remove { .. } => "remove",
        }
    }

    /// One of each kind, to ask what can be done.
    pub const EXAMPLES: [Self; 10] = [
        Self::Reverse,
        Self::Disturb { strength: 1e-6, seed: 0 },
        Self::Place { body: 0, at: [0.0; 3] },
        Self::Throw { body: 0, velocity: [0.0; 3] },
        Self::Partition { axis: 0, at: 0.0, hole: None },
        Self::OpenPartitions,
        Self::Heat { axis: 0, upper: false, temperature: None },
        Self::Push { velocity: [0.0; 3] },
        Self::Add { at: [0.0; 3], velocity: [0.0; 3], like: 0 },
        Self::Remove { body: 0 },
    ];

    /// Whether a simulation lets itself be touched in this way.
    ///
    /// # Errors
    /// Its [`refusal`](Simulation::refusal).
    pub(crate) fn allowed(self, simulation: &(impl Simulation + ?Sized)) -> Result<(), Invalid> {
        simulation.refusal(self).map_or(Ok(()), |expected| self.refused(expected))
    }

    /// Refuses this action, and says what would have been needed for it.
    pub(crate) fn refused<T>(self, expected: &str) -> Result<T, Invalid> {
        Err(Invalid::new("action", self.name(), expected))
    }
}

/// The numerical quality of a run, for the honesty panel, the report and `summary.json`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Honesty {
    /// Engine and, where there is one, integrator.
    pub engine: String,
    /// Collisions of an event-driven engine or steps of a time-driven one, over all replicas.
    pub work: u64,
    /// What `work` counts: `collisions` or `steps`.
    pub work_unit: &'static str,
    /// Largest `|E - E_0| / |E_0|` seen, where energy is conserved.
    pub energy_drift: Option<f64>,
    /// Largest `|p - p_0|` over the sum of `|m v|`, where momentum is conserved.
    pub momentum_drift: Option<f64>,
    /// Largest `|L - L_0|` relative to its scale, where angular momentum is conserved.
    pub angular_momentum_drift: Option<f64>,
    /// Deepest overlap over the contact distance, for hard particles.
    pub largest_overlap: Option<f64>,
    /// Time step times the highest frequency, for a time-driven engine that has such a limit.
    pub stability_number: Option<f64>,
    /// Events of an event-driven engine that had become obsolete when their time came, and were rejected.
    pub rejected_events: Option<u64>,
    /// Physical time until which single paths are known: beyond it rounding has grown to the size of what moves.
    pub precision_horizon: Option<f64>,
}

/// Largest overlap, relative energy and momentum drift of hard particles: what 10^9 collisions of this engine leave (6e-16,
/// 2.3e-12 and 3e-16) lies orders of magnitude below, what a lost collision leaves above.
const HARD_BOUND: f64 = 1e-7;

impl Honesty {
    /// What is broken that this dynamics keeps by itself, in words; none of a sound run.
    ///
    /// Hard particles conserve energy and momentum and do not overlap, up to rounding. Integrators have an error of their own,
    /// which a check judges; but all that was measured has to be a number.
    pub fn broken(&self) -> Option<String> {
        let quantities = [
            ("the energy drift", self.energy_drift),
            ("the momentum drift", self.momentum_drift),
            ("the angular momentum drift", self.angular_momentum_drift),
            ("the largest overlap", self.largest_overlap),
        ];
        let hard = self.largest_overlap.is_some();
        for (name, value) in quantities.into_iter().filter_map(|(name, value)| Some((name, value?))) {
            if !value.is_finite() {
                return Some(format!("{name} is {value}: an invariant is broken"));
            }
            if hard && value > HARD_BOUND {
                return Some(format!(
                    "{name} is {value:.1e}, where rounding leaves less than {HARD_BOUND:.0e}: an invariant is broken"
                ));
            }
        }
        None
    }
}

/// A table of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name of the file it is saved under: lower case, words joined by hyphens.
    pub name: String,
    /// Headers, `name_unit`.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<f64>>,
}
