//! Diffusion: a drop of marked particles in a gas of their like.
//!
//! In equilibrium, marks change nothing: that a marked particle is at `x` at the time `t` has the probability of the drop convolved with
//! the distribution of one particle's walk, whatever the density. Where that walk is normal with the variance `s^2(t)` along an
//! axis, each wave of the concentration fades by `exp(-k^2 s^2/2)`: with `s^2 = 2 D t` Fick's law and the heat kernel. `s^2` is
//! measured on the particles that are not marked, so that the drop has nothing of its own to be fitted to.
//!
//! The beginning of the walk is exact: collisions slow a particle by the friction `gamma = kT/(m D_1)` with Enskog's first
//! approximation `D_1 = (1/(2 n s chi)) sqrt(kT/(pi m))` of discs, `(3/(8 n s^2 chi)) sqrt(kT/(pi m))` of spheres, and the contact value
//! `chi`. Were each collision independent of those before, `D` would be 1.029 (1.019) times `D_1`, the sum of Sonine's
//! series; what collisions remember makes it some tenths more in dense gases (Alder and Wainwright 1970,
//! doi:10.1103/PhysRevA.1.18), and lets it grow without bound, as a logarithm, in large planes.

mod vessel;
mod wave;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate, theory};
use corpuscle_scene::{Colouring, Scene};

use crate::gas;
use crate::hand::{self, InHand};
use crate::replicas::{Replicas, energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Probed, Settings, Simulation, drawing, ensemble, peek};
use vessel::{BINS, Set, Vessel};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "diffusion",
    title: "A drop spreads",
    summary: "Mark the particles in the middle of a gas and watch them spread: Fick's law and the heat kernel out of collisions, \
              beside Enskog's coefficient.",
    dimensions: &[2, 3],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    gas::DIMENSION,
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of particles, marked or not; they are all alike.",
        kind: Kind::Whole { default: 1200, least: 50, most: 200_000 },
    },
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Volume of the particles over that of the box.",
        kind: Kind::Real { default: 0.2, least: 0.001, most: 0.65 },
    },
    Parameter {
        name: "drop_radius",
        unit: "L",
        help: "Radius of the drop, in sides of the box.",
        kind: Kind::Real { default: 0.22, least: 0.02, most: 0.45 },
    },
    Parameter {
        name: "temperature",
        unit: "",
        help: "Temperature k_B T.",
        kind: Kind::Real { default: 1.0, least: 1e-6, most: 1e6 },
    },
    Parameter {
        name: "duration",
        unit: "L²/(4π² D)",
        help: "How long is watched, in times in which the longest wave fades to 1/e by Enskog's coefficient.",
        kind: Kind::Real { default: 1.2, least: 0.2, most: 20.0 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent vessels; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 24, least: 3, most: 10_000 },
    },
];

/// Samples a fading time.
const RESOLUTION: f64 = 25.0;
/// Times `1/gamma` after which a walk counts as normal and as diffusion.
const OLD: f64 = 12.0;

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(match settings.word("dimension") {
        "3" => Box::new(Diffusion::<3>::new(settings)?),
        _ => Box::new(Diffusion::<2>::new(settings)?),
    })
}

/// The running experiment.
struct Diffusion<const D: usize> {
    set: Set<D>,
    duration: f64,
    vessels: Replicas<Vessel<D>>,
    in_hand: Option<InHand<D>>,
}

resume!(Diffusion<const D> { values: [], parts: [vessels], set_up: [set, duration, in_hand] });

