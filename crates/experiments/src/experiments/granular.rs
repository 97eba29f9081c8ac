//! A granular gas: hard particles that lose a part of their relative speed at each contact, and nothing to warm them.
//!
//! Kinetic theory of the even gas. A contact takes `(1 - e^2) kT` on average, so that in `D` dimensions with the collision rate
//! `nu_0` at the start `T = T_0/(1 + t/tau)^2`, `1/tau = (1 - e^2) nu_0 (1 + 3 a_2/16)/(2 D)`: Haff's law (1983,
//! doi:10.1017/S0022112083003419). Velocities are not quite Maxwell's: `<v^4> = (1 + 2/D) <v^2>^2 (1 + a_2)`,
//! `a_2 = 16 (1 - e)(1 - 2 e^2)/(9 + 24 D + (8 D - 41) e + 30 e^2 (1 - e))` (van Noije and Ernst 1998,
//! doi:10.1007/s100350050009). In terms of the number `C` of contacts, `ln(T/T_0) = -2 (1 - e^2)(1 + a_2/4) C/(f + 1)` with the
//! `f = D (N - 1)` degrees of freedom, whatever the density.
//!
//! The even gas is unstable: shear of wave length above `2 pi sqrt(2 eta_s/(rho zeta))` loses less than heat does, particles
//! stream along each other, meet, slow down and cluster (Goldhirsch and Zanetti 1993, doi:10.1103/PhysRevLett.70.1619). A
//! small thin box has no room for such waves and obeys Haff's law; a crowd shows what else there is.

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Boundary, Engine, Failure, Invalid, Particles, Random};
use corpuscle_event::{EventDriven, Restitution, Rules};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate, theory};
use corpuscle_scene::{Colouring, Scene};

use crate::gas::{self, Species};
use crate::hand::{self, InHand};
use crate::replicas::{Member, Replicas, honesty};
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Probed, Settings, Simulation, drawing, ensemble, peek};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "granular",
    title: "A granular gas",
    summary: "Grains that lose a little at each contact: small boxes cool by Haff's law, and a crowd of them falls into streams \
              and clusters.",
    dimensions: &[2, 3],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    gas::DIMENSION,
    Parameter {
        name: "restitution",
        unit: "",
        help: "Part of the normal relative speed that a contact leaves.",
        kind: Kind::Real { default: 0.85, least: 0.5, most: 0.999 },
    },
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of grains in each small box.",
        kind: Kind::Whole { default: 200, least: 10, most: 20_000 },
    },
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Volume of the grains over that of a small box. Theory is for a thin, even gas.",
        kind: Kind::Real { default: 0.02, least: 1e-5, most: 0.3 },
    },
    Parameter {
        name: "crowd",
        unit: "",
        help: "Number of grains on show.",
        kind: Kind::Whole { default: 2500, least: 10, most: 200_000 },
    },
    Parameter {
        name: "crowd_packing_fraction",
        unit: "",
        help: "Volume of the grains on show over that of their box.",
        kind: Kind::Real { default: 0.2, least: 1e-4, most: 0.5 },
    },
    Parameter {
        name: "duration",
        unit: "τ",
        help: "How long is watched, in Haff's cooling times of the small boxes.",
        kind: Kind::Real { default: 8.0, least: 1.0, most: 1000.0 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent small boxes; their scatter gives the error bars.",
        kind: Kind::Whole { default: 48, least: 2, most: 10_000 },
    },
];

/// Samples a cooling time.
const RESOLUTION: f64 = 8.0;
/// Cooling times after which velocities have the distribution of the cooling gas: ten contacts a particle at least.
const SETTLED: f64 = 2.0;
/// Grains in a cell in which the crowd is counted, about.
const CELL: f64 = 8.0;
/// Stream of random numbers of the crowd.
const CROWD_STREAM: u64 = 1 << 33;

/// `a_2` of the cooling gas.
fn excess_kurtosis(dimension: f64, e: f64) -> f64 {
    16.0 * (1.0 - e) * (1.0 - 2.0 * e * e) / (9.0 + 24.0 * dimension + (8.0 * dimension - 41.0) * e + 30.0 * e * e * (1.0 - e))
}

/// One gas under way.
struct Grains<const D: usize> {
    engine: EventDriven<D>,
    /// At each sample: temperature, contacts so far, the mean fourth power of the speed over the square of that of its second.
    samples: Vec<[f64; 3]>,
    freedom: f64,
    started: f64,
    warm_up: u64,
}

resume!(Grains<const D> { values: [engine, samples], set_up: [freedom, started, warm_up] });

