//! Boltzmann's H: a gas whose speeds are all equal, or whose particles have two temperatures, relaxes to Maxwell's distribution.
//!
//! `H = int f ln f d^dv` falls to its least value, that of Maxwell's distribution at the same energy. Two initial rates are exact
//! for hard particles in molecular chaos. At equal speeds `c` a collision adds on the average `128/225 c^4` to `v1^4 + v2^4` in
//! the plane and `16/35 c^4` in space (scattering isotropic there, `|sin(chi/2)|` here). Between two Maxwellians of equal masses an
//! unlike collision carries the energy `T_1 - T_2` in the mean: with `V` the velocity of the centre and `g` the relative one it is
//! `m (g.n)(V.n)`, `<V g>/<g g> = (T_2 - T_1)/(2(T_1 + T_2))` and `<(g.n)^2> = 2 (T_1 + T_2)/m` over collisions, so that the
//! difference decays at first as `exp(-(2/d) nu t)`, `nu` the rate of collisions of a particle.

use std::ops::ControlFlow;

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Invalid, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::speeds::{SpeedDistribution, binned_h, boltzmann_h};
use corpuscle_observe::{Chart, Check, Estimate, theory};
use corpuscle_scene::{Colouring, Scene};

use super::Set;
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Samples in the whole duration.
const SAMPLES: usize = 200;
/// Collisions per particle in it: fourth moments need some ten of them to forget.
const DURATION: f64 = 40.0;
/// Bins of the speeds, up to so many thermal speeds.
const BINS: usize = 32;
const REACH: f64 = 5.0;
/// The hot half starts at `1 + CONTRAST` of the temperature, the cold one at `1 - CONTRAST`.
const CONTRAST: f64 = 0.8;

/// Gases from either start, side by side.
pub(super) fn start<const D: usize>(set: Set<D>, settings: &Settings) -> Result<Running<D, Relaxation<D>>, Invalid> {
    // Every partner but oneself, in the volume open to centres.
    let density = (set.particles as f64 - 1.0) / set.boundary.accessible_volume(set.radius);
    let rate = theory::collision_rate::<D>(density, 2.0 * set.radius, set.temperature, 1.0);
    let duration = Set::<D>::duration(settings, DURATION / rate);
    let replicas = settings.whole("replicas") as u64;
    let starts = if settings.word("start") == "equal-speeds" {
        [Start::EqualSpeeds, Start::TwoTemperatures]
    } else {
        [Start::TwoTemperatures, Start::EqualSpeeds]
    };
    let jobs: Vec<(Start, u64)> = starts.into_iter().flat_map(|start| (0..replicas).map(move |r| (start, r))).collect();
    let gases = ensemble::build(&jobs, |&(start, replica)| Gas::new(&set, start, replica))?;
    Ok(Running::new(Relaxation { set, rate, shown: starts[0] }, duration, SAMPLES, gases))
}

/// How a gas starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    EqualSpeeds,
    TwoTemperatures,
}

/// What is asked.
pub(super) struct Relaxation<const D: usize> {
    set: Set<D>,
    /// Collisions of a particle per time in equilibrium.
    rate: f64,
    shown: Start,
}

/// What was noted at one sampling time.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Reading {
    /// Speeds in bins.
    counts: Vec<u16>,
    /// `<v^4>/<v^2>^2`.
    fourth: f64,
    /// Temperature of the first half of the particles less that of the second, over that of all.
    difference: f64,
}

/// A gas on its way to equilibrium.
pub(super) struct Gas<const D: usize> {
    vessel: Vessel<D>,
    start: Start,
    readings: Vec<Reading>,
    temperature: f64,
}

resume!(Gas<const D> { values: [readings], parts: [vessel], set_up: [start, temperature] });

