//! Mechanical waves on a chain of masses and springs: what a string does, and where its discreteness shows.
//!
//! `m d^2u_n/dt^2 = kappa (u_{n+1} - 2 u_n + u_{n-1})`; long waves run at `c = a sqrt(kappa/m) = sqrt(T/mu)`, short ones
//! slower: `omega = 2 sqrt(kappa/m) |sin(k a/2)|`. The chain on show starts with a pulse, a normal mode or a shaker;
//! chains beside it measure all modes, echoes from both kinds of end, a row of density steps and a running wave.
//! Everything here is deterministic and linear, so every bound is derived: from the lattice, the step of time, or rounding.

mod chain;
mod charts;
mod picture;
mod sine;
mod theory;
mod trials;
mod verdicts;

use corpuscle_checkpoint::{Fault, Resume, resume};
use std::f64::consts::TAU;

use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::{Chart, Check, Schedule};
use corpuscle_scene::Scene;
use corpuscle_time::{Integrator, Signal};

use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation, Table, ensemble};
use chain::{Chain, Design, End, Ends, Polarisation};
use theory::{Dalembert, Modes};
use trials::{Finding, Material, Trial};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "wave",
    title: "Waves on a chain",
    summary: "A pulse, a mode or a shaker on a chain of masses and springs: reflection at ends and at a density step, standing \
              waves, dispersion, and where the chain stops being a string.",
    dimensions: &[2],
    engines: &["time-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "preset",
        unit: "",
        help: "A ready-made set of the parameters below; those given beside it win.",
        kind: Kind::Choice {
            default: "density-step",
            options: &["density-step", "fixed-end", "free-end", "ring", "standing-wave", "shaker", "longitudinal"],
        },
    },
    Parameter {
        name: "polarisation",
        unit: "",
        help: "Displacements across the chain (transverse, as on a string) or along it (longitudinal, as in sound).",
        kind: Kind::Choice { default: "transverse", options: &["transverse", "longitudinal"] },
    },
    Parameter {
        name: "ends",
        unit: "",
        help: "Both ends fixed, both free, or joined to a ring (periodic); with a shaker, the end opposite to it.",
        kind: Kind::Choice { default: "fixed", options: &["fixed", "free", "periodic"] },
    },
    Parameter {
        name: "start",
        unit: "",
        help: "A Gaussian pulse running to the right, a normal mode, or rest with a shaker (drive) at the left end.",
        kind: Kind::Choice { default: "pulse", options: &["pulse", "mode", "drive"] },
    },
    Parameter {
        name: "masses",
        unit: "",
        help: "Number N of masses that can move.",
        kind: Kind::Whole { default: 100, least: 3, most: 2000 },
    },
    Parameter {
        name: "density_ratio",
        unit: "",
        help: "Mass of each mass in the right half over that in the left; 1 for a uniform chain. The steps measured beside \
               include this one.",
        kind: Kind::Real { default: 4.0, least: 0.0625, most: 16.0 },
    },
    Parameter {
        name: "amplitude",
        unit: "",
        help: "Height of the pulse, of the mode or of the shaker's motion.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "pulse_width",
        unit: "spacings",
        help: "Standard deviation of the pulse, in spacings; the narrower, the more dispersion.",
        kind: Kind::Real { default: 5.0, least: 1.0, most: 100.0 },
    },
    Parameter {
        name: "mode",
        unit: "",
        help: "Number j of the mode to start with.",
        kind: Kind::Whole { default: 3, least: 1, most: 2000 },
    },
    Parameter {
        name: "drive_frequency",
        unit: "1/time",
        help: "Frequency f of the shaker; waves longer than two spacings exist only below f = sqrt(stiffness/mass)/pi.",
        kind: Kind::Real { default: 0.025, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "stiffness",
        unit: "",
        help: "Stiffness kappa of each spring; a transverse string is under the tension stiffness x spacing.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "mass",
        unit: "",
        help: "Mass m of each mass in the left half.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "spacing",
        unit: "",
        help: "Distance a of neighbours at rest.",
        kind: Kind::Real { default: 1.0, least: 1e-3, most: 1e3 },
    },
    Parameter {
        name: "integrator",
        unit: "",
        help: "How the chain on show is advanced; the measurements beside it use velocity Verlet, whose error is known exactly.",
        kind: Kind::Choice {
            default: "velocity-verlet",
            options: &["velocity-verlet", "symplectic-euler", "yoshida-4", "runge-kutta-4", "explicit-euler"],
        },
    },
    Parameter {
        name: "time_step",
        unit: "time",
        help: "Step of time; 0 for a tenth of sqrt(mass/stiffness). Velocity Verlet is stable below 2 over the highest frequency.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e6 },
    },
    Parameter {
        name: "duration",
        unit: "time",
        help: "How long to watch; 0 for one and a half crossings of a pulse, three of a driven wave, three periods of a mode.",
        kind: Kind::Real { default: 0.0, least: 0.0, most: 1e9 },
    },
];

