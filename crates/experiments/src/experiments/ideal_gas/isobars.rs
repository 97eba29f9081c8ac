//! Pressure held: a loaded piston lets the gas have the volume it needs, at each temperature (Charles 1787, Gay-Lussac 1802) and
//! for each number of particles (Avogadro 1811).
//!
//! All other walls have the temperature `T`. With the energy `F x` of the load, the gas is canonical at constant pressure: the length
//! `x` open to centres is distributed as `Q_N(x) exp(-F x/kT)`. An ideal gas fills `<x> = (N + 1) kT/F`, with the variance
//! `(N + 1)(kT/F)^2`: its volume is proportional to `T`, and but for the one of the piston to `N`. The mass of the piston says only
//! how fast it goes.

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Invalid, Piston, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::distribution::normal_score_of_chi_squared;
use corpuscle_observe::{Chart, Check, Estimate, Histogram, fit};
use corpuscle_scene::{Colouring, Scene};

use super::system::State;
use super::theory;
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Crossings of the box before the measurement: the heat of the start has gone through the walls many times.
const BEFORE: f64 = 20.0;
/// Samples a crossing.
const RESOLUTION: f64 = 2.0;
/// The box is so much longer than the ideal gas at the base temperature.
const ROOM: f64 = 2.5;

/// Gases under the same load; the base state is on show.
pub(super) fn start<const D: usize>(settings: &Settings) -> Result<Running<D, Isobars>, Invalid> {
    let base = State::base::<D>(settings);
    let points = settings.whole("points");
    let least = 1.0 / settings.real("span");
    let parts = || (0..points - 1).map(|k| least + (1.0 - least) * k as f64 / (points - 1) as f64);
    let mut states = vec![(Law::Both, base)];
    states.extend(parts().map(|part| (Law::Charles, State { temperature: part * base.temperature, ..base })));
    states.extend(parts().map(|part| (Law::Avogadro, State { count: (part * base.count as f64).round() as usize, ..base })));
    let load = base.count as f64 * base.temperature / base.open_side();
    let points = states.into_iter().map(|(law, state)| Point::new::<D>(law, state, load)).collect();
    let replicas = settings.whole("replicas") as u64;
    let crossings = settings.real("duration");
    let samples = (RESOLUTION * crossings).round().max(1.0) as usize;
    let study = Isobars { points, base, load, mass: settings.real("piston_mass"), samples };
    let jobs: Vec<(usize, u64)> = (0..study.points.len()).flat_map(|k| (0..replicas).map(move |r| (k, r))).collect();
    let gases = ensemble::build(&jobs, |&(k, replica)| {
        Pressed::new(&study, k, &mut Random::new(settings.seed, (k as u64) << 32 | replica))
    })?;
    Ok(Running::new(study, crossings * base.crossing(), samples, gases))
}

/// What a state belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Law {
    /// `V` against `T`.
    Charles,
    /// `V` against `N`.
    Avogadro,
    /// The base state.
    Both,
}

/// A state under the load.
struct Point {
    law: Law,
    state: State,
    /// Mean and variance of the length that theory expects.
    expected: (f64, f64),
    /// `ln` of what the distribution of lengths is to be divided by.
    ln_norm: f64,
}

impl Point {
    fn new<const D: usize>(law: Law, state: State, load: f64) -> Self {
        const STEPS: usize = 20_000;
        let [least, most] = stops(&state).map(|place| place - 2.0 * state.radius);
        let mut point = Self { law, state, expected: (0.0, 0.0), ln_norm: 0.0 };
        // The trapezium rule; at the ends there is next to nothing.
        let width = (most - least) / STEPS as f64;
        let places: Vec<f64> = (1..STEPS).map(|k| least + width * k as f64).collect();
        let logarithms: Vec<f64> = places.iter().map(|&x| point.ln_weight::<D>(x, load)).collect();
        let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [mut sum, mut first, mut second] = [0.0; 3];
        for (x, ln) in places.iter().zip(&logarithms) {
            let weight = libm::exp(ln - largest);
            (sum, first, second) = (sum + weight, first + weight * x, second + weight * x * x);
        }
        let mean = first / sum;
        point.expected = (mean, second / sum - mean * mean);
        point.ln_norm = largest + libm::log(sum * width);
        point
    }

    /// `ln Q_N(x) - F x/kT`.
    fn ln_weight<const D: usize>(&self, length: f64, load: f64) -> f64 {
        let mut sides = [self.state.open_side(); D];
        sides[0] = length;
        theory::ln_configurations::<D>(self.state.count, sides, 2.0 * self.state.radius) - load * length / self.state.temperature
    }

    /// Length of an ideal gas.
    fn ideal(&self, load: f64) -> f64 {
        self.state.count as f64 * self.state.temperature / load
    }
}

/// Where the piston turns back.
fn stops(state: &State) -> [f64; 2] {
    [6.0 * state.radius, ROOM * state.side - 2.0 * state.radius]
}