impl<const D: usize> Grains<D> {
    /// A box of elastic grains that have come to equilibrium at temperature 1, and are from now on inelastic.
    fn new(settings: &Settings, count: usize, packing: f64, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(settings.seed, stream);
        let boundary = Boundary::<D>::periodic(gas::side::<D>(count, 0.5, packing));
        let mut particles = Particles::new();
        let places = if packing < 0.3 {
            gas::add(&mut particles, &boundary, Species { count, radius: 0.5, mass: 1.0, index: 0 }, &mut random)
        } else {
            gas::grow(&mut particles, &boundary, count, &mut random)
        };
        places?;
        maxwell(&mut particles, 1.0, true, &mut random);
        let rate = theory::collision_rate::<D>(theory_density::<D>(packing), 1.0, 1.0, 1.0);
        let mut elastic = EventDriven::new(boundary.clone(), particles, Rules::default())?;
        elastic.advance(10.0 / rate, &mut ()).map_err(|failure| Invalid::new("particles", count, failure.to_string()))?;
        let rules = Rules { restitution: Restitution::Constant(settings.real("restitution")), ..Rules::default() };
        let engine = EventDriven::new(boundary, elastic.snapshot(), rules)?;
        Ok(Self { engine, samples: vec![], freedom: (D * (count - 1)) as f64, started: 0.0, warm_up: elastic.counts().collisions })
    }

    fn temperature(&self) -> f64 {
        2.0 * self.engine.kinetic_energy() / self.freedom
    }

    /// Variance of the numbers in equal cells over that of chance: what clusters raise.
    fn clumping(&self) -> f64 {
        let count = self.engine.particle_count();
        let extent = self.engine.boundary().extent();
        let cells = libm::pow(count as f64 / CELL, 1.0 / D as f64).round().max(2.0) as usize;
        let mut numbers = vec![0.0; cells.pow(D as u32)];
        for i in 0..count {
            let place = self.engine.position(i);
            let index = (0..D).fold(0, |index, k| index * cells + ((place[k] / extent[k] * cells as f64) as usize).min(cells - 1));
            numbers[index] += 1.0;
        }
        let mean = count as f64 / numbers.len() as f64;
        numbers.iter().map(|n| (n - mean) * (n - mean)).sum::<f64>() / (mean * (numbers.len() as f64 - 1.0))
    }
}

/// Number density of spheres of diameter 1.
fn theory_density<const D: usize>(packing: f64) -> f64 {
    packing / corpuscle_core::particles::ball_volume::<D>(0.5)
}

impl<const D: usize> Member for Grains<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.engine.advance(self.started + time, &mut ())
    }

    fn sample(&mut self) {
        let count = self.engine.particle_count();
        let squares = (0..count).map(|i| self.engine.velocity(i).norm_squared());
        let (second, fourth) = squares.fold((0.0, 0.0), |(second, fourth), square| (second + square, fourth + square * square));
        let kurtosis = fourth * count as f64 / (second * second);
        self.samples.push([self.temperature(), self.engine.counts().collisions as f64, kurtosis]);
    }

    fn time(&self) -> f64 {
        self.engine.time() - self.started
    }
}

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("dimension") {
        "3" => Box::new(Granular::<3>::new(settings)?),
        _ => Box::new(Granular::<2>::new(settings)?),
    })
}

/// The running experiment.
struct Granular<const D: usize> {
    restitution: f64,
    freedom: f64,
    /// Haff's cooling time of the small boxes.
    cooling: f64,
    crowd_cooling: f64,
    duration: f64,
    boxes: Replicas<Grains<D>>,
    crowd: Replicas<Crowd<D>>,
    in_hand: Option<InHand<D>>,
}

/// The grains on show, and how they clump.
struct Crowd<const D: usize> {
    grains: Grains<D>,
    clumping: Vec<f64>,
}

resume!(Crowd<const D> { values: [clumping], parts: [grains], set_up: [] });

impl<const D: usize> Member for Crowd<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        self.grains.advance(time)
    }

    fn sample(&mut self) {
        self.grains.sample();
        self.clumping.push(self.grains.clumping());
    }

    fn time(&self) -> f64 {
        self.grains.time()
    }
}

resume!(Granular<const D> { values: [], parts: [boxes, crowd], set_up: [restitution, freedom, cooling, crowd_cooling, duration, in_hand] });

