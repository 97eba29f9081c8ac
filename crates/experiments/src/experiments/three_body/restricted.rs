//! The restricted problem: grains about two stars on circles, seen in the frame that turns with these.
//!
//! The Jacobi constant `C = 2 Omega - v^2` is conserved, so that a grain can never enter the region `2 Omega < C`; and the
//! places where it goes through the line `y = 0` upwards (Poincaré's section) lie on a curve if its motion is regular, and fill an
//! area if it is chaotic. How fast neighbouring paths part is measured twice: by the variational equations, and by twins.

mod frame;
mod orbit;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{self as core, Boundary, Failure, Invalid, Particles, Random, Vector};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Estimate, Series, Style};
use corpuscle_scene::{Body, Camera, Colour, Colouring, Label, Scene, TrailPoint};

use super::failure;
use crate::{Action, Frame, Honesty, Settings, Simulation, Table, ensemble};
use frame::Turning;
use orbit::Orbit;

/// Stream of the random starts.
const STREAM: u64 = 0x3e57;
/// Samples in a unit of time, of which there are `2 pi` to a revolution; and the units followed.
const SAMPLES: u64 = 50;
const DURATION: f64 = 200.0;
/// Samples kept of each path.
const KEPT: usize = 400;
/// Half the width of the picture, and cells of the forbidden region along it.
const HALF: f64 = 1.5;
const CELLS: usize = 360;
/// Faster than this, paths part exponentially: at the end regular ones, which part linearly, are below `ln(T)/T`, some 0.02.
const CHAOTIC: f64 = 0.05;

/// The running experiment.
pub(super) struct Restricted {
    frame: Turning,
    jacobi: f64,
    orbits: Vec<Orbit>,
    samples: u64,
    end: f64,
    time: f64,
}

resume!(Restricted { values: [samples, time], parts: [orbits], set_up: [frame, jacobi, end] });

impl Restricted {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        if settings.word("show") == "basins" {
            return Err(settings.invalid("show", "paths: the map of fates wants three stars"));
        }
        let [one, two, ..] = *settings.list("masses") else {
            return Err(settings.invalid("masses", "those of the two stars, and one that is not used; or none"));
        };
        let frame = Turning { mu: two / (one + two) };
        let jacobi = settings.real("jacobi_constant");
        let grains = settings.whole("grains");
        // Starts between the first star and the way round the second, one in each part of that, at random: there the grain has to be
        // allowed, and moves up in the turning frame.
        let [.., second] = frame.stars();
        let (from, to) = (-frame.mu + 0.1, second.1[0] - 0.05);
        let mut random = Random::new(settings.seed, STREAM);
        let starts = (0..grains).filter_map(|k| {
            let x = from + (to - from) * (k as f64 + random.uniform()) / grains as f64;
            let square = 2.0 * frame.potential(Vector([x, 0.0])) - jacobi;
            (square > 0.0).then(|| (x, square.sqrt()))
        });
        let orbits = starts.map(|(x, speed)| Orbit::new(frame, x, speed, jacobi)).collect::<Result<Vec<_>, _>>()?;
        if orbits.is_empty() && grains > 0 {
            return Err(settings.invalid("jacobi_constant", "a smaller one: no start between the stars is allowed"));
        }
        let given = settings.real("duration");
        Ok(Self { frame, jacobi, orbits, samples: 0, end: if given > 0.0 { given } else { DURATION }, time: 0.0 })
    }

    /// Exponents of all grains that have gone on for long enough to have one.
    fn exponents(&self) -> Vec<(f64, f64)> {
        self.orbits.iter().filter(|orbit| !orbit.ended && self.time >= 20.0).filter_map(Orbit::exponents).collect()
    }
}