impl<const D: usize> Diffusion<D> {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let set = Set::<D>::new(settings)?;
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let members = ensemble::build(&streams, |&stream| Vessel::new(&set, stream))?;
        // Between two samples: whether the last one is taken does not hang on a rounding.
        let duration = ((settings.real("duration") * RESOLUTION).ceil() + 0.5) * set.fading() / RESOLUTION;
        Ok(Self { duration, vessels: Replicas::new(set.fading() / RESOLUTION, members), set, in_hand: None })
    }

    /// Friction of collisions, exact given the contact value.
    fn friction(&self) -> f64 {
        2.0 / D as f64 * theory::collision_rate::<D>(self.set.density(), 1.0, self.set.temperature, 1.0)
    }

    /// `s^2(t)` of Enskog: `2 D (t - tau (1 - e^(-t/tau)))` with `tau = m D/kT`.
    fn enskog_spread(&self, time: f64) -> f64 {
        let diffusion = self.set.enskog();
        let relaxation = diffusion / self.set.temperature;
        2.0 * diffusion * (time + relaxation * libm::expm1(-time / relaxation))
    }

    /// Whether walks are old at a sample.
    fn is_old(&self, sample: usize) -> bool {
        self.friction() * self.vessels.times[sample] >= OLD
    }

    /// The last sample, if walks are old halfway there.
    fn last(&self) -> Option<usize> {
        let last = self.vessels.times.len() - 1;
        self.is_old(last / 2).then_some(last)
    }

    /// Mean variance of the walks of particles that are not marked.
    fn spread(&self, sample: usize) -> Estimate {
        self.vessels.mean(|vessel| vessel.samples[sample].spread[0])
    }

    /// Coefficient of diffusion: half the slope of the variance over the later half, of particles that are not marked.
    fn coefficient(&self, last: usize) -> Estimate {
        let (from, times) = (last / 2, &self.vessels.times);
        let time = times[last] - times[from];
        self.vessels.mean(|vessel| (vessel.samples[last].spread[0] - vessel.samples[from].spread[0]) / (2.0 * time))
    }

    /// A wave of the drop over what the walks of the others make of it.
    fn wave(&self, wave: usize, sample: usize) -> Estimate {
        let pairs: Vec<[f64; 2]> = self
            .vessels
            .members
            .iter()
            .map(|vessel| [vessel.samples[sample].waves[wave - 1], vessel.samples[sample].spread[0]])
            .collect();
        Estimate::jackknife(&pairs, |[amplitude, variance]| amplitude / self.set.drop.faded(wave, variance))
    }

    fn profile_chart(&self) -> Chart {
        let side = self.set.drop.side;
        let last = self.vessels.times.len() - 1;
        let mut chart = Chart::new(
            "profile",
            "The drop along an axis",
            Axis::linear("place from the middle", "L"),
            Axis::linear("concentration over its mean", ""),
        );
        let mut steps = vec![0, (0.1 * RESOLUTION) as usize, (0.4 * RESOLUTION) as usize, last];
        steps.retain(|&step| step <= last);
        steps.dedup();
        for step in steps {
            let place = |bin: usize| (bin as f64 + 0.5) / BINS as f64 - 0.5;
            let measured = (0..BINS).map(|bin| {
                let share = self.vessels.mean(|vessel| vessel.samples[step].bins[bin] * BINS as f64);
                (place(bin), share.mean, share.standard_error)
            });
            let variance = self.spread(step).mean;
            let time = format!("t = {:.2} L²/(4π² D)", self.vessels.times[step] / self.set.fading());
            let law = |x: f64| self.set.drop.profile(x * side, variance);
            chart = chart
                .with(Series::theory(format!("{time}, heat kernel"), -0.5, 0.5, 160, Scale::Linear, law))
                .with(Series::with_errors(time, Style::Points, measured));
        }
        chart.noting("Nothing is fitted: the width of the kernel is that of the walks of particles that are not in the drop.")
    }

    fn spread_chart(&self) -> Chart {
        let (times, samples) = (&self.vessels.times, self.vessels.times.len());
        let measured = |kind: usize| {
            let points = (1..samples).map(move |sample| {
                let spread = self.vessels.mean(|vessel| vessel.samples[sample].spread[kind]);
                (times[sample], spread.mean, spread.standard_error)
            });
            points.collect::<Vec<_>>()
        };
        let (from, to) = (0.2 / self.friction(), self.vessels.sampled().max(1.0 / self.friction()));
        Chart::new(
            "spread",
            "How far particles have walked",
            Axis::logarithmic("time t", ""),
            Axis::logarithmic("mean squared displacement along an axis", ""),
        )
        .with(Series::theory("Enskog: 2 D (t − τ(1 − exp(−t/τ)))", from, to, 100, Scale::Logarithmic, |t| {
            self.enskog_spread(t)
        }))
        .with(Series::with_errors("the others", Style::Points, measured(0)))
        .with(Series::with_errors("the drop", Style::Points, measured(1)))
        .noting("First straight on, t²; after some collisions as a random walk, t.")
    }

    fn wave_chart(&self) -> Chart {
        let mut chart = Chart::new(
            "waves",
            "Waves of the concentration fade",
            Axis::linear("time t", ""),
            Axis::logarithmic("amplitude over that at the start", ""),
        );
        for wave in 1..=2 {
            let start = self.set.drop.amplitude(wave);
            let measured = self.vessels.times.iter().enumerate().map(|(sample, &time)| {
                let amplitude = self.vessels.mean(|vessel| vessel.samples[sample].waves[wave - 1] / start);
                (time, amplitude.mean, amplitude.standard_error)
            });
            let measured: Vec<_> = measured.filter(|point| point.1 > 3.0 * point.2).collect();
            let end = measured.last().map_or(0.0, |point| point.0);
            let law = |time: f64| self.set.drop.faded(wave, self.enskog_spread(time)) / start;
            let name = if wave == 1 { "longest wave" } else { "half as long" };
            chart = chart
                .with(Series::theory(format!("{name}, Enskog"), 0.0, end, 100, Scale::Linear, law))
                .with(Series::with_errors(name, Style::Points, measured));
        }
        chart.noting("A wave half as long fades four times as fast: sharp edges go first.")
    }
}

