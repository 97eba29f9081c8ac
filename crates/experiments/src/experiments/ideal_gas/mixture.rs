//! Two gases in one box: Dalton's law, and one temperature for all.
//!
//! All have the same size, so that the gases are in the same places and share the walls' force as their numbers are: the partial
//! pressure is `P_s = x_s P`, at any density. Energy is shared equally among all velocity components, whatever the mass.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Contact, Failure, Invalid, Meeting, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::{Colouring, Scene};
use std::ops::ControlFlow;

use super::system::State;
use super::theory;
use crate::gas::{self, Species};
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Crossings of the box before the measurement, of heavy particles.
const BEFORE: f64 = 10.0;
/// Samples a crossing.
const RESOLUTION: f64 = 2.0;

/// Mixtures of as many light as heavy particles.
pub(super) fn start<const D: usize>(settings: &Settings) -> Result<Running<D, Mixture>, Invalid> {
    let state = State::base::<D>(settings);
    let masses = [state.mass, state.mass * settings.real("heavy_mass")];
    let slow = State { mass: masses[0].max(masses[1]), ..state };
    let mixture = Mixture { state, counts: [state.count.div_ceil(2), state.count / 2], masses, samples: 0 };
    let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
    let gases = ensemble::build(&streams, |&stream| Mixed::new(&mixture, &mut Random::new(settings.seed, stream)))?;
    let crossings = settings.real("duration");
    let samples = (RESOLUTION * crossings).round().max(1.0) as usize;
    Ok(Running::new(Mixture { samples, ..mixture }, crossings * slow.crossing(), samples, gases))
}

/// What is asked.
pub(super) struct Mixture {
    state: State,
    counts: [usize; 2],
    masses: [f64; 2],
    samples: usize,
}

/// What was noted at one sampling time, of the light and of the heavy.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Reading {
    impulses: [f64; 2],
    energies: [f64; 2],
}

/// A mixture.
pub(super) struct Mixed<const D: usize> {
    vessel: Vessel<D>,
    species: Vec<u16>,
    masses: [f64; 2],
    impulses: [f64; 2],
    readings: Vec<Reading>,
}

resume!(Mixed<const D> { values: [impulses, readings], parts: [vessel], set_up: [species, masses] });

impl<const D: usize> Mixed<D> {
    fn new(mixture: &Mixture, random: &mut Random) -> Result<Self, Invalid> {
        let (state, boundary) = (&mixture.state, mixture.state.boundary());
        let mut particles = corpuscle_core::Particles::new();
        for index in 0..2 {
            let (count, mass) = (mixture.counts[index], mixture.masses[index]);
            gas::add(&mut particles, &boundary, Species { count, radius: state.radius, mass, index: index as u16 }, random)?;
        }
        gas::heat(&mut particles, state.temperature, random);
        let species = particles.species.clone();
        let slow = State { mass: mixture.masses[0].max(mixture.masses[1]), ..*state };
        let vessel = Vessel::new(boundary, particles, BEFORE * slow.crossing(), random)?;
        Ok(Self { vessel, species, masses: mixture.masses, impulses: [0.0; 2], readings: vec![] })
    }
}

impl<const D: usize> Member for Mixed<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let Self { vessel, species, impulses, .. } = self;
        vessel.advance(time, &mut |contact: &Contact<D>| {
            if let Meeting::Face { .. } = contact.with {
                impulses[usize::from(species[contact.first.index])] += contact.impulse;
            }
            ControlFlow::Continue(())
        })
    }

    fn sample(&mut self) {
        let mut energies = [0.0; 2];
        for (i, &species) in self.species.iter().enumerate() {
            let s = usize::from(species);
            energies[s] += 0.5 * self.masses[s] * self.vessel.engine.velocity(i).norm_squared();
        }
        self.readings.push(Reading { impulses: self.impulses, energies });
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Mixed<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.vessel
    }
}

type Gases<const D: usize> = Replicas<Mixed<D>>;