impl Simulation for Restricted {
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
        self.end
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let last = (to * SAMPLES as f64 * (1.0 + 1e-12)).floor() as u64;
        let from = self.samples + 1;
        ensemble::for_each(&mut self.orbits, |orbit| {
            (from..=last).try_for_each(|sample| {
                let time = sample as f64 / SAMPLES as f64;
                orbit.sample(time, KEPT)?;
                if sample % SAMPLES == 0 { orbit.renormalise(time).map_err(failure) } else { Ok(()) }
            })
        })?;
        self.samples = self.samples.max(last);
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        scene.time = self.time;
        scene.title = "The restricted three-body problem".into();
        scene.caption = format!(
            "turning with the stars   C = {}   grey: forbidden, 2Ω < C   Jacobi constant kept to {:.0e}",
            self.jacobi,
            self.orbits.iter().map(|orbit| orbit.error).fold(0.0, f64::max)
        );
        scene.camera = Camera::fit([-HALF, -HALF, 0.0], [HALF, HALF, 0.0]);
        scene.map = Some(self.frame.forbidden(self.jacobi, HALF, CELLS));
        let mut names = vec![];
        for (number, (mass, star)) in self.frame.stars().into_iter().enumerate() {
            names.push(format!("star, m = {mass}"));
            let radius = 0.05 * HALF * mass.cbrt().max(0.35);
            scene.bodies.push(Body {
                position: star.to_three(),
                radius,
                shade: number as f64,
                time: scene.time,
                ..Body::default()
            });
        }
        names.extend(["dust, regular".into(), "dust, chaotic".into()]);
        scene.colouring = Colouring::Species(names);
        for (number, place) in self.frame.equilibria().into_iter().enumerate() {
            scene.labels.push(Label { at: place.to_three(), text: format!("L{}", number + 1), colour: Colour::Ink });
        }
        for (number, orbit) in self.orbits.iter().enumerate() {
            let Some(now) = orbit.path.back() else { continue };
            let chaotic = orbit.exponents().is_some_and(|exponents| exponents.0 > CHAOTIC.max(4.0 / self.time));
            let colour = if chaotic { 3 } else { 2 };
            let (position, velocity) = (now.r.to_three(), now.v.to_three());
            scene.bodies.push(Body { position, velocity, time: now.time, radius: 0.012 * HALF, shade: f64::from(colour) });
            let trail = scene.trail(number as u32, KEPT, Colour::Accent(colour));
            (trail.width, trail.colour) = (1.0, Colour::Accent(colour));
            let seen = trail.points().back().map_or(f64::NEG_INFINITY, |point| point.time);
            for state in orbit.path.iter().filter(|state| state.time > seen) {
                trail.push(TrailPoint { position: state.r.to_three(), time: state.time });
            }
        }
    }

    /// Both stars and all grains in the frame that turns; a grain that has hit a star stays where it did.
    fn frame(&self) -> Option<Frame> {
        let mut all = Particles::<2>::new();
        for (mass, star) in self.frame.stars() {
            all.push(star, Vector::ZERO, mass, 0.0, 0);
        }
        for now in self.orbits.iter().filter_map(|orbit| orbit.path.back()) {
            all.push(now.r, now.v, 0.0, 0.0, 1);
        }
        let around = Boundary::new([-HALF; 2], [HALF; 2], core::Axis::Open);
        Some(Frame::new(self.samples as f64 / SAMPLES as f64, &around, &all, &["stars".into(), "dust".into()]))
    }

    fn charts(&self) -> Vec<Chart> {
        vec![self.chart_of_section(), self.chart_of_growth()]
    }

    fn checks(&self) -> Vec<Check> {
        if self.samples == 0 || self.orbits.is_empty() {
            return vec![];
        }
        let worst = self.orbits.iter().map(|orbit| orbit.error / orbit.bound()).fold(0.0, f64::max);
        let mut checks = vec![Check::at_most(
            "Jacobi constant of each grain: largest error over its bound",
            worst,
            1.0,
            "Jacobi 1836: C = 2Ω − v² is conserved; bound: rounding, 4 u sqrt(n) times its largest scale",
        )];
        let differences: Vec<f64> = self.exponents().iter().map(|(tangent, twin)| tangent - twin).collect();
        if differences.len() >= 3 {
            checks.push(Estimate::from_replicas(&differences).check(
                "Lyapunov exponent by the variational equations less that by twins, mean over the grains",
                0.0,
                "Benettin et al. 1980 (doi:10.1007/BF02128236): both renormalised each unit of time; standard error over the grains",
            ));
        }
        checks
    }

    fn honesty(&self) -> Honesty {
        let fastest = self.exponents().iter().map(|exponents| exponents.0).fold(0.0, f64::max);
        Honesty {
            engine: "time-driven, gauss-radau-15".into(),
            work: self.orbits.iter().map(Orbit::steps).sum(),
            work_unit: "steps",
            energy_drift: Some(self.orbits.iter().map(|orbit| orbit.error / self.jacobi).fold(0.0, f64::max)),
            precision_horizon: (fastest > CHAOTIC).then(|| -libm::log(f64::EPSILON) / fastest),
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        let section =
            self.orbits.iter().enumerate().flat_map(|(k, orbit)| orbit.section.iter().map(move |p| vec![k as f64, p.0, p.1]));
        let exponent = |(k, orbit): (usize, &Orbit)| orbit.exponents().map(|(tangent, twin)| vec![k as f64, tangent, twin]);
        let columns = |names: [&str; 3]| names.map(String::from).to_vec();
        vec![
            Table { name: "section".into(), columns: columns(["grain", "x", "x_velocity"]), rows: section.collect() },
            Table {
                name: "lyapunov".into(),
                columns: columns(["grain", "exponent_variational", "exponent_twin"]),
                rows: self.orbits.iter().enumerate().filter_map(exponent).collect(),
            },
        ]
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.02 * self.end, 0.2 * self.end]
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("three stars that move: these grains are followed with all their neighbours from their start")
    }
}

