//! Chains whose springs do not obey Hooke: the one of Fermi, Pasta, Ulam and Tsingou, which never thermalised, and Toda's,
//! which explains why.
//!
//! Both run twice, with one step of time and with twice that: what the step does to a result is then known.

mod fput;
mod toda;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis, Boundary, Engine, Failure, Invalid, Particles, Vector};
use corpuscle_observe::{Chart, Check, Schedule};
use corpuscle_scene::{Body, Colour, Label, Line, Region, Scene};
use corpuscle_time::{Bonds, Force, Integrator, Pin, Spring, Springs, TimeDriven, Toda};

use super::beads::{self, HEIGHT};
use crate::{Action, Frame, Honesty, Settings, Simulation, Table, ensemble};
use fput::Recurrence;
use toda::Solitons;

/// Samples in the whole run.
const SAMPLES: usize = 1200;
/// The largest displacement drawn, over the length of the chain.
const REACH: f64 = 0.16;

/// A chain of masses along a line, its ends held.
struct Row {
    engine: TimeDriven<1>,
    rest: Vec<f64>,
}

resume!(Row { values: [], parts: [engine], set_up: [rest] });

/// What both chains are made of.
#[derive(Clone, Copy, Debug)]
struct Material {
    masses: usize,
    stiffness: f64,
    mass: f64,
    spacing: f64,
}

impl Material {
    /// `omega_0 = sqrt(kappa/m)`, the inverse of the time a long wave takes from mass to mass.
    fn omega_0(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }
}

/// The law of the springs.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// Tension `k (x + alpha x^2)`.
    Quadratic(f64),
    /// Tension `(k/b) (1 - exp(-b x))`.
    Toda(f64),
}

impl Row {
    /// Masses `1..=N` between walls `0` and `N + 1`, with displacements of all of these and velocities.
    fn new(material: Material, law: Law, integrator: Integrator, displacement: &[f64], velocity: &[f64]) -> Result<Self, Invalid> {
        let Material { masses, stiffness, mass, spacing } = material;
        let rest: Vec<f64> = (0..masses + 2).map(|n| n as f64 * spacing).collect();
        let mut particles = Particles::<1>::new();
        for ((&x, &u), &v) in rest.iter().zip(displacement).zip(velocity) {
            particles.push(Vector([x + u]), Vector([v]), mass, 0.0, 0);
        }
        let last = masses + 1;
        let force: Box<dyn Force<1>> = match law {
            Law::Quadratic(quadratic) => Box::new(Springs::new(
                (0..last).map(|n| Spring { quadratic, ..Spring::new(n, n + 1, stiffness, spacing) }).collect(),
            )),
            Law::Toda(steepness) => {
                let law = Toda { stiffness, steepness, rest_length: spacing };
                Box::new(Bonds::new(law, (0..last).map(|n| (n, n + 1)).collect()))
            }
        };
        let space = Boundary::new([-spacing], [rest[last] + spacing], Axis::Open);
        let pins = [0, last].map(|particle| Pin { particle, axes: [true] }).to_vec();
        let engine = TimeDriven::new(space, particles, vec![force], integrator)?.with_pins(pins)?;
        Ok(Self { engine, rest })
    }

    /// Displacements of walls and masses.
    fn displacements(&self) -> Vec<f64> {
        self.engine.particles().position.iter().zip(&self.rest).map(|(r, rest)| r[0] - rest).collect()
    }

    fn velocities(&self) -> Vec<f64> {
        self.engine.particles().velocity.iter().map(|v| v[0]).collect()
    }
}

/// What is measured on either chain.
enum Purpose {
    Recurrence(Recurrence),
    Solitons(Solitons),
}

impl Resume for Purpose {
    fn save(&self, out: &mut corpuscle_checkpoint::Writer) -> Result<(), corpuscle_checkpoint::Fault> {
        match self {
            Self::Recurrence(part) => part.save(out),
            Self::Solitons(part) => part.save(out),
        }
    }

    fn load(&mut self, from: &mut corpuscle_checkpoint::Reader<'_>) -> Result<(), corpuscle_checkpoint::Fault> {
        match self {
            Self::Recurrence(part) => part.load(from),
            Self::Solitons(part) => part.load(from),
        }
    }
}

