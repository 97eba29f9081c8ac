//! Compression without heat: a wall halves the volume, slowly or fast.
//!
//! Slowly: the volume of phase space below the energy, `E^(dN/2) Q(V)`, is an adiabatic invariant (Hertz 1910,
//! doi:10.1002/andp.19103381202), so that `E_1/E_0 = (Q_0/Q_1)^(2/(dN))`; for an ideal gas that is `T V^(gamma - 1)` and
//! `P V^gamma` constant with `gamma = (d + 2)/d`. Fast: the wall runs into the gas and heats it more. An elastic wall that comes with
//! the speed `u` sends a particle back with `2u` more.

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Invalid, Motion, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Colouring, Scene};

use super::system::State;
use super::theory;
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Samples of the slowest compression.
const SAMPLES: usize = 100;
/// Crossings of the box before the wall starts.
const BEFORE: f64 = 10.0;
/// What is left of the length of the box between centres.
const LEFT: f64 = 0.5;

/// Gases that are compressed at different speeds, side by side; the slowest is on show.
pub(super) fn start<const D: usize>(settings: &Settings) -> Result<Running<D, Adiabat>, Invalid> {
    let state = State::base::<D>(settings);
    let speeds: Vec<f64> = settings.list("speeds").iter().map(|speed| speed * state.thermal_speed()).collect();
    let (Some(&first), false) = (speeds.first(), speeds.iter().zip(speeds.iter().skip(1)).any(|(a, b)| a >= b)) else {
        return Err(settings.invalid("speeds", "at least one speed, each larger than the one before"));
    };
    let replicas = settings.whole("replicas") as u64;
    let jobs: Vec<(usize, u64)> = (0..speeds.len()).flat_map(|k| (0..replicas).map(move |r| (k, r))).collect();
    let gases = ensemble::build(&jobs, |&(k, replica)| {
        Squeezed::new(&state, k, speeds[k], &mut Random::new(settings.seed, (k as u64) << 32 | replica))
    })?;
    let duration = (1.0 - LEFT) * state.open_side() / first;
    Ok(Running::new(Adiabat { state, speeds, dimension: D }, duration, SAMPLES, gases))
}

/// What is asked.
pub(super) struct Adiabat {
    state: State,
    speeds: Vec<f64>,
    dimension: usize,
}

impl Adiabat {
    /// `E/E_0` of a slow compression to this part of the volume.
    fn energy<const D: usize>(&self, part: f64) -> f64 {
        let (whole, diameter) = ([self.state.open_side(); D], 2.0 * self.state.radius);
        let mut sides = whole;
        sides[0] *= part;
        let ln = |sides| theory::ln_configurations::<D>(self.state.count, sides, diameter);
        libm::exp(2.0 / (D * self.state.count) as f64 * (ln(whole) - ln(sides)))
    }
}

/// A gas under compression.
pub(super) struct Squeezed<const D: usize> {
    vessel: Vessel<D>,
    /// Index and value of the speed.
    index: usize,
    speed: f64,
    /// Part of the volume and energy, over those at the start, at the samples of the compression.
    path: Vec<(f64, f64)>,
    side: f64,
}

resume!(Squeezed<const D> { values: [path], parts: [vessel], set_up: [index, speed, side] });

impl<const D: usize> Squeezed<D> {
    fn new(state: &State, index: usize, speed: f64, random: &mut Random) -> Result<Self, Invalid> {
        let wait = BEFORE * state.crossing();
        let mut vessel = state.vessel(wait, random)?;
        let side = state.open_side();
        let mut boundary = vessel.engine.boundary().clone();
        let (from, to) = (state.side, state.side - (1.0 - LEFT) * side);
        boundary.faces[0][1].motion = Some(Motion::Path(vec![(wait, from), (wait + (from - to) / speed, to)]));
        vessel.engine.set_boundary(boundary)?;
        Ok(Self { vessel, index, speed, path: vec![], side })
    }

    /// Part of the volume that is left at a time.
    fn part(&self, time: f64) -> f64 {
        (1.0 - self.speed * time / self.side).max(LEFT)
    }

    fn growth(&self) -> f64 {
        self.vessel.engine.kinetic_energy() / self.vessel.energy()
    }
}

