//! The Lennard-Jones fluid: argon, more or less, as a gas, as a liquid and frozen, held against published values.
//!
//! `U(r) = 4 epsilon ((sigma/r)^12 - (sigma/r)^6)`, cut at `r_c = 3 sigma`, in reduced units (`epsilon = sigma = m = k_B = 1`), at constant
//! temperature. Of the liquid, energy and pressure stand beside those of the NIST Standard Reference Simulation Website
//! (doi:10.18434/T4M88Q; Monte Carlo, 500 particles, the same cutoff), with the usual corrections for what lies beyond, where
//! `g = 1`: `U/N + (8/3) pi rho (r_c^-9/3 - r_c^-3)`, `P + (16/3) pi rho^2 (2 r_c^-9/3 - r_c^-3)`. Of the thin gas, beside the second
//! virial coefficient `B_2 = -2 pi int (e^(-U/kT) - 1) r^2 dr`: `P = rho k T (1 + B_2 rho)`, `U/N = -rho T^2 dB_2/dT`, and
//! `g(r) = e^(-U(r)/kT)`. Of the crystal, beside the lattice and its phonons.

mod solid;

use std::f64::consts::PI;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Boundary, Engine, Failure, Invalid, Particles, Random, Vector, placement};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate, RadialDistribution, Schedule, blocking};
use corpuscle_scene::{Colouring, Scene};
use corpuscle_time::{Force, Integrator, LennardJones, PairForce, TimeDriven};

use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation, drawing, hand};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "lennard-jones",
    title: "The Lennard-Jones fluid",
    summary: "Soft particles that attract each other, as a thin gas, a liquid and a crystal: structure, energy and pressure beside \
              published values.",
    dimensions: &[3],
    engines: &["time-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "state",
        unit: "",
        help: "A liquid close to its vapour, a denser one under pressure, a thin gas, or a cold crystal (solid); theory or published \
               values for each.",
        kind: Kind::Choice { default: "liquid", options: &["liquid", "dense", "gas", "solid"] },
    },
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of particles; published values are of 500. A crystal has 4 n^3: 256, 500, 864 ...",
        kind: Kind::Whole { default: 500, least: 250, most: 100_000 },
    },
    Parameter {
        name: "time_step",
        unit: "",
        help: "Step of the integrator.",
        kind: Kind::Real { default: 0.004, least: 1e-4, most: 0.01 },
    },
    Parameter {
        name: "duration",
        unit: "",
        help: "How long is measured, in units of sigma sqrt(m/epsilon), 2 ps of argon; the gas four times as long.",
        kind: Kind::Real { default: 100.0, least: 5.0, most: 1e6 },
    },
];

/// Distance at which the potential is cut.
const CUTOFF: f64 = 3.0;
/// Time before the measurement: the lattice has melted, and the gas mixed.
const SETTLING: f64 = 12.0;
/// Samples per time; of the structure a tenth as many.
const RESOLUTION: f64 = 10.0;
/// Rate of the friction of a crystal's bath.
const FRICTION: f64 = 4.0;
const STRUCTURE: u64 = 10;
/// Range and bins of `g(r)`.
const RANGE: f64 = 3.5;
const BINS: usize = 140;

/// A state with what is known of it.
#[derive(Clone, Copy)]
struct State {
    density: f64,
    temperature: f64,
    /// Energy per particle and pressure.
    expected: [Estimate; 2],
    reference: &'static str,
    phase: Phase,
    /// How many times slower things happen than in the liquid: sampled as much more rarely, and measured as much longer.
    pace: f64,
}

/// What is known of a state, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Energies are those of the potential cut and not shifted, with what lies beyond added.
    Liquid,
    /// Cut and shifted.
    Gas,
    /// Cut and not shifted; theory knows of nothing beyond.
    Solid,
}

const NIST: &str = "NIST Standard Reference Simulation Website, doi:10.18434/T4M88Q: constant volume, T = 0.85";

