//! Three stars, and dust among them: orbits that return, orbits that never do, and what a tenth of a unit changes.

mod basins;
mod conservation;
mod displaced;
mod dust;
mod fate;
mod line;
mod lyapunov;
mod orbits;
mod orders;
mod parameters;
mod picture;
mod quintic;
mod report;
mod restricted;
mod start;
mod tangent;
mod triangle;

use corpuscle_checkpoint::{Fault, Resume, resume};
use std::collections::VecDeque;

use corpuscle_core::{Engine, Failure, Invalid, Vector};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::Scene;
use corpuscle_time::Integrator;

use crate::{Action, Experiment, Honesty, Settings, Simulation, Table, ensemble, hand};
use basins::Basins;
use conservation::{Frame, Run};
use dust::Parting;
use fate::Fate;
use line::Line;
use lyapunov::Lyapunov;
use orders::Orders;
use restricted::Restricted;
use start::{PRECISE, Start};
use triangle::Triangle;

/// Three stars and dust.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "three-body",
    title: "Three stars and dust",
    summary: "Gravity among three stars and dust grains: orbits that return, orbits that fly apart, and how small \
              differences of the start grow; energy, momentum and the order of every integrator are measured beside.",
    dimensions: &[2],
    engines: &["time-driven"],
    parameters: parameters::PARAMETERS,
    start: |settings| {
        Ok(match (settings.word("preset"), settings.word("show")) {
            ("restricted", _) => Box::new(Restricted::new(settings)?),
            (_, "basins") => Box::new(Basins::new(settings)?),
            _ => Box::new(ThreeBody::new(settings)?),
        })
    },
};

/// Samples of the paths kept for drawing.
const KEPT: usize = 1500;
/// Samples computed between two times at which the integrators are brought together.
const BATCH: u64 = 256;

/// What is measured beside the system on show, once.
struct Aside {
    orders: Option<Orders>,
    /// Distance of the figure-eight from its start after a period.
    closure: Option<f64>,
    triangles: Vec<Triangle>,
    line: Option<Line>,
    burrau: Option<Run>,
    lyapunov: Option<Lyapunov>,
}

struct ThreeBody {
    start: Start,
    seed: u64,
    /// The system on show; the same in another integrator; and, with a fixed step, the same with twice the step.
    runs: Vec<Run>,
    parting: Parting,
    /// Newest samples, for trails.
    path: VecDeque<Frame>,
    /// Where all is in the other integrator at the newest sample, and whether to show it.
    other: Vec<Vector<2>>,
    both: bool,
    energy_error: Vec<(f64, f64)>,
    other_energy_error: Vec<(f64, f64)>,
    /// Distance of the stars from their start after one period.
    closure: Option<f64>,
    /// The same with twice the step, for an integrator with a fixed one.
    coarse_closure: Option<f64>,
    /// Greatest coordinate of a star so far.
    reach: f64,
    samples: u64,
    time: f64,
    aside: Option<Aside>,
    /// The system in a hand, started from where the one on show was; the measurement goes on with the untouched one.
    in_hand: Option<InHand>,
}

/// A copy of the system on show, with its own clock.
struct InHand {
    run: Run,
    /// When it was made.
    since: f64,
}

