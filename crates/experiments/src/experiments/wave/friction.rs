//! Chains with friction: an end that sends nothing back, modes that die away, and resonance.
//!
//! A damper of the impedance of the string takes a long wave as more string would. Friction `-m gamma v` on every mass makes a mode decay
//! as `exp(-gamma t/2)` and lowers its frequency to `sqrt(omega_j^2 - gamma^2/4)`; shaken at one end, the chain answers with standing
//! waves, largest near the frequencies of its modes. All of this is known exactly on the lattice, in continuous time; Runge and Kutta's
//! rule comes so near that the bound of each deviation is the error of the step, known from a second run with twice the step.

mod charts;
mod theory;
mod trial;

use std::f64::consts::TAU;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::{Chart, Check, Schedule};
use corpuscle_scene::{Colour, Line, Scene};
use corpuscle_time::Signal;

use super::beads::{self, HEIGHT};
use super::chain::{Chain, End, Ends};
use super::theory::{Modes, dispersion, project};
use crate::{Action, Frame, Honesty, Settings, Simulation, ensemble};
use trial::{PERIODS, Trial};

/// Samples in the whole run.
const SAMPLES: usize = 480;
/// The largest displacement drawn, over the length of the chain.
const REACH: f64 = 0.19;
/// Impedances of the ends measured, over that of the string.
const IMPEDANCES: [f64; 8] = [0.0, 1.0 / 9.0, 0.25, 0.5, 1.0, 2.0, 4.0, 9.0];
/// Friction of the modes measured, over the critical one `2 omega_j`.
const FRICTIONS: [f64; 7] = [0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.95];
/// Modes about which the response is measured, and where, in widths `gamma` of a resonance.
const RESONANCES: usize = 5;
const ABOUT: [f64; 9] = [-3.0, -1.5, -0.8, -0.4, 0.0, 0.4, 0.8, 1.5, 3.0];
/// Longest chain whose response is measured.
const LONGEST: usize = 100;

/// What a chain is made of.
#[derive(Clone, Copy, Debug)]
struct Material {
    stiffness: f64,
    mass: f64,
    spacing: f64,
}

impl Material {
    fn omega_0(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    fn speed(&self) -> f64 {
        self.spacing * self.omega_0()
    }
}

/// What is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Subject {
    /// A pulse on its way to a damper of this impedance, over the string's.
    End { impedance: f64 },
    /// A mode with this number and frequency, and its friction.
    Mode { number: usize, omega: f64, gamma: f64 },
    /// A chain shaken at this frequency.
    Shaken { omega: f64, gamma: f64 },
}

/// The running experiment.
pub(super) struct Braked {
    subject: Subject,
    material: Material,
    amplitude: f64,
    chain: Chain,
    trials: Vec<Trial>,
    schedule: Schedule,
    end: f64,
    time: f64,
    /// Time, energy, and displacement of the mode, at the samples.
    samples: Vec<(f64, f64, f64)>,
    /// Sums of `u sin(omega t)` and `u cos(omega t)` over the last periods of a driven chain, and how many.
    lock: Vec<(f64, f64)>,
    locked: u64,
}

resume!(Braked {
    values: [schedule, time, samples, lock, locked],
    parts: [chain, trials],
    set_up: [subject, material, amplitude, end],
});

