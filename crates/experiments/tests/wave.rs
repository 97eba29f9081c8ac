//! The experiment `wave` against theory: every preset, both polarisations, all integrators.
#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use corpuscle_experiments::{Action, Settings, Simulation, find};
use corpuscle_observe::{Check, Verdict};
use corpuscle_scene::Scene;

fn settings(seed: u64, changes: &[(&str, &str)]) -> Settings {
    let mut settings = Settings::new(find("wave").unwrap().parameters, seed);
    for (key, text) in changes {
        settings.set_text(key, text).unwrap();
    }
    settings
}

/// Runs to the end in `stops` advances.
fn run(settings: &Settings, stops: u32) -> Box<dyn Simulation> {
    let mut simulation = (find("wave").unwrap().start)(settings).unwrap();
    for stop in 1..=stops {
        simulation.advance(simulation.end() * f64::from(stop) / f64::from(stops)).unwrap();
    }
    simulation
}

fn assert_all_pass(name: &str, checks: &[Check]) {
    for check in checks {
        println!("{name}: {} = {:.3e}, bound {:.3e}", check.quantity, check.measured, check.expected);
    }
    for check in checks {
        assert!(check.passed, "{name}: {check:?}");
    }
}

fn find_check<'a>(checks: &'a [Check], words: &str) -> &'a Check {
    checks.iter().find(|check| check.quantity.contains(words)).unwrap_or_else(|| panic!("no check of {words}"))
}

#[test]
fn every_preset_agrees_with_theory() {
    for preset in ["density-step", "fixed-end", "free-end", "ring", "standing-wave", "shaker", "longitudinal"] {
        let simulation = run(&settings(1, &[("preset", preset)]), 1);
        let checks = simulation.checks();
        assert_all_pass(preset, &checks);
        assert!(checks.len() >= 10, "{preset}: {} checks", checks.len());
        assert!(checks.iter().all(|check| check.verdict != Verdict::Agreement), "nothing here is random");
        let mut scene = Scene::default();
        simulation.draw(&mut scene);
        let finite = |p: &[f64; 3]| p.iter().all(|x| x.is_finite());
        assert!(!scene.bodies.is_empty() && scene.bodies.iter().all(|body| finite(&body.position)), "{preset}");
        for chart in simulation.charts() {
            for series in &chart.series {
                assert!(series.x.len() <= 2000 && series.x.len() == series.y.len(), "{preset}: {}", chart.name);
                // Only the rows of the space-time chart are interrupted, by points that are none.
                let gap = |x: f64, y: f64| chart.name == "space-time" && x.is_nan() && y.is_nan();
                let mut points = series.x.iter().zip(&series.y);
                assert!(
                    points.all(|(&x, &y)| (x.is_finite() && y.is_finite()) || gap(x, y)),
                    "{preset}: {} {}",
                    chart.name,
                    series.name
                );
            }
        }
        for table in simulation.tables() {
            assert!(table.rows.iter().all(|row| row.len() == table.columns.len()));
        }
    }
}

#[test]
fn other_materials_and_seeds_agree_too() {
    for seed in 2..=10 {
        assert_all_pass("seed", &run(&settings(seed, &[]), 1).checks());
    }
    for changes in [
        &[("stiffness", "250"), ("mass", "0.01"), ("spacing", "0.05"), ("amplitude", "0.01")][..],
        &[("polarisation", "longitudinal"), ("density_ratio", "0.3"), ("masses", "240")],
        &[("density_ratio", "16"), ("time_step", "0.4"), ("masses", "200")],
        &[("preset", "ring"), ("polarisation", "longitudinal"), ("masses", "161"), ("time_step", "0.7")],
        &[("preset", "standing-wave"), ("ends", "free"), ("mode", "59")],
        &[("preset", "standing-wave"), ("ends", "periodic"), ("mode", "29")],
    ] {
        assert_all_pass(&format!("{changes:?}"), &run(&settings(1, changes), 1).checks());
    }
}