impl<const D: usize> Member for Squeezed<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.vessel.advance(time, &mut |_| ControlFlow::Continue(()))
    }

    fn sample(&mut self) {
        self.path.push((self.part(self.vessel.time()), self.growth()));
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Squeezed<D> {
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

type Gases<const D: usize> = Replicas<Squeezed<D>>;

/// Mean over the gases of one speed.
fn mean<const D: usize>(gases: &Gases<D>, index: usize, value: impl Fn(&Squeezed<D>) -> f64) -> Estimate {
    Estimate::from_replicas(&gases.members.iter().filter(|gas| gas.index == index).map(value).collect::<Vec<_>>())
}

fn last<const D: usize>(gas: &Squeezed<D>) -> f64 {
    gas.path.last().map_or(f64::NAN, |&(_, growth)| growth)
}

impl<const D: usize> Study<D> for Adiabat {
    type Specimen = Squeezed<D>;

    fn draw(&self, gases: &Gases<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = Colouring::Speed { most: 4.0 * self.state.thermal_speed(), unit: String::new() };
        let gas = &gases.members[0];
        let (part, growth) = (gas.part(gas.vessel.time()), gas.growth());
        scene.caption = format!("V/V₀ = {part:.3}, T/T₀ = {growth:.3}, slow compression {:.3}", self.energy::<D>(part));
    }

    fn charts(&self, gases: &Gases<D>) -> Vec<Chart> {
        let gamma = 1.0 + 2.0 / D as f64;
        let mut path = Chart::new(
            "adiabat",
            "Compression without heat: temperature against volume",
            Axis::logarithmic("V_acc over that at the start", ""),
            Axis::logarithmic("T over that at the start", ""),
        )
        .with(Series::theory(format!("P V^γ constant, γ = {gamma:.3}"), LEFT, 1.0, 60, Scale::Logarithmic, |part| {
            self.energy::<D>(part)
        }));
        for (index, speed) in self.speeds.iter().enumerate() {
            let Some(first) = gases.members.iter().find(|gas| gas.index == index) else { continue };
            let reached = first.path.iter().position(|&(part, _)| part <= LEFT).map_or(first.path.len(), |end| end + 1);
            let points = (0..reached).map(|k| {
                let growth = mean(gases, index, |gas| gas.path[k].1);
                (first.path[k].0, growth.mean, growth.standard_error)
            });
            let name = format!("wall at {} thermal speeds", speed / self.state.thermal_speed());
            path = path.with(Series::with_errors(name, Style::Points, points));
        }
        let work = self.speeds.iter().enumerate().filter(|_| gases.times.len() > SAMPLES).map(|(index, speed)| {
            let growth = mean(gases, index, last);
            (speed / self.state.thermal_speed(), growth.mean, growth.standard_error)
        });
        let slow = self.energy::<D>(LEFT);
        let (from, to) = (self.speeds[0], self.speeds[self.speeds.len() - 1]);
        let unit = self.state.thermal_speed();
        let work = Chart::new(
            "work",
            "Temperature after the compression",
            Axis::logarithmic("speed of the wall", "sqrt(kT/m)"),
            Axis::linear("T over that at the start", ""),
        )
        .with(Series::theory("slow", from / unit, to / unit, 2, Scale::Logarithmic, |_| slow))
        .with(Series::with_errors("measured", Style::Points, work))
        .noting("Slowness is measured against the particles: a wall as fast as they are does much more work.");
        vec![path.noting("A slow wall follows the adiabat; a fast one runs into a gas that has no time to make way."), work]
    }

    fn checks(&self, gases: &Gases<D>) -> Vec<Check> {
        if gases.times.len() <= SAMPLES || self.speeds.len() < 2 {
            return vec![];
        }
        let logarithm = |index: usize| mean(gases, index, |gas| libm::log(last(gas)));
        let (u, v) = (self.speeds[0], self.speeds[1]);
        // The lag of the gas behind the wall is of first order in the speed.
        let slow = logarithm(0) * (v / (v - u)) - logarithm(1) * (u / (v - u));
        let expected = libm::log(self.energy::<D>(LEFT));
        let gamma = slow * (1.0 / (1.0 / LEFT).ln());
        let fastest = mean(gases, self.speeds.len() - 1, last);
        let mut exponent = gamma.check(
            "γ − 1 of a compression of no speed, ln(T₁/T₀)/ln(V₀/V₁)",
            expected / (1.0 / LEFT).ln(),
            format!("adiabatic invariant with hard cores; ideal gas {:.4} = 2/{}", 2.0 / D as f64, self.dimension),
        );
        exponent.unit = String::new();
        vec![
            exponent,
            Check::at_least(
                "T₁/T₀ of the fastest compression",
                fastest.mean,
                self.energy::<D>(LEFT),
                "no compression takes less work than a slow one",
            ),
        ]
    }

    fn moments(&self, end: f64) -> Vec<f64> {
        vec![0.0, 0.5 * end]
    }
}
