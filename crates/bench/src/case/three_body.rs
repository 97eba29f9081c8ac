//! The figure-eight of three equal masses, to rounding.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_experiments::{Parameter, Settings};
use corpuscle_observe::Drift;
use corpuscle_time::{Gravity, Integrator, TimeDriven};

use crate::threads::in_pool;
use crate::{Case, Clock, Figure, SECONDS, THREADS, Trouble};

pub(crate) static CASE: Case = Case {
    name: "three-body",
    summary: "The figure-eight of three masses by Gauss-Radau of order 15: seconds per 1000 periods, at the error of rounding.",
    parameters: &[
        Parameter { help: "Threads there are; three bodies are too few to share, and one of them does the work.", ..THREADS },
        SECONDS,
    ],
    run: |settings| in_pool(settings, || run(settings)),
};

/// Period of the orbit (Chenciner and Montgomery 2000, doi:10.2307/2661357; numbers by Simo).
const PERIOD: f64 = 6.325_913_98;
/// Periods between two looks at the clock.
const GROUP: u64 = 10;

fn run(settings: &Settings) -> Result<Vec<Figure>, Trouble> {
    let (x, v) = (Vector([0.970_004_36, -0.243_087_53]), Vector([-0.932_407_37, -0.864_731_46]));
    let mut bodies = Particles::<2>::new();
    bodies.push(x, v * -0.5, 1.0, 0.0, 0);
    bodies.push(-x, v * -0.5, 1.0, 0.0, 0);
    bodies.push(Vector::ZERO, v, 1.0, 0.0, 0);
    let start = bodies.clone();
    let space = Boundary::new([-2.0; 2], [2.0; 2], Axis::Open);
    let radau = Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None };
    let mut engine = TimeDriven::new(space, bodies, vec![Box::new(Gravity::new(1.0, 0.0))], radau)?;

    let (mut drift, mut periods, mut distance) = (Drift::<1>::new(), 0, f64::NAN);
    let (mut spent, mut wall) = (0.0, 0.0);
    while spent < settings.real("seconds") {
        drift.see_energy(engine.energy());
        periods += GROUP;
        let clocks = (CASE.clock(settings).start(), Clock::Wall.start());
        engine.advance(periods as f64 * PERIOD, &mut ())?;
        (spent, wall) = (spent + clocks.0.seconds(), wall + clocks.1.seconds());
        if periods == GROUP {
            let pairs = engine.particles().position.iter().zip(&start.position);
            distance = pairs.map(|(r, r0)| (*r - *r0).norm()).fold(0.0, f64::max);
        }
    }
    drift.see_energy(engine.energy());
    Ok(vec![
        Figure::new("seconds_per_1000_periods", 1000.0 * spent / periods as f64),
        Figure::new("wall_s_per_1000_periods", 1000.0 * wall / periods as f64),
        Figure::new("steps_per_period", engine.steps() as f64 / periods as f64),
        Figure::new("seconds_measured", spent),
        Figure::new("periods_measured", periods as f64),
        Figure::new("energy_error", drift.largest().unwrap_or(f64::NAN)),
        Figure::new("distance_from_start_after_10_periods", distance),
    ])
}
