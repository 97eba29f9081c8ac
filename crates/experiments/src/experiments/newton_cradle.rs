//! Newton's cradle: pendulums side by side, whose balls just touch at rest.
//!
//! Small swings: each ball's displacement obeys `x'' = -omega^2 x`, so between contacts `x = A cos omega t + B sin omega t`,
//! and so does the gap between neighbours: the next contact is the root of a sine, exact without any time step. Contacts are
//! Newton's, `v_1' - v_2' = -e (v_1 - v_2)` with conserved momentum.
//!
//! What must come out. Equal masses, `e = 1`: velocities are exchanged, `k` balls in, `k` balls out. A row of masses: the last ball
//! leaves with `v_n = v_1 prod (1 + e) m_i/(m_i + m_(i+1))`, since each contact is a two-body problem; between a heavy and a light
//! ball one of mass `sqrt(m_1 m_3)` passes on the most (Huygens; Kerwin 1972, doi:10.1119/1.1986800). With `e < 1`: contacts do not
//! change `sum m v` and a spring to each ball's own place acts on the sum as on one body, so the centre of mass swings on
//! undamped; all else decays. In the end all balls swing together with the share `k/n` of the energy.

mod row;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis as Faces, Boundary, Failure, Invalid, Particles, Vector};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Schedule};
use corpuscle_scene::{Body, Camera, Colour, Colouring, Line, Scene};

use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation};
use row::Row;

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "newton-cradle",
    title: "Newton's cradle",
    summary: "Balls on strings: as many as fall in on the one side leave on the other. With a little loss they end up swinging \
              all together, as the centre of mass demands.",
    dimensions: &[2],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter { name: "balls", unit: "", help: "Number of balls.", kind: Kind::Whole { default: 5, least: 2, most: 30 } },
    Parameter {
        name: "lifted",
        unit: "",
        help: "Number of balls lifted on the left.",
        kind: Kind::Whole { default: 2, least: 1, most: 29 },
    },
    Parameter {
        name: "masses",
        unit: "",
        help: "Masses of the balls from the left; empty for equal ones of mass 1.",
        kind: Kind::List { default: &[], least: 1e-3, most: 1e3, longest: 30 },
    },
    Parameter {
        name: "restitution",
        unit: "",
        help: "Part of the relative speed that a contact leaves; steel about 0.97.",
        kind: Kind::Real { default: 1.0, least: 0.0, most: 1.0 },
    },
    Parameter {
        name: "gap",
        unit: "",
        help: "Distance between neighbours at rest, in diameters. Theory is for gaps that hardly matter.",
        kind: Kind::Real { default: 1e-6, least: 1e-9, most: 0.5 },
    },
    Parameter {
        name: "amplitude",
        unit: "",
        help: "How far the lifted balls are drawn aside, in diameters; strings are ten long.",
        kind: Kind::Real { default: 3.0, least: 0.1, most: 5.0 },
    },
    Parameter {
        name: "duration",
        unit: "T",
        help: "How long is watched, in periods of a pendulum.",
        kind: Kind::Real { default: 6.0, least: 1.0, most: 1e4 },
    },
];

/// Samples a period.
const RESOLUTION: f64 = 100.0;
/// Length of a string, in diameters.
const STRING: f64 = 10.0;
/// Energy of the relative motion over that of the start below which the balls count as swinging together.
const TOGETHER: f64 = 1e-6;

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Cradle::new(settings)?))
}

/// One sample of the row.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Sample {
    time: f64,
    places: Vec<f64>,
    energy: f64,
    /// Energy of the centre of mass, were all mass there.
    centre: f64,
}

/// The running experiment. Times are in periods, lengths in diameters.
struct Cradle {
    row: Row,
    lifted: usize,
    gap: f64,
    amplitude: f64,
    duration: f64,
    schedule: Schedule,
    samples: Vec<Sample>,
    /// A copy that a hand plays with, while the measured row swings on.
    in_hand: Option<Row>,
}

resume!(Cradle { values: [schedule, samples], parts: [row], set_up: [lifted, gap, amplitude, duration, in_hand] });