impl Braked {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let material =
            Material { stiffness: settings.real("stiffness"), mass: settings.real("mass"), spacing: settings.real("spacing") };
        let (count, amplitude) = (settings.whole("masses"), settings.real("amplitude"));
        let omega_0 = material.omega_0();
        let gamma = settings.real("damping") * omega_0;
        let fixed = Ends::Between(End::Fixed, End::Fixed);
        let design = |ends, friction, dt| trial::design(material, count, ends, friction, dt);
        let uniform = vec![gamma; count];
        let dt = 0.05 / omega_0;
        let modes = Modes::of(&design(fixed, vec![], dt));
        let omega_of = |j: usize| modes.map_or(f64::NAN, |modes| dispersion(omega_0, modes.phase(j)));
        let mode = settings.whole("mode");
        if mode > count && settings.idle_under("mode").is_none() {
            return Err(settings.invalid("mode", format!("a whole number from 1 to {count}")));
        }
        let (subject, chain, trials, end) = match settings.word("preset") {
            "matched-end" => {
                let impedance = settings.real("end_impedance");
                // A strong damper is a stiff equation.
                let dt = dt / impedance.max(1.0);
                let design = design(Ends::Between(End::Fixed, End::Free), trial::damper(material, count, impedance), dt);
                let (u, v) = pulse(settings, &design, amplitude, material)?;
                let end = 1.6 * design.length() / material.speed();
                let mut impedances = IMPEDANCES.to_vec();
                if !impedances.contains(&impedance) {
                    impedances.push(impedance);
                }
                let trials = impedances.into_iter().map(|z| Trial::echo(material, z)).collect::<Result<Vec<_>, _>>()?;
                (Subject::End { impedance }, Chain::new(design, &u, &v)?, trials, end)
            }
            "damped-mode" => {
                let omega = omega_of(mode);
                let shape = modes.map_or_else(Vec::new, |modes| modes.shape(mode));
                let start: Vec<f64> = shape.iter().map(|s| amplitude * s).collect();
                let chain = Chain::new(design(fixed, uniform, dt), &start, &vec![0.0; count])?;
                let trial = |part: &f64| Trial::decay(material, count, mode, part * 2.0 * omega);
                let trials = FRICTIONS.iter().map(trial).collect::<Result<Vec<_>, _>>()?;
                (Subject::Mode { number: mode, omega, gamma }, chain, trials, 8.0 * TAU / omega)
            }
            _ => {
                if count > LONGEST {
                    return Err(settings.invalid("masses", format!("at most {LONGEST} where all resonances are measured")));
                }
                if gamma >= 1.6 * omega_of(1) {
                    let most = 1.6 * omega_of(1) / omega_0;
                    return Err(settings.invalid("damping", format!("less than {most:.4}: more of it leaves no resonance")));
                }
                let frequency = settings.real("drive_frequency");
                let omega = if frequency > 0.0 { TAU * frequency } else { omega_of(mode) };
                // Each period has whole steps.
                let steps = (TAU / (omega * dt)).ceil().max(8.0);
                let signal = Signal::Sine { amplitude, angular_frequency: omega, phase: 0.0, ramp: 2.0 * TAU / omega };
                let ends = Ends::Between(End::Driven(signal), End::Fixed);
                let chain = Chain::new(design(ends, uniform, TAU / (omega * steps)), &[], &[])?;
                let places = places_of_response(&(1..=RESONANCES.min(count)).map(omega_of).collect::<Vec<_>>(), gamma);
                let trial = |&omega: &f64| Trial::response(material, count, watched(count), omega, gamma);
                let trials = ensemble::build(&places, trial)?;
                let periods = (trial::settling(gamma) * omega / TAU).ceil().min(40.0) + 2.0 + PERIODS as f64;
                (Subject::Shaken { omega, gamma }, chain, trials, periods * TAU / omega)
            }
        };
        let given = settings.real("duration");
        let end = if given > 0.0 { given } else { end };
        let lock = vec![(0.0, 0.0); count];
        let schedule = Schedule::new(end / SAMPLES as f64);
        let mut this =
            Self { subject, material, amplitude, chain, trials, schedule, end, time: 0.0, samples: vec![], lock, locked: 0 };
        this.record_until(0.0).map_err(|failure| Invalid::new("preset", failure, "a chain that can start"))?;
        Ok(this)
    }

    fn record_until(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            self.advance_chain(time)?;
            let mode = match self.subject {
                Subject::Mode { number, .. } => {
                    Modes::of(self.chain.design()).map_or(0.0, |modes| project(&self.chain.displacements(), &modes.shape(number)))
                }
                _ => 0.0,
            };
            self.samples.push((self.chain.time(), self.chain.energy().total(), mode));
        }
        Ok(())
    }

    /// Advances the chain on show. In the last periods of a driven one, each step is noted.
    fn advance_chain(&mut self, to: f64) -> Result<(), Failure> {
        let Subject::Shaken { omega, .. } = self.subject else { return self.chain.advance(to) };
        let Some(dt) = self.chain.design().integrator.dt() else { return self.chain.advance(to) };
        let period = (TAU / (omega * dt)).round() as u64;
        let last = (self.end / dt).round() as u64;
        let first = last.saturating_sub(PERIODS * period);
        while (self.chain.steps() + 1) as f64 * dt <= to * (1.0 + 4.0 * f64::EPSILON) {
            let step = self.chain.steps() + 1;
            self.chain.advance((step as f64 + 0.25) * dt)?;
            if step > first && step <= last {
                let (sine, cosine) = libm::sincos(omega * dt * step as f64);
                for (sum, u) in self.lock.iter_mut().zip(self.chain.displacements()) {
                    *sum = (sum.0 + u * sine, sum.1 + u * cosine);
                }
                self.locked += 1;
            }
        }
        Ok(())
    }

    /// Largest deviation of a trial from theory over its bound, once all are done.
    fn worst(&self) -> Option<f64> {
        let deviations: Option<Vec<f64>> = self.trials.iter().map(Trial::deviation).collect();
        // A NaN must not get lost.
        Some(deviations?.into_iter().fold(0.0, |most: f64, d| if d > most || d.is_nan() { d } else { most }))
    }
}

