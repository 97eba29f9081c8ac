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
    assert_all_passed(simulation.as_ref(), 17);
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
    assert_all_passed(simulation.as_ref(), 12);
    assert!(check(&simulation.checks(), "after one period").measured < 1e-6);
}

#[test]
fn the_pythagorean_problem_ends_with_a_binary_and_an_escape() {
    let simulation = run(1, &[("preset", "pythagorean")]);
    assert_all_passed(simulation.as_ref(), 7);
}

#[test]
fn the_triangle_turns_and_breaks_as_routh_says() {
    assert_all_passed(run(1, &[("preset", "lagrange")]).as_ref(), 8);
    for masses in ["1,0.03,0.007", "1,0.037,0.0001", "1,0.5,0.2", "3,4,5"] {
        let simulation = run(1, &[("preset", "lagrange"), ("masses", masses), ("grains", "0"), ("duration", "10")]);
        assert_all_passed(simulation.as_ref(), 7);
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

#[test]
fn the_new_starts_return_or_fall_apart_as_they_should() {
    for preset in ["butterfly", "butterfly-2", "moth", "dragonfly", "yin-yang", "goggles", "yarn"] {
        let simulation = run(1, &[("preset", preset)]);
        assert_all_passed(simulation.as_ref(), 5);
    }
    let euler = run(1, &[("preset", "euler"), ("duration", "6")]);
    assert_all_passed(euler.as_ref(), 6);
    assert_all_passed(run(2, &[("preset", "euler"), ("masses", "3,0.5,0.1"), ("duration", "6")]).as_ref(), 6);
    assert_all_passed(run(1, &[("preset", "sun-earth-moon")]).as_ref(), 4);
}

/// Random starts of the restricted problem and of the triangle's and the line's displacements: their scores are normal deviates.
#[test]
fn scores_of_the_restricted_problem_and_of_eulers_line_are_normal() {
    let mut scores = corpuscle_observe::scores::Scores::new();
    for seed in 1..=10 {
        let restricted = run(seed, &[("preset", "restricted"), ("duration", "60")]);
        let line = run(seed, &[("preset", "euler"), ("duration", "0.1"), ("masses", "1,2,0.5")]);
        for check in restricted.checks().into_iter().chain(line.checks()) {
            assert!(check.passed, "seed {seed}: {check:?}");
            check.z.into_iter().for_each(|z| scores.push(z));
        }
    }
    println!("{scores:?}: mean {:.3}, mean square {:.3}", scores.mean(), scores.mean_square());
    assert_eq!(scores.count(), 30);
    assert!(scores.score_of_mean().abs() < 4.0 && scores.score_of_spread().abs() < 4.0, "{scores:?}");
}

/// The map of fates: its shares are those of another integrator's random grains, for every seed; its border is a fractal.
#[test]
fn shares_of_fates_agree_over_seeds() {
    let values = [("show", "basins"), ("resolution", "96"), ("duration", "30")];
    common::agrees_over_more_seeds("three-body", &values, 14);
    let charts = run(1, &values).charts();
    let uncertainty = charts.iter().find(|chart| chart.name == "uncertainty").unwrap();
    let measured = uncertainty.series.last().unwrap();
    let (nearest, farthest) = (measured.y[0], *measured.y.last().unwrap());
    // Of a smooth border a distance eight times smaller would leave an eighth.
    let doublings = measured.y.len() - 1;
    assert!(doublings == 3 && nearest > 1.5 * farthest / 8.0, "{measured:?}");
}

#[test]
fn a_map_has_the_same_bits_whatever_the_threads_and_stops() {
    let values = [("show", "basins"), ("resolution", "61"), ("duration", "8"), ("preset", "pythagorean"), ("map_extent", "3")];
    let drawn = |simulation: &dyn Simulation| {
        let mut scene = corpuscle_scene::Scene::default();
        simulation.draw(&mut scene);
        (scene.map.unwrap(), simulation.checks())
    };
    let whole = run(3, &values);
    assert_eq!(drawn(whole.as_ref()).0.cells.len(), 61 * 61);
    let mut steps = start(3, &values).unwrap();
    for k in 1..=97 {
        steps.advance(8.0 * f64::from(k) / 97.0).unwrap();
    }
    assert_eq!(drawn(whole.as_ref()), drawn(steps.as_ref()));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| run(3, &values));
    assert_eq!(drawn(whole.as_ref()), drawn(one.as_ref()));
}

#[test]
fn the_new_views_refuse_what_makes_no_sense() {
    for (values, key) in [
        (&[("show", "basins"), ("map_centre", "1")][..], "map_centre"),
        (&[("show", "basins"), ("resolution", "5")], "resolution"),
        (&[("preset", "restricted"), ("jacobi_constant", "50")], "jacobi_constant"),
        (&[("preset", "restricted"), ("show", "basins")], "show"),
        (&[("preset", "restricted"), ("masses", "1")], "masses"),
    ] {
        assert_eq!(start(1, values).err().map(|invalid| invalid.key).as_deref(), Some(key), "{values:?}");
    }
}