impl State {
    /// The force between atoms.
    fn forces(&self) -> Vec<Box<dyn Force<3>>> {
        let force = PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: CUTOFF });
        vec![Box::new(if self.phase == Phase::Gas { force } else { force.unshifted() })]
    }

    /// The state of this name, of so many particles.
    fn named(word: &str, count: usize) -> Self {
        let published = |density: f64, energy: Estimate, pressure: Estimate| Self {
            density,
            temperature: 0.85,
            expected: [energy, pressure],
            reference: NIST,
            phase: Phase::Liquid,
            pace: 1.0,
        };
        match word {
            "dense" => published(0.82, Estimate::new(-5.7947, 6.03e-4), Estimate::new(5.5355e-1, 4.13e-3)),
            "gas" => {
                let (density, temperature) = (0.002, 1.5);
                let [second, slope] = second_virial(temperature);
                let energy = -density * temperature * temperature * slope;
                let pressure = density * temperature * (1.0 + second * density);
                let expected = [Estimate::exact(energy), Estimate::exact(pressure)];
                let reference = "second virial coefficient, by quadrature; the third adds less than a hundredth";
                Self { density, temperature, expected, reference, phase: Phase::Gas, pace: 4.0 }
            }
            "solid" => {
                // Nearly without pressure; the cutoff lies midway between two shells, farther from either than atoms get.
                let (density, temperature) = (1.08, 0.1);
                let expected = solid::crystal(count, density).map_or([f64::NAN; 2], |crystal| crystal.expected(temperature));
                let reference =
                    "lattice and phonons of this very crystal, with van der Hoef's anharmonic part (2000, doi:10.1063/1.1314342)";
                Self { density, temperature, expected: expected.map(Estimate::exact), reference, phase: Phase::Solid, pace: 1.0 }
            }
            _ => published(0.776, Estimate::new(-5.5121, 4.55e-4), Estimate::new(6.7714e-3, 1.72e-3)),
        }
    }

    /// What lies beyond the cutoff, of energy per particle and pressure.
    fn beyond(&self) -> [f64; 2] {
        if self.phase != Phase::Liquid {
            return [0.0; 2];
        }
        let (third, ninth) = (CUTOFF.powi(-3), CUTOFF.powi(-9));
        let energy = 8.0 / 3.0 * PI * self.density * (ninth / 3.0 - third);
        [energy, 16.0 / 3.0 * PI * self.density * self.density * (2.0 / 3.0 * ninth - third)]
    }
}

/// The potential without its cut.
fn potential(r: f64) -> f64 {
    let sixth = r.powi(-6);
    4.0 * sixth * (sixth - 1.0)
}

/// `B_2` and `dB_2/dT` of the potential cut and shifted to zero at the cutoff, which is what the forces belong to; Simpson.
fn second_virial(temperature: f64) -> [f64; 2] {
    const STEPS: usize = 20_000;
    let h = CUTOFF / STEPS as f64;
    let shift = potential(CUTOFF);
    let mut sums = [0.0; 2];
    for k in 0..=STEPS {
        let r = h * k as f64;
        let weight = if k == 0 || k == STEPS {
            1.0
        } else if k % 2 == 1 {
            4.0
        } else {
            2.0
        };
        // Closer than that nothing ever comes: the factor is e^(-10^6) and less.
        let (mayer, slope) = if r < 0.3 {
            (-1.0, 0.0)
        } else {
            let energy = potential(r) - shift;
            let boltzmann = libm::exp(-energy / temperature);
            (boltzmann - 1.0, boltzmann * energy / (temperature * temperature))
        };
        sums[0] += weight * mayer * r * r;
        sums[1] += weight * slope * r * r;
    }
    sums.map(|sum| -2.0 * PI * sum * h / 3.0)
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Fluid::new(settings)?))
}

/// The running experiment.
struct Fluid {
    state: State,
    duration: f64,
    engine: TimeDriven<3>,
    schedule: Schedule,
    /// Energies per particle, pressures and temperatures at the samples, what lies beyond the cutoff included.
    energies: Vec<f64>,
    pressures: Vec<f64>,
    temperatures: Vec<f64>,
    structure: RadialDistribution<3>,
    started: f64,
    /// Of a crystal, with its shells of neighbours.
    crystal: Option<(solid::Crystal, Vec<solid::Shell>)>,
    in_hand: Option<Held>,
}

