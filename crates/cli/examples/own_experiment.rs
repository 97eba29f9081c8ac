//! An experiment of one's own, offered by the whole of the command: a mass on a spring, moved by symplectic Euler, whose
//! period is measured from its passages through the middle and held against the theory of that very integrator.
//!
//! `cargo run --release --example own_experiment -- run spring`

use std::process::ExitCode;

use corpuscle_core::{Failure, Invalid};
use corpuscle_experiments::{Experiment, Honesty, Kind, Parameter, Settings, Simulation};
use corpuscle_observe::chart::{Axis, Chart, Scale, Series, Style};
use corpuscle_observe::check::Check;
use corpuscle_scene::{Body, Camera, Colour, Line, Scene};

static SPRING: Experiment = Experiment {
    name: "spring",
    title: "A mass on a spring",
    summary: "Hooke's law in discrete time: the step shortens the period by a known amount.",
    dimensions: &[2],
    engines: &["symplectic Euler"],
    parameters: &[
        Parameter {
            name: "frequency",
            unit: "",
            help: "Angular frequency omega = sqrt(k/m).",
            kind: Kind::Real { default: 1.0, least: 1e-3, most: 1e3 },
        },
        Parameter { name: "step", unit: "", help: "Time step dt.", kind: Kind::Real { default: 0.01, least: 1e-6, most: 1.0 } },
        Parameter {
            name: "periods",
            unit: "",
            help: "Periods measured.",
            kind: Kind::Whole { default: 100, least: 1, most: 100_000 },
        },
    ],
    start,
};

fn main() -> ExitCode {
    corpuscle::main(&[&SPRING])
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    let (omega, dt) = (settings.real("frequency"), settings.real("step"));
    if omega * dt >= 2.0 {
        return Err(
            settings.invalid("step", format!("a step below 2 / frequency = {}, where the integrator is stable", 2.0 / omega))
        );
    }
    let periods = settings.whole("periods");
    Ok(Box::new(Spring { omega, dt, periods, x: 1.0, v: 0.0, steps: 0, time: 0.0, crossings: vec![], path: vec![(0.0, 1.0)] }))
}

struct Spring {
    omega: f64,
    dt: f64,
    periods: usize,
    x: f64,
    v: f64,
    steps: u64,
    time: f64,
    crossings: Vec<f64>,
    path: Vec<(f64, f64)>,
}

impl Spring {
    /// Period of symplectic Euler: `sin(omega' dt / 2) = omega dt / 2`.
    fn theory(&self) -> f64 {
        std::f64::consts::PI * self.dt / (0.5 * self.omega * self.dt).asin()
    }

    fn step(&mut self) {
        self.v -= self.omega * self.omega * self.x * self.dt;
        let before = self.x;
        self.x += self.v * self.dt;
        self.steps += 1;
        let now = self.steps as f64 * self.dt;
        if before < 0.0 && self.x >= 0.0 {
            self.crossings.push(now - self.dt * self.x / (self.x - before));
        }
        self.path.push((now, self.x));
    }
}

impl Simulation for Spring {
    fn time(&self) -> f64 {
        self.time
    }

    fn end(&self) -> f64 {
        (self.periods as f64 + 1.0) * self.theory()
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while (self.steps + 1) as f64 * self.dt <= to {
            self.step();
        }
        self.time = to;
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        scene.time = self.time;
        scene.title = SPRING.title.into();
        scene.caption = format!("{} steps", self.steps);
        scene.camera = Camera::fit([-1.5, -0.5, 0.0], [1.5, 0.5, 0.0]);
        scene.lines.push(Line { from: [-1.5, 0.0, 0.0], to: [self.x, 0.0, 0.0], width: 2.0, colour: Colour::Faint });
        scene.bodies.push(Body { position: [self.x, 0.0, 0.0], time: self.time, radius: 0.1, ..Body::default() });
    }

    fn charts(&self) -> Vec<Chart> {
        let count = self.path.len().min((3.0 * self.theory() / self.dt) as usize);
        let omega = self.omega;
        let period = self.theory();
        let place = Chart::new("place", "Place against time", Axis::linear("time t", ""), Axis::linear("place x", ""))
            .with(Series::theory("cos ωt", 0.0, self.path[count - 1].0.max(self.dt), 400, Scale::Linear, |t| (omega * t).cos()))
            .with(Series::new("symplectic Euler", Style::Points, self.path.iter().copied().take(count).step_by(20)))
            .noting("The first three periods.");
        let turns = self.crossings.windows(2).enumerate().map(|(k, pair)| (k as f64 + 1.0, (pair[1] - pair[0]) / period, 1e-6));
        let periods = Chart::new("period", "Period after period", Axis::linear("turn", ""), Axis::linear("period over theory", ""))
            .with(Series::with_errors("measured", Style::Line, turns))
            .with(Series::theory("theory", 1.0, self.periods as f64, 2, Scale::Linear, |_| 1.0));
        vec![place, periods]
    }

    fn checks(&self) -> Vec<Check> {
        let (Some(first), Some(last)) = (self.crossings.first(), self.crossings.last()) else { return vec![] };
        let turns = (self.crossings.len() - 1) as f64;
        let period = (last - first) / turns;
        // Interpolating a passage linearly errs by at most omega^2 dt^3 / 8 of |x| < omega dt, either end.
        let bound = 2.0 * self.omega * self.omega * self.dt.powi(3) / turns + 1e-12;
        vec![Check::at_most(
            "difference from the integrator's own period",
            (period - self.theory()).abs(),
            bound,
            "sin(ω'dt/2) = ω dt/2",
        )]
    }

    fn honesty(&self) -> Honesty {
        // The quantity this integrator keeps exactly, but for rounding.
        let kept = self.v * self.v + self.omega * self.omega * (self.x * self.x - self.dt * self.x * self.v);
        Honesty {
            engine: "symplectic Euler".into(),
            work: self.steps,
            work_unit: "steps",
            energy_drift: Some((kept / (self.omega * self.omega) - 1.0).abs()),
            stability_number: Some(self.omega * self.dt),
            ..Honesty::default()
        }
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.5 * self.theory()]
    }
}
