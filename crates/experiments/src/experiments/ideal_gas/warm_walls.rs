//! Walls with a temperature: the gas exchanges energy with them, and is canonical.
//!
//! Its mean energy is `d N kT/2` and its variance `(d N/2)(kT)^2` (Gibbs 1902): the temperature is given, the energy fluctuates.
//! Places do not care, so that the pressure is that of the isolated gas at the same temperature.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Failure, Invalid, Observer, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Histogram};
use corpuscle_scene::{Colouring, Scene};

use super::system::{State, Totals};
use super::theory;
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Crossings of the box before the measurement: each particle has been at a wall many times.
const BEFORE: f64 = 20.0;
/// Samples a crossing.
const RESOLUTION: f64 = 2.0;

/// Gases between warm walls.
pub(super) fn start<const D: usize>(settings: &Settings) -> Result<Running<D, WarmWalls>, Invalid> {
    let state = State::base::<D>(settings);
    let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
    let gases = ensemble::build(&streams, |&stream| Bathed::new(&state, &mut Random::new(settings.seed, stream)))?;
    let crossings = settings.real("duration");
    let samples = (RESOLUTION * crossings).round().max(1.0) as usize;
    Ok(Running::new(WarmWalls { state, samples }, crossings * state.crossing(), samples, gases))
}

/// What is asked.
pub(super) struct WarmWalls {
    state: State,
    samples: usize,
}

/// A gas between warm walls.
pub(super) struct Bathed<const D: usize> {
    vessel: Vessel<D>,
    meter: Totals<D>,
    /// Energy at the samples, in units of `kT`.
    energies: Vec<f64>,
    temperature: f64,
}

resume!(Bathed<const D> { values: [meter, energies], parts: [vessel], set_up: [temperature] });

impl<const D: usize> Bathed<D> {
    fn new(state: &State, random: &mut Random) -> Result<Self, Invalid> {
        let mut boundary = state.boundary();
        for face in boundary.faces.iter_mut().flatten() {
            face.temperature = Some(state.temperature);
        }
        let particles = state.particles(&boundary, random)?;
        let vessel = Vessel::new(boundary, particles, BEFORE * state.crossing(), random)?;
        Ok(Self { vessel, meter: Totals::ZERO, energies: vec![], temperature: state.temperature })
    }
}

impl<const D: usize> Member for Bathed<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let meter = &mut self.meter;
        self.vessel.advance(time, &mut |contact| meter.contact(contact))
    }

    fn sample(&mut self) {
        self.energies.push(self.vessel.engine.kinetic_energy() / self.temperature);
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Bathed<D> {
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

type Gases<const D: usize> = Replicas<Bathed<D>>;

impl WarmWalls {
    fn half_freedom<const D: usize>(&self) -> f64 {
        0.5 * (D * self.state.count) as f64
    }
}

impl<const D: usize> Study<D> for WarmWalls {
    type Specimen = Bathed<D>;

    fn draw(&self, gases: &Gases<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = Colouring::Speed { most: 3.0 * self.state.thermal_speed(), unit: String::new() };
        let energy = gases.members[0].energies.last().copied().unwrap_or(0.0);
        scene.caption = format!(
            "energy {:.3} of its mean, fluctuating by {:.3}",
            energy / self.half_freedom::<D>(),
            1.0 / self.half_freedom::<D>().sqrt()
        );
    }

    fn charts(&self, gases: &Gases<D>) -> Vec<Chart> {
        let (mean, deviation) = (self.half_freedom::<D>(), self.half_freedom::<D>().sqrt());
        let mut histogram = Histogram::new(mean - 4.0 * deviation, mean + 4.0 * deviation, 24);
        gases.members.iter().flat_map(|gas| &gas.energies).for_each(|&energy| histogram.add(energy));
        let bars = histogram.densities().into_iter().map(|(x, density)| (x, density.mean, density.standard_error));
        let gamma = |x: f64| libm::exp((mean - 1.0) * libm::log(x) - x - libm::lgamma(mean));
        let course = gases.times.iter().enumerate().map(|(k, &time)| {
            let energy = gases.mean(|gas| gas.energies[k] / mean);
            (time, energy.mean, energy.standard_error)
        });
        let one = gases.times.iter().zip(&gases.members[0].energies).map(|(&time, energy)| (time, energy / mean));
        vec![
            Chart::new(
                "energies",
                "Gibbs: distribution of the energy",
                Axis::linear("energy E", "kT"),
                Axis::linear("probability density", ""),
            )
            .with(Series::with_errors("measured", Style::Bars, bars))
            .with(Series::theory(
                "canonical, E^(dN/2 − 1) exp(−E/kT)",
                mean - 4.0 * deviation,
                mean + 4.0 * deviation,
                120,
                Scale::Linear,
                gamma,
            ))
            .noting("The walls fix the temperature, not the energy; it fluctuates by sqrt(2/(dN)) of itself."),
            Chart::new("energy", "Energy between warm walls", Axis::linear("time t", ""), Axis::linear("E/(d N kT/2)", ""))
                .with(Series::theory("mean", 0.0, gases.sampled().max(1.0), 2, Scale::Linear, |_| 1.0))
                .with(Series::with_errors("mean of the replicas", Style::Line, course))
                .with(Series::new("one gas", Style::Line, one))
                .noting("What one gas gains another loses: the mean stays."),
        ]
    }

    fn checks(&self, gases: &Gases<D>) -> Vec<Check> {
        if gases.times.len() <= self.samples {
            return vec![];
        }
        let half = self.half_freedom::<D>();
        let energy = gases.mean(|gas| gas.energies.iter().sum::<f64>() / (gas.energies.len() as f64 * half));
        let variance = gases.mean(|gas| {
            gas.energies.iter().map(|energy| (energy - half) * (energy - half)).sum::<f64>() / (gas.energies.len() as f64 * half)
        });
        let state = &self.state;
        let area = 2.0 * D as f64 * state.volume::<D>() / state.open_side();
        let pressure = gases.mean(|gas| gas.meter.impulse() / (gases.sampled() * area * state.ideal_pressure::<D>()));
        vec![
            energy.check("mean energy over d N kT/2", 1.0, "canonical: the walls' temperature"),
            variance.check("variance of the energy over (d N/2)(kT)²", 1.0, "canonical (Gibbs 1902)"),
            pressure.check(
                "P V_acc/(N k T) on warm walls",
                theory::between_walls::<D>(state.count, state.open_side(), 2.0 * state.radius),
                "as of the isolated gas: places do not know of velocities",
            ),
        ]
    }
}