/// The running experiment.
pub(super) struct Nonlinear {
    material: Material,
    purpose: Purpose,
    /// With the step asked for, with twice that step, and as Fermi, Pasta, Ulam and Tsingou did it.
    rows: Vec<Row>,
    schedule: Schedule,
    end: f64,
    time: f64,
    energy_at_start: f64,
    energy_error: f64,
}

resume!(Nonlinear { values: [schedule, time, energy_error], parts: [purpose, rows], set_up: [material, end, energy_at_start] });

impl Nonlinear {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let material = Material {
            masses: settings.whole("masses"),
            stiffness: settings.real("stiffness"),
            mass: settings.real("mass"),
            spacing: settings.real("spacing"),
        };
        let given = settings.real("time_step");
        // Solitons are steep: their springs are stiffer than at rest.
        let share = if settings.word("preset") == "solitons" { 0.02 } else { 0.1 };
        let dt = if given > 0.0 { given } else { share / material.omega_0() };
        if dt * material.omega_0() > 0.35 {
            return Err(settings.invalid("time_step", format!("at most {}", 0.35 / material.omega_0())));
        }
        let (purpose, law, displacement, velocity, end) = if settings.word("preset") == "solitons" {
            let solitons = Solitons::new(settings, material)?;
            let (u, v) = (solitons.displacements(0.0), solitons.velocities(0.0));
            let (law, end) = (Law::Toda(solitons.steepness()), solitons.end());
            (Purpose::Solitons(solitons), law, u, v, end)
        } else {
            let recurrence = Recurrence::new(settings, material)?;
            let (u, v, law) = (recurrence.start(), vec![0.0; material.masses + 2], Law::Quadratic(recurrence.alpha()));
            let end = recurrence.end();
            (Purpose::Recurrence(recurrence), law, u, v, end)
        };
        let mut integrators = vec![Integrator::Yoshida4 { dt }, Integrator::Yoshida4 { dt: 2.0 * dt }];
        if let Purpose::Recurrence(part) = &purpose {
            integrators.push(part.original());
        }
        let rows = integrators.into_iter().map(|integrator| Row::new(material, law, integrator, &displacement, &velocity));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        let given = settings.real("duration");
        let end = if given > 0.0 { given } else { end };
        let energy_at_start = rows[0].engine.energy();
        let schedule = Schedule::new(end / SAMPLES as f64);
        let mut chain = Self { material, purpose, rows, schedule, end, time: 0.0, energy_at_start, energy_error: 0.0 };
        chain.record_until(0.0).map_err(|failure| Invalid::new("start", failure, "a chain that can start"))?;
        Ok(chain)
    }

    fn record_until(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            ensemble::for_each(&mut self.rows, |row| row.engine.advance(time, &mut ()))?;
            let error = (self.rows[0].engine.energy() / self.energy_at_start - 1.0).abs();
            self.energy_error = self.energy_error.max(error);
            match &mut self.purpose {
                Purpose::Recurrence(part) => part.see(&self.rows),
                Purpose::Solitons(part) => part.see(&self.rows),
            }
        }
        Ok(())
    }

    /// Length of the row between its walls.
    fn length(&self) -> f64 {
        (self.material.masses + 1) as f64 * self.material.spacing
    }
}