impl Cradle {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let given = settings.list("masses");
        let balls = if given.is_empty() { settings.whole("balls") } else { given.len() };
        if balls < 2 || (settings.is_given("balls") && balls != settings.whole("balls")) {
            return Err(settings.invalid("masses", "as many masses as balls, two at least"));
        }
        let masses = if given.is_empty() { vec![1.0; balls] } else { given.to_vec() };
        let lifted = settings.whole("lifted");
        if lifted >= balls {
            return Err(settings.invalid("lifted", format!("fewer than the {balls} balls")));
        }
        let (gap, amplitude) = (settings.real("gap"), settings.real("amplitude"));
        let displacements = (0..balls).map(|i| if i < lifted { -amplitude } else { 0.0 }).collect();
        let row = Row::new(masses, displacements, gap, settings.real("restitution"));
        let mut cradle = Self {
            row,
            lifted,
            gap,
            amplitude,
            duration: settings.real("duration"),
            schedule: Schedule::new(1.0 / RESOLUTION).after_start(),
            samples: vec![],
            in_hand: None,
        };
        cradle.take_sample();
        Ok(cradle)
    }

    fn take_sample(&mut self) {
        self.samples.push(Sample {
            time: self.row.time(),
            places: self.row.places(),
            energy: self.row.energy(),
            centre: self.row.centre_energy(),
        });
    }

    /// The row that is drawn.
    fn on_show(&self) -> &Row {
        self.in_hand.as_ref().unwrap_or(&self.row)
    }

    fn equal(&self) -> bool {
        self.row.masses().iter().all(|&mass| mass == self.row.masses()[0])
    }

    /// Amplitude of each ball once all swing together: that of the centre of mass at the start.
    fn common_amplitude(&self) -> f64 {
        let masses = self.row.masses();
        self.amplitude * masses[..self.lifted].iter().sum::<f64>() / masses.iter().sum::<f64>()
    }

    /// Speed of the last ball after the first round, over that of the ball let go: each contact a two-body problem.
    fn passed_on(&self) -> f64 {
        let e = self.row.restitution();
        self.row.masses().windows(2).map(|m| (1.0 + e) * m[0] / (m[0] + m[1])).product()
    }

    fn path_chart(&self) -> Chart {
        let mut chart = Chart::new(
            "paths",
            "Where the balls are",
            Axis::linear("time t", "T"),
            Axis::linear("place (a diameter between neighbours)", ""),
        );
        for ball in 0..self.row.masses().len() {
            let path = self.samples.iter().map(|sample| (sample.time, sample.places[ball] + ball as f64));
            chart = chart.with(Series::new(format!("ball {}", ball + 1), Style::Line, path));
        }
        chart.noting("As many balls leave as come in. What the middle ones do is over in an instant.")
    }

    fn energy_chart(&self) -> Chart {
        let start = self.samples[0].energy;
        let end = self.row.time().max(1e-9);
        let share = self.samples[0].centre / start;
        Chart::new("energy", "Energy", Axis::linear("time t", "T"), Axis::linear("E / E₀", ""))
            .with(Series::theory("the centre of mass's, for ever", 0.0, end, 2, Scale::Linear, |_| share))
            .with(Series::new("centre of mass", Style::Line, self.samples.iter().map(|s| (s.time, s.centre / start))))
            .with(Series::new("all", Style::Line, self.samples.iter().map(|s| (s.time, s.energy / start))))
            .noting("Contacts between balls cannot touch the centre of mass: its share of the energy remains, all else may go.")
    }
}