/// What is asked.
pub(super) struct Isobars {
    /// The base state first.
    points: Vec<Point>,
    base: State,
    /// Force `F = P A` on the piston.
    load: f64,
    /// Mass of the piston, in masses of the gas under it.
    mass: f64,
    samples: usize,
}

/// A gas under the piston.
pub(super) struct Pressed<const D: usize> {
    vessel: Vessel<D>,
    /// Which state.
    point: usize,
    /// Lengths open to centres, at the samples.
    lengths: Vec<f64>,
    radius: f64,
}

resume!(Pressed<const D> { values: [lengths], parts: [vessel], set_up: [point, radius] });

impl<const D: usize> Pressed<D> {
    fn new(study: &Isobars, index: usize, random: &mut Random) -> Result<Self, Invalid> {
        let Point { state, expected: (length, _), .. } = &study.points[index];
        let mut boundary = state.boundary::<D>();
        boundary.upper[0] = length + 2.0 * state.radius;
        let particles = state.particles(&boundary, random)?;
        let position = boundary.upper[0];
        boundary.upper[0] = ROOM * state.side;
        for face in boundary.faces.iter_mut().flatten() {
            face.temperature = Some(state.temperature);
        }
        boundary.piston = Some(Piston {
            axis: 0,
            position,
            velocity: 0.0,
            mass: study.mass * state.count as f64 * state.mass,
            force: -study.load,
            stops: stops(state),
        });
        let vessel = Vessel::new(boundary, particles, BEFORE * state.crossing(), random)?;
        Ok(Self { vessel, point: index, lengths: vec![], radius: state.radius })
    }

    fn length(&self) -> f64 {
        self.vessel.engine.piston().map_or(f64::NAN, |piston| piston.position - 2.0 * self.radius)
    }

    /// Mean of a function of the length over the samples.
    fn mean(&self, value: impl Fn(f64) -> f64) -> f64 {
        self.lengths.iter().map(|&length| value(length)).sum::<f64>() / self.lengths.len() as f64
    }
}

impl<const D: usize> Member for Pressed<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.vessel.advance(time, &mut |_| ControlFlow::Continue(()))
    }

    fn sample(&mut self) {
        self.lengths.push(self.length());
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Pressed<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.vessel
    }

    fn conserves_energy(&self) -> bool {
        false
    }
}

type Gases<const D: usize> = Replicas<Pressed<D>>;

impl Isobars {
    fn of<const D: usize>(gases: &Gases<D>, index: usize) -> impl Iterator<Item = &Pressed<D>> {
        gases.members.iter().filter(move |gas| gas.point == index)
    }

    fn length<const D: usize>(gases: &Gases<D>, index: usize) -> Estimate {
        Estimate::from_replicas(&Self::of(gases, index).map(|gas| gas.mean(|length| length)).collect::<Vec<_>>())
    }

    /// Indices of the states of a law, the base state last.
    fn sweep(&self, law: Law) -> Vec<usize> {
        let others = (0..self.points.len()).filter(|&k| self.points[k].law == law);
        others.chain(std::iter::once(0)).collect()
    }

    /// What a law is about.
    fn abscissa(&self, law: Law, index: usize) -> f64 {
        let state = &self.points[index].state;
        if law == Law::Avogadro { state.count as f64 } else { state.temperature }
    }

    fn of_law<const D: usize>(&self, gases: &Gases<D>, law: Law) -> Chart {
        let (name, title, label) = if law == Law::Avogadro {
            ("avogadro", "Avogadro: volume against number, at constant P and T", "number of particles N")
        } else {
            ("charles", "Charles: volume against temperature, at constant P and N", "temperature kT")
        };
        let area = self.base.open_side().powi(D as i32 - 1);
        let (sweep, most) = (self.sweep(law), self.abscissa(law, 0));
        let whole = area * self.points[0].ideal(self.load);
        let chart = Chart::new(name, title, Axis::linear(label, ""), Axis::linear("accessible volume V_acc", ""))
            .with(Series::theory("ideal gas, N k T/P", 0.0, 1.05 * most, 2, Scale::Linear, |x| whole * x / most))
            .with(Series::new(
                "with the particles' size",
                Style::Theory,
                sweep.iter().map(|&k| (self.abscissa(law, k), area * self.points[k].expected.0)),
            ));
        let measured = sweep.iter().map(|&k| {
            let length = Self::length(gases, k) * area;
            (self.abscissa(law, k), length.mean, length.standard_error)
        });
        chart
            .with(Series::with_errors("measured", Style::Points, measured))
            .noting("The points lie on a line through the origin but for the small excess that the particles' own size adds.")
    }

