//! An experiment for the tests of this crate: a harmonic oscillator, moved exactly, its period and energy measured.

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_experiments::{Experiment, Honesty, Kind, Parameter, Settings, Simulation, Table};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Scale, Series, Style};
use corpuscle_scene::Scene;

pub(crate) static OSCILLATOR: Experiment = Experiment {
    name: "oscillator",
    title: "Harmonic <oscillator>",
    summary: "One mass on one spring & nothing else.",
    dimensions: &[2],
    engines: &["exact"],
    parameters: &[
        Parameter {
            name: "frequency",
            unit: "1/s",
            help: "Turns a second.",
            kind: Kind::Real { default: 1.0, least: 1e-300, most: 10.0 },
        },
        Parameter {
            name: "amplitude",
            unit: "m",
            help: "Greatest distance.",
            kind: Kind::Real { default: 1.0, least: 0.0, most: 1e300 },
        },
        Parameter { name: "samples", unit: "", help: "Measurements.", kind: Kind::Whole { default: 20, least: 1, most: 1000 } },
        Parameter {
            name: "start",
            unit: "",
            help: "Where.",
            kind: Kind::Choice { default: "middle", options: &["middle", "side"] },
        },
        Parameter { name: "damped", unit: "", help: "Whether.", kind: Kind::Flag { default: false } },
        Parameter {
            name: "masses",
            unit: "kg",
            help: "Which.",
            kind: Kind::List { default: &[], least: 0.0, most: 9.0, longest: 3 },
        },
    ],
    start,
};

pub(crate) static REGISTRY: &[&Experiment] = &[&OSCILLATOR];

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    if settings.real("amplitude") * settings.real("frequency") > 1e3 {
        return Err(settings.invalid("amplitude", "a speed below light's"));
    }
    Ok(Box::new(Oscillator { settings: settings.clone(), time: 0.0 }))
}

struct Oscillator {
    settings: Settings,
    time: f64,
}

resume!(Oscillator { values: [time], set_up: [settings] });

impl Simulation for Oscillator {
    fn time(&self) -> f64 {
        self.time
    }
    fn end(&self) -> f64 {
        2.0
    }
    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.time = to;
        Ok(())
    }
    fn draw(&self, _: &mut Scene) {}
    fn charts(&self) -> Vec<Chart> {
        let (f, a) = (self.settings.real("frequency"), self.settings.real("amplitude"));
        let place = move |t: f64| a * (std::f64::consts::TAU * f * t).sin();
        let count = self.settings.whole("samples");
        let sampled = (0..count).map(|k| 2.0 * k as f64 / count as f64).map(|t| (t, place(t), 0.07));
        let chart = Chart::new("place", "Place & time", Axis::linear("time t", "s"), Axis::linear("place <x>", "m"))
            .with(Series::theory("theory", 0.0, 2.0, 3000, Scale::Linear, place))
            .with(Series::with_errors("measured, \"here\"", Style::Points, sampled))
            .noting("It swings.");
        vec![chart]
    }
    fn checks(&self) -> Vec<Check> {
        let period = 1.0 / self.settings.real("frequency");
        vec![
            Check::agreement("period <T>", period * 1.001, period * 0.001, period, "T = 1/f").with_unit("s"),
            Check::at_most("energy drift", 1e-15, 1e-12, "rounding"),
        ]
    }
    fn honesty(&self) -> Honesty {
        Honesty { engine: "exact".into(), work: 12345, work_unit: "steps", energy_drift: Some(1e-15), ..Honesty::default() }
    }
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }
    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }
    fn tables(&self) -> Vec<Table> {
        vec![Table { name: "turning-points".into(), columns: vec!["time_s".into()], rows: vec![vec![0.1 + 0.2], vec![f64::NAN]] }]
    }
}
