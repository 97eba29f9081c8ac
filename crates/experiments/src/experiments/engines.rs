//! Two engines, one gas: hard discs from event to event, and nearly hard ones step by step.
//!
//! **How long they agree.** Discs that repel each other by `U = k (s - r)^2/2` are in contact for `pi sqrt(m/(2 k))`, in which hard
//! ones would have parted already: each contact puts the engines that time apart. From then on they part as any two neighbours
//! do, by `exp(lambda t)`, so that harder discs and finer steps win logarithms of time only.
//!
//! **What averages care.** Nothing: both have the pressure of hard discs, the soft ones of discs of the diameter
//! `s (1 - sqrt(pi kT/(2 k s^2)))` (Barker and Henderson 1967, doi:10.1063/1.1701689).
//!
//! **What a step misses.** Two discs that fly straight on through each other overlap for the time `2 s cos(phi)/g`. A program that
//! looks every `h` sees nothing of it with the probability `max(0, 1 - 2 s cos(phi)/(g h))`. Averaged over impact parameters and
//! relative speeds in equilibrium ([`chords`]) that is `h^2 kT/(4 m s^2)` of all collisions for short steps.
//!
//! **What it costs.** An event for each collision, whenever it is; a step for everybody, `sqrt(k)` of them per time, whether
//! there is a collision or not.

mod chords;
mod pair;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Engine, Failure, Invalid};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::theory::hard_discs;
use corpuscle_observe::{Chart, Check, Curves, theory};
use corpuscle_scene::{Body, Camera, Colour, Colouring, Label, Scene};

use crate::replicas::{Replicas, energy_check, honesty};
use crate::tally::Tally;
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation, Table, drawing, ensemble, peek};
use chords::STEPS;
use pair::{Pair, Sample, Set};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "engines",
    title: "Two engines, one gas",
    summary: "The same discs from event to event and step by step: how long the engines agree, what a step misses, and why averages \
              do not care.",
    dimensions: &[2],
    engines: &["event-driven", "time-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "particles",
        unit: "",
        help: "Number of discs in each box.",
        kind: Kind::Whole { default: 120, least: 10, most: 20_000 },
    },
    Parameter {
        name: "packing_fraction",
        unit: "",
        help: "Area of the discs over that of the box.",
        kind: Kind::Real { default: 0.3, least: 0.005, most: 0.65 },
    },
    Parameter {
        name: "hardness",
        unit: "k_B T",
        help: "Energy it takes to push two discs of the time-driven engine wholly together.",
        kind: Kind::Real { default: 1e4, least: 200.0, most: 1e10 },
    },
    Parameter {
        name: "steps_per_contact",
        unit: "",
        help: "Steps of the time-driven engine in the time two discs are in contact.",
        kind: Kind::Real { default: 20.0, least: 1.5, most: 500.0 },
    },
    Parameter {
        name: "duration",
        unit: "",
        help: "How long both are watched, in mean times between collisions of a disc.",
        kind: Kind::Real { default: 25.0, least: 4.0, most: 1e4 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent pairs of boxes; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 8, least: 3, most: 1000 },
    },
];

/// Distance at which the engines no longer agree: a radius.
const PARTED: f64 = 0.5;
/// Steps at which the share of missed collisions is judged, of [`STEPS`]: enough are missed for their mean to be normal.
const JUDGED: [usize; 3] = [2, 4, 6];
/// Steps a contact above which the time-driven engine is held to the pressure of hard discs, and hardness likewise.
const FINE: f64 = 10.0;
const HARD: f64 = 3000.0;
/// Room between the boxes, in sides.
const GAP: f64 = 0.08;

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Engines::new(settings)?))
}

/// The running experiment.
struct Engines {
    set: Set,
    duration: f64,
    pairs: Replicas<Pair>,
}

resume!(Engines { values: [], parts: [pairs], set_up: [set, duration] });