impl<const D: usize> Granular<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (e, count, packing) = (settings.real("restitution"), settings.whole("particles"), settings.real("packing_fraction"));
        let freedom = (D * (count - 1)) as f64;
        let cooling = |packing: f64, freedom: f64| {
            let rate = theory::collision_rate::<D>(theory_density::<D>(packing), 1.0, 1.0, 1.0);
            // With a fixed energy the mean cube of the relative speed is lower than Maxwell's.
            let half = 0.5 * freedom;
            let closed = libm::exp(1.5 * libm::log(half) + libm::lgamma(half) - libm::lgamma(half + 1.5));
            let d = D as f64;
            2.0 * d / ((1.0 - e * e) * rate * closed * (1.0 + 0.1875 * excess_kurtosis(d, e)))
        };
        let (crowd, crowd_packing) = (settings.whole("crowd"), settings.real("crowd_packing_fraction"));
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let boxes = ensemble::build(&streams, |&stream| Grains::new(settings, count, packing, stream))?;
        let grains = Grains::new(settings, crowd, crowd_packing, CROWD_STREAM)?;
        let cooling_time = cooling(packing, freedom);
        let interval = cooling_time / RESOLUTION;
        Ok(Self {
            restitution: e,
            freedom,
            cooling: cooling_time,
            crowd_cooling: cooling(crowd_packing, (D * (crowd - 1)) as f64),
            duration: settings.real("duration") * cooling_time,
            boxes: Replicas::new(interval, boxes),
            crowd: Replicas::new(interval, vec![Crowd { grains, clumping: vec![] }]),
            in_hand: None,
        })
    }

    fn haff(time: f64, cooling: f64) -> f64 {
        1.0 / ((1.0 + time / cooling) * (1.0 + time / cooling))
    }

    fn temperatures(&self) -> Vec<(f64, f64, f64)> {
        let at = |(k, &time): (usize, &f64)| {
            let mean = self.boxes.mean(|grains| grains.samples[k][0]);
            (time, mean.mean, mean.standard_error)
        };
        self.boxes.times.iter().enumerate().map(at).collect()
    }

    fn cooling_chart(&self) -> Chart {
        let end = self.boxes.sampled();
        let first = 0.1 * self.cooling;
        let crowd = self.boxes.times.iter().zip(&self.crowd.members[0].grains.samples).skip(1).map(|(&t, sample)| (t, sample[0]));
        Chart::new("cooling", "Cooling", Axis::logarithmic("time t", ""), Axis::logarithmic("temperature T / T₀", ""))
            .with(Series::theory("Haff, small boxes", first, end, 100, Scale::Logarithmic, |t| Self::haff(t, self.cooling)))
            .with(Series::with_errors("small boxes", Style::Points, self.temperatures().into_iter().skip(1)))
            .with(Series::theory("Haff, the crowd were it even", first, end, 100, Scale::Logarithmic, |t| {
                Self::haff(t, self.crowd_cooling)
            }))
            .with(Series::new("the crowd", Style::Points, crowd))
            .noting(
                "Slope −2 on these axes. The crowd leaves the law where streams form: they keep energy that contacts cannot take.",
            )
    }

    fn contact_chart(&self) -> Chart {
        let per_particle = |samples: &[f64; 3], count: f64| (2.0 * samples[1] / count, samples[0]);
        let count = self.freedom / D as f64 + 1.0;
        let first = &self.boxes.members[0];
        let most = first.samples.last().map_or(1.0, |sample| 2.0 * sample[1] / count);
        let slope = self.loss_per_contact() * 0.5 * count;
        let measured = first.samples.iter().map(|sample| per_particle(sample, count));
        Chart::new(
            "contacts",
            "Cooling, contact by contact",
            Axis::linear("contacts per grain", ""),
            Axis::logarithmic("temperature T / T₀", ""),
        )
        .with(Series::theory("exp(−(1 − e²) C/D)", 0.0, most, 60, Scale::Linear, |c| libm::exp(-slope * c)))
        .with(Series::new("one small box", Style::Points, measured))
        .noting("Each contact takes the same share, on average: the law is exponential in contacts, which get rarer as it cools.")
    }

    fn clumping_chart(&self) -> Chart {
        let crowd = &self.crowd.members[0];
        let points = self.crowd.times.iter().copied().zip(crowd.clumping.iter().copied());
        Chart::new(
            "clumping",
            "Clusters",
            Axis::linear("time t", ""),
            Axis::linear("variance of the count in a cell, over Poisson's", ""),
        )
        .with(Series::theory("chance", 0.0, self.crowd.sampled(), 2, Scale::Linear, |_| 1.0))
        .with(Series::new("the crowd", Style::Line, points))
        .noting("An even fluid is steadier than chance. Clusters and voids raise the variance far above it.")
    }

    /// `-d ln T / dC` for `C` contacts in the whole box.
    fn loss_per_contact(&self) -> f64 {
        let e = self.restitution;
        2.0 * (1.0 - e * e) * (1.0 + 0.25 * excess_kurtosis(D as f64, e)) / (self.freedom + 1.0)
    }
}