/// Mass whose response is measured: off the middle, where every second mode has a node.
fn watched(count: usize) -> usize {
    count / 5
}

/// Frequencies at which a response is measured: about each resonance, and halfway between two.
fn places_of_response(modes: &[f64], gamma: f64) -> Vec<f64> {
    let mut places: Vec<f64> = modes.iter().flat_map(|omega| ABOUT.map(|widths| omega + widths * gamma)).collect();
    places.extend(modes.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])));
    let (least, most) = (0.2 * modes[0], 1.15 * modes[modes.len() - 1]);
    places.retain(|&omega| omega > least && omega < most);
    places.push(least);
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| *a - *b < 0.05 * gamma);
    places
}

/// A pulse at a quarter of the chain, running to the right.
fn pulse(
    settings: &Settings,
    design: &super::chain::Design,
    amplitude: f64,
    material: Material,
) -> Result<(Vec<f64>, Vec<f64>), Invalid> {
    let (width, middle) = (settings.real("pulse_width") * design.spacing, 0.25 * design.length());
    if 20.0 * width > design.length() {
        let most = design.length() / (20.0 * design.spacing);
        return Err(settings.invalid("pulse_width", format!("at most a twentieth of the chain, {most}, to start clear")));
    }
    let offsets = (0..design.count()).map(|n| (design.place(n) - middle) / width);
    Ok(offsets
        .map(|x| {
            let u = amplitude * libm::exp(-0.5 * x * x);
            (u, material.speed() / width * x * u)
        })
        .unzip())
}

