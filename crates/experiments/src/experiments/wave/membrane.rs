//! Waves on a membrane: two sources, slits, and a source that moves.
//!
//! A square lattice of masses and springs under tension, `m u'' = kappa (sum of the four neighbours' u - 4 u)`; each mass
//! moves across the membrane only, so that one number says where it is. Its edges swallow what reaches them.

mod doppler;
mod parts;
mod screen;
mod theory;

use std::f64::consts::{PI, TAU};

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis, Boundary, Engine, Failure, Invalid, Particles, Vector};
use corpuscle_observe::{Chart, Check};
use corpuscle_scene::{Camera, Cell, Colour, Colouring, Line, Map, Scene};
use corpuscle_time::{Force, Integrator, Pin, Spring, Springs, TimeDriven};

use super::sponge::Sponge;
use crate::{Action, Frame, Honesty, Settings, Simulation};
use parts::Sources;

/// Masses along and across.
const COLUMNS: usize = 250;
const ROWS: usize = 170;
/// Width of the sponge, and its greatest rate over `omega_0`: `exp(-rate W/3)` comes back, 0.4 per cent.
const SPONGE: usize = 28;
const RATE: f64 = 0.6;
/// Columns of the barrier, of the sources and of the screen.
const BARRIER: usize = 80;
const SCREEN: usize = COLUMNS - SPONGE - 8;
/// Periods over which the amplitude on the screen is taken.
const PERIODS: u64 = 4;

/// What is on the membrane.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Subject {
    /// Two sources, so many rows apart.
    TwoSources(usize),
    /// A wall with two slits: distance of their middles, and width.
    DoubleSlit(usize, usize),
    /// A wall with one slit of this width.
    SingleSlit(usize),
    /// A source that moves at this share of the speed of long waves.
    Moving(f64),
}

/// The running experiment.
pub(super) struct Membrane {
    subject: Subject,
    engine: TimeDriven<1>,
    omega_0: f64,
    spacing: f64,
    angular_frequency: f64,
    dt: f64,
    /// Steps after which all that is measured has arrived, and those of the whole run.
    settled: u64,
    last: u64,
    /// Sums of `u cos(omega t)` and `u sin(omega t)` for each mass on the screen.
    lock: Vec<(f64, f64)>,
    /// Displacement ahead of and behind a moving source.
    heard: [Vec<f64>; 2],
    /// Greatest displacement that a picture was drawn for.
    largest: f64,
    steps: u64,
    time: f64,
}

resume!(Membrane {
    values: [lock, heard, largest, steps, time],
    parts: [engine],
    set_up: [subject, omega_0, spacing, angular_frequency, dt, settled, last],
});

/// Place of a mass in the list.
const fn index(row: usize, column: usize) -> usize {
    row * COLUMNS + column
}