impl Mixture {
    /// Pressure of the whole gas that theory expects, over `kT/V_acc`.
    fn expected<const D: usize>(&self) -> f64 {
        let state = &self.state;
        state.count as f64 * theory::between_walls::<D>(state.count, state.open_side(), 2.0 * state.radius)
    }

    /// Partial pressure over `kT/V_acc` up to a sample.
    fn pressure<const D: usize>(&self, gases: &Gases<D>, sample: usize, part: impl Fn([f64; 2]) -> f64) -> Estimate {
        let state = &self.state;
        let scale = state.open_side() / (2.0 * D as f64 * state.temperature * gases.times[sample]);
        gases.mean(|gas| part(gas.readings[sample].impulses) * scale)
    }
}

impl<const D: usize> Study<D> for Mixture {
    type Specimen = Mixed<D>;

    fn draw(&self, gases: &Gases<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = Colouring::Species(vec!["light".into(), "heavy".into()]);
        let sample = gases.times.len() - 1;
        scene.caption = if sample == 0 {
            "two gases, one box".into()
        } else {
            let p = |s: usize| self.pressure(gases, sample, |impulses| impulses[s]).mean;
            format!(
                "P V_acc/kT: light {:.1}, heavy {:.1}, together {:.1} (theory {:.1})",
                p(0),
                p(1),
                p(0) + p(1),
                self.expected::<D>()
            )
        };
    }

    fn shade(&self, gas: &Mixed<D>, particle: usize) -> f64 {
        f64::from(gas.species[particle])
    }

    fn charts(&self, gases: &Gases<D>) -> Vec<Chart> {
        let samples = 1..gases.times.len();
        let step = (samples.len() / 60).max(1);
        let end = gases.sampled().max(self.state.crossing());
        let mut chart = Chart::new(
            "dalton",
            "Dalton: partial pressures, averaged so far",
            Axis::linear("averaging time t", ""),
            Axis::linear("P V_acc/kT", ""),
        );
        let (expected, whole) = (self.expected::<D>(), self.state.count as f64);
        for (name, which) in [("light", 0), ("heavy", 1), ("together", 2)] {
            let part = move |impulses: [f64; 2]| if which < 2 { impulses[which] } else { impulses[0] + impulses[1] };
            let share = if which < 2 { self.counts[which] as f64 / whole } else { 1.0 };
            let points = samples.clone().step_by(step).map(|sample| {
                let pressure = self.pressure(gases, sample, part);
                (gases.times[sample], pressure.mean, pressure.standard_error)
            });
            chart = chart
                .with(Series::theory(format!("{name}: theory"), 0.0, end, 2, Scale::Linear, |_| share * expected))
                .with(Series::with_errors(format!("{name}: measured"), Style::Line, points));
        }
        vec![chart.noting("Each gas presses as if it were alone in the box: the heavy hit less often, and harder.")]
    }

    fn checks(&self, gases: &Gases<D>) -> Vec<Check> {
        if gases.times.len() <= self.samples {
            return vec![];
        }
        let (expected, whole) = (self.expected::<D>(), self.state.count as f64);
        let mut checks = vec![];
        for (s, name) in ["light", "heavy"].into_iter().enumerate() {
            let share = self.counts[s] as f64 / whole;
            checks.push(self.pressure(gases, self.samples, |impulses| impulses[s]).check(
                format!("partial pressure of the {name} gas, P V_acc/kT"),
                share * expected,
                "Dalton: as its share of the particles",
            ));
        }
        checks.push(self.pressure(gases, self.samples, |[a, b]| a + b).check(
            "pressure of both, P V_acc/kT",
            expected,
            "equation of state of this very box; masses do not matter",
        ));
        let energy = gases.mean(|gas| {
            let sum: f64 = gas.readings.iter().map(|reading| reading.energies[1]).sum();
            2.0 * sum / ((D * self.counts[1]) as f64 * gas.readings.len() as f64 * self.state.temperature)
        });
        checks.push(energy.check("temperature of the heavy gas over T", 1.0, "equipartition"));
        checks
    }
}
