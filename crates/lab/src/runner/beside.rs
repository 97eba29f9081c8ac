//! The same system computed another way, beside the one that runs, and how long the two agree.

use corpuscle_core::Failure;
use corpuscle_experiments::{Action, Simulation};
use corpuscle_io::{Refusal, Scenario};
use corpuscle_observe::Chart;
use corpuscle_observe::chart::{Axis, Series, Style};
use corpuscle_scene::Scene;

use super::sight::Sight;
use crate::tools::state_at;

/// Times in a run at which the two are compared: a grid of its own, so that the answer depends on nothing else.
const COMPARISONS: f64 = 600.0;

/// What a viewer sees of it.
#[derive(Clone, Debug, Default)]
pub struct Side {
    /// What computes it.
    pub name: String,
    /// What there is to see.
    pub scene: Scene,
    /// Largest distance of a body from itself at the last comparison.
    pub apart: f64,
    /// Radius of the smallest body: beyond it the two have parted.
    pub radius: f64,
    /// When they parted.
    pub parted: Option<f64>,
    /// Why it goes no further.
    pub fault: Option<String>,
}

/// Another way to compute what runs.
pub(crate) struct Beside {
    scenario: Scenario,
    simulation: Box<dyn Simulation>,
    pub(crate) sight: Sight,
    side: Side,
    /// Time and largest distance at each comparison.
    distances: Vec<(f64, f64)>,
    start: f64,
    interval: f64,
    /// Where both are drawn to be compared.
    scratch: [Scene; 2],
}

impl Beside {
    /// Starts it.
    pub(crate) fn new(name: String, scenario: Scenario, sight: Sight) -> Result<Self, Refusal> {
        let simulation = scenario.start()?;
        let (start, end) = (simulation.time(), scenario.duration.unwrap_or_else(|| simulation.end()));
        Ok(Self {
            side: Side { name, ..Side::default() },
            interval: (end - start) / COMPARISONS,
            distances: vec![],
            scratch: [Scene::default(), Scene::default()],
            scenario,
            simulation,
            sight,
            start,
        })
    }

    /// Runs it again from its start.
    pub(crate) fn restart(&mut self) {
        if let Ok(fresh) = Self::new(self.side.name.clone(), self.scenario.clone(), self.sight.clone()) {
            *self = fresh;
            self.sight.begin();
        }
    }

    /// Advances both to a time, and compares them on the way.
    ///
    /// # Errors
    /// [`Failure`] of the one that runs; that of the other is kept, and it stays where it is.
    pub(crate) fn advance(&mut self, own: &mut dyn Simulation, to: f64) -> Result<(), Failure> {
        loop {
            let next = self.start + self.distances.len() as f64 * self.interval;
            if next > to || self.interval <= 0.0 {
                break;
            }
            own.advance(next)?;
            self.follow(next);
            if self.side.fault.is_some() {
                break;
            }
            self.compare(own, next);
        }
        own.advance(to)?;
        self.follow(to);
        Ok(())
    }

    fn follow(&mut self, to: f64) {
        if self.side.fault.is_none()
            && let Err(failure) = self.simulation.advance(to)
        {
            self.side.fault = Some(failure.to_string());
        }
    }

    fn compare(&mut self, own: &dyn Simulation, time: f64) {
        let [a, b] = &mut self.scratch;
        own.draw(a);
        self.simulation.draw(b);
        let apart = largest_distance(a, b, time);
        self.distances.push((time, apart));
        self.side.apart = apart;
        self.side.radius = a.bodies.iter().map(|body| body.radius).fold(f64::INFINITY, f64::min);
        if self.side.parted.is_none() && apart > self.side.radius {
            self.side.parted = Some(time);
        }
    }

    /// Does the same to it as to the one that runs.
    pub(crate) fn act(&mut self, action: Action) {
        // What it cannot do is seen by the two parting.
        let _ = self.simulation.act(action);
    }

    /// What there is to see now.
    pub(crate) fn look(&mut self) -> Side {
        self.sight.look(self.simulation.as_ref(), &mut self.side.scene);
        self.side.clone()
    }

    /// The distance against time.
    pub(crate) fn chart(&self) -> Chart {
        let (first, last) = (self.start, self.distances.last().map_or(self.start, |distance| distance.0));
        let radius = self.side.radius;
        Chart::new(
            "agreement",
            "How far the two ways of computing are apart",
            Axis::linear("time t", ""),
            Axis::logarithmic("largest distance", ""),
        )
        .with(Series::new("radius of a body", Style::Theory, [(first, radius), (last, radius)]))
        .with(Series::new("largest over all bodies", Style::Line, self.distances.iter().copied()))
        .noting("Where the path is chaotic, any difference grows exponentially: single paths agree for a while, averages for ever.")
    }
}

/// Largest distance of a body in one scene from the same body in another, at a time that both have about reached: a fixed step
/// ends a little before. Around a periodic box the shorter way counts.
fn largest_distance(a: &Scene, b: &Scene, time: f64) -> f64 {
    let distance = |(one, other): (&corpuscle_scene::Body, &corpuscle_scene::Body)| {
        let (p, q) = (state_at(one, a, time).0, state_at(other, b, time).0);
        let way = (0..3).map(|k| {
            let (difference, side) = (p[k] - q[k], a.period[k]);
            if side > 0.0 { difference - (difference / side).round() * side } else { difference }
        });
        way.map(|x| x * x).sum::<f64>().sqrt()
    };
    a.bodies.iter().zip(&b.bodies).map(distance).fold(0.0, |largest, d| if d > largest || d.is_nan() { d } else { largest })
}
