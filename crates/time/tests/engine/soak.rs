//! A long run: what a thousand periods hide, a hundred thousand show. `make soak` runs it.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_observe::fit::power_law;
use corpuscle_time::{Gravity, Integrator, TimeDriven};
use rayon::prelude::*;

const PERIOD: f64 = 6.325_913_98;
const PERIODS: u32 = 100_000;
/// Periods between two looks at the energy.
const LOOK: u32 = 100;
/// Starts: the same orbit, turned.
const DIRECTIONS: u32 = 8;

/// The figure-eight (Chenciner and Montgomery 2000, doi:10.2307/2661357), turned by an angle.
fn figure_eight(angle: f64) -> TimeDriven<2> {
    let (sine, cosine) = angle.sin_cos();
    let turn = |x: f64, y: f64| Vector([cosine * x - sine * y, sine * x + cosine * y]);
    let (r, v) = (turn(0.970_004_36, -0.243_087_53), turn(-0.932_407_37, -0.864_731_46));
    let mut bodies = Particles::new();
    bodies.push(r, v * -0.5, 1.0, 0.0, 0);
    bodies.push(-r, v * -0.5, 1.0, 0.0, 0);
    bodies.push(Vector::ZERO, v, 1.0, 0.0, 0);
    let space = Boundary::new([-5.0; 2], [5.0; 2], Axis::Open);
    let radau = Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None };
    TimeDriven::new(space, bodies, vec![Box::new(Gravity::new(1.0, 0.0))], radau).expect("a valid system")
}

/// Relative energy errors of one start, look by look; says how far it is.
fn errors(direction: u32) -> Vec<f64> {
    let angle = 0.7 * f64::from(direction);
    let mut engine = figure_eight(angle);
    let energy = engine.energy();
    let (mut errors, mut worst) = (vec![0.0], 0.0f64);
    for look in 1..=PERIODS / LOOK {
        engine.advance(f64::from(look * LOOK) * PERIOD, &mut ()).expect("a smooth orbit");
        let error = engine.energy() / energy - 1.0;
        worst = worst.max(error.abs());
        errors.push(error);
        if [1, 10, 100, 1000].contains(&look) {
            println!("{angle:.1}: {} periods, {} steps, worst energy error {worst:.1e}", look * LOOK, engine.steps());
        }
    }
    errors
}

/// Mean squares of what is added to the error in `2^k` looks, for each `k`, over all starts, and how many there are.
fn growth(starts: &[&[f64]]) -> Vec<(f64, f64, f64)> {
    let looks = (PERIODS / LOOK) as usize;
    // Shorter times than 400 periods show the rounding of the energy that is looked at.
    let times = (2..).map(|k| 1usize << k).take_while(|time| 8 * time <= looks);
    times
        .map(|time| {
            let squares = starts.iter().flat_map(|errors| {
                let ends = errors.iter().step_by(time);
                ends.clone().zip(ends.skip(1)).map(|(from, to)| (to - from) * (to - from)).collect::<Vec<_>>()
            });
            let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
            (time as f64 * f64::from(LOOK), sum / count, count)
        })
        .collect()
}

/// The exponent `p` of `error ~ t^p`: half of that of mean squares, a mean of `n` of which has the relative standard error `sqrt(2/n)`.
fn exponent(starts: &[&[f64]]) -> f64 {
    let points: Vec<_> = growth(starts).into_iter().map(|(time, square, n)| (time, square, square * (2.0 / n).sqrt())).collect();
    0.5 * power_law(&points).expect("points of different times").slope.mean
}

/// Over `10^5` periods, 26 million steps, the energy error of Gauss-Radau grows like the square root of time (Rein and Spiegel 2015,
/// doi:10.1093/mnras/stu2164). The exponent is fitted to increments of all starts, its standard error found by leaving out one start at
/// a time; and every start stays within six standard deviations of a walk of `1.6e-2` units of the last digit a step, the spread seen
/// over 3200 periods. A bias of `2e-20` a step would be 28 of them, and an exponent near 1.
#[test]
#[ignore = "minutes: `make soak`"]
fn energy_walks_at_random_for_a_hundred_thousand_periods() {
    let all: Vec<Vec<f64>> = (0..DIRECTIONS).into_par_iter().map(errors).collect();
    let starts: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
    for (time, square, count) in growth(&starts) {
        println!("{time} periods: rms {:.2e} of {count}", square.sqrt());
    }
    let fitted = exponent(&starts);
    let without: Vec<f64> = (0..starts.len())
        .map(|left_out| {
            let rest: Vec<&[f64]> = starts.iter().enumerate().filter(|(i, _)| *i != left_out).map(|(_, start)| *start).collect();
            exponent(&rest)
        })
        .collect();
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let error = (without.iter().map(|p| (p - mean) * (p - mean)).sum::<f64>() * (n - 1.0) / n).sqrt();
    let z = (fitted - 0.5) / error;
    println!("exponent {fitted:.3} +- {error:.3}, z = {z:.2}");
    // 258 to 260 steps a period in every direction.
    let steps = f64::from(PERIODS) * 260.0;
    let walk = 1.6e-2 * f64::EPSILON * steps.sqrt();
    for errors in &all {
        let worst = errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
        // Looking at the energy rounds it, too.
        assert!(worst < 6.0 * walk + 8.0 * f64::EPSILON, "{worst:e}");
    }
    assert!(error < 0.1, "too uncertain: {fitted} +- {error}");
    // Student's t with 7 degrees of freedom: |t| > 5.4 has probability 0.001.
    assert!(z.abs() < 5.4, "exponent {fitted} +- {error}");
}