/// What each preset changes of the defaults, as one would write it on the command line.
fn preset(name: &str) -> &'static [(&'static str, &'static str)] {
    match name {
        "fixed-end" => &[("density_ratio", "1")],
        "free-end" => &[("density_ratio", "1"), ("ends", "free")],
        "ring" => &[("density_ratio", "1"), ("ends", "periodic")],
        "standing-wave" => &[("density_ratio", "1"), ("start", "mode"), ("masses", "60")],
        "shaker" => &[("density_ratio", "1"), ("start", "drive")],
        "longitudinal" => &[("polarisation", "longitudinal")],
        _ => &[],
    }
}

/// Samples of the energies in the whole run.
const SAMPLES: usize = 480;
/// Samples from one kept picture of the whole chain to the next.
const KEEP: usize = 20;
/// Density ratios measured beside the run's own.
const RATIOS: [f64; 6] = [1.0 / 9.0, 0.25, 0.5, 2.0, 4.0, 9.0];
/// Stability numbers on either side of velocity Verlet's limit of 2, with steps enough to tell.
const STABILITY: [(f64, u64); 2] = [(1.99, 2000), (2.01, 100)];

/// What starts the chain on show.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    Pulse { width: f64 },
    Mode(usize),
    Drive { angular_frequency: f64 },
}

/// Energies at one time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Sample {
    time: f64,
    kinetic: f64,
    elastic: f64,
    /// Energy in the left half.
    left: f64,
    /// Shadow energy of velocity Verlet.
    shadow: f64,
}

/// The running experiment.
struct Wave {
    material: Material,
    ratio: f64,
    start: Start,
    amplitude: f64,
    chain: Chain,
    /// Place of the density step.
    step: f64,
    dalembert: Option<Dalembert>,
    initial: (Vec<f64>, Vec<f64>),
    trials: Vec<Trial>,
    schedule: Schedule,
    end: f64,
    time: f64,
    samples: Vec<Sample>,
    /// The whole chain at some times.
    kept: Vec<(f64, Vec<f64>)>,
    largest: f64,
    /// Largest deviation from the superposition of normal modes, where that is known.
    deviation: Option<f64>,
    reversed: bool,
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    let mut settings = settings.clone();
    let name = settings.word("preset").to_owned();
    for (key, text) in preset(&name) {
        if !settings.is_given(key) {
            settings.set_text(key, text)?;
        }
    }
    Ok(Box::new(Wave::new(&settings)?))
}

