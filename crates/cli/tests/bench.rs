//! `corpuscle bench` through the real command, on systems so small and short that only its form can be judged, and the
//! physics that no clock disturbs.

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

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