impl Simulation for Nonlinear {
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
        self.record_until(to)?;
        // What is seen between two samples.
        self.rows[0].engine.advance(to, &mut ())?;
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        beads::stage(scene, self.length(), self.rows[0].engine.time());
        match &self.purpose {
            Purpose::Recurrence(part) => self.draw_recurrence(part, scene),
            Purpose::Solitons(part) => self.draw_solitons(part, scene),
        }
    }

    /// Walls and masses of the chain with the finest step, along a line.
    fn frame(&self) -> Option<Frame> {
        let engine = &self.rows[0].engine;
        let mut frame = Frame::new(engine.time(), engine.boundary(), engine.particles(), &["masses".into(), "walls".into()]);
        let last = frame.particles.len() - 1;
        (frame.particles.species[0], frame.particles.species[last]) = (1, 1);
        Some(frame)
    }

    fn charts(&self) -> Vec<Chart> {
        match &self.purpose {
            Purpose::Recurrence(part) => part.charts(),
            Purpose::Solitons(part) => part.charts(&self.rows[0]),
        }
    }

    fn checks(&self) -> Vec<Check> {
        if self.time <= 0.0 {
            return vec![];
        }
        match &self.purpose {
            Purpose::Recurrence(part) => part.checks(),
            Purpose::Solitons(part) => part.checks(self.rows[0].engine.time(), self.end),
        }
    }

    fn honesty(&self) -> Honesty {
        Honesty {
            engine: "time-driven, yoshida-4".into(),
            work: self.rows.iter().map(|row| row.engine.steps()).sum(),
            work_unit: "steps",
            energy_drift: Some(self.energy_error),
            stability_number: self.rows[0].engine.integrator().dt().map(|dt| 2.0 * self.material.omega_0() * dt),
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        match &self.purpose {
            Purpose::Recurrence(part) => vec![part.table()],
            Purpose::Solitons(part) => vec![part.table()],
        }
    }

    fn moments(&self) -> Vec<f64> {
        [0.1, 0.3, 0.5, 0.75].map(|share| share * self.end).to_vec()
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("a linear chain: solitons and recurrences are measured from their start")
    }
}

impl Nonlinear {
    /// Masses at their places, with these heights; and the springs between them.
    fn draw_row(&self, scene: &mut Scene, heights: &[f64], base: f64) {
        let spacing = self.material.spacing;
        let radius = (0.35 * spacing).min(0.008 * self.length());
        let place = |n: usize| [n as f64 * spacing, base + heights[n], 0.0];
        for n in 0..heights.len() {
            scene.bodies.push(Body { position: place(n), radius, shade: 0.0, time: scene.time, ..Body::default() });
            if n > 0 {
                scene.lines.push(Line { from: place(n - 1), to: place(n), width: 1.2, colour: Colour::Faint });
            }
        }
    }

    /// The chain above, and the share of the energy in each of the lowest modes below.
    fn draw_recurrence(&self, part: &Recurrence, scene: &mut Scene) {
        scene.title = "Fermi, Pasta, Ulam and Tsingou's chain".into();
        scene.caption = part.caption();
        let (length, scale) = (self.length(), REACH * self.length() / part.amplitude());
        let heights: Vec<f64> = self.rows[0].displacements().iter().map(|u| scale * u / 1.4).collect();
        self.draw_row(scene, &heights, 0.25 * HEIGHT * length);
        let floor = -0.42 * HEIGHT * length;
        let shares = part.shares_now();
        let width = length / shares.len() as f64;
        for (mode, share) in shares.into_iter().enumerate() {
            let from = (mode as f64 + 0.2) * width;
            let (lower, upper) = ([from, floor], [from + 0.6 * width, floor + 0.4 * HEIGHT * length * share.max(0.002)]);
            // Opaque bars: a region's colour is that of its role.
            scene.regions.push(Region { lower, upper, colour: Colour::Accent(mode as u8 % 7) });
            let at = [from + 0.3 * width, floor - 0.035 * length, 0.0];
            scene.labels.push(Label { at, text: format!("mode {}", mode + 1), colour: Colour::Ink });
        }
    }

    /// How much each spring pulls, drawn upwards where it is pressed; and the exact solution behind it.
    fn draw_solitons(&self, part: &Solitons, scene: &mut Scene) {
        scene.title = "Solitons on Toda's chain".into();
        scene.caption = part.caption(scene.time);
        let scale = 1.8 * REACH * self.length() / part.highest();
        let base = -0.3 * HEIGHT * self.length();
        let heights: Vec<f64> = part.pressure(&self.rows[0].displacements()).iter().map(|f| scale * f).collect();
        let exact: Vec<f64> = part.pressure(&part.displacements(scene.time)).iter().map(|f| scale * f).collect();
        for (n, pair) in exact.windows(2).enumerate() {
            let at = |k: usize| [(n + k) as f64 * self.material.spacing, base + pair[k], 0.0];
            scene.lines.push(Line { from: at(0), to: at(1), width: 3.0, colour: Colour::Accent(1) });
        }
        self.draw_row(scene, &heights, base);
    }
}