impl Wave {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (stiffness, mass, spacing) = (settings.real("stiffness"), settings.real("mass"), settings.real("spacing"));
        let given_step = settings.real("time_step");
        let time_step = if given_step > 0.0 { given_step } else { 0.1 * (mass / stiffness).sqrt() };
        let polarisation =
            if settings.word("polarisation") == "transverse" { Polarisation::Transverse } else { Polarisation::Longitudinal };
        let material = Material { stiffness, mass, spacing, polarisation, time_step, seed: settings.seed };
        let (count, ratio, amplitude) = (settings.whole("masses"), settings.real("density_ratio"), settings.real("amplitude"));
        let c = material.speed();
        let start = match settings.word("start") {
            "pulse" => Start::Pulse { width: settings.real("pulse_width") * spacing },
            "mode" => Start::Mode(settings.whole("mode")),
            _ => Start::Drive { angular_frequency: TAU * settings.real("drive_frequency") },
        };
        let signal = match start {
            Start::Drive { angular_frequency } => {
                Signal::Sine { amplitude, angular_frequency, phase: 0.0, ramp: 2.0 * TAU / angular_frequency }
            }
            Start::Pulse { width } => Signal::Pulse { amplitude, centre: 0.0, width: width / c },
            Start::Mode(_) => Signal::Pulse { amplitude, centre: 0.0, width: 1.0 },
        };
        let other = if settings.word("ends") == "free" { End::Free } else { End::Fixed };
        let driven = matches!(start, Start::Drive { .. });
        let ends = match settings.word("ends") {
            "periodic" if driven => return Err(settings.invalid("ends", "fixed or free where a shaker drives the other end")),
            "periodic" => Ends::Ring,
            _ if driven => Ends::Between(End::Driven(signal), other),
            _ => Ends::Between(other, other),
        };
        let masses = (0..count).map(|n| if n < count / 2 { mass } else { mass * ratio }).collect();
        let integrator = Integrator::from_name(settings.word("integrator"), time_step)?;
        let design = Design { masses, stiffness, spacing, polarisation, ends, integrator };
        let limit = 2.0 / design.highest_frequency();
        if time_step >= limit {
            return Err(settings.invalid("time_step", format!("less than 2 over the highest frequency, {limit}")));
        }
        let length = design.length();
        let x = if driven { 0.0 } else { 0.25 * length };
        let (displacement, velocity) = Self::initial(settings, &design, start, amplitude, c, x)?;
        let step = 0.5 * (design.place((count / 2).max(1) - 1) + design.place(count / 2));
        let parts = if ratio == 1.0 { vec![(0.0, length, c)] } else { vec![(0.0, step, c), (step, length, c / ratio.sqrt())] };
        let crossing = length / c;
        let end = match (settings.real("duration"), start) {
            (given, _) if given > 0.0 => given,
            (_, Start::Pulse { .. }) => 1.5 * crossing,
            (_, Start::Drive { .. }) => 3.0 * crossing,
            (_, Start::Mode(j)) => {
                let phase = Modes::of(&design).map_or(1.0, |modes| modes.phase(j));
                3.0 * TAU / theory::dispersion(material.omega_0(), phase)
            }
        };
        let dalembert = match start {
            Start::Mode(_) => None,
            _ => Dalembert::new(parts, ends, signal, x, end),
        };
        let chain = Chain::new(design, &displacement, &velocity)?;
        let mut wave = Self {
            material,
            ratio,
            start,
            amplitude,
            chain,
            step,
            dalembert,
            initial: (displacement, velocity),
            trials: Self::trials(material, ratio)?,
            schedule: Schedule::new(end / SAMPLES as f64),
            end,
            time: 0.0,
            samples: vec![],
            kept: vec![],
            largest: 0.0,
            deviation: None,
            reversed: false,
        };
        wave.sample_until(0.0)?;
        Ok(wave)
    }

    /// Displacements and velocities at the start.
    fn initial(
        settings: &Settings,
        design: &Design,
        start: Start,
        amplitude: f64,
        c: f64,
        x: f64,
    ) -> Result<(Vec<f64>, Vec<f64>), Invalid> {
        let (count, ratio) = (design.count(), settings.real("density_ratio"));
        let places: Vec<f64> = (0..count).map(|n| design.place(n)).collect();
        let (displacement, velocity, strain): (Vec<f64>, Vec<f64>, f64) = match start {
            Start::Pulse { width } => {
                if 20.0 * width > design.length() {
                    let most = design.length() / (20.0 * design.spacing);
                    return Err(
                        settings.invalid("pulse_width", format!("at most a twentieth of the chain, {most}, to start clear"))
                    );
                }
                let u = |x_n: f64| amplitude * libm::exp(-0.5 * (x_n - x) * (x_n - x) / (width * width));
                let displacement = places.iter().map(|&p| u(p)).collect();
                // d'Alembert's wave to the right, u(x - c t): its velocity is -c du/dx.
                let velocity = places.iter().map(|&p| c * (p - x) / (width * width) * u(p)).collect();
                (displacement, velocity, 1.3 * amplitude / width * ratio.sqrt().max(1.0))
            }
            Start::Mode(j) => {
                if ratio != 1.0 {
                    return Err(settings.invalid("density_ratio", "1 for a start in a normal mode, whose shape is then a sine"));
                }
                let highest = Modes::of(design).map_or(0, |modes| modes.highest());
                let modes = Modes::of(design).filter(|_| j <= highest);
                let Some(modes) = modes else {
                    return Err(settings.invalid("mode", format!("a whole number from 1 to {highest}")));
                };
                let displacement = modes.shape(j).iter().map(|s| amplitude * s).collect();
                (displacement, vec![0.0; count], amplitude * modes.phase(j) / design.spacing)
            }
            Start::Drive { angular_frequency } => {
                (vec![0.0; count], vec![0.0; count], 2.0 * amplitude * angular_frequency / c * ratio.sqrt().max(1.0))
            }
        };
        if design.polarisation == Polarisation::Longitudinal && strain >= 1.0 {
            let most = amplitude / strain;
            return Err(settings.invalid("amplitude", format!("less than {most:.4}: longitudinal masses must keep their order")));
        }
        Ok((displacement, velocity))
    }

    fn trials(material: Material, ratio: f64) -> Result<Vec<Trial>, Invalid> {
        let mut trials = vec![
            Trial::modes(material, Ends::Between(End::Fixed, End::Fixed), 0)?,
            Trial::modes(material, Ends::Between(End::Free, End::Free), 1)?,
            Trial::modes(material, Ends::Ring, 2)?,
            Trial::echo(material, End::Fixed)?,
            Trial::echo(material, End::Free)?,
            Trial::travel(material)?,
        ];
        for (number, steps) in STABILITY {
            trials.push(Trial::growth(material, number, steps)?);
        }
        let mut ratios = RATIOS.to_vec();
        if ratio != 1.0 && !ratios.contains(&ratio) {
            ratios.push(ratio);
        }
        ratios.sort_by(f64::total_cmp);
        for ratio in ratios {
            trials.push(Trial::step(material, ratio)?);
        }
        Ok(trials)
    }

    fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.trials.iter().filter_map(Trial::finding)
    }

    /// d'Alembert's solution does not know that somebody turned the wave round.
    #[allow(clippy::unnecessary_wraps, reason = "what `resume!` calls may fail")]
    fn forget_when_reversed(&mut self) -> Result<(), Fault> {
        if self.reversed {
            self.dalembert = None;
        }
        Ok(())
    }

    /// Records energies and pictures at the experiment's own times.
    fn sample_until(&mut self, to: f64) -> Result<(), Invalid> {
        self.record_until(to).map_err(|failure| Invalid::new("start", failure, "a chain that can start"))
    }

    fn record_until(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            self.chain.advance(time)?;
            let energy = self.chain.energy();
            let half = self.chain.design().count() / 2;
            let dt = self.material.time_step;
            self.samples.push(Sample {
                time: self.chain.time(),
                kinetic: energy.kinetic,
                elastic: energy.elastic,
                left: energy.local[..half].iter().sum(),
                shadow: energy.total() - 0.125 * dt * dt * energy.force_term,
            });
            let displacements = self.chain.displacements();
            self.largest = displacements.iter().fold(self.largest, |most, u| most.max(u.abs()));
            if (self.samples.len() - 1).is_multiple_of(KEEP) {
                if let Some(exact) = self.exact(self.chain.time()) {
                    let off = displacements.iter().zip(exact).map(|(u, e)| (u - e).abs());
                    self.deviation = Some(off.fold(self.deviation.unwrap_or(0.0), f64::max));
                }
                self.kept.push((self.chain.time(), displacements));
            }
        }
        Ok(())
    }

    /// The exact solution of the chain advanced by velocity Verlet, as a superposition of normal modes:
    /// `Q(t) = Q cos(omega' t) + V dt sin(omega' t)/sin(omega' dt)`. None where the modes are not sines, the integrator is
    /// another one, or somebody reversed the run.
    fn exact(&self, time: f64) -> Option<Vec<f64>> {
        let design = self.chain.design();
        let Integrator::VelocityVerlet { dt } = design.integrator else { return None };
        if self.ratio != 1.0 || self.reversed || matches!(self.start, Start::Drive { .. }) || design.count() > 500 {
            return None;
        }
        let mut sum = vec![0.0; design.count()];
        for (phase, shape) in Modes::of(design)?.basis() {
            let (q, v) = (theory::project(&self.initial.0, &shape), theory::project(&self.initial.1, &shape));
            let omega = theory::verlet_frequency(theory::dispersion(self.material.omega_0(), phase), dt);
            let (sine, cosine) = libm::sincos(omega * time);
            let lever = if omega == 0.0 { time } else { dt * sine / libm::sin(omega * dt) };
            sum.iter_mut().zip(shape).for_each(|(u, s)| *u += (q * cosine + v * lever) * s);
        }
        Some(sum)
    }
}