/// The bounds are tight enough to see what they are for: without velocity Verlet's shift the frequencies would fail by
/// far, and the dispersion of the chain is seen in what it does to a pulse.
#[test]
fn the_bounds_can_tell() {
    let simulation = run(&settings(1, &[]), 1);
    let checks = simulation.checks();
    let modes = simulation.tables().into_iter().find(|table| table.name == "modes-fixed-ends").unwrap();
    let bound = find_check(&checks, "with fixed ends").expected;
    for row in &modes.rows {
        assert!((row[2] / row[4] - 1.0).abs() > 100.0 * bound, "mode {}: the shift is not seen", row[0]);
    }
    assert!(find_check(&checks, "fixed end inverts").expected < 1e-3);
    assert!(find_check(&checks, "transmitted amplitude").expected < 1e-2);
    assert!(find_check(&checks, "pulse's speed").expected < 1e-5);
}

/// Explicit Euler makes energy from nothing, and the verdict says so; the others keep theirs.
#[test]
fn integrators_are_judged() {
    for integrator in ["velocity-verlet", "symplectic-euler", "yoshida-4", "runge-kutta-4"] {
        let checks = run(&settings(1, &[("integrator", integrator), ("masses", "160")]), 1).checks();
        assert_all_pass(integrator, &checks);
    }
    let checks = run(&settings(1, &[("integrator", "explicit-euler")]), 1).checks();
    assert!(!find_check(&checks, "energy: largest").passed);
}

#[test]
fn stopping_on_the_way_changes_nothing() {
    let set = settings(3, &[("masses", "170")]);
    let (once, often) = (run(&set, 1), run(&set, 97));
    assert_eq!(once.checks(), often.checks());
    // As text: the gaps of a chart are equal to each other as well.
    assert_eq!(format!("{:?}", once.charts()), format!("{:?}", often.charts()));
}

#[test]
fn stopping_changes_nothing_of_chains_with_friction() {
    for preset in ["matched-end", "damped-mode", "resonance"] {
        let set = settings(1, &[("preset", preset), ("masses", "20"), ("mode", "2"), ("pulse_width", "1"), ("damping", "0.05")]);
        let (once, often) = (run(&set, 1), run(&set, 31));
        assert_eq!(once.checks(), often.checks());
        assert_eq!(format!("{:?}", once.charts()), format!("{:?}", often.charts()));
        assert!(!once.checks().is_empty());
    }
}

#[test]
fn threads_change_nothing() {
    let set = settings(3, &[]);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&set, 3).checks())
    };
    assert_eq!(on(1), on(2));
}

/// Reversed at the end and run as long again, a pulse is back where it began: to rounding, which here is the chain's own
/// worst case, `8 n eps sqrt(N) N` of the amplitude.
#[test]
fn reversal_runs_the_pulse_back() {
    let set = settings(1, &[("duration", "200")]);
    let mut simulation = run(&set, 1);
    let mut before = Scene::default();
    (find("wave").unwrap().start)(&set).unwrap().draw(&mut before);
    simulation.act(Action::Reverse).unwrap();
    simulation.advance(400.0).unwrap();
    let mut after = Scene::default();
    simulation.draw(&mut after);
    // Heights over the largest: the picture's scale adapts to what has been seen.
    let heights = |scene: &Scene| {
        let most = scene.bodies.iter().fold(0.0, |most: f64, body| most.max(body.position[1]));
        scene.bodies.iter().map(|body| body.position[1] / most).collect::<Vec<_>>()
    };
    for (n, (a, b)) in heights(&before).into_iter().zip(heights(&after)).enumerate() {
        assert!((a - b).abs() < 8.0 * 4000.0 * f64::EPSILON * 160f64.powf(1.5), "mass {n}: {a} and {b}");
    }
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    for (changes, key) in [
        (&[("time_step", "1.1")][..], "time_step"),
        (&[("time_step", "0.3"), ("density_ratio", "0.0625"), ("stiffness", "4")], "time_step"),
        (&[("pulse_width", "20")], "pulse_width"),
        (&[("start", "mode")], "density_ratio"),
        (&[("preset", "standing-wave"), ("mode", "61")], "mode"),
        (&[("preset", "standing-wave"), ("ends", "free"), ("mode", "60")], "mode"),
        (&[("preset", "standing-wave"), ("ends", "periodic"), ("mode", "30")], "mode"),
        (&[("start", "drive"), ("ends", "periodic")], "ends"),
        (&[("polarisation", "longitudinal"), ("amplitude", "10")], "amplitude"),
    ] {
        let error = (find("wave").unwrap().start)(&settings(1, changes)).err().expect("refused");
        assert_eq!(error.key, key, "{error}");
    }
}

