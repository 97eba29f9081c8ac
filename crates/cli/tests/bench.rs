//! `corpuscle bench` through the real command, on systems so small and short that only its form can be judged, and the
//! physics that no clock disturbs.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot be set up has failed")]

use std::process::{Command, Output};

use serde_json::Value;

fn bench(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corpuscle")).arg("bench").args(arguments).output().expect("the command starts")
}

fn report(arguments: &[&str]) -> Value {
    let output = bench(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn hard_spheres_report_their_speed_and_their_physics() {
    for (dimension, packing) in [("2", "0.3"), ("3", "0.3")] {
        let arguments = ["hard-spheres", "--dimension", dimension, "--particles", "500", "--packing", packing, "--seconds", "0.2"];
        let report = report(&arguments);
        let number = |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report:#}"));
        assert!(number("collisions_per_second") > 1e3 && number("searches_per_second") > number("collisions_per_second"));
        assert!(number("seconds_measured") >= 0.2);
        assert!((50.0..10_000.0).contains(&number("bytes_per_particle")));
        assert!(number("relative_energy_drift") < 1e-12);
        assert_eq!(report["parameters"]["particles"], 500);
        assert_eq!(report["seed"], 1);
        // The equations of state are good to 0.3 % here, and 500 particles to 1/500 of Z - 1.
        let (z, theory) = (number("compressibility_factor"), number("compressibility_factor_theory"));
        let error = number("compressibility_factor_standard_error");
        assert!((z - theory).abs() < 5.0 * error + 0.005 * theory, "{z} +- {error}, {theory}");
        assert!(error < 0.2 * theory);
    }
}

#[test]
fn a_large_particle_collides_as_often_as_theory_has_it() {
    let report = report(&["brownian", "--dimension", "2", "--particles", "2000", "--radius-ratio", "10", "--seconds", "0.3"]);
    let number = |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report:#}"));
    let (rate, theory) = (number("collisions_of_large_particle_per_time"), number("collisions_of_large_particle_per_time_theory"));
    let error = number("collisions_of_large_particle_per_time_standard_error");
    assert!((rate - theory).abs() < 5.0 * error + 0.03 * theory, "{rate} +- {error}, {theory}");
}

/// The figures of a report, by key.
fn numbers(report: &Value) -> impl Fn(&str) -> f64 + '_ {
    move |key| report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report:#}"))
}

#[test]
fn fluids_report_their_speed_and_their_physics() {
    for (case, particles, start) in [("lennard-jones", "256", 1.44), ("wca", "400", 1.0)] {
        for (threads, clock) in [("1", "processor time of this thread"), ("2", "wall time")] {
            let report = report(&[case, "--particles", particles, "--threads", threads, "--seconds", "0.4"]);
            let number = numbers(&report);
            assert!(number("particle_steps_per_second") > 1e4 && number("steps_measured") >= 10.0);
            if cfg!(unix) {
                assert_eq!(report["clock"], clock);
            }
            // Velocity Verlet at this step: errors of some 1e-4 of the kinetic energy, more in so small a system.
            assert!(number("energy_drift_over_kinetic_energy") < 5e-3 && number("momentum_per_particle") < 1e-12);
            // Of the crystal's kinetic energy a part went into the potential.
            assert!((0.3 * start..start).contains(&number("temperature")), "{report:#}");
            assert!((-2.0..10.0).contains(&number("pressure")), "{report:#}");
        }
    }
}

#[test]
fn gravity_reports_its_errors_against_direct_sums() {
    let direct = report(&["gravity", "--particles", "300", "--seconds", "0.2"]);
    let number = numbers(&direct);
    assert!(number("pairs_per_second") > 1e6 && number("force_error_worst") < 1e-12);
    assert!(number("relative_momentum_drift") < 1e-11 && number("relative_energy_drift") < 1e-3);
    let errors = ["0", "0.4", "0.8"].map(|angle| {
        let report = report(&["tree", "--particles", "2000", "--opening-angle", angle, "--threads", "2", "--seconds", "0.05"]);
        let number = numbers(&report);
        assert!(number("seconds_per_step") > 0.0 && number("force_error_median") <= number("force_error_of_99_in_100_below"));
        number("force_error_median")
    });
    assert!(errors[0] < 1e-13 && errors[0] < 0.1 * errors[1] && errors[1] < 0.3 * errors[2], "{errors:?}");
}

#[test]
fn grains_keep_jacobis_constant() {
    let report = report(&["grains", "--particles", "500", "--seconds", "0.2"]);
    let number = numbers(&report);
    assert!(number("particle_steps_per_second") > 1e5 && number("time_reached") > 0.5);
    // Leapfrog is wrong by the square of its step, 1e-6, times the share of the stars' pulls that changes.
    assert!(number("jacobi_error_over_kinetic_energy_worst") < 1e-5 && number("relative_energy_drift_of_stars") < 1e-9);
}

#[test]
fn the_figure_eight_returns() {
    let report = report(&["three-body", "--seconds", "0.05"]);
    let number = numbers(&report);
    assert!(number("seconds_per_1000_periods") > 0.0 && number("wall_s_per_1000_periods") > 0.0);
    // The start is known to eight decimals, and errors of it grow in proportion to time.
    assert!(number("energy_error") < 1e-13 && number("distance_from_start_after_10_periods") < 1e-5);
}

#[test]
fn a_membrane_swings_as_its_mode_does_beside_the_time_of_its_memory() {
    for threads in ["1", "2"] {
        let report = report(&["membrane", "--particles", "2500", "--threads", threads, "--seconds", "0.1"]);
        let number = numbers(&report);
        assert!((number("amplitude_of_mode") - number("amplitude_of_mode_theory")).abs() < 1e-9, "{report:#}");
        let floor = 104.0 * 2500.0 / number("memory_bytes_per_second") * 1e3;
        assert!((number("memory_floor_milliseconds_per_step") / floor - 1.0).abs() < 1e-12);
        assert!((number("share_of_memory_floor") * number("milliseconds_per_step") / floor - 1.0).abs() < 1e-12);
    }
}

#[test]
fn people_read_a_table() {
    let output = bench(&["hard-spheres", "--particles", "32", "--seconds", "0.01"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for part in ["collisions per second", "bytes per particle", "compressibility factor", "theory", "seed 1", "particles 32"] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn what_cannot_be_timed_is_refused_by_name() {
    let rows: &[(&[&str], &[&str])] = &[
        (&[], &["expected one of hard-spheres, brownian", "--help"]),
        (&["hard-sphere"], &["hard-sphere", "did you mean `hard-spheres`?"]),
        (&["hard-spheres", "--dimension", "4"], &["dimension = 4", "one of 2, 3"]),
        (&["hard-spheres", "--particles", "0"], &["particles = 0", "a whole number from 2"]),
        (&["hard-spheres", "--particles", "many"], &["particles = many", "a whole number"]),
        (&["hard-spheres", "--packing", "-1"], &["packing = -1", "a number from"]),
        (&["hard-spheres", "--packing", "0.8"], &["on the command line", "particles = 10976", "at most"]),
        (&["hard-spheres", "--seconds", "0"], &["seconds = 0", "a number from"]),
        (&["hard-spheres", "--seed", "-1"], &["seed = -1", "a whole number"]),
        (&["hard-spheres", "--partcles", "3"], &["--partcles", "did you mean `--particles`?"]),
        (&["brownian", "--radius-ratio", "1e9"], &["radius-ratio = 1e9", "a number from 1 to 60"]),
        (
            &["brownian", "--particles", "3", "--packing", "0.6"],
            &["on the command line", "radius of particle 0 = 15", "fits into the box"],
        ),
        (&["lennard-jones", "--particles", "50"], &["particles = 50", "a whole number from 108"]),
        (&["wca", "--threads", "0"], &["threads = 0", "a whole number from 1 to 256"]),
        (&["gravity", "--particles", "1"], &["particles = 1", "a whole number from 2"]),
        (&["tree", "--opening-angle", "1"], &["opening-angle = 1", "a number from 0 to 0.99"]),
        (&["grains", "--seconds", "long"], &["seconds = long", "a number from"]),
        (&["three-body", "--particles", "4"], &["--particles", "--help"]),
        (&["membrane", "--particles", "10"], &["on the command line", "particles = 10", "such as 9 or 16"]),
        (&["membrane", "--packing", "0.3"], &["--packing", "--help"]),
    ];
    for (arguments, parts) in rows {
        let output = bench(arguments);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {complaint}");
        assert!(output.stdout.is_empty() && complaint.lines().count() == 1, "{complaint}");
        for part in *parts {
            assert!(complaint.contains(part), "{arguments:?}: {complaint}does not say {part}");
        }
    }
}
