//! The experiment `entropy` against theory, over seeds.

use corpuscle_experiments::{Settings, find};
use corpuscle_observe::Check;

fn settings(seed: u64, changes: &[(&str, &str)]) -> Settings {
    let mut settings = Settings::new(find("entropy").unwrap().parameters, seed);
    for (key, text) in changes {
        settings.set_text(key, text).unwrap();
    }
    settings
}

/// Runs to the end in `stops` advances.
fn checks(settings: &Settings, stops: u32) -> Vec<Check> {
    let mut simulation = (find("entropy").unwrap().start)(settings).unwrap();
    for stop in 1..=stops {
        simulation.advance(simulation.end() * f64::from(stop) / f64::from(stops)).unwrap();
    }
    simulation.checks()
}

/// All checks pass, and the z values of ten seeds look like standard normal deviates: their sum of squares follows
/// chi^2, which is held to four standard deviations either way, and their mean to four standard errors.
fn agrees(changes: &[(&str, &str)]) {
    let mut scores = vec![];
    for seed in 1..=10 {
        for check in checks(&settings(seed, changes), 1) {
            println!(
                "{seed} {}: {} ± {:?}, expected {}, z {:?}",
                check.quantity, check.measured, check.standard_error, check.expected, check.z
            );
            assert!(check.passed, "seed {seed}: {check:?}");
            scores.extend(check.z);
        }
    }
    let n = scores.len() as f64;
    assert!(n >= 40.0, "only {n} statistical checks in ten runs");
    let mean = scores.iter().sum::<f64>() / n;
    let square = scores.iter().map(|z| z * z).sum::<f64>() / n;
    println!("mean {mean}, mean square {square} of {n}");
    assert!(mean.abs() * n.sqrt() < 4.0, "mean of z {mean}");
    assert!((square - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "mean square of z {square}");
}

#[test]
fn discs_agree_with_theory() {
    agrees(&[]);
}

#[test]
fn spheres_agree_with_theory() {
    agrees(&[("dimension", "3"), ("cells", "4"), ("replicas", "40"), ("duration", "400"), ("reverse_at", "15")]);
}

#[test]
fn stopping_on_the_way_changes_nothing() {
    let set = settings(3, &[("replicas", "4"), ("duration", "200"), ("process", "mixing")]);
    assert_eq!(checks(&set, 1), checks(&set, 97));
}

#[test]
fn threads_change_nothing() {
    let set = settings(3, &[("replicas", "6"), ("duration", "100"), ("reverse_at", "30")]);
    let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| checks(&set, 3));
    assert_eq!(on(1), on(2));
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    for (changes, key) in [
        (&[("cells", "7")][..], "cells"),
        (&[("hole_width", "0.9")][..], "hole_width"),
        (&[("hole_width", "1000")][..], "hole_width"),
        (&[("reverse_at", "900")][..], "reverse_at"),
        (&[("particles", "2"), ("packing_fraction", "0.3")][..], "particles"),
    ] {
        let error = (find("entropy").unwrap().start)(&settings(1, changes)).err().expect("refused");
        assert_eq!(error.key, key, "{error}");
    }
}