impl<const D: usize> Gas<D> {
    fn new(set: &Set<D>, start: Start, replica: u64) -> Result<Self, Invalid> {
        let stream = if start == Start::EqualSpeeds { 0 } else { 1 << 32 };
        let mut vessel = set.vessel(&mut Random::new(set.seed, stream + replica))?;
        // Places are in equilibrium, velocities no longer.
        let speed = (D as f64 * set.temperature).sqrt();
        let energy = 0.5 * set.particles as f64 * speed * speed;
        vessel.set_velocities(|i, velocity| {
            *velocity = match start {
                Start::EqualSpeeds => *velocity * (speed / velocity.norm()),
                Start::TwoTemperatures if is_hot(i) => *velocity * (1.0 + CONTRAST).sqrt(),
                Start::TwoTemperatures => *velocity * (1.0 - CONTRAST).sqrt(),
            }
        });
        let scale = (energy / vessel.engine.kinetic_energy()).sqrt();
        vessel.set_velocities(|_, velocity| *velocity = *velocity * scale);
        Ok(Self { vessel, start, readings: vec![], temperature: set.temperature })
    }
}

/// Particles of even index start hot: they are everywhere.
fn is_hot(particle: usize) -> bool {
    particle.is_multiple_of(2)
}

impl<const D: usize> Member for Gas<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.vessel.advance(time, &mut |_| ControlFlow::Continue(()))
    }

    fn sample(&mut self) {
        let velocities = self.vessel.engine.snapshot().velocity;
        let (n, unit) = (velocities.len() as f64, self.temperature.sqrt());
        let mut counts = vec![0; BINS];
        let (mut second, mut fourth, mut halves) = (0.0, 0.0, [[0.0; 2]; 2]);
        for (i, velocity) in velocities.iter().enumerate() {
            let square = velocity.norm_squared();
            let bin = (square.sqrt() / (unit * REACH) * BINS as f64) as usize;
            if let Some(count) = counts.get_mut(bin) {
                *count += 1;
            }
            (second, fourth) = (second + square, fourth + square * square);
            let half = &mut halves[usize::from(!is_hot(i))];
            *half = [half[0] + square, half[1] + 1.0];
        }
        let [hot, cold] = halves.map(|[sum, count]| sum / count);
        self.readings.push(Reading { counts, fourth: n * fourth / (second * second), difference: n * (hot - cold) / second });
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Gas<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.vessel
    }
}

type Gases<const D: usize> = Replicas<Gas<D>>;

impl<const D: usize> Relaxation<D> {
    fn gases(gases: &Gases<D>, start: Start) -> impl Iterator<Item = &Gas<D>> {
        gases.members.iter().filter(move |gas| gas.start == start)
    }

    fn edges(&self) -> Vec<f64> {
        (0..=BINS).map(|bin| REACH * self.set.thermal_speed() * bin as f64 / BINS as f64).collect()
    }

    /// Mean over the gases of one start at each sampling time.
    fn curve(gases: &Gases<D>, start: Start, value: impl Fn(&Reading) -> f64) -> Vec<(f64, f64, f64)> {
        let at = |k: usize| {
            let values: Vec<f64> = Self::gases(gases, start).map(|gas| value(&gas.readings[k])).collect();
            Estimate::from_replicas(&values)
        };
        gases.times.iter().enumerate().map(|(k, &time)| (time, at(k).mean, at(k).standard_error)).collect()
    }

    /// Boltzmann's function in equilibrium, seen through the bins.
    fn equilibrium(&self) -> f64 {
        let closed = SpeedDistribution::closed(D, self.set.particles, false, self.set.temperature, 1.0);
        binned_h(&closed, &self.edges())
    }

    fn h_chart(&self, gases: &Gases<D>) -> Chart {
        let edges = self.edges();
        let curve = |start: Start| {
            let at = |k: usize| {
                let mut sums = vec![0u64; BINS];
                for gas in Self::gases(gases, start) {
                    sums.iter_mut().zip(&gas.readings[k].counts).for_each(|(sum, &n)| *sum += u64::from(n));
                }
                boltzmann_h(&sums, &edges, D)
            };
            gases
                .times
                .iter()
                .enumerate()
                .map(|(k, &time)| (time * self.rate, at(k).mean, at(k).standard_error))
                .collect::<Vec<_>>()
        };
        let end = gases.sampled().max(1.0 / self.rate) * self.rate;
        Chart::new(
            "boltzmann",
            "Boltzmann's H falls",
            Axis::linear("collisions per particle, ν t", ""),
            Axis::linear("H = ∫ f ln f", ""),
        )
        .with(Series::theory("Maxwell's distribution, these bins", 0.0, end, 2, Scale::Linear, |_| self.equilibrium()))
        .with(Series::with_errors("from equal speeds", Style::Line, curve(Start::EqualSpeeds)))
        .with(Series::with_errors("from two temperatures", Style::Line, curve(Start::TwoTemperatures)))
        .noting("A few collisions a particle are enough, and nothing but collisions is needed. H of equal speeds is as large as the bins allow.")
    }