/// A copy that a hand plays with while the measurement goes on: a fluid that starts where the other one is.
struct Held {
    engine: TimeDriven<3>,
    /// Time of its start, on the other one's clock.
    since: f64,
}

/// Radius of the room that a carried atom needs: closer than `0.9 sigma` the repulsion is a blow.
const ROOM: f64 = 0.45;

resume!(Fluid {
    values: [schedule, energies, pressures, temperatures, structure],
    parts: [engine],
    set_up: [state, duration, started, crystal, in_hand],
});

impl Fluid {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (count, dt) = (settings.whole("particles"), settings.real("time_step"));
        let state = State::named(settings.word("state"), count);
        let boundary = Boundary::<3>::periodic(libm::cbrt(count as f64 / state.density));
        let half = 0.5 * boundary.extent()[0];
        let mut random = Random::new(settings.seed, 0);
        let mut particles = Particles::new();
        let places = if state.phase == Phase::Solid {
            let cells =
                solid::cells(count).ok_or_else(|| settings.invalid("particles", "4 n^3 of a crystal: 256, 500, 864, 1372 ..."))?;
            solid::places(cells, boundary.extent()[0]).map(Vector).collect()
        } else {
            placement::lattice(&boundary, count, 0.0, &mut random, |_| true)?
        };
        for place in places {
            particles.push(place, Vector::ZERO, 1.0, 0.0, 0);
        }
        placement::maxwell(&mut particles, state.temperature, true, &mut random);
        let forces = state.forces();
        let (temperature, seed) = (state.temperature, settings.seed);
        let integrator = if state.phase == Phase::Solid {
            // The modes of a cold crystal hardly know of each other: each needs a bath of its own.
            Integrator::Langevin { dt, temperature, friction: FRICTION, seed }
        } else {
            let degrees_of_freedom = 3 * (count as u32 - 1);
            Integrator::StochasticRescaling { dt, temperature, relaxation_time: 0.5, degrees_of_freedom, seed }
        };
        let structure = RadialDistribution::new(&boundary, RANGE.min(half), BINS)?;
        let mut engine = TimeDriven::new(boundary, particles, forces, integrator)?;
        engine.advance(SETTLING * state.pace, &mut ()).map_err(|failure| Invalid::new("time_step", dt, failure.to_string()))?;
        let started = engine.time();
        let crystal = solid::crystal(count, state.density).filter(|_| state.phase == Phase::Solid).map(|crystal| {
            let shells = crystal.shells(state.temperature, RANGE);
            (crystal, shells)
        });
        Ok(Self {
            state,
            duration: settings.real("duration") * state.pace,
            engine,
            schedule: Schedule::new(state.pace / RESOLUTION).after_start(),
            energies: vec![],
            pressures: vec![],
            temperatures: vec![],
            structure,
            started,
            crystal,
            in_hand: None,
        })
    }

    /// What is drawn.
    fn on_show(&self) -> &TimeDriven<3> {
        self.in_hand.as_ref().map_or(&self.engine, |held| &held.engine)
    }

    /// What a hand plays with, as it is now.
    fn held(&self) -> Result<Held, Invalid> {
        let mut particles = self.engine.snapshot();
        particles.radius.fill(ROOM);
        let engine = TimeDriven::new(self.engine.boundary().clone(), particles, self.state.forces(), self.engine.integrator())?;
        Ok(Held { engine, since: self.engine.time() })
    }

    fn take_sample(&mut self) {
        let particles = self.engine.particles();
        let (count, volume) = (particles.len(), self.engine.boundary().volume());
        let [energy, pressure] = self.state.beyond();
        self.energies.push(self.engine.potential_energy() / count as f64 + energy);
        // The kinetic part is k T by construction: the mean, known exactly, in place of the sample.
        self.pressures.push(self.state.density * self.state.temperature + self.engine.virial() / (3.0 * volume) + pressure);
        // Friction and noise do not keep the momentum of the whole.
        let freedom = 3 * (count - usize::from(self.crystal.is_none()));
        self.temperatures.push(particles.temperature(freedom));
        if self.schedule.count().is_multiple_of(STRUCTURE) {
            self.structure.add(particles);
        }
    }

    fn series_chart(&self, name: &str, title: &str, label: &str, values: &[f64], expected: f64, known: &str) -> Chart {
        let end = (self.engine.time() - self.started).max(1e-9);
        let mut sum = 0.0;
        let means: Vec<(f64, f64)> = values
            .iter()
            .enumerate()
            .map(|(k, value)| {
                sum += value;
                (self.schedule.interval() * (k + 1) as f64, sum / (k + 1) as f64)
            })
            .collect();
        let samples = values.iter().enumerate().map(|(k, &value)| (self.schedule.interval() * (k + 1) as f64, value));
        Chart::new(name, title, Axis::linear("time t", ""), Axis::linear(label, ""))
            .with(Series::theory(known, 0.0, end, 2, Scale::Linear, |_| expected))
            .with(Series::new("now", Style::Line, samples))
            .with(Series::new("mean so far", Style::Line, means))
            .noting("The value of an instant means little; its mean has an error that blocking finds.")
    }

    fn structure_chart(&self) -> Chart {
        let points = self.structure.points();
        let mut chart = Chart::new("structure", "Structure", Axis::linear("distance r", "σ"), Axis::linear("g(r)", ""));
        let temperature = self.state.temperature;
        chart = chart.with(match self.state.phase {
            Phase::Liquid => Series::theory("independent", 0.0, RANGE, 2, Scale::Linear, |_| 1.0),
            Phase::Gas => {
                let shift = potential(CUTOFF);
                let law = |r: f64| libm::exp(-(if r < CUTOFF { potential(r) - shift } else { 0.0 }) / temperature);
                Series::theory("exp(−U/kT)", 0.5, RANGE, 200, Scale::Linear, law)
            }
            Phase::Solid => {
                let law = |r: f64| self.crystal.as_ref().map_or(f64::NAN, |(crystal, shells)| crystal.structure(shells, r));
                Series::theory("lattice and phonons", 0.5, RANGE, 400, Scale::Linear, law)
            }
        });
        let style = if self.state.phase == Phase::Liquid { Style::Line } else { Style::Points };
        chart
            .with(Series::with_errors("measured", style, points.into_iter().map(|(r, g)| (r, g.mean, g.standard_error))))
            .noting("A liquid has shells of neighbours, a thin gas one, where the potential has its well, and a crystal has them sharp and far out.")
    }
}

