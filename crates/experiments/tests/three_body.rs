//! The three-body experiment against its theory.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests too

mod common;

use corpuscle_core::Invalid;
use corpuscle_experiments::Simulation;
use corpuscle_observe::Check;

fn start(seed: u64, values: &[(&str, &str)]) -> Result<Box<dyn Simulation>, Invalid> {
    common::start("three-body", seed, values)
}

fn run(seed: u64, values: &[(&str, &str)]) -> Box<dyn Simulation> {
    common::run("three-body", seed, values, 1)
}

fn check<'a>(checks: &'a [Check], words: &str) -> &'a Check {
    checks.iter().find(|check| check.quantity.contains(words)).unwrap_or_else(|| panic!("no check of {words}"))
}

fn assert_all_passed(simulation: &dyn Simulation, count: usize) {
    let checks = simulation.checks();
    for check in &checks {
        println!(
            "{:90} {:12.5e} {:?} {:12.5e} {:?}",
            check.quantity, check.measured, check.standard_error, check.expected, check.z
        );
        assert!(check.passed, "{check:?}");
    }
    assert_eq!(checks.len(), count);
}

#[test]
fn the_default_run_reproduces_the_papers_claim() {
    let simulation = run(1, &[]);
    assert_all_passed(simulation.as_ref(), 16);
    let charts = simulation.charts();
    let separation = &charts[0];
    // Neighbours 0.1 apart, and twins 1e-4 apart, end as far apart as unrelated grains; from the start they grow tenfold and more.
    let ends: Vec<f64> = separation.series.iter().map(|series| *series.y.last().unwrap()).collect();
    let (neighbours, wide, unrelated) = (ends[0], ends[1], ends[3]);
    assert!((separation.series[0].y[0] - 0.1).abs() < 1e-12 && (separation.series[1].y[0] - 1e-4).abs() < 1e-12);
    assert!(neighbours > 0.2 * unrelated && neighbours < 5.0 * unrelated, "{ends:?}");
    assert!(wide > 0.02 * unrelated, "{ends:?}");
}

#[test]
fn the_figure_eight_returns() {
    let simulation = run(1, &[("preset", "figure-eight")]);
    assert_all_passed(simulation.as_ref(), 9);
    assert!(check(&simulation.checks(), "after one period").measured < 1e-6);
}

#[test]
fn the_pythagorean_problem_ends_with_a_binary_and_an_escape() {
    let simulation = run(1, &[("preset", "pythagorean")]);
    assert_all_passed(simulation.as_ref(), 6);
}

#[test]
fn the_triangle_turns_and_breaks_as_routh_says() {
    assert_all_passed(run(1, &[("preset", "lagrange")]).as_ref(), 7);
    for masses in ["1,0.03,0.007", "1,0.037,0.0001", "1,0.5,0.2", "3,4,5"] {
        let simulation = run(1, &[("preset", "lagrange"), ("masses", masses), ("grains", "0"), ("duration", "10")]);
        assert_all_passed(simulation.as_ref(), 6);
    }
}

/// The orders and the triangle start at random places; their verdicts must not depend on which.
#[test]
fn every_seed_passes() {
    let mut scores = vec![];
    for seed in 1..=10 {
        let simulation = run(seed, &[("duration", "0.1"), ("grains", "0")]);
        for check in simulation.checks() {
            assert!(check.passed, "seed {seed}: {check:?}");
            if check.quantity.contains("growth rate") {
                scores.extend(check.z);
            }
        }
    }
    // The rates of growth are statistical: their scores are normal deviates.
    let n = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / n.sqrt();
    let squares = scores.iter().map(|z| z * z).sum::<f64>();
    println!("{scores:?}: mean {mean:.2}, squares {squares:.2} of {n}");
    assert_eq!(scores.len(), 10);
    assert!(mean.abs() < 4.0 && squares > 1.0 && squares < 40.0, "chi-squared of 10 lies outside once in 10^4: {scores:?}");
}

#[test]
fn fixed_steps_keep_their_bounds_and_a_poor_integrator_is_found_out() {
    for integrator in ["symplectic-euler", "velocity-verlet", "runge-kutta-4", "yoshida-4"] {
        let simulation = run(1, &[("preset", "paper"), ("integrator", integrator), ("grains", "2")]);
        for check in simulation.checks().iter().filter(|check| check.quantity.starts_with("relative")) {
            assert!(check.passed, "{integrator}: {check:?}");
        }
    }
    let poor = run(1, &[("preset", "figure-eight"), ("integrator", "explicit-euler")]).checks();
    assert!(!check(&poor, "after one period").passed);
    let good = run(1, &[("preset", "figure-eight"), ("integrator", "runge-kutta-4")]).checks();
    assert!(check(&good, "after one period").passed);
}

#[test]
fn bad_parameters_are_refused_by_name() {
    for (key, text) in [
        ("masses", "1,2"),
        ("masses", "1,-2,3"),
        ("masses", "1,2,0"),
        ("preset", "solar"),
        ("integrator", "magic"),
        ("time_step", "0"),
        ("grain_spacing", "NaN"),
        ("softening", "-1"),
        ("grains", "1001"),
    ] {
        assert_eq!(start(1, &[(key, text)]).err().map(|invalid| invalid.key).as_deref(), Some(key), "{key} = {text}");
    }
    let many = start(1, &[("time_step", "1e-6"), ("duration", "1e6")]);
    assert_eq!(many.err().map(|invalid| invalid.key).as_deref(), Some("time_step"));
}

#[test]
fn neither_stops_nor_threads_leave_a_trace() {
    let values = [("duration", "12")];
    let whole = run(3, &values);
    let mut steps = start(3, &values).unwrap();
    for k in 1..=1000 {
        steps.advance(0.012 * f64::from(k)).unwrap();
    }
    steps.advance(12.0).unwrap();
    assert_eq!((whole.checks(), whole.charts()), (steps.checks(), steps.charts()));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| run(3, &values));
    assert_eq!((whole.checks(), whole.charts()), (one.checks(), one.charts()));
}