    fn fourth_chart(&self, gases: &Gases<D>) -> Chart {
        let d = D as f64;
        let equilibrium = self.fourth_moment();
        let end = gases.sampled().max(1.0 / self.rate) * self.rate;
        let measured = Self::curve(gases, Start::EqualSpeeds, |reading| reading.fourth).into_iter();
        Chart::new(
            "fourth-moment",
            "From equal speeds: the fourth moment",
            Axis::linear("collisions per particle, ν t", ""),
            Axis::linear("⟨v⁴⟩/⟨v²⟩²", ""),
        )
        .with(Series::theory("Maxwell's", 0.0, end, 2, Scale::Linear, |_| equilibrium))
        .with(Series::theory("first collisions, exact", 0.0, (2.0 / d).min(end), 2, Scale::Linear, |x| {
            1.0 + self.first_rate() / self.rate * x
        }))
        .with(Series::with_errors("measured", Style::Line, measured.map(|(t, y, e)| (t * self.rate, y, e))))
        .noting("The first collisions are known exactly; what follows has to bend towards Maxwell's value.")
    }

    fn exchange_chart(&self, gases: &Gases<D>) -> Chart {
        let end = gases.sampled().max(1.0 / self.rate).min(6.0 / self.rate) * self.rate;
        let measured = Self::curve(gases, Start::TwoTemperatures, |reading| reading.difference).into_iter();
        let measured = measured.map(|(t, y, e)| (t * self.rate, y, e)).filter(|point| point.0 <= end);
        Chart::new(
            "two-temperatures",
            "From two temperatures: their difference",
            Axis::linear("collisions per particle, ν t", ""),
            Axis::linear("(T hot − T cold)/T", ""),
        )
        .with(Series::theory("as long as both are Maxwellian, exp(−(2/d) ν t)", 0.0, end, 100, Scale::Linear, |x| {
            2.0 * CONTRAST * libm::exp(-self.exchange_rate() / self.rate * x)
        }))
        .with(Series::with_errors("measured", Style::Points, measured))
        .noting("Each collision of a hot particle with a cold one hands over, on the average, the difference of the temperatures.")
    }

    /// `<v^4>/<v^2>^2` in equilibrium at constant energy, `(1 + 2/d) f/(f + 2)` with `f = d N`.
    fn fourth_moment(&self) -> f64 {
        let freedom = (D * self.set.particles) as f64;
        (1.0 + 2.0 / D as f64) * freedom / (freedom + 2.0)
    }

    /// Growth of `<v^4>/<v^2>^2` per time at equal speeds: half of what a collision adds, times the collisions of a particle. Their
    /// rate is that of equilibrium times the ratio of the mean relative speeds.
    fn first_rate(&self) -> f64 {
        let pi = std::f64::consts::PI;
        let (gain, relative) = if D == 2 {
            (128.0 / 225.0, 4.0 / pi * 2f64.sqrt() / pi.sqrt())
        } else {
            (16.0 / 35.0, 4.0 / 3.0 * 3f64.sqrt() / (16.0 / pi).sqrt())
        };
        0.5 * gain * relative * self.rate
    }

    /// Decay rate of the difference of the temperatures at the start: `N/(N - 1)` of `(2/d) nu`, since a particle has one unlike
    /// partner more than like ones.
    fn exchange_rate(&self) -> f64 {
        let n = self.set.particles as f64;
        2.0 / D as f64 * self.rate * n / (n - 1.0)
    }

    /// Slope at the start from the first three samples, `(4 y(h) - y(2h) - 3 y(0))/(2h)`, of each gas.
    fn slope(gases: &Gases<D>, start: Start, value: impl Fn(&Reading) -> f64) -> Estimate {
        let h = gases.times[1];
        let of_gas = |gas: &Gas<D>| {
            let [a, b, c] = [0, 1, 2].map(|k| value(&gas.readings[k]));
            (4.0 * b - c - 3.0 * a) / (2.0 * h)
        };
        Estimate::from_replicas(&Self::gases(gases, start).map(of_gas).collect::<Vec<_>>())
    }

