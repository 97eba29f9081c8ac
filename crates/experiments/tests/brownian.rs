//! The experiment `brownian` against theory, over seeds.

use corpuscle_experiments::{Settings, find};
use corpuscle_observe::Check;

fn settings(seed: u64, changes: &[(&str, &str)]) -> Settings {
    let mut settings = Settings::new(find("brownian").unwrap().parameters, seed);
    for (key, text) in changes {
        settings.set_text(key, text).unwrap();
    }
    settings
}

/// Runs to the end in `stops` advances.
fn checks(settings: &Settings, stops: u32) -> Vec<Check> {
    let mut simulation = (find("brownian").unwrap().start)(settings).unwrap();
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
    agrees(&[("replicas", "24")]);
}

#[test]
fn spheres_agree_with_theory() {
    agrees(&[("dimension", "3"), ("radius", "1.5"), ("replicas", "24"), ("duration", "40")]);
}

#[test]
fn between_walls_the_heavy_particle_has_the_temperature_of_the_bath() {
    for check in checks(&settings(1, &[("boundary", "walls"), ("replicas", "24"), ("duration", "20")]), 1) {
        assert!(check.passed, "{check:?}");
    }
}

#[test]
fn stopping_on_the_way_changes_nothing() {
    let set = settings(3, &[("replicas", "4"), ("duration", "22"), ("particles", "100")]);
    assert_eq!(checks(&set, 1), checks(&set, 97));
}

#[test]
fn threads_change_nothing() {
    let set = settings(3, &[("replicas", "6"), ("duration", "6"), ("particles", "100")]);
    let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| checks(&set, 3));
    assert_eq!(on(1), on(2));
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    for (changes, key) in [
        (&[("radius", "100")][..], "radius"),
        (&[("particles", "3"), ("packing_fraction", "0.4")][..], "radius"),
        (
            &[
                ("particles", "2000"),
                ("packing_fraction", "0.4"),
                ("radius", "5"),
                ("bath_radius", "0.5"),
                ("boundary", "walls"),
                ("replicas", "1"),
            ][..],
            "replicas",
        ),
    ] {
        let experiment = find("brownian").unwrap();
        let mut settings = Settings::new(experiment.parameters, 1);
        let error = changes
            .iter()
            .try_for_each(|(key, text)| settings.set_text(key, text))
            .and_then(|()| (experiment.start)(&settings).map(|_| ()))
            .unwrap_err();
        assert_eq!(error.key, key, "{error}");
    }
}