impl<const D: usize> Simulation for Diffusion<D> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.vessels.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.vessels.advance(to)?;
        InHand::advance_any(&mut self.in_hand, self.vessels.members[0].started + to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let vessel = &self.vessels.members[0];
        let shade = |i: usize| f64::from(u8::from(vessel.is_marked(i)));
        let engine = InHand::on_show(self.in_hand.as_ref(), &vessel.engine);
        drawing::add_event_driven(scene, engine, &Tally::default(), vessel.started, shade);
        scene.colouring = Colouring::Species(vec!["gas".into(), "drop".into()]);
        scene.title = EXPERIMENT.title.into();
        let ratio = |diffusion: f64| diffusion / self.set.enskog();
        scene.caption = match self.last() {
            Some(last) => {
                let diffusion = self.coefficient(last);
                format!("D = {:.3} ± {:.3} of Enskog's", ratio(diffusion.mean), ratio(diffusion.standard_error))
            }
            None => format!("Enskog: D = {:.4}", self.set.enskog()),
        };
    }

    fn frame(&self) -> Option<Frame> {
        let vessel = &self.vessels.members[0];
        let species = (0..self.set.particles).map(|i| u16::from(vessel.is_marked(i)));
        Some(Frame::of_hard(&vessel.engine, vessel.started, &["gas", "drop"]).with_species(species))
    }

    fn charts(&self) -> Vec<Chart> {
        if self.vessels.times.len() < 3 {
            return vec![];
        }
        vec![self.profile_chart(), self.spread_chart(), self.wave_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        if let Some(last) = self.last() {
            let friction = self.vessels.mean(|vessel| vessel.friction(last, self.vessels.times[last], self.set.temperature));
            let reference = "Enskog: kT/(m D_1), exact given the contact value; equation of state of the fluid";
            checks.push(friction.check("friction by the kicks of collisions", self.friction(), reference));
            let reference = "heat kernel: J_1 (spherical) amplitude times exp(-k^2 s^2/2), s^2 of the other particles";
            for (name, wave, sample) in [
                ("longest wave of the drop at the end, over the heat kernel's", 1, last),
                ("longest wave of the drop halfway, over the heat kernel's", 1, last / 2),
                ("half as long a wave at a quarter, over the heat kernel's", 2, last / 4),
            ] {
                if self.is_old(sample) {
                    checks.push(self.wave(wave, sample).check(name, 1.0, reference));
                }
            }
        }
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        honesty(self.vessels.members.iter().map(|vessel| (&vessel.engine, Some(vessel.energy))))
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.1 * self.set.fading(), 0.4 * self.set.fading()]
    }

    fn next_event(&self) -> Option<f64> {
        let vessel = &self.vessels.members[0];
        peek::next_contact(InHand::on_show(self.in_hand.as_ref(), &vessel.engine), 1.5 * self.duration)
            .map(|time| time - vessel.started)
    }

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        InHand::lay(&mut self.in_hand, &self.vessels.members[0].engine, corners);
    }

    fn probed(&self) -> Option<Probed> {
        InHand::probed(self.in_hand.as_ref())
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        hand::wanting_of_number(&self.vessels.members[0].engine, action)
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        InHand::act(&mut self.in_hand, &self.vessels.members[0].engine, &Tally::default(), action)
    }
}