impl Simulation for Cradle {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.row.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            self.row.advance(time)?;
            self.take_sample();
        }
        self.row.advance(to)?;
        self.in_hand.as_mut().map_or(Ok(()), |row| row.advance(to))
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let row = self.on_show();
        let places = row.places();
        let speeds = row.velocities();
        let masses = row.masses();
        let most = self.amplitude * std::f64::consts::TAU;
        let largest = masses.iter().copied().fold(0.0, f64::max);
        scene.time = self.row.time();
        for (i, (&x, &v)) in places.iter().zip(&speeds).enumerate() {
            let hook = i as f64 * (1.0 + self.gap);
            // Drawn on its circle; the dynamics is that of small swings.
            let drop = (STRING * STRING - x * x).max(0.0).sqrt();
            let place = [hook + x, -drop, 0.0];
            let radius = 0.5 * libm::cbrt(masses[i] / largest);
            scene.bodies.push(Body { position: place, velocity: [0.0; 3], time: scene.time, radius, shade: v.abs() });
            scene.lines.push(Line { from: [hook, 0.0, 0.0], to: place, width: 1.5, colour: Colour::Faint });
        }
        let last = (places.len() - 1) as f64 * (1.0 + self.gap);
        scene.lines.push(Line { from: [-1.0, 0.0, 0.0], to: [last + 1.0, 0.0, 0.0], width: 3.0, colour: Colour::Wall });
        let reach = self.amplitude + 1.0;
        scene.camera = Camera::fit([-reach, -STRING - 1.0, 0.0], [last + reach, 0.5, 0.0]);
        scene.colouring = Colouring::Value { name: "speed".into(), unit: String::new(), least: 0.0, most };
        scene.title = EXPERIMENT.title.into();
        scene.caption = format!("{} contacts   energy {:.1} %", row.contacts(), 100.0 * row.energy() / self.samples[0].energy);
    }

    fn frame(&self) -> Option<Frame> {
        let (places, velocities, masses) = (self.row.places(), self.row.velocities(), self.row.masses());
        let mut balls = Particles::<2>::new();
        for (i, (&place, &velocity)) in places.iter().zip(&velocities).enumerate() {
            balls.push(Vector([i as f64 * (1.0 + self.gap) + place, 0.0]), Vector([velocity, 0.0]), masses[i], 0.5, 0);
        }
        let (reach, last) = (self.amplitude + 1.0, (places.len() - 1) as f64 * (1.0 + self.gap));
        let space = Boundary::new([-reach, -1.0], [last + reach, 1.0], Faces::Open);
        Some(Frame::new(self.row.time(), &space, &balls, &["balls".into()]))
    }

    fn charts(&self) -> Vec<Chart> {
        vec![self.path_chart(), self.energy_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let last = self.samples.last().filter(|_| self.samples.len() > 1);
        // Gaps delay each contact by gap/speed, so that the balls of a group part by some of that: to first order in the gap.
        let n = self.row.masses().len() as f64;
        let slack = 10.0 * n * self.gap + 1e-10;
        let e = self.row.restitution();
        if self.row.time() >= 0.5 && self.equal() && e == 1.0 && self.gap < 1e-3 {
            let half = &self.samples[(0.5 * RESOLUTION) as usize];
            let balls = half.places.len();
            let error = (0..balls)
                .map(|i| (half.places[i] - if i + self.lifted >= balls { self.amplitude } else { 0.0 }).abs())
                .fold(0.0, f64::max);
            let reference = "equal masses exchange velocities: as many balls out as came in, at half a period";
            checks.push(Check::at_most("distance from the mirror image of the start", error / self.amplitude, slack, reference));
        }
        if self.row.time() >= 0.5 && self.lifted == 1 && self.gap < 1e-3 && self.row.last_speed() > 0.0 {
            let passed = self.row.last_speed() / (self.amplitude * std::f64::consts::TAU);
            let expected = self.passed_on();
            let reference = format!("prod (1 + e) m_i/(m_i + m_(i+1)) = {expected:.6}: each contact a two-body problem");
            checks.push(Check::at_most(
                "first speed of the last ball: relative error",
                (passed / expected - 1.0).abs(),
                slack,
                reference,
            ));
        }
        if let Some(sample) = last {
            let centre = (sample.centre / self.samples[0].centre - 1.0).abs();
            let reference = "contacts do not change the momentum of all: rounding";
            checks.push(Check::at_most("energy of the centre of mass: relative error", centre, 1e-11, reference));
            let relative = (sample.energy - sample.centre) / self.samples[0].energy;
            if e < 1.0 && relative < TOGETHER {
                let share =
                    (sample.energy / self.samples[0].energy / (self.samples[0].centre / self.samples[0].energy) - 1.0).abs();
                let reference =
                    format!("all swing together with the amplitude {:.4} of the centre of mass", self.common_amplitude());
                checks.push(Check::at_most(
                    "energy that is left over the centre of mass's, less 1",
                    share,
                    TOGETHER * n,
                    reference,
                ));
            }
        }
        if let Some(drift) = self.honesty().energy_drift {
            checks.push(Check::at_most("relative energy drift", drift, 1e-11, "elastic contacts, double precision"));
        }
        checks
    }

    fn honesty(&self) -> Honesty {
        let drift = (self.row.energy() / self.samples[0].energy - 1.0).abs();
        Honesty {
            engine: "event-driven".into(),
            work: self.row.contacts(),
            work_unit: "collisions",
            energy_drift: (self.row.restitution() == 1.0).then_some(drift),
            largest_overlap: Some(self.row.overlap()),
            ..Honesty::default()
        }
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.24, 0.4]
    }

    fn next_event(&self) -> Option<f64> {
        self.on_show().next_contact().filter(|&time| time <= 1.5 * self.duration)
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        let known = matches!(action, Action::Reverse | Action::Place { .. } | Action::Throw { .. });
        (!known).then_some("a gas in a box: these balls hang in a row")
    }

    /// A ball goes as far as its neighbours let it, and keeps to its line.
    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        action.allowed(self)?;
        let mut row = self.on_show().clone();
        match action {
            Action::Place { body, at } => row.place(body, at[0] - body as f64 * (1.0 + self.gap))?,
            Action::Throw { body, velocity } => row.throw(body, velocity[0])?,
            _ => row.reverse(),
        }
        self.in_hand = Some(row);
        Ok(())
    }
}