    fn checks_of_law<const D: usize>(&self, gases: &Gases<D>, law: Law) -> Vec<Check> {
        let sweep = self.sweep(law);
        let of_each: Vec<Vec<f64>> = sweep.iter().map(|&k| Self::of(gases, k).map(|gas| gas.mean(|x| x)).collect()).collect();
        let line = |replica: usize| {
            let points = sweep.iter().zip(&of_each).map(|(&k, lengths)| {
                let ideal = self.points[k].ideal(self.load);
                // A length varies by its part 1/sqrt(N).
                let weight = ideal / (self.points[k].state.count as f64).sqrt();
                (self.abscissa(law, k), lengths[replica] * ideal / self.points[k].expected.0, weight)
            });
            fit::line(&points.collect::<Vec<_>>())
        };
        let Some(lines) = (0..of_each[0].len()).map(line).collect::<Option<Vec<fit::Line>>>() else { return vec![] };
        let over = |value: &dyn Fn(&fit::Line) -> f64| Estimate::from_replicas(&lines.iter().map(value).collect::<Vec<_>>());
        let whole = self.points[0].ideal(self.load);
        let (slope, symbol) = if law == Law::Avogadro {
            ("Avogadro: slope of V/Z against N, over k T/P", "k T/P")
        } else {
            ("Charles: slope of V/Z against T, over N k/P", "N k/P")
        };
        let intercept = format!("{law:?}: intercept over V of the base state");
        vec![
            over(&|line| line.slope.mean * self.abscissa(law, 0) / whole).check(slope, 1.0, symbol),
            over(&|line| line.intercept.mean / whole).check(intercept, 0.0, "a proportionality"),
        ]
    }
}

impl<const D: usize> Study<D> for Isobars {
    type Specimen = Pressed<D>;

    fn draw(&self, gases: &Gases<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = Colouring::Speed { most: 3.0 * self.base.thermal_speed(), unit: String::new() };
        let whole = self.points[0].expected.0;
        scene.caption = format!(
            "V over its mean {:.3}, fluctuating by {:.3}",
            gases.members[0].length() / whole,
            self.points[0].expected.1.sqrt() / whole
        );
    }

    fn charts(&self, gases: &Gases<D>) -> Vec<Chart> {
        let point = &self.points[0];
        let (mean, deviation) = (point.expected.0, point.expected.1.sqrt());
        let (least, most) = (mean - 4.0 * deviation, mean + 4.0 * deviation);
        // Samples of one gas are not independent of each other: the error is the scatter of the gases.
        let densities: Vec<Vec<(f64, Estimate)>> = Self::of(gases, 0)
            .map(|gas| {
                let mut histogram = Histogram::new(least / mean, most / mean, 24);
                gas.lengths.iter().for_each(|&length| histogram.add(length / mean));
                histogram.densities()
            })
            .collect();
        let bars = (0..24).map(|bin| {
            let density = Estimate::from_replicas(&densities.iter().map(|gas| gas[bin].1.mean).collect::<Vec<_>>());
            (densities[0][bin].0, density.mean, density.standard_error)
        });
        let density = |x: f64| mean * libm::exp(point.ln_weight::<D>(x * mean, self.load) - point.ln_norm);
        vec![
            self.of_law(gases, Law::Charles),
            self.of_law(gases, Law::Avogadro),
            Chart::new(
                "volumes",
                "Distribution of the volume at constant pressure",
                Axis::linear("volume over its mean", ""),
                Axis::linear("probability density", ""),
            )
            .with(Series::with_errors("measured", Style::Bars, bars))
            .with(Series::theory("canonical, Q(V) exp(−P V/kT)", least / mean, most / mean, 120, Scale::Linear, density))
            .noting("The load fixes the pressure, not the volume; it fluctuates by sqrt(1/N) of itself."),
        ]
    }

    fn checks(&self, gases: &Gases<D>) -> Vec<Check> {
        if gases.times.len() <= self.samples {
            return vec![];
        }
        let (mean, variance) = self.points[0].expected;
        let canonical = "canonical at constant pressure: Q_N(x) exp(-F x/kT)";
        let spread = Self::of(gases, 0).map(|gas| gas.mean(|length| (length - mean) * (length - mean) / variance));
        let scores = self.points.iter().enumerate().map(|(k, point)| Self::length(gases, k).score(point.expected.0));
        let (sum, count) = scores.fold((0.0, 0.0), |(sum, n), z| (sum + z * z, n + 1.0));
        let z = normal_score_of_chi_squared(sum, count);
        let mut checks = vec![
            (Self::length(gases, 0) / mean).check("mean volume of the base state over theory", 1.0, canonical),
            Estimate::from_replicas(&spread.collect::<Vec<_>>()).check("variance of the volume over theory", 1.0, canonical),
            Check::scored(
                "V of all states: chi^2 per degree of freedom",
                sum / count,
                (2.0 / count).sqrt(),
                1.0,
                z,
                "each mean volume against the canonical one of its own gas",
            ),
        ];
        checks.extend(self.checks_of_law(gases, Law::Charles));
        checks.extend(self.checks_of_law(gases, Law::Avogadro));
        checks
    }
}