    /// `H` in the second half, over the gases of one start.
    fn settled(&self, gases: &Gases<D>, start: Start) -> Estimate {
        let edges = self.edges();
        let sums: Vec<[f64; BINS]> = Self::gases(gases, start)
            .map(|gas| {
                let mut sums = [0.0; BINS];
                for reading in &gas.readings[SAMPLES / 2..] {
                    sums.iter_mut().zip(&reading.counts).for_each(|(sum, &n)| *sum += f64::from(n));
                }
                sums
            })
            .collect();
        let shells: Vec<f64> = edges.windows(2).map(|w| corpuscle_observe::speeds::shell(D, w[0], w[1])).collect();
        Estimate::jackknife(&sums, |counts| {
            let total: f64 = counts.iter().sum();
            let occupied = counts.iter().zip(&shells).filter(|(n, _)| **n > 0.0);
            occupied.map(|(n, shell)| n / total * libm::log(n / total / shell)).sum()
        })
    }
}

impl<const D: usize> Study<D> for Relaxation<D> {
    type Specimen = Gas<D>;

    fn draw(&self, gases: &Gases<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = match self.shown {
            Start::EqualSpeeds => Colouring::Speed { most: 3.0 * self.set.thermal_speed(), unit: String::new() },
            Start::TwoTemperatures => Colouring::Species(vec!["started hot".into(), "started cold".into()]),
        };
        let reading = gases.members[0].readings.last();
        let (fourth, difference) = reading.map_or((1.0, 0.0), |reading| (reading.fourth, reading.difference));
        let collisions = gases.sampled() * self.rate;
        scene.caption = match self.shown {
            Start::EqualSpeeds => {
                format!("{collisions:.1} collisions a particle: ⟨v⁴⟩/⟨v²⟩² = {fourth:.2}, Maxwell {:.2}", self.fourth_moment())
            }
            Start::TwoTemperatures => format!("{collisions:.1} collisions a particle: (T hot − T cold)/T = {difference:.2}"),
        };
    }

    fn shade(&self, _: &Gas<D>, particle: usize) -> f64 {
        f64::from(u8::from(!is_hot(particle)))
    }

    fn charts(&self, gases: &Gases<D>) -> Vec<Chart> {
        vec![self.h_chart(gases), self.fourth_chart(gases), self.exchange_chart(gases)]
    }

    fn checks(&self, gases: &Gases<D>) -> Vec<Check> {
        let mut checks = vec![];
        // The first three samples tell of the first collisions, if they are close together.
        if gases.times.len() > 2 && gases.times[1] * self.rate <= 0.25 {
            checks.push(Self::slope(gases, Start::EqualSpeeds, |reading| reading.fourth).check(
                "first growth of ⟨v⁴⟩/⟨v²⟩² from equal speeds",
                self.first_rate(),
                "exact in molecular chaos: mean gain of a collision times its rate, Enskog",
            ));
            checks.push((Self::slope(gases, Start::TwoTemperatures, |reading| reading.difference) * (-0.5 / CONTRAST)).check(
                "first decay rate of the difference of temperatures",
                self.exchange_rate(),
                "(2/d) nu: an unlike collision carries T1 - T2 in the mean; Enskog",
            ));
        }
        if gases.times.len() > SAMPLES && gases.sampled() * self.rate >= 0.9 * DURATION {
            for (start, name) in [(Start::EqualSpeeds, "equal speeds"), (Start::TwoTemperatures, "two temperatures")] {
                checks.push(self.settled(gases, start).check(
                    format!("Boltzmann's H at the end, from {name}"),
                    self.equilibrium(),
                    "Maxwell's distribution at constant energy through the same bins",
                ));
            }
        }
        checks
    }

    fn moments(&self, end: f64) -> Vec<f64> {
        vec![0.0, 1.0 / self.rate, 4.0 / self.rate].into_iter().filter(|&time| time < end).collect()
    }
}
