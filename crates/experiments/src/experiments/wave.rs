//! Mechanical waves on a chain of masses and springs: what a string does, and where its discreteness shows.
//!
//! `m d^2u_n/dt^2 = kappa (u_{n+1} - 2 u_n + u_{n-1})`; long waves run at `c = a sqrt(kappa/m) = sqrt(T/mu)`, short ones
//! slower: `omega = 2 sqrt(kappa/m) |sin(k a/2)|`. The chain on show starts with a pulse, a normal mode or a shaker;
//! chains beside it measure all modes, echoes from both kinds of end, a row of density steps and a running wave.
//! Everything here is deterministic and linear, so every bound is derived: from the lattice, the step of time, or rounding.

mod beads;
mod chain;
mod charts;
mod friction;
mod held;
mod initial;
mod membrane;
mod nonlinear;
mod parameters;
mod picture;
mod sine;
mod spectra;
mod sponge;
mod theory;
mod trials;
mod verdicts;

use corpuscle_checkpoint::{Fault, Resume, resume};
use std::f64::consts::TAU;

use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::{Chart, Check, Schedule};
use corpuscle_scene::Scene;
use corpuscle_time::{Integrator, Signal};

use crate::{Action, Experiment, Frame, Honesty, Settings, Simulation, Table, ensemble};
use chain::{Chain, Design, End, Ends, Polarisation};
use friction::Braked;
use held::Held;
use membrane::Membrane;
use nonlinear::Nonlinear;
use spectra::Spectra;
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
    parameters: parameters::PARAMETERS,
    start,
};

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
    /// A copy that a hand plays with, while the measured chain goes on.
    in_hand: Option<Held>,
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("preset") {
        "fermi-pasta" | "solitons" => Box::new(Nonlinear::new(settings)?),
        "dispersion" => Box::new(Spectra::new(settings)?),
        "matched-end" | "damped-mode" | "resonance" => Box::new(Braked::new(settings)?),
        "two-sources" | "double-slit" | "single-slit" | "doppler" => Box::new(Membrane::new(settings)?),
        _ => Box::new(Wave::new(settings)?),
    })
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
            _ if settings.real("drive_frequency") > 0.0 => {
                Start::Drive { angular_frequency: TAU * settings.real("drive_frequency") }
            }
            _ => return Err(settings.invalid("drive_frequency", "a number above 0: this chain has no mode to shake in")),
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
        let design = Design { masses, stiffness, spacing, polarisation, ends, integrator, friction: vec![] };
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
            in_hand: None,
        };
        wave.sample_until(0.0)?;
        Ok(wave)
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
    set_up: [material, ratio, start, amplitude, step, dalembert, initial, end, in_hand],
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
        self.in_hand.as_mut().map_or(Ok(()), |held| held.advance(to))?;
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

    fn refusal(&self, action: Action) -> Option<&'static str> {
        match action {
            Action::Reverse | Action::Place { .. } | Action::Throw { .. } if !matches!(self.start, Start::Drive { .. }) => None,
            Action::Reverse | Action::Place { .. } | Action::Throw { .. } => Some("a chain without a shaker, which would go on"),
            _ => Some("free particles: the masses of this chain are held by their springs"),
        }
    }

    /// The reversal is of the measured chain, as long as no hand has touched it otherwise.
    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        action.allowed(self)?;
        if action != Action::Reverse {
            return self.touch(action);
        }
        self.reversed = true;
        self.dalembert = None;
        self.chain.reverse()?;
        self.in_hand.as_mut().map_or(Ok(()), |held| held.chain.reverse())
    }
}