impl Engines {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let set = Set::new(settings);
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let members = ensemble::build(&streams, |&stream| Pair::new(&set, stream))?;
        // Between two samples: whether the last one is taken does not hang on a rounding.
        let duration = ((settings.real("duration") * pair::RESOLUTION).ceil() + 0.5) * set.interval();
        Ok(Self { duration, pairs: Replicas::new(set.interval(), members), set })
    }

    fn curve(&self, number: impl Fn(&Sample) -> f64) -> Curves {
        let series = |pair: &Pair| pair.samples.iter().map(&number).collect();
        Curves { x: self.pairs.times.clone(), y: self.pairs.members.iter().map(series).collect() }
    }

    /// When the engines of a pair had parted, if they have.
    fn parted(&self, pair: &Pair) -> Option<f64> {
        pair.samples.iter().position(|sample| sample.apart > PARTED).map(|sample| self.pairs.times[sample])
    }

    fn agreement_chart(&self) -> Chart {
        let logarithms = |number: fn(&Sample) -> f64| {
            let curve = self.curve(move |sample| libm::log(number(sample)));
            let points = curve.points().into_iter().skip(1).map(|(t, mean)| {
                let value = libm::exp(mean.mean);
                (t, value, value * mean.standard_error)
            });
            points.collect::<Vec<_>>()
        };
        let end = self.pairs.sampled();
        let flight = 0.5 * self.set.contact_time();
        Chart::new(
            "agreement",
            "How far the engines are apart",
            Axis::linear("time t", ""),
            Axis::logarithmic("distance of a disc from itself", "σ"),
        )
        .with(Series::theory("a radius", 0.0, end, 2, Scale::Linear, |_| PARTED))
        .with(Series::theory("what one contact is late, times the speed", 0.0, end, 2, Scale::Linear, |_| flight))
        .with(Series::with_errors("one engine and the other", Style::Points, logarithms(|sample| sample.apart)))
        .with(Series::with_errors("one engine twice, a hair apart", Style::Points, logarithms(|sample| sample.twins)))
        .noting("Both rise alike: the engines part as two starts would. Discs a hundred times as hard agree but a little longer.")
    }

    fn missed_chart(&self) -> Chart {
        let measured = STEPS.iter().enumerate().map(|(k, &step)| {
            let share = self.pairs.mean(|pair| pair.chords.shares()[k]);
            (step, share.mean, share.standard_error)
        });
        Chart::new(
            "missed",
            "Collisions that a look every h does not see",
            Axis::logarithmic("time between looks h", "σ √(m/kT)"),
            Axis::logarithmic("share of the collisions", ""),
        )
        .with(Series::theory(
            "straight flight, uniform impact",
            STEPS[0],
            STEPS[STEPS.len() - 1],
            100,
            Scale::Logarithmic,
            chords::missed,
        ))
        .with(Series::with_errors("measured", Style::Points, measured.filter(|point| point.1 > 0.0)))
        .noting("Half the step, a quarter of the tunnels: never none. The event-driven engine has no h.")
    }

    fn energy_chart(&self) -> Chart {
        let points = self.curve(|sample| sample.drift.max(1e-17)).points();
        let measured = points.into_iter().skip(1).map(|(t, drift)| (t, drift.mean, drift.standard_error));
        let exact = self.honesty().energy_drift.unwrap_or(0.0).max(1e-17);
        Chart::new("energy", "Energy", Axis::linear("time t", ""), Axis::logarithmic("|E − E₀|/E₀", ""))
            .with(Series::with_errors("time-driven", Style::Line, measured))
            .with(Series::theory("event-driven, so far", 0.0, self.pairs.sampled(), 2, Scale::Linear, |_| exact))
            .noting(
                "While two soft discs are in contact a part of their energy is the potential's, known to the step's second order.",
            )
    }

    fn work_chart(&self) -> Chart {
        let events = |packing: f64| {
            let density = packing / corpuscle_core::particles::ball_volume::<2>(0.5);
            0.5 * theory::collision_rate::<2>(density, 1.0, 1.0, 1.0)
        };
        let collisions =
            self.pairs.mean(|pair| pair.hard.counts().collisions as f64 / (self.set.particles as f64 * pair.hard.time().max(1e-9)));
        let steps = 1.0 / self.set.step();
        let here = self.set.packing;
        Chart::new(
            "work",
            "Work for each disc in a unit of time",
            Axis::logarithmic("packing fraction", ""),
            Axis::logarithmic("events, or steps", ""),
        )
        .with(Series::theory("events: half of Enskog's collision rate", 0.005, 0.68, 80, Scale::Logarithmic, events))
        .with(Series::with_errors("events, measured", Style::Points, [(here, collisions.mean, collisions.standard_error)]))
        .with(Series::theory("steps: this hardness", 0.005, 0.68, 2, Scale::Logarithmic, |_| steps))
        .with(Series::new("steps, taken", Style::Points, [(here, steps)]))
        .noting("An event is paid when something happens, a step always; a step looks at all neighbours, an event at those of two discs.")
    }
}