impl Membrane {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (stiffness, mass, spacing) = (settings.real("stiffness"), settings.real("mass"), settings.real("spacing"));
        let omega_0 = (stiffness / mass).sqrt();
        let wavelength = settings.real("wavelength");
        let (separation, width) = (settings.whole("slit_separation"), settings.whole("slit_width"));
        let subject = match settings.word("preset") {
            "two-sources" => Subject::TwoSources(separation),
            "double-slit" => Subject::DoubleSlit(separation, width),
            "single-slit" => Subject::SingleSlit(width),
            _ => Subject::Moving(settings.real("source_speed")),
        };
        let free = ROWS - 2 * SPONGE;
        let fits = match subject {
            Subject::TwoSources(separation) => separation <= free,
            Subject::DoubleSlit(separation, width) => width < separation && separation <= free,
            Subject::SingleSlit(width) => width <= free,
            Subject::Moving(_) => true,
        };
        if !fits {
            return Err(
                settings.invalid("slit_width", format!("slits that fit between the sponges, {free} masses, and do not meet"))
            );
        }
        // A whole number of steps to a period, and exactly this wavelength along the axes.
        let frequency = 2.0 * omega_0 * libm::sin(PI / wavelength);
        let steps = (TAU / frequency / (0.35 / omega_0)).ceil();
        let (mut dt, mut angular_frequency) = (TAU / frequency / steps, frequency);
        for _ in 0..20 {
            angular_frequency = super::theory::verlet_frequency(frequency, dt);
            dt = TAU / angular_frequency / steps;
        }
        let middle = ROWS / 2;
        let apart = |by: usize| [middle - by / 2, middle - by / 2 + by];
        let places: Vec<(usize, f64)> = match subject {
            Subject::TwoSources(by) => apart(by).map(|row| (row, BARRIER as f64)).to_vec(),
            Subject::Moving(_) => vec![(middle, (SPONGE + 12) as f64)],
            _ => (0..ROWS).map(|row| (row, (SPONGE + 4) as f64)).collect(),
        };
        let speed = if let Subject::Moving(share) = subject { share * omega_0 } else { 0.0 };
        let amplitude = settings.real("amplitude") * omega_0 * omega_0;
        let sources = Sources { places, speed, angular_frequency, amplitude, columns: COLUMNS };
        let engine = Self::build(subject, stiffness, mass, omega_0, dt, sources)?;
        let period = steps as u64;
        let travel = |masses: f64| (masses / (omega_0 * dt)) as u64;
        #[allow(clippy::single_match_else, reason = "one arm for each kind of measurement")]
        let (settled, last) = match subject {
            Subject::Moving(share) => {
                let way = (COLUMNS - 2 * SPONGE - 40) as f64 / share.max(0.3);
                (4 * period, travel(way))
            }
            _ => {
                let settled = travel(1.25 * (COLUMNS - SPONGE) as f64) + 6 * period;
                (settled, settled + PERIODS * period)
            }
        };
        Ok(Self {
            subject,
            engine,
            omega_0,
            spacing,
            angular_frequency,
            dt,
            settled,
            last,
            lock: vec![(0.0, 0.0); ROWS],
            heard: [vec![], vec![]],
            largest: 0.0,
            steps: 0,
            time: 0.0,
        })
    }

    fn build(
        subject: Subject,
        stiffness: f64,
        mass: f64,
        omega_0: f64,
        dt: f64,
        sources: Sources,
    ) -> Result<TimeDriven<1>, Invalid> {
        let mut particles = Particles::<1>::new();
        for _ in 0..ROWS * COLUMNS {
            particles.push(Vector([0.0]), Vector([0.0]), mass, 0.0, 0);
        }
        let along = (0..ROWS).flat_map(|row| (1..COLUMNS).map(move |column| (index(row, column - 1), index(row, column))));
        let across = (1..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (index(row - 1, column), index(row, column))));
        let springs = along.chain(across).map(|(i, j)| Spring::new(i, j, stiffness, 0.0)).collect();
        let slits = matches!(subject, Subject::DoubleSlit(..) | Subject::SingleSlit(_));
        let rate = |row: usize, column: usize| {
            let depth = |place: usize, count: usize| SPONGE.saturating_sub(place.min(count - 1 - place)) as f64 / SPONGE as f64;
            // In front of a wall a plane wave runs along free edges, which leave it plane.
            let sideways = if slits && column < BARRIER { 0.0 } else { depth(row, ROWS) };
            let depth = depth(column, COLUMNS).max(sideways);
            RATE * omega_0 * depth * depth
        };
        let rates = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column))).map(|(row, column)| rate(row, column));
        let sponge = Sponge { rates: rates.collect() };
        let forces: Vec<Box<dyn Force<1>>> = vec![Box::new(Springs::new(springs)), Box::new(sources), Box::new(sponge)];
        let space = Boundary::new([-1e6], [1e6], Axis::Open);
        let pins = (0..ROWS).filter(|&row| slits && !subject.is_open(row));
        let pins = pins.map(|row| Pin { particle: index(row, BARRIER), axes: [true] }).collect();
        TimeDriven::new(space, particles, forces, Integrator::VelocityVerlet { dt })?.with_pins(pins)
    }

    fn displacement(&self, row: usize, column: usize) -> f64 {
        self.engine.particles().position[index(row, column)][0]
    }

    /// `sin(omega' dt/2)/(omega_0 dt)` of a frequency: the sine of half the phase from mass to mass along an axis.
    fn half_sine(&self, frequency: f64) -> f64 {
        libm::sin(0.5 * frequency * self.dt) / (self.omega_0 * self.dt)
    }

    fn measure(&mut self) {
        if let Subject::Moving(_) = self.subject {
            let row = ROWS / 2;
            let columns = [COLUMNS - SPONGE - 2, SPONGE + 2];
            for (series, column) in self.heard.iter_mut().zip(columns) {
                series.push(self.engine.particles().position[index(row, column)][0]);
            }
        } else if self.steps > self.settled && self.steps <= self.last {
            let (sine, cosine) = libm::sincos(self.angular_frequency * self.steps as f64 * self.dt);
            for row in 0..ROWS {
                let u = self.displacement(row, SCREEN);
                self.lock[row].0 += u * cosine;
                self.lock[row].1 += u * sine;
            }
        }
    }

    /// Amplitude of each mass on the screen.
    fn amplitudes(&self) -> Option<Vec<f64>> {
        (self.steps >= self.last && !matches!(self.subject, Subject::Moving(_))).then(|| {
            let share = 2.0 / (self.last - self.settled) as f64;
            self.lock.iter().map(|(c, s)| share * c.hypot(*s)).collect()
        })
    }

    fn caption(&self) -> String {
        let wavelength = PI / libm::asin(self.half_sine(self.angular_frequency));
        let subject = match self.subject {
            Subject::TwoSources(apart) => format!("two sources {apart} apart"),
            Subject::DoubleSlit(apart, width) => format!("two slits {apart} apart, {width} wide"),
            Subject::SingleSlit(width) => format!("a slit {width} wide"),
            Subject::Moving(share) => format!("a source at {share} of the speed of long waves"),
        };
        format!("{subject}   wavelength {wavelength:.1} spacings   the edges swallow what reaches them")
    }
}