impl Restricted {
    fn chart_of_section(&self) -> Chart {
        let mut chart = Chart::new(
            "section",
            "Poincaré's section: where grains go through y = 0 upwards",
            Axis::linear("position x", ""),
            Axis::linear("velocity dx/dt", ""),
        );
        for (name, chaotic) in [("regular", false), ("chaotic", true)] {
            let of_kind = self.orbits.iter().filter(|orbit| orbit.exponents().is_some_and(|e| (e.0 > CHAOTIC) == chaotic));
            let points: Vec<(f64, f64)> = of_kind.flat_map(|orbit| orbit.section.iter().copied()).collect();
            let stride = points.len().div_ceil(2000).max(1);
            if !points.is_empty() {
                chart = chart.with(Series::new(name, Style::Points, points.into_iter().step_by(stride)));
            }
        }
        chart.noting(format!(
            "All grains have the Jacobi constant {}. Those of a regular motion draw curves, those of a chaotic one fill an area.",
            self.jacobi
        ))
    }

    /// The exponents as time goes on: those of the fastest and of the slowest grain.
    fn chart_of_growth(&self) -> Chart {
        let mut chart = Chart::new(
            "lyapunov",
            "Lyapunov exponents, by variational equations and by twins",
            Axis::logarithmic("time t", ""),
            Axis::logarithmic("ln(growth)/t", ""),
        );
        let mut ranked: Vec<&Orbit> = self.orbits.iter().filter(|orbit| orbit.growth.len() > 1).collect();
        ranked.sort_by(|a, b| a.growth[a.growth.len() - 1].0.total_cmp(&b.growth[b.growth.len() - 1].0));
        if let [slowest, .., fastest] = ranked[..] {
            for (name, orbit) in [("slowest grain", slowest), ("fastest grain", fastest)] {
                let points = |pick: fn(&(f64, f64)) -> f64| {
                    orbit.growth.iter().enumerate().map(|(k, growth)| (k as f64 + 1.0, pick(growth))).collect::<Vec<_>>()
                };
                let twin = points(|growth| growth.1);
                let few = twin.iter().copied().step_by(twin.len().div_ceil(40).max(1)).collect::<Vec<_>>();
                chart = chart
                    .with(Series::new(format!("{name}: variational equations"), Style::Theory, points(|growth| growth.0)))
                    .with(Series::new(format!("{name}: twins"), Style::Points, few));
            }
        }
        let exponents: Vec<f64> = self.exponents().iter().map(|e| e.0).filter(|&e| e > CHAOTIC).collect();
        let mean = Estimate::from_replicas(&exponents);
        let chaotic = if exponents.len() >= 2 {
            format!(" The {} chaotic grains have λ = {:.3} ± {:.3}.", exponents.len(), mean.mean, mean.standard_error)
        } else {
            String::new()
        };
        chart.noting(format!(
            "Where motion is regular the exponent goes to zero as ln(t)/t; where it is chaotic it settles.{chaotic}"
        ))
    }
}