impl Simulation for Engines {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.pairs.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.pairs.advance(to)
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let (pair, side) = (&self.pairs.members[0], self.set.side);
        drawing::add_event_driven(scene, &pair.hard, &Tally::default(), 0.0, |i| pair.distance(i));
        let soft = pair.soft.particles();
        let shift = side * (1.0 + GAP);
        let place = |r: [f64; 3]| [r[0] + shift, r[1], r[2]];
        let shades: Vec<f64> = scene.bodies.iter().map(|body| body.shade).collect();
        scene.bodies.extend((0..soft.len()).map(|i| Body {
            position: place(soft.position[i].to_three()),
            velocity: soft.velocity[i].to_three(),
            time: pair.soft.time(),
            radius: 0.5,
            shade: shades[i],
        }));
        scene.add_box(place([0.0; 3]), place([side, side, 0.0]), 1.0, Colour::Faint);
        for (x, text) in [
            (0.5 * side, "from event to event".to_owned()),
            (0.5 * side + shift, format!("step by step, {:.0} a contact", self.set.contact_time() / self.set.step())),
        ] {
            scene.labels.push(Label { at: [x, -0.05 * side, 0.0], text, colour: Colour::Ink });
        }
        let corners = [[0.0, -0.1 * side, 0.0], [side + shift, side, 0.0]];
        (scene.period, scene.bounds) = ([0.0; 3], Some(corners));
        scene.camera = Camera::fit(corners[0], corners[1]);
        scene.colouring =
            Colouring::Value { name: "distance from itself in the other engine".into(), unit: "σ".into(), least: 0.0, most: 1.0 };
        scene.title = EXPERIMENT.title.into();
        scene.caption = match self.parted(pair) {
            Some(time) => format!("they agreed until t = {time:.2}, for {:.1} collisions of a disc", time * self.set.rate()),
            None => "they agree so far".into(),
        };
    }

    /// Those of the event-driven engine.
    fn frame(&self) -> Option<Frame> {
        Some(Frame::of_hard(&self.pairs.members[0].hard, 0.0, &["discs"]))
    }

    fn charts(&self) -> Vec<Chart> {
        if self.pairs.times.len() < 3 {
            return vec![];
        }
        vec![self.agreement_chart(), self.missed_chart(), self.energy_chart(), self.work_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        if self.pairs.sampled() * self.set.rate() >= 3.9 {
            for k in JUDGED {
                let share = self.pairs.mean(|pair| pair.chords.shares()[k]);
                let name = format!("share of collisions missed by looks every {} σ sqrt(m/kT)", STEPS[k]);
                let reference = "straight flight, uniform impact parameters, relative speeds in equilibrium: exact";
                checks.push(share.check(name, chords::missed(STEPS[k]), reference));
            }
            let virial = "ten virial coefficients, Clisby and McCoy 2006, doi:10.1007/s10955-005-8080-0, of a fixed number";
            let pressure = self.pairs.mean(|pair| pair.hard_compressibility(self.pairs.sampled()));
            let expected = hard_discs::liquid_of_few(self.set.packing, self.set.particles);
            checks.push(pressure.check("P V/(N k T), event-driven", expected, virial));
            if self.set.steps_per_contact >= FINE && self.set.hardness >= HARD {
                let diameter = self.set.effective_diameter();
                let expected = hard_discs::liquid_of_few(self.set.packing * diameter * diameter, self.set.particles);
                let pressure = self.pairs.mean(Pair::soft_compressibility);
                let reference = "the same at the diameter of Barker and Henderson 1967, doi:10.1063/1.1701689";
                checks.push(pressure.check("P V/(N k T), time-driven", expected, reference));
            }
        }
        checks.extend(energy_check(&self.honesty()));
        checks
    }

    fn honesty(&self) -> Honesty {
        let hard = honesty(self.pairs.members.iter().map(|pair| (&pair.hard, Some(pair.energy))));
        // Two discs in contact swing about each other with the frequency pi over the time of contact.
        let stability = std::f64::consts::PI * self.set.step() / self.set.contact_time();
        Honesty { engine: "event-driven, and velocity-verlet beside it".into(), stability_number: Some(stability), ..hard }
    }

    fn tables(&self) -> Vec<Table> {
        let row = |(replica, pair): (usize, &Pair)| {
            let parted = self.parted(pair).unwrap_or(f64::NAN);
            vec![
                replica as f64,
                parted,
                parted * self.set.rate(),
                pair.soft_temperature(),
                pair.hard.counts().collisions as f64,
                pair.soft.steps() as f64,
            ]
        };
        vec![Table {
            name: "agreement".into(),
            columns: ["replica", "agreed_until", "collisions_of_a_disc", "temperature_time_driven", "events", "steps"]
                .map(String::from)
                .to_vec(),
            rows: self.pairs.members.iter().enumerate().map(row).collect(),
        }]
    }

    fn moments(&self) -> Vec<f64> {
        let free = 1.0 / self.set.rate();
        vec![free, 5.0 * free, 8.0 * free]
    }

    fn next_event(&self) -> Option<f64> {
        peek::next_contact(&self.pairs.members[0].hard, 1.5 * self.duration)
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("one engine: here two are compared from one start, which a hand would change")
    }
}