#[test]
fn nonlinear_chains_and_membranes_agree_with_theory() {
    for (changes, count) in [
        (&[("preset", "fermi-pasta")][..], 4),
        (&[("preset", "dispersion")], 3),
        (&[("preset", "dispersion"), ("masses", "41"), ("stiffness", "9"), ("spacing", "0.2")], 3),
        (&[("preset", "solitons")], 2),
        (&[("preset", "solitons"), ("solitons", "1.4,1,0.6"), ("masses", "700"), ("stiffness", "4"), ("spacing", "0.5")], 2),
        (&[("preset", "matched-end")], 2),
        (&[("preset", "matched-end"), ("end_impedance", "0.3"), ("stiffness", "4"), ("spacing", "0.5")], 2),
        (&[("preset", "matched-end"), ("end_impedance", "30")], 2),
        (&[("preset", "damped-mode")], 1),
        (&[("preset", "damped-mode"), ("mode", "20"), ("mass", "3"), ("damping", "0.4")], 1),
        (&[("preset", "resonance")], 1),
        (&[("preset", "resonance"), ("masses", "12"), ("mass", "2"), ("damping", "0.1"), ("drive_frequency", "0.1")], 1),
        (&[("preset", "two-sources")], 1),
        (&[("preset", "double-slit")], 1),
        (&[("preset", "single-slit")], 1),
        (&[("preset", "doppler")], 2),
    ] {
        let simulation = run(&settings(1, changes), 3);
        let checks = simulation.checks();
        assert_all_pass(&format!("{changes:?}"), &checks);
        assert_eq!(checks.len(), count, "{changes:?}");
        let mut scene = Scene::default();
        simulation.draw(&mut scene);
        assert!(!scene.title.is_empty() && (scene.map.is_some() || !scene.bodies.is_empty()));
        for chart in simulation.charts() {
            println!("{}: {}", chart.name, chart.note);
            let finite = |x: &f64| x.is_finite();
            assert!(chart.series.iter().all(|series| series.x.iter().all(finite) && series.y.iter().all(finite)), "{}", chart.name);
        }
    }
}

#[test]
fn nonlinear_chains_and_membranes_refuse_nonsense_by_name() {
    for (changes, key) in [
        (&[("preset", "solitons"), ("solitons", "1,1")][..], "solitons"),
        (&[("preset", "solitons"), ("masses", "60")], "masses"),
        (&[("preset", "fermi-pasta"), ("amplitude", "50")], "amplitude"),
        (&[("preset", "fermi-pasta"), ("mode", "40")], "mode"),
        (&[("preset", "fermi-pasta"), ("time_step", "3")], "time_step"),
        (&[("preset", "double-slit"), ("slit_width", "41")], "slit_width"),
        (&[("preset", "matched-end"), ("pulse_width", "9")], "pulse_width"),
        (&[("preset", "damped-mode"), ("mode", "61")], "mode"),
        (&[("preset", "resonance"), ("masses", "300")], "masses"),
        (&[("preset", "resonance"), ("damping", "0.5")], "damping"),
    ] {
        let error = (find("wave").unwrap().start)(&settings(1, changes)).err().expect("refused");
        assert_eq!(error.key, key, "{error}");
    }
}