impl<const D: usize> Simulation for Granular<D> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.crowd.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.boxes.advance(to)?;
        self.crowd.advance(to)?;
        InHand::advance_any(&mut self.in_hand, self.crowd.members[0].grains.started + to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let crowd = &self.crowd.members[0].grains;
        let engine = InHand::on_show(self.in_hand.as_ref(), &crowd.engine);
        drawing::add_event_driven(scene, engine, &Tally::default(), crowd.started, |_| 0.0);
        let temperature = crowd.temperature();
        scene.colouring = Colouring::Speed { most: 2.5 * (D as f64 * temperature).sqrt(), unit: String::new() };
        scene.title = EXPERIMENT.title.into();
        scene.caption = format!(
            "T / T₀ = {temperature:.4} (even gas, Haff: {:.4})   {:.1} contacts a grain",
            Self::haff(self.time(), self.crowd_cooling),
            2.0 * crowd.engine.counts().collisions as f64 / crowd.engine.particle_count() as f64
        );
    }

    fn frame(&self) -> Option<Frame> {
        let crowd = &self.crowd.members[0].grains;
        Some(Frame::of_hard(&crowd.engine, crowd.started, &["grains"]))
    }

    fn charts(&self) -> Vec<Chart> {
        if self.boxes.times.len() < 3 {
            return vec![];
        }
        vec![self.cooling_chart(), self.clumping_chart(), self.contact_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let settled = (SETTLED * RESOLUTION) as usize;
        let last = self.boxes.times.len() - 1;
        if last > 2 * settled {
            let time = self.boxes.times[last];
            let temperature = self.boxes.mean(|grains| libm::log(grains.samples[last][0]));
            let expected = libm::log(Self::haff(time, self.cooling));
            checks.push(temperature.check("ln(T/T0) at the end", expected, "Haff 1983, doi:10.1017/S0022112083003419; Enskog"));
            let loss = self.boxes.mean(|grains| {
                let (a, b) = (grains.samples[0], grains.samples[last]);
                libm::log(a[0] / b[0]) / (b[1] - a[1])
            });
            let reference = "2 (1 - e^2)(1 + a_2/4)/(f + 1): a contact takes (1 - e^2) kT on average";
            checks.push(loss.check("loss of ln T in a contact", self.loss_per_contact(), reference));
            let kurtosis = self.boxes.mean(|grains| {
                let samples = &grains.samples[settled..];
                samples.iter().map(|sample| sample[2]).sum::<f64>() / samples.len() as f64
            });
            let d = D as f64;
            // In a closed system speeds are bounded: the factor f/(f + 2).
            let scale = (1.0 + 2.0 / d) * self.freedom / (self.freedom + 2.0);
            let excess =
                Estimate { mean: kurtosis.mean / scale - 1.0, standard_error: kurtosis.standard_error / scale, ..kurtosis };
            let reference = "van Noije and Ernst 1998, doi:10.1007/s100350050009";
            checks.push(excess.check(
                "excess a2 of the fourth moment of the speed",
                excess_kurtosis(d, self.restitution),
                reference,
            ));
        }
        let momentum = self.boxes.members.iter().map(|grains| grains.engine.momentum().norm()).fold(0.0, f64::max);
        let scale = self.freedom.sqrt();
        checks.push(Check::at_most("momentum over that of one box at the start", momentum / scale, 1e-11, "contacts conserve it"));
        checks
    }

    fn honesty(&self) -> Honesty {
        let crowd = self.crowd.members.iter().map(|crowd| &crowd.grains);
        let warm_up: u64 = self.boxes.members.iter().chain(crowd.clone()).map(|grains| grains.warm_up).sum();
        let runs = self.boxes.members.iter().chain(crowd).map(|grains| (&grains.engine, None));
        let honesty = honesty(runs);
        Honesty { work: honesty.work + warm_up, ..honesty }
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.2 * self.duration, 0.5 * self.duration]
    }

    fn next_event(&self) -> Option<f64> {
        let engine = InHand::on_show(self.in_hand.as_ref(), &self.crowd.members[0].grains.engine);
        peek::next_contact(engine, 1.5 * self.duration)
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        InHand::lay(&mut self.in_hand, &self.crowd.members[0].grains.engine, corners);
    }

    fn probed(&self) -> Option<Probed> {
        InHand::probed(self.in_hand.as_ref())
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.crowd.members[0].grains.engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        InHand::act(&mut self.in_hand, &self.crowd.members[0].grains.engine, &Tally::default(), action)
    }
}