impl Simulation for Fluid {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.engine.time() - self.started
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            self.engine.advance(self.started + time, &mut ())?;
            self.take_sample();
        }
        self.engine.advance(self.started + to, &mut ())?;
        let held = self.in_hand.as_mut();
        held.map_or(Ok(()), |held| held.engine.advance(self.started + to - held.since, &mut ()))
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let particles = self.on_show().particles();
        scene.time = self.time();
        drawing::add_particles(scene, scene.time, particles, |_| 0.5);
        drawing::add_boundary(scene, self.engine.boundary(), scene.time);
        scene.colouring = Colouring::Speed { most: 3.0 * self.state.temperature.sqrt(), unit: String::new() };
        scene.title = EXPERIMENT.title.into();
        scene.caption = if self.energies.is_empty() {
            format!("ρ = {}, T = {}", self.state.density, self.state.temperature)
        } else {
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            let (energy, pressure) = (mean(&self.energies), mean(&self.pressures));
            let [known_energy, known_pressure] = self.state.expected.map(|known| known.mean);
            format!("mean so far: U/N = {energy:.3} (known: {known_energy:.3})   P = {pressure:.4} (known: {known_pressure:.4})")
        };
    }

    fn frame(&self) -> Option<Frame> {
        Some(Frame::new(self.time(), self.engine.boundary(), self.engine.particles(), &["atoms".into()]))
    }

    fn charts(&self) -> Vec<Chart> {
        if self.energies.len() < 3 {
            return vec![];
        }
        let [energy, pressure] = self.state.expected;
        let known = match self.state.phase {
            Phase::Liquid => "NIST",
            Phase::Gas => "second virial coefficient",
            Phase::Solid => "lattice and phonons",
        };
        let mut charts = vec![];
        if self.structure.samples() > 1 {
            charts.push(self.structure_chart());
        }
        charts.push(self.series_chart("energy", "Energy", "energy per particle U/N", &self.energies, energy.mean, known));
        charts.push(self.series_chart("pressure", "Pressure", "pressure P", &self.pressures, pressure.mean, known));
        charts
    }

    fn checks(&self) -> Vec<Check> {
        if self.energies.len() < 40 {
            return vec![];
        }
        let [energy, pressure] = self.state.expected;
        let blocks = [&self.energies, &self.pressures, &self.temperatures].map(|series| blocking::blocking(series));
        let [u, p, temperature] = blocks.map(|blocked| blocked.estimate);
        let checks = [
            u.check_against(energy, "energy per particle U/N", self.state.reference),
            p.check_against(pressure, "pressure P", self.state.reference),
            match (&self.crystal, self.engine.integrator().dt()) {
                (Some((crystal, _)), Some(dt)) => temperature.check(
                    "temperature",
                    self.state.temperature * (1.0 - 0.25 * dt * dt * crystal.mean_square_frequency()),
                    "the bath's, less (omega dt)^2/4 of each phonon (Leimkuhler and Matthews 2013, doi:10.1063/1.4802990)",
                ),
                _ => temperature.check(
                    "temperature",
                    self.state.temperature,
                    "the thermostat's (Bussi, Donadio and Parrinello 2007, doi:10.1063/1.2408420)",
                ),
            },
        ];
        // A series too short for its own correlations has no error to be judged by.
        checks.into_iter().zip(blocks).filter(|(_, blocked)| blocked.plateau).map(|(check, _)| check).collect()
    }

    fn honesty(&self) -> Honesty {
        Honesty {
            engine: format!("time-driven, {}", self.engine.integrator().name()),
            work: self.engine.steps(),
            work_unit: "steps",
            ..Honesty::default()
        }
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_soft_number(action)
    }

    /// A reversal does not lead back: the bath's random forces do not know of it.
    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        action.allowed(self)?;
        let mut held = match self.in_hand.take() {
            Some(held) => held,
            None => self.held()?,
        };
        let outcome = hand::on_soft(&mut held.engine, action);
        self.in_hand = Some(held);
        outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hirschfelder, Curtiss and Bird (1954) tabulate `B_2` of the whole potential; at `T = 1.5` it is `-1.20088 (2 pi/3)`. The cut
    /// at 3 and the shift take off the tail, `-(8 pi/3)` of which is known to first order in `U/kT`.
    #[test]
    fn the_second_virial_coefficient_is_the_tabulated_one() {
        let temperature = 1.5;
        let tail = -2.0 * PI * 4.0 / (3.0 * CUTOFF.powi(3)) / temperature;
        // The shift lowers nothing but the depth: int (1 - e^(-shift/T)) e^(-U/T) r^2 by its first order, g = 1 outside the core.
        let shift = 2.0 * PI * potential(CUTOFF) / temperature * (CUTOFF.powi(3) - 1.0) / 3.0;
        let whole = second_virial(temperature)[0] + tail + shift;
        assert!((whole / (2.0 * PI / 3.0) + 1.200_88).abs() < 0.02, "{}", whole / (2.0 * PI / 3.0));
    }

    #[test]
    fn its_slope_is_its_derivative() {
        let h = 1e-4;
        let difference = (second_virial(1.5 + h)[0] - second_virial(1.5 - h)[0]) / (2.0 * h);
        assert!((second_virial(1.5)[1] / difference - 1.0).abs() < 1e-6);
    }
}
