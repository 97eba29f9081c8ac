//! A running experiment, its dimension and engine erased: what the command and the window drive.

use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::Scene;

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

    /// Physical time of the next collision of what is on show; none where nothing collides, or not before [`end`](Self::end)
    /// and half as long again.
    fn next_event(&self) -> Option<f64> {
        None
    }

    /// Does something to the system now.
    ///
    /// # Errors
    /// Says so when this experiment cannot do it.
    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        Err(Invalid::new("action", format!("{action:?}"), "an action this experiment knows"))
    }
}

/// What a person at the window may do to a running system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Reverse all velocities.
    Reverse,
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