resume!(Wave {
    values: [schedule, time, samples, kept, largest, deviation, reversed],
    parts: [chain, trials],
    set_up: [material, ratio, start, amplitude, step, dalembert, initial, end],
    then: forget_when_reversed,
});

impl Simulation for Wave {
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
        let share = to / self.end;
        ensemble::for_each(&mut self.trials, |trial| trial.advance(share))?;
        self.record_until(to)?;
        self.chain.advance(to)?;
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        self.picture(scene);
    }

    fn frame(&self) -> Option<Frame> {
        Some(self.chain.frame())
    }

    fn charts(&self) -> Vec<Chart> {
        self.all_charts()
    }

    fn checks(&self) -> Vec<Check> {
        self.verdicts()
    }

    fn honesty(&self) -> Honesty {
        let first = self.samples[0];
        let energy = |sample: &Sample| sample.kinetic + sample.elastic;
        let drift = self.samples.iter().map(|sample| (energy(sample) - energy(&first)).abs() / energy(&first));
        let driven = matches!(self.start, Start::Drive { .. });
        Honesty {
            engine: format!("time-driven, {}", self.chain.design().integrator.name()),
            work: self.chain.steps() + self.trials.iter().map(Trial::work).sum::<u64>(),
            work_unit: "steps",
            energy_drift: (!driven).then(|| drift.fold(0.0, f64::max)),
            stability_number: Some(self.chain.design().highest_frequency() * self.material.time_step),
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        self.all_tables()
    }

    fn moments(&self) -> Vec<f64> {
        (0..5).map(|k| 0.2 * f64::from(k) * self.end).collect()
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        if action != Action::Reverse {
            return action.refused("free particles: the masses of this chain are held by their springs");
        }
        if matches!(self.start, Start::Drive { .. }) {
            return action.refused("a chain without a shaker, which would go on forwards");
        }
        self.reversed = true;
        self.dalembert = None;
        self.chain.reverse()
    }
}
