//! What the window knows of the running simulation.

use std::sync::Arc;

use corpuscle_experiments::{Action, Honesty, Probed, Simulation, Table};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::Scene;

use super::beside::Side;

/// Everything there is to see at one moment.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Counts the runs: another number is another run, whose trails and charts begin anew.
    pub run: u64,
    /// Numbers the looks at the system: under the same number the scene is the same.
    pub look: u64,
    /// What the stage shows.
    pub scene: Scene,
    /// Physical time reached.
    pub time: f64,
    /// Physical time at which the run began.
    pub start: f64,
    /// Physical time at which the experiment has measured what it set out to measure.
    pub end: f64,
    /// Whether time passes.
    pub playing: bool,
    /// Physical time asked for in a second of the viewer.
    pub speed: f64,
    /// Share of that speed that the engine reaches, 1 when it keeps up.
    pub pace: f64,
    /// On the way to a chosen time: where from, and where to.
    pub travel: Option<(f64, f64)>,
    /// The same system computed another way, where that is wanted.
    pub beside: Option<Side>,
    /// What has been done to the system by hand, and when.
    pub deeds: Arc<Vec<(f64, Action)>>,
    /// What the probe has seen of contacts, where they can be watched.
    pub probed: Option<Probed>,
    /// What kinds of action this experiment refuses, by their names, and what each would need.
    pub refusals: Arc<Vec<(&'static str, &'static str)>>,
    /// Charts, checks and honesty, made now and then.
    pub measured: Arc<Measured>,
    /// What went wrong since the last order, in the program's words.
    pub fault: Option<Fault>,
}

/// What has been measured up to a time.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// The run it belongs to.
    pub run: u64,
    /// Physical time of the measurement.
    pub time: f64,
    /// Charts, the most telling first.
    pub charts: Vec<Chart>,
    /// Measurement beside theory.
    pub checks: Vec<Check>,
    /// Numerical quality.
    pub honesty: Honesty,
    /// Further tables.
    pub tables: Vec<Table>,
}

/// Seconds of the viewer in which the whole experiment passes by at the usual speed.
const SECONDS: f64 = 30.0;

impl Measured {
    /// What a simulation has measured by now.
    pub(crate) fn of(simulation: &dyn Simulation, run: u64) -> Self {
        Self {
            run,
            time: simulation.time(),
            charts: simulation.charts(),
            checks: simulation.checks(),
            honesty: simulation.honesty(),
            tables: simulation.tables(),
        }
    }
}

/// What a person asked for and did not get.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// A parameter, by its key, and what was expected of it.
    Refused {
        /// The key.
        key: String,
        /// What would have been accepted.
        expected: String,
    },
    /// The dynamics broke down.
    Failed(String),
    /// The experiment cannot do this.
    Unable(String),
    /// There is no next collision.
    NoCollisions,
}

impl Snapshot {
    /// What an action of this kind would need that is not here; none where it can be tried.
    pub fn refusal(&self, action: Action) -> Option<&'static str> {
        self.refusals.iter().find(|(name, _)| *name == action.name()).map(|&(_, needs)| needs)
    }

    /// Takes in what there is to know of a simulation that has just started, to be run for so long, or as long as it needs.
    pub(crate) fn begin(&mut self, simulation: &dyn Simulation, duration: Option<f64>) {
        let start = simulation.time();
        let end = duration.unwrap_or_else(|| simulation.end());
        (self.time, self.start, self.end) = (start, start, end.max(start));
        let refused = |action: &Action| Some((action.name(), simulation.refusal(*action)?));
        self.refusals = Arc::new(Action::EXAMPLES.iter().filter_map(refused).collect());
    }

    /// Physical time a second of the viewer, unless told otherwise.
    pub(crate) fn usual_speed(&self) -> f64 {
        (self.end - self.start) / SECONDS
    }

    /// Copies `other`, using the memory that is there.
    pub(crate) fn copy(&mut self, other: &Self) {
        let scene = std::mem::take(&mut self.scene);
        *self = Self { scene, ..other.without_scene() };
        copy_scene(&mut self.scene, &other.scene);
    }

    fn without_scene(&self) -> Self {
        Self {
            run: self.run,
            look: self.look,
            scene: Scene::default(),
            time: self.time,
            start: self.start,
            end: self.end,
            playing: self.playing,
            speed: self.speed,
            pace: self.pace,
            travel: self.travel,
            beside: self.beside.clone(),
            deeds: self.deeds.clone(),
            probed: self.probed,
            refusals: self.refusals.clone(),
            measured: self.measured.clone(),
            fault: self.fault.clone(),
        }
    }
}

/// Copies a scene into the memory of another.
fn copy_scene(into: &mut Scene, from: &Scene) {
    into.bodies.clone_from(&from.bodies);
    into.lines.clone_from(&from.lines);
    into.regions.clone_from(&from.regions);
    into.map.clone_from(&from.map);
    into.labels.clone_from(&from.labels);
    into.trails.clone_from(&from.trails);
    into.title.clone_from(&from.title);
    into.caption.clone_from(&from.caption);
    into.colouring.clone_from(&from.colouring);
    (into.time, into.camera, into.field, into.least_radius) = (from.time, from.camera, from.field, from.least_radius);
    (into.wanted, into.shaded, into.period, into.bounds) = (from.wanted, from.shaded, from.period, from.bounds);
}