impl Subject {
    /// Whether the wall has a hole in this row.
    fn is_open(self, row: usize) -> bool {
        let (row, middle) = (row as f64, (ROWS / 2) as f64);
        let within = |centre: f64, width: usize| (row - centre).abs() <= 0.5 * (width as f64 - 1.0);
        match self {
            Self::DoubleSlit(apart, width) => {
                let lower = middle - (apart / 2) as f64;
                within(lower, width) || within(lower + apart as f64, width)
            }
            Self::SingleSlit(width) => within(middle, width),
            _ => true,
        }
    }

    /// Places the waves come from: row, column and weight of each point.
    fn origins(self) -> Vec<(f64, f64)> {
        let open =
            |subject: Self| (0..ROWS).filter(move |&row| subject.is_open(row)).map(|row| (row as f64, BARRIER as f64)).collect();
        match self {
            Self::TwoSources(apart) => {
                let lower = (ROWS / 2 - apart / 2) as f64;
                vec![(lower, BARRIER as f64), (lower + apart as f64, BARRIER as f64)]
            }
            Self::Moving(_) => vec![],
            subject => open(subject),
        }
    }
}

impl Simulation for Membrane {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn end(&self) -> f64 {
        self.last as f64 * self.dt
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let target = (to / self.dt * (1.0 + 1e-12)).floor() as u64;
        while self.steps < target {
            self.engine.advance((self.steps + 1) as f64 * self.dt, &mut ())?;
            self.steps += 1;
            self.measure();
            if self.steps.is_multiple_of(8) {
                let all = &self.engine.particles().position;
                self.largest = 0.98 * self.largest.max(1.02 * all.iter().map(|u| u[0].abs()).fold(0.0, f64::max));
            }
        }
        self.time = self.time.max(to);
        Ok(())
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let size = [COLUMNS, ROWS].map(|count| (count - 1) as f64 * self.spacing);
        scene.time = self.steps as f64 * self.dt;
        scene.title = "Waves on a membrane".into();
        scene.caption = self.caption();
        scene.camera = Camera::fit([0.0; 3], [size[0], size[1], 0.0]);
        scene.colouring = Colouring::Species(vec!["up".into(), "down".into()]);
        let most = 0.35 * self.largest.max(f64::MIN_POSITIVE);
        let cell = |u: &Vector<1>| Cell { species: u8::from(u[0] < 0.0), strength: (255.0 * (u[0].abs() / most).min(1.0)) as u8 };
        let half = 0.5 * self.spacing;
        scene.map = Some(Map {
            lower: [-half; 2],
            upper: size.map(|length| length + half),
            columns: COLUMNS,
            cells: self.engine.particles().position.iter().map(cell).collect(),
        });
        let mut line = |from: [f64; 2], to: [f64; 2], width: f32, colour: Colour| {
            let place = |[x, y]: [f64; 2]| [x * self.spacing, y * self.spacing, 0.0];
            scene.lines.push(Line { from: place(from), to: place(to), width, colour });
        };
        for row in (0..ROWS).filter(|&row| !self.subject.is_open(row)) {
            let (x, y) = (BARRIER as f64, row as f64);
            line([x, y - 0.5], [x, y + 0.5], 3.0, Colour::Ink);
        }
        if let Some(amplitudes) = self.amplitudes() {
            // What the screen receives, drawn as a curve in front of it.
            let highest = amplitudes.iter().fold(0.0, |most: f64, &a| most.max(a));
            let place = |row: usize| [SCREEN as f64 + 26.0 * amplitudes[row] / highest, row as f64];
            (1..ROWS).for_each(|row| line(place(row - 1), place(row), 2.0, Colour::Ink));
        }
        if !matches!(self.subject, Subject::Moving(_)) {
            line([SCREEN as f64, 0.0], [SCREEN as f64, (ROWS - 1) as f64], 1.0, Colour::Faint);
        }
    }