impl ThreeBody {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let start = Start::new(settings)?;
        let dt = start.fitting_step(settings.real("time_step"));
        let steps = start.duration / dt;
        if steps > 1e9 {
            return Err(settings.invalid("time_step", format!("one that needs at most 1e9 steps, not {steps:.1e}")));
        }
        let integrator = match settings.word("integrator") {
            "gauss-radau-15" => PRECISE,
            name => Integrator::from_name(name, dt)?,
        };
        let mut runs = vec![Run::new(&start, integrator)?];
        if integrator == PRECISE {
            runs.push(Run::new(&start, Integrator::Yoshida4 { dt })?);
        } else {
            // An interval may be a single step: then twice the step meets every other sampling time, which is enough.
            runs.push(Run::new(&start, PRECISE)?);
            runs.push(Run::new(&start.without_dust(), Integrator::from_name(integrator.name(), 2.0 * dt)?)?);
        }
        let mut simulation = Self {
            parting: Parting::new(&start),
            seed: settings.seed,
            runs,
            path: VecDeque::new(),
            other: vec![],
            both: settings.word("show") == "integrators",
            energy_error: vec![],
            other_energy_error: vec![],
            closure: None,
            coarse_closure: None,
            reach: 0.0,
            samples: 0,
            time: 0.0,
            aside: None,
            in_hand: None,
            start,
        };
        for run in &mut simulation.runs {
            run.sample(0.0).map_err(|failure| Invalid::new("start", failure, "a system that can be evaluated"))?;
        }
        simulation.take_in();
        Ok(simulation)
    }

    /// Whether the system on show has the outcome the literature gives.
    fn is_burrau(&self) -> bool {
        self.start.preset == "pythagorean" && self.start.masses() == [3.0, 4.0, 5.0] && self.start.softening == 0.0
    }

    /// What is measured once, beside the system on show, is the same whenever it is measured.
    fn measure_again(&mut self) -> Result<(), Fault> {
        self.aside = if self.time > 0.0 { Some(self.measure_aside().map_err(Fault::new)?) } else { None };
        Ok(())
    }

    fn measure_aside(&self) -> Result<Aside, Failure> {
        let preset = self.start.preset.as_str();
        let (all, eight) = (preset == "paper", preset == "figure-eight");
        let mut aside = Aside { orders: None, closure: None, triangles: vec![], line: None, burrau: None, lyapunov: None };
        if all || eight {
            aside.orders = Some(Orders::measure(self.seed)?);
        }
        if all {
            let start = Start::figure_eight([1.0; 3], 1.0, 0.0);
            let mut run = Run::new(&start, PRECISE).map_err(failure)?;
            run.advance(start::PERIOD_OF_EIGHT)?;
            let frame = [run.engine.particles().position.clone(), start.particles.position];
            aside.closure = Some(farthest(&frame[0], &frame[1]));
            aside.burrau = Some(fate::burrau()?);
        }
        if all || preset == "lagrange" {
            let own = if all { [1.0, 0.02, 0.01] } else { self.start.masses() };
            aside.triangles.push(Triangle::measure(own, self.seed)?);
            if own != [1.0; 3] {
                aside.triangles.push(Triangle::measure([1.0; 3], self.seed)?);
            }
        }
        if preset == "euler" {
            aside.line = Some(Line::measure(self.start.masses(), self.seed)?);
        }
        // The Moon's distance is not the length of the Sun's system, by which twins are apart.
        if self.start.magnified.is_none() {
            aside.lyapunov = Some(Lyapunov::measure(&self.start, self.seed)?);
        }
        Ok(aside)
    }

    /// The system as it was last seen, to be played with.
    fn copy(&self) -> Result<InHand, Invalid> {
        let frame = self.path.back().ok_or_else(|| Invalid::new("action", "early", "a system that has been looked at"))?;
        let mut start = self.start.clone();
        start.particles.position.clone_from(&frame.position);
        start.particles.velocity.clone_from(&frame.velocity);
        Ok(InHand { run: Run::new(&start, self.runs[0].engine.integrator())?, since: frame.time })
    }

    /// Takes in the frames all runs have sampled.
    fn take_in(&mut self) {
        let mut batches = self.runs.iter_mut().map(|run| std::mem::take(&mut run.frames));
        let mut next = || batches.next().unwrap_or_default();
        let (own, other, mut coarse) = (next(), next(), next().into_iter());
        drop(batches);
        let mut held = self.in_hand.as_mut().map(|copy| std::mem::take(&mut copy.run.frames).into_iter());
        let since = self.in_hand.as_ref().map_or(0.0, |copy| copy.since);
        for (frame, other) in own.into_iter().zip(other) {
            let coarse = coarse.next();
            self.parting.see(frame.time, &frame.position, &other.position);
            self.energy_error.push((frame.time, frame.energy_error));
            self.other_energy_error.push((frame.time, other.energy_error));
            let coordinates = frame.position[..3].iter().flat_map(|r| r.0);
            self.reach = coordinates.fold(self.reach, |reach, x| reach.max(x.abs()));
            if self.closure.is_none() && self.start.period.is_some_and(|period| frame.time >= period * (1.0 - 1e-12)) {
                let stars = &self.start.particles.position[..3];
                self.closure = Some(farthest(&frame.position[..3], stars));
                self.coarse_closure = coarse.map(|frame| farthest(&frame.position, stars));
            }
            self.other = other.position;
            if self.path.len() == KEPT {
                self.path.pop_front();
            }
            let shown = held.as_mut().and_then(Iterator::next).map(|held| Frame { time: since + held.time, ..held });
            self.path.push_back(shown.unwrap_or(frame));
            self.samples += 1;
        }
    }
}

resume!(ThreeBody {
    values: [path, other, energy_error, other_energy_error, closure, coarse_closure, reach, samples, time],
    parts: [runs, parting],
    set_up: [start, seed, both, aside, in_hand],
    then: measure_again,
});

impl Simulation for ThreeBody {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn end(&self) -> f64 {
        self.start.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        if self.aside.is_none() {
            self.aside = Some(self.measure_aside()?);
        }
        let interval = self.start.interval;
        let last = (to / interval * (1.0 + 1e-12)).floor() as u64;
        while self.samples <= last {
            let (from, until) = (self.samples, (self.samples + BATCH).min(last + 1));
            let outcome =
                ensemble::for_each(&mut self.runs, |run| (from..until).try_for_each(|sample| run.sample(sample as f64 * interval)));
            let held = self
                .in_hand
                .as_mut()
                .map_or(Ok(()), |copy| (from..until).try_for_each(|sample| copy.run.sample(sample as f64 * interval - copy.since)));
            self.take_in();
            outcome.and(held)?;
        }
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        self.draw_into(scene);
    }