impl Simulation for Braked {
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
        self.advance_chain(to)?;
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        let design = self.chain.design();
        let length = design.length();
        beads::stage(scene, length, self.chain.time());
        scene.title = "Waves on a chain".into();
        let largest = match self.subject {
            Subject::Shaken { omega, gamma } => {
                let parts = theory::response(omega, gamma, self.material.omega_0(), design.count());
                self.amplitude * parts.iter().fold(1.0, |most: f64, (a, b)| most.max(a.hypot(*b)))
            }
            Subject::End { .. } => 2.0 * self.amplitude,
            Subject::Mode { .. } => self.amplitude,
        };
        let scale = REACH * length / largest;
        let radius = (0.48 * design.spacing).min(0.009 * length);
        beads::string(scene, &self.chain, |u| scale * u, |_| radius, |_| 0.0);
        let half = 0.5 * HEIGHT * length;
        let post = |x: f64, width: f32, colour: Colour| Line { from: [x, -half, 0.0], to: [x, half, 0.0], width, colour };
        for (x, _) in self.chain.anchors() {
            let shaken = x == 0.0 && matches!(self.subject, Subject::Shaken { .. });
            scene.lines.push(if shaken { post(x, 1.5, Colour::Accent(1)) } else { post(x, 4.0, Colour::Wall) });
        }
        if let Subject::End { .. } = self.subject {
            // The damper: a ring on a rod that holds it back.
            let last = design.count() - 1;
            scene.bodies[last].radius = 1.4 * radius;
            scene.lines.push(post(design.place(last), 4.0, Colour::Accent(1)));
        }
        let told = match self.subject {
            Subject::End { impedance } => {
                let left = self.chain.energy().total() / self.samples[0].1;
                format!("damper of {impedance} Z, echo {:+.3} in theory, energy left {:.2} %", long_echo(impedance), 100.0 * left)
            }
            Subject::Mode { number, omega, gamma } => format!("mode {number}, omega = {omega:.4}, gamma = {gamma:.4}"),
            Subject::Shaken { omega, gamma } => format!("shaken at omega = {omega:.4}, gamma = {gamma:.4}"),
        };
        scene.caption = format!("{told}  ·  heights × {scale:.0}");
    }

    fn frame(&self) -> Option<Frame> {
        Some(self.chain.frame())
    }

    fn charts(&self) -> Vec<Chart> {
        self.all_charts()
    }

    fn checks(&self) -> Vec<Check> {
        let Some(worst) = self.worst() else { return vec![] };
        let step = "bound: an eighth of what twice the step of time changes, and rounding";
        match self.subject {
            Subject::End { impedance } => {
                let mut checks = vec![Check::at_most(
                    format!("echoes of {} ends: largest deviation from the lattice's over its bound", self.trials.len()),
                    worst,
                    1.0,
                    format!("(1 - z exp(-i k a/2))/(1 + z exp(i k a/2)), z = Z'/Z, over the pulse's spectrum; {step}"),
                )];
                let own = self
                    .trials
                    .iter()
                    .find(|trial| matches!(trial.purpose, trial::Purpose::Echo { impedance: z } if z == impedance));
                if let Some((finding, lattice)) = own.and_then(|trial| Some((trial.finding?, trial.expected()[0]))) {
                    let (echo, long) = (finding.measured[0], long_echo(impedance));
                    checks.push(Check::at_most(
                        format!("echo {echo:.5} from an end of {impedance} Z: deviation from {long:.5}"),
                        (echo - long).abs(),
                        (lattice - long).abs() + finding.bound[0],
                        "(Z - Z')/(Z + Z') of long waves; bound: what the lattice changes of it, and the step of time",
                    ));
                }
                checks
            }
            Subject::Mode { .. } => vec![Check::at_most(
                format!("frequency and decay at {} frictions: largest deviation over its bound", self.trials.len()),
                worst,
                1.0,
                format!("sqrt(omega_j^2 - gamma^2/4) and gamma/2; {step}"),
            )],
            Subject::Shaken { .. } => vec![Check::at_most(
                format!("amplitude and phase at {} frequencies: largest deviation over its bound", self.trials.len()),
                worst,
                1.0,
                format!("sin(theta (L - n))/sin(theta L), 2 (1 - cos theta) = (omega^2 - i gamma omega)/omega_0^2; {step}"),
            )],
        }
    }

    fn honesty(&self) -> Honesty {
        Honesty {
            engine: "time-driven, runge-kutta-4".into(),
            work: self.chain.steps() + self.trials.iter().map(Trial::work).sum::<u64>(),
            work_unit: "steps",
            stability_number: self.chain.design().integrator.dt().map(|dt| dt * self.chain.design().highest_frequency()),
            ..Honesty::default()
        }
    }

    fn moments(&self) -> Vec<f64> {
        match self.subject {
            Subject::End { .. } => [0.0, 0.3, 0.47, 0.6].map(|share| share * self.end).to_vec(),
            _ => [0.0, 0.03, 0.1, 0.5].map(|share| share * self.end).to_vec(),
        }
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("a chain without friction, whose way back is as its way forth")
    }
}

/// Echo of long waves from an end of this impedance, over the string's.
fn long_echo(impedance: f64) -> f64 {
    (1.0 - impedance) / (1.0 + impedance)
}
