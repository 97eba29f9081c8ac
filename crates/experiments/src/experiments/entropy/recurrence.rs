//! Recurrence: few particles come together in the left half by themselves, as Poincare says they must, and as seldom as
//! Boltzmann says.
//!
//! All `N` are on the left with the probability `P = Q(left)/Q(box)`, where `Q(V) = V^N (1 - W/V^2)^(N(N-1)/2)` and
//! `W = integral over |u| < s of prod (a_k - |u_k|) du` is the volume that two centres with sides `a_k` to move in keep from each
//! other: `2^-N` for points, exact for two discs or spheres, to first order in the packing for more.
//!
//! The mean time from one such meeting to the next is `1/(P k)` with the rate `k` at which a meeting ends (Kac 1947,
//! doi:10.1090/S0002-9904-1947-08927-8): the flux across the middle, `k = (d ln Q/d a_x) <|v_x|>/2`, where `<|v_x|>` is that of
//! `f = d N` velocity components at constant energy.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Invalid, Observer, Random};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Gate, theory};
use corpuscle_scene::{Colour, Colouring, Region, Scene};

use super::Set;
use crate::gas::ln_configurations;
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Samples in the whole duration.
const SAMPLES: usize = 100;
/// Duration in mean recurrence times of the largest number.
const DURATION: f64 = 3.0;
/// The largest number whose recurrence can be waited for.
const MOST: usize = 10;

/// Rooms with 2, 3, ... particles; the fullest is on show.
pub(super) fn start<const D: usize>(settings: &Settings) -> Result<Running<D, Recurrence>, Invalid> {
    let counts: Vec<usize> = (2..=settings.whole("particles").min(MOST)).rev().collect();
    let sets: Vec<Set<D>> = counts.iter().map(|&count| Set::of(settings, count)).collect::<Result<_, _>>()?;
    let expected: Vec<Meeting> = sets.iter().map(Meeting::new).collect();
    let longest = 1.0 / (expected[0].probability * expected[0].end_rate);
    let duration = Set::<D>::duration(settings, DURATION * longest);
    let replicas = settings.whole("replicas") as u64;
    let jobs: Vec<(usize, u64)> = (0..counts.len()).flat_map(|index| (0..replicas).map(move |r| (index, r))).collect();
    let rooms = ensemble::build(&jobs, |&(index, replica)| Few::new(&sets[index], (counts[index] as u64) << 32 | replica))?;
    Ok(Running::new(
        Recurrence { counts, expected, middle: sets[0].middle(), height: sets[0].boundary.upper[1] },
        duration,
        SAMPLES,
        rooms,
    ))
}

/// What theory says of the meetings of all particles on the left.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    probability: f64,
    /// Rate at which one that is on ends.
    end_rate: f64,
}

impl Meeting {
    fn new<const D: usize>(set: &Set<D>) -> Self {
        let (radius, extent) = (set.radius, set.boundary.extent());
        let mut sides: [f64; D] = std::array::from_fn(|k| extent[k] - 2.0 * radius);
        let whole = ln_configurations(set.particles, sides, 2.0 * radius);
        sides[0] *= 0.5;
        let part = ln_configurations(set.particles, sides, 2.0 * radius);
        let step = 1e-4 * sides[0];
        let wider = |step: f64| {
            let mut sides = sides;
            sides[0] += step;
            ln_configurations(set.particles, sides, 2.0 * radius)
        };
        let slope = (wider(step) - wider(-step)) / (2.0 * step);
        let freedom = (D * set.particles) as f64;
        let flux = theory::wall_hit_rate(1.0, set.temperature, 1.0) * theory::closed_flux_factor(freedom);
        Self { probability: libm::exp(part - whole), end_rate: slope * flux }
    }
}

/// What is asked.
pub(super) struct Recurrence {
    /// Numbers of particles, the largest first.
    counts: Vec<usize>,
    expected: Vec<Meeting>,
    middle: f64,
    height: f64,
}

/// A room with few particles.
pub(super) struct Few<const D: usize> {
    vessel: Vessel<D>,
    gate: Gate,
    count: usize,
}

resume!(Few<const D> { values: [gate], parts: [vessel], set_up: [count] });

impl<const D: usize> Few<D> {
    fn new(set: &Set<D>, stream: u64) -> Result<Self, Invalid> {
        let vessel = set.vessel(&mut Random::new(set.seed, stream))?;
        let gate = Gate::new(0, set.middle(), vessel.engine.time(), &vessel.engine.snapshot());
        Ok(Self { vessel, gate, count: set.particles })
    }

    /// Share of the time that so many were on the left.
    fn share(&self, left: usize) -> f64 {
        self.gate.durations()[left] / self.gate.durations().iter().sum::<f64>()
    }
}

impl<const D: usize> Member for Few<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let gate = &mut self.gate;
        self.vessel.advance(time, &mut |contact| gate.contact(contact))
    }

    fn sample(&mut self) {
        self.gate.settle(self.vessel.engine.time());
    }

    fn time(&self) -> f64 {
        self.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Few<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.vessel
    }
}

type Rooms<const D: usize> = Replicas<Few<D>>;