    fn frame(&self) -> Option<crate::Frame> {
        let engine = &self.runs[0].engine;
        let names: Vec<String> = (1..=3).map(|star| format!("star {star}")).chain(["dust".into()]).collect();
        Some(crate::Frame::new(engine.time(), engine.boundary(), engine.particles(), &names))
    }

    fn charts(&self) -> Vec<Chart> {
        let mut charts = vec![self.chart_of_parting()];
        if let Some(aside) = &self.aside {
            charts.extend(aside.orders.as_ref().map(Orders::chart));
            if let [first, others @ ..] = &aside.triangles[..] {
                charts.push(first.chart(others.first()));
            }
            charts.extend(aside.line.as_ref().map(Line::chart));
            charts.extend(aside.lyapunov.as_ref().map(Lyapunov::chart));
        }
        charts.push(self.chart_of_energy());
        charts
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = self.checks_of_conservation();
        checks.extend(self.check_of_closure());
        checks.extend(self.check_of_year());
        if self.is_burrau() && self.time >= self.end() {
            checks.extend(Fate::checks_of_burrau(self.runs[0].engine.particles(), self.start.constant, self.time));
        }
        checks.extend(self.checks_of_parting());
        if let Some(aside) = &self.aside {
            checks.extend(aside.orders.iter().flat_map(Orders::checks));
            checks.extend(aside.closure.map(report::check_of_closure));
            checks.extend(aside.triangles.iter().map(Triangle::check));
            checks.extend(aside.line.as_ref().map(Line::check));
            checks.extend(aside.lyapunov.iter().flat_map(Lyapunov::checks));
            if let Some(burrau) = &aside.burrau {
                checks.extend(Fate::checks_of_burrau(burrau.engine.particles(), 1.0, burrau.engine.time()));
            }
        }
        checks
    }

    fn honesty(&self) -> Honesty {
        let run = &self.runs[0];
        Honesty {
            engine: format!("time-driven, {}", run.engine.integrator().name()),
            work: self.runs.iter().map(|run| run.engine.steps()).sum(),
            work_unit: "steps",
            energy_drift: Some(run.relative_energy_error()),
            momentum_drift: Some(run.relative_momentum_error()),
            angular_momentum_drift: Some(run.relative_angular_momentum_error()),
            stability_number: run.engine.integrator().dt().map(|dt| dt * run.fastest),
            // Until neighbouring paths, which part as measured, have gone from rounding to the size of the orbits.
            precision_horizon: self.parting.growth().map(|growth| -libm::log(f64::EPSILON) / growth.rate.mean),
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        let parting = &self.parting;
        let mut columns: Vec<String> = ["time", "other_integrator_separation"].map(String::from).to_vec();
        let mut series = vec![&parting.integrators];
        if self.start.grains > 1 {
            columns.extend(["neighbour_separation", "twin_1e-4_separation", "twin_1e-8_separation"].map(String::from));
            series.extend([&parting.neighbours, &parting.twins[0], &parting.twins[1]]);
        }
        let row = |k: usize| std::iter::once(parting.time[k]).chain(series.iter().map(|s| libm::exp(s[k]))).collect();
        vec![Table { name: "separation".into(), columns, rows: (0..parting.time.len()).map(row).collect() }]
    }

    fn moments(&self) -> Vec<f64> {
        let end = self.end();
        if self.start.preset == "pythagorean" {
            vec![0.0, 0.22 * end, 0.6 * end, 0.95 * end]
        } else {
            vec![0.0, 0.15 * end, 0.5 * end]
        }
    }
    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_soft_number(action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        action.allowed(self)?;
        let mut copy = match self.in_hand.take() {
            Some(copy) => copy,
            None => self.copy()?,
        };
        let outcome = hand::on_soft(&mut copy.run.engine, action);
        if let Some(shown) = self.path.back_mut() {
            let particles = copy.run.engine.particles();
            shown.position.clone_from(&particles.position);
            shown.velocity.clone_from(&particles.velocity);
        }
        self.in_hand = Some(copy);
        outcome
    }
}

/// Greatest distance between a body in one picture and the same body in another.
fn farthest(a: &[Vector<2>], b: &[Vector<2>]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max)
}

/// A set-up of this program's own that was refused: said as what it is, a run that cannot go on.
#[allow(clippy::needless_pass_by_value)] // as `map_err` hands it over
fn failure(invalid: Invalid) -> Failure {
    Failure { time: 0.0, particle: None, cause: invalid.to_string() }
}

#[cfg(test)]
mod tests;
