//! The ideal gas: its checks over many seeds, and that callers and threads leave no trace.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

mod common;

use std::collections::BTreeMap;

use corpuscle_experiments::{Settings, Simulation, find};
use corpuscle_observe::distribution::normal_score_of_chi_squared;
use corpuscle_observe::{Check, Estimate, Style};

/// A fraction of the default's size, so that ten seeds take seconds.
const SMALL: [(&str, &str); 4] = [("points", "3"), ("replicas", "6"), ("duration", "20"), ("particles", "100")];

fn start(seed: u64, values: &[(&str, &str)]) -> Box<dyn Simulation> {
    common::start("ideal-gas", seed, values).unwrap()
}

fn run(seed: u64, values: &[(&str, &str)]) -> Box<dyn Simulation> {
    common::run("ideal-gas", seed, values, 1)
}

/// Over ten seeds the scores of every check are standard normal deviates: the mean is zero, the squares are neither too large
/// nor, as with wrong error bars, too small. Checks of one run share data, so that all of them together are judged by the
/// scatter between seeds.
fn scores_are_standard_normal(dimension: &str) {
    let values = [&SMALL[..], &[("dimension", dimension)]].concat();
    let mut scores: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let mut squares = vec![];
    for seed in 1..=10 {
        let checks = run(seed, &values).checks();
        assert_eq!(checks.len(), if dimension == "2" { 18 } else { 19 });
        for check in &checks {
            assert!(check.passed, "seed {seed}: {check:?}");
        }
        let of_run: Vec<(String, f64)> = checks.into_iter().filter_map(|check| Some((check.quantity, check.z?))).collect();
        squares.push(of_run.iter().map(|(_, z)| z * z).sum::<f64>() / of_run.len() as f64);
        for (quantity, z) in of_run {
            scores.entry(quantity).or_default().push(z);
        }
    }
    for (quantity, z) in &scores {
        let n = z.len() as f64;
        let mean = z.iter().sum::<f64>() / n.sqrt();
        let spread = normal_score_of_chi_squared(z.iter().map(|z| z * z).sum(), n);
        println!("{quantity:72} mean {mean:5.2} spread {spread:5.2}");
        assert!(mean.abs() < 4.0 && spread.abs() < 4.0, "{quantity}: {z:?}");
    }
    let together = Estimate::from_replicas(&squares);
    println!("mean square {:.3} +- {:.3}", together.mean, together.standard_error);
    assert!(together.score(1.0).abs() < 4.0, "{together:?}");
}

#[test]
fn scores_of_discs_are_standard_normal() {
    scores_are_standard_normal("2");
}

#[test]
fn scores_of_spheres_are_standard_normal() {
    scores_are_standard_normal("3");
}

/// The other processes, small; few checks a run, so more seeds.
#[test]
fn scores_of_the_other_processes_are_standard_normal() {
    let few = [("particles", "100"), ("replicas", "8"), ("duration", "20")];
    let seeds = [("warm-walls", 16), ("mixture", 12), ("adiabat", 40), ("piston", 16), ("isotherms", 10), ("isobars", 10)];
    for (process, seeds) in seeds {
        common::agrees_over_more_seeds("ideal-gas", &[&few[..], &[("process", process)]].concat(), seeds);
        for check in common::run("ideal-gas", 1, &[&few[..], &[("process", process), ("dimension", "3")]].concat(), 1).checks() {
            assert!(check.passed, "{process}: {check:?}");
        }
    }
}

#[test]
fn the_other_processes_repeat() {
    for process in ["warm-walls", "mixture", "adiabat", "piston", "isotherms", "isobars"] {
        let values = [("process", process), ("particles", "40"), ("replicas", "4"), ("duration", "5")];
        let (whole, stopped) = (run(3, &values), common::run("ideal-gas", 3, &values, 29));
        assert_eq!(whole.checks(), stopped.checks(), "{process}");
        assert_eq!(format!("{:?}", whole.charts()), format!("{:?}", stopped.charts()), "{process}");
        assert_eq!(whole.checks(), common::checks_on(1, "ideal-gas", 3, &values), "{process}");
        assert!(!whole.checks().is_empty(), "{process}");
    }
}

/// Other masses, radii and temperatures only change the units.
#[test]
fn units_do_not_matter() {
    let plain = run(7, &SMALL).checks();
    let scaled = run(7, &[&SMALL[..], &[("mass", "4"), ("radius", "2"), ("temperature", "16")]].concat()).checks();
    // Powers of two scale every number of the run exactly.
    let scores = |checks: &[Check]| checks.iter().map(|check| check.z).collect::<Vec<_>>();
    assert_eq!(scores(&plain).len(), scores(&scaled).len());
    for (a, b) in plain.iter().zip(&scaled) {
        assert!(a.z.zip(b.z).is_none_or(|(a, b)| (a - b).abs() < 1e-6), "{a:?} {b:?}");
    }
}

#[test]
fn stops_and_threads_leave_no_trace() {
    let short = [&SMALL[..], &[("duration", "5"), ("replicas", "3")]].concat();
    let whole = run(3, &short);
    let mut steps = start(3, &short);
    for k in 1..=97 {
        steps.advance(steps.end() * f64::from(k) / 97.0).unwrap();
        steps.charts();
        steps.checks();
    }
    assert_eq!(whole.checks(), steps.checks());
    assert_eq!(whole.tables(), steps.tables());
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(whole.checks(), pool.install(|| run(3, &short)).checks());
    }
    assert_ne!(whole.checks(), run(4, &short).checks());
}

#[test]
fn nonsense_is_refused_by_name() {
    for (key, text) in [
        ("particles", "0"),
        ("packing_fraction", "0.3"),
        ("packing_fraction", "NaN"),
        ("radius", "-1"),
        ("temperature", "0"),
        ("dense_packings", "0.1,0.9"),
        ("dimension", "4"),
        ("span", "1"),
    ] {
        let error = Settings::new(find("ideal-gas").unwrap().parameters, 1).set_text(key, text).unwrap_err();
        assert_eq!((error.key.as_str(), error.value.as_str()), (key, text));
    }
    assert_eq!(common::refused("ideal-gas", &[("process", "adiabat"), ("speeds", "1,0.5")]), "speeds");
    assert_eq!(common::refused("ideal-gas", &[("process", "isotherms"), ("temperatures", "2,1")]), "temperatures");
    assert_eq!(common::refused("ideal-gas", &[("process", "isotherms"), ("dense_packings", "")]), "dense_packings");
}

#[test]
fn before_there_is_data_nothing_is_claimed() {
    let mut simulation = start(1, &SMALL);
    assert!(simulation.checks().is_empty());
    simulation.advance(0.3 * simulation.end()).unwrap();
    for chart in simulation.charts() {
        assert!(chart.series.iter().any(|series| series.style == Style::Theory), "{}", chart.name);
        for series in &chart.series {
            assert!(series.y.iter().all(|y| y.is_finite()), "{} {}", chart.name, series.name);
        }
    }
    let honesty = simulation.honesty();
    assert!(honesty.energy_drift.unwrap() < 1e-12 && honesty.largest_overlap.unwrap() < 1e-10);
}