    /// All masses in space: at their places on the membrane, as high as they are displaced; those of a wall are held.
    fn frame(&self) -> Option<Frame> {
        let flat = self.engine.particles();
        let mut masses = Particles::<3>::new();
        for (i, (u, v)) in flat.position.iter().zip(&flat.velocity).enumerate() {
            let (row, column) = (i / COLUMNS, i % COLUMNS);
            let place = Vector([column as f64 * self.spacing, row as f64 * self.spacing, u[0]]);
            let wall = column == BARRIER && !self.subject.is_open(row);
            masses.push(place, Vector([0.0, 0.0, v[0]]), flat.mass[i], 0.0, u16::from(wall));
        }
        // The edges are open, and nothing is between one height and another.
        let [width, height] = [COLUMNS, ROWS].map(|count| count as f64 * self.spacing);
        let half = 0.5 * self.spacing;
        let around = Boundary::new([-half, -half, -half], [width - half, height - half, half], Axis::Open);
        Some(Frame::new(self.steps as f64 * self.dt, &around, &masses, &["masses".into(), "wall".into()]))
    }

    fn charts(&self) -> Vec<Chart> {
        match self.subject {
            Subject::Moving(share) => vec![self.chart_of_doppler(share)],
            _ => self.chart_of_screen().into_iter().collect(),
        }
    }

    fn checks(&self) -> Vec<Check> {
        match self.subject {
            Subject::Moving(share) => self.checks_of_doppler(share),
            _ => self.check_of_fringes().into_iter().collect(),
        }
    }

    fn honesty(&self) -> Honesty {
        Honesty {
            engine: "time-driven, velocity-verlet".into(),
            work: self.engine.steps(),
            work_unit: "steps",
            stability_number: Some(8f64.sqrt() * self.omega_0 * self.dt),
            ..Honesty::default()
        }
    }

    fn moments(&self) -> Vec<f64> {
        [0.25, 0.6].map(|share| share * self.end()).to_vec()
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("a chain: the sources of this membrane go on by themselves")
    }
}