impl Recurrence {
    /// Mean over the rooms with so many particles.
    fn mean<const D: usize>(rooms: &Rooms<D>, count: usize, value: impl Fn(&Few<D>) -> f64) -> corpuscle_observe::Estimate {
        let values: Vec<f64> = rooms.members.iter().filter(|room| room.count == count).map(value).collect();
        corpuscle_observe::Estimate::from_replicas(&values)
    }

    fn all<const D: usize>(rooms: &Rooms<D>, count: usize) -> corpuscle_observe::Estimate {
        Self::mean(rooms, count, |room| room.share(count))
    }

    /// Meetings that began, per time.
    fn rate<const D: usize>(rooms: &Rooms<D>, count: usize) -> corpuscle_observe::Estimate {
        let time = rooms.sampled();
        Self::mean(rooms, count, |room| room.gate.arrivals()[count] as f64 / time)
    }

    fn probability_chart<const D: usize>(&self, rooms: &Rooms<D>) -> Chart {
        let points = self.counts.iter().map(|&count| {
            let share = Self::all(rooms, count);
            (count as f64, share.mean, share.standard_error)
        });
        Chart::new(
            "recurrence",
            "Share of the time that all particles are in the left half",
            Axis::linear("number of particles N", ""),
            Axis::logarithmic("probability", ""),
        )
        .with(Series::theory("2^-N", 2.0, self.counts[0] as f64, 60, Scale::Linear, |n| libm::exp2(-n)))
        .with(Series::with_errors("measured", Style::Points, points.filter(|point| point.1 > 0.0)))
        .noting("Nothing forbids it; with every particle it becomes half as likely. For 160 it is once in 10^48 looks.")
    }

    fn time_chart<const D: usize>(&self, rooms: &Rooms<D>) -> Chart {
        let points = self.counts.iter().map(|&count| {
            let rate = Self::rate(rooms, count);
            (count as f64, 1.0 / rate.mean, rate.standard_error / (rate.mean * rate.mean))
        });
        let expected =
            self.counts.iter().zip(&self.expected).map(|(&n, meeting)| (n as f64, 1.0 / (meeting.probability * meeting.end_rate)));
        Chart::new(
            "recurrence-time",
            "Time from one meeting on the left to the next",
            Axis::linear("number of particles N", ""),
            Axis::logarithmic("mean recurrence time", ""),
        )
        .with(Series::new("Kac: one over the probability times the rate of its end", Style::Theory, expected))
        .with(Series::with_errors("measured", Style::Points, points.filter(|point| point.1.is_finite())))
        .noting("Poincaré's recurrence is no idle threat for few particles, and no threat at all for many.")
    }

    fn occupation_chart<const D: usize>(&self, rooms: &Rooms<D>) -> Chart {
        let most = self.counts[0];
        let measured = (0..=most).map(|left| {
            let share = Self::mean(rooms, most, |room| room.share(left));
            (left as f64, share.mean, share.standard_error)
        });
        let ln_choose = |n: usize, k: usize| {
            let ln = |n: usize| libm::lgamma(n as f64 + 1.0);
            ln(n) - ln(k) - ln(n - k)
        };
        let binomial = (0..=most).map(|left| (left as f64, libm::exp(ln_choose(most, left)) * libm::exp2(-(most as f64))));
        Chart::new(
            "occupation",
            format!("Share of the time with so many of {most} particles in the left half"),
            Axis::linear("particles in the left half", ""),
            Axis::linear("share of the time", ""),
        )
        .with(Series::with_errors("measured", Style::Bars, measured))
        .with(Series::new("binomial", Style::Theory, binomial))
        .noting("Each particle tosses its own coin.")
    }
}

impl<const D: usize> Study<D> for Recurrence {
    type Specimen = Few<D>;

    fn draw(&self, rooms: &Rooms<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        scene.colouring = Colouring::Uniform(Colour::Accent(0));
        if D == 2 {
            scene.regions.push(Region { lower: [0.0, 0.0], upper: [self.middle, self.height], colour: Colour::Tint(0) });
        }
        let (room, expected) = (&rooms.members[0], self.expected[0]);
        scene.caption = format!(
            "all {} on the left {} times so far (theory: once in {:.0})",
            room.count,
            room.gate.arrivals()[room.count],
            1.0 / (expected.probability * expected.end_rate)
        );
    }

    fn charts(&self, rooms: &Rooms<D>) -> Vec<Chart> {
        if rooms.times.len() < 2 {
            return vec![];
        }
        vec![self.probability_chart(rooms), self.time_chart(rooms), self.occupation_chart(rooms)]
    }

    fn checks(&self, rooms: &Rooms<D>) -> Vec<Check> {
        if rooms.times.len() <= SAMPLES {
            return vec![];
        }
        let of_count = |(&count, meeting): (&usize, &Meeting)| {
            let rate = meeting.probability * meeting.end_rate;
            [
                Self::all(rooms, count).check(
                    format!("share of the time with all {count} on the left"),
                    meeting.probability,
                    format!("2^-{count} = {:.3e}, with hard cores", libm::exp2(-(count as f64))),
                ),
                Self::rate(rooms, count).check(
                    format!("meetings of {count} on the left, per time"),
                    rate,
                    format!("Kac: mean recurrence time {:.1}", 1.0 / rate),
                ),
            ]
        };
        self.counts.iter().zip(&self.expected).rev().flat_map(of_count).collect()
    }
}
