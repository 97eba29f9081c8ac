//! A square membrane of springs, beside the time its memory alone would take.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_experiments::{Kind, Parameter, Settings};
use corpuscle_observe::Drift;
use corpuscle_time::{Integrator, Pin, Spring, Springs, TimeDriven};
use rayon::prelude::*;

use super::steps;
use crate::threads::in_pool;
use crate::{Case, Clock, Figure, SECONDS, THREADS, Trouble};

pub(crate) static CASE: Case = Case {
    name: "membrane",
    summary: "A square membrane of masses and springs, velocity Verlet: milliseconds a step, and the share of them its memory \
              needs.",
    parameters: &[
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of masses: a square.",
            kind: Kind::Whole { default: 1_000_000, least: 9, most: 100_000_000 },
        },
        THREADS,
        SECONDS,
    ],
    run: |settings| in_pool(settings, || run(settings)),
};

/// Length of a step; masses and springs are 1.
const STEP: f64 = 0.1;
/// Bytes a mass and step that have to go through the memory, were each number read or written once: position and velocity in and out,
/// the mass in.
const BYTES: f64 = 104.0;
/// Masses times steps between two looks at the clock. Where an engine stops, the last kick is a pass of its own.
const WORK_OF_GROUP: usize = 128_000_000;
/// The most steps, so that few masses do not take longer than asked for.
const MOST_OF_GROUP: usize = 2000;

/// A mode of a square membrane whose rim is held: `sin(p pi x / L) sin(p pi y / L)`.
struct Mode {
    wave_number: f64,
    frequency: f64,
}

impl Mode {
    /// One of some twenty particles a half wave, so that a measurement sees it move.
    fn new(side: usize) -> Self {
        let length = (side - 1) as f64;
        let number = (length / 20.0).ceil();
        let wave_number = std::f64::consts::PI * number / length;
        // omega^2 is the sum of those of both directions, 4 sin^2(k/2) each.
        Self { wave_number, frequency: 8.0f64.sqrt() * libm::sin(0.5 * wave_number) }
    }

    fn shape(&self, x: usize, y: usize) -> f64 {
        libm::sin(self.wave_number * x as f64) * libm::sin(self.wave_number * y as f64)
    }

    /// Amplitude after so many steps of velocity Verlet from rest, exactly: it turns by `2 asin(omega dt / 2)` a step.
    fn amplitude(&self, steps: u64) -> f64 {
        libm::cos(steps as f64 * 2.0 * libm::asin(0.5 * self.frequency * STEP))
    }
}

/// A stretched membrane in space, its rim held, at rest in a mode across its plane.
fn start(side: usize, mode: &Mode) -> Result<TimeDriven<3>, Trouble> {
    let (mut masses, mut springs, mut rim) = (Particles::new(), vec![], vec![]);
    for i in 0..side * side {
        let (x, y) = (i % side, i / side);
        masses.push(Vector([x as f64, y as f64, mode.shape(x, y)]), Vector::ZERO, 1.0, 0.0, 0);
        if x > 0 {
            springs.push(Spring::new(i - 1, i, 1.0, 0.0));
        }
        if y > 0 {
            springs.push(Spring::new(i - side, i, 1.0, 0.0));
        }
        if x == 0 || y == 0 || x == side - 1 || y == side - 1 {
            rim.push(Pin { particle: i, axes: [true; 3] });
        }
    }
    let space = Boundary::new([0.0; 3], [side as f64; 3], Axis::Open);
    let verlet = Integrator::VelocityVerlet { dt: STEP };
    Ok(TimeDriven::new(space, masses, vec![Box::new(Springs::new(springs))], verlet)?.with_pins(rim)?)
}

fn run(settings: &Settings) -> Result<Vec<Figure>, Trouble> {
    let count = settings.whole("particles");
    let side = count.isqrt();
    if side * side != count {
        let expected = format!("the square of a whole number, such as {} or {}", side * side, (side + 1) * (side + 1));
        return Err(settings.invalid("particles", expected).into());
    }
    let mode = Mode::new(side);
    let mut engine = start(side, &mode)?;
    engine.advance(STEP, &mut ())?;
    let clock = CASE.clock(settings);
    let mut drift = Drift::<1>::new();
    drift.see_energy(engine.energy());
    let group = WORK_OF_GROUP.div_ceil(count).min(MOST_OF_GROUP) as u64;
    let mut memory = Memory::new(3 * count, clock);
    // In turn: both meet the same machine, whatever else it does.
    let taken = steps::take(&mut engine, clock, settings.real("seconds"), group, |_| memory.pass())?;
    drift.see_energy(engine.energy());
    let bandwidth = memory.bytes_per_second();
    let milliseconds = 1e3 / taken.per_second();
    let floor = 1e3 * BYTES * count as f64 / bandwidth;

    let shape = |i: usize| mode.shape(i % side, i / side);
    let height = engine.particles().position.iter().map(|r| r[2]).enumerate();
    let (overlap, norm) = height.fold((0.0, 0.0), |(overlap, norm), (i, z)| (overlap + z * shape(i), norm + shape(i) * shape(i)));
    let mut amplitude = Figure::new("amplitude_of_mode", overlap / norm);
    amplitude.theory = Some(mode.amplitude(engine.steps()));
    let mut figures = vec![
        Figure::new("milliseconds_per_step", milliseconds),
        Figure::new("particle_steps_per_second", count as f64 * taken.per_second()),
        Figure::new("memory_bytes_per_second", bandwidth),
        Figure::new("memory_floor_milliseconds_per_step", floor),
        Figure::new("share_of_memory_floor", floor / milliseconds),
    ];
    figures.extend(taken.figures());
    figures.extend([amplitude, Figure::new("relative_energy_drift", drift.largest().unwrap_or(f64::NAN))]);
    Ok(figures)
}

/// How fast memory is: `a += s b` over arrays of so many numbers, on the threads of this pool.
struct Memory {
    a: Vec<f64>,
    b: Vec<f64>,
    clock: Clock,
    passes: usize,
    seconds: f64,
}

impl Memory {
    /// Passes in a row that are timed.
    const IN_A_ROW: usize = 8;

    fn new(length: usize, clock: Clock) -> Self {
        Self { a: vec![0.0; length], b: vec![1.0; length], clock, passes: 0, seconds: 0.0 }
    }

    /// Goes through the arrays a few times.
    fn pass(&mut self) {
        self.go(); // brings back what the engine drove out of the caches, or the system has yet to give
        let running = self.clock.start();
        for _ in 0..Self::IN_A_ROW {
            self.go();
        }
        self.seconds += running.seconds();
        self.passes += Self::IN_A_ROW;
    }

    fn go(&mut self) {
        let chunk = self.a.len().div_ceil(rayon::current_num_threads());
        self.a.par_chunks_mut(chunk).zip(self.b.par_chunks(chunk)).for_each(|(a, b)| {
            for (a, b) in a.iter_mut().zip(b) {
                *a += 0.5 * b;
            }
        });
    }

    /// In the mean over all passes: read twice, written once.
    fn bytes_per_second(&self) -> f64 {
        24.0 * std::hint::black_box(&self.a).len() as f64 * self.passes as f64 / self.seconds
    }
}
