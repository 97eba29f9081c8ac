#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use corpuscle_core::Failure;
use corpuscle_observe::Check;
use corpuscle_scene::Scene;
use proptest::prelude::*;

use super::*;
use crate::Action;

mod forces;
mod laws;
mod start;
mod walls;

fn read(text: &str) -> System {
    toml::from_str(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn started(text: &str, seed: u64) -> Box<dyn Simulation> {
    start(&read(text), seed).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Runs to the end, and looks at everything there is to see.
fn run(text: &str, seed: u64) -> Result<Box<dyn Simulation>, Failure> {
    let mut simulation = started(text, seed);
    simulation.advance(simulation.end())?;
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    assert!(!scene.bodies.is_empty() && !scene.lines.is_empty());
    assert!(!simulation.charts().is_empty() && !simulation.honesty().engine.is_empty());
    Ok(simulation)
}

fn check(simulation: &dyn Simulation, name: &str) -> Check {
    let checks = simulation.checks();
    let names: Vec<_> = checks.iter().map(|check| check.quantity.clone()).collect();
    checks.into_iter().find(|check| check.quantity.starts_with(name)).unwrap_or_else(|| panic!("no {name} among {names:?}"))
}

/// What two runs must share to be called the same.
fn fingerprint(simulation: &dyn Simulation) -> String {
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    format!("{:?} {:?} {:?} {:?}", scene.bodies, simulation.charts(), simulation.checks(), simulation.tables())
}

const GAS: &str = "engine = 'event'\nduration = 2.0\n[box]\nlower = [0.0, 0.0]\nupper = [12.0, 9.0]\nfaces = 'walls'\n\
                   [[species]]\ncount = 30\nradius = 0.3\n";
const GAS_3: &str = "engine = 'event'\nduration = 2.0\n[box]\nlower = [0.0, 0.0, -1.0]\nupper = [8.0, 8.0, 7.0]\n\
                     faces = 'periodic'\n[[species]]\ncount = 60\nradius = 0.4\n";
const SOFT: &str = "engine = 'time'\nduration = 1.0\n[integrator]\nname = 'velocity-verlet'\ntime_step = 0.005\n\
                    [box]\nlower = [0.0, 0.0]\nupper = [12.0, 12.0]\nfaces = 'periodic'\n[forces.wca]\n\
                    [[species]]\ncount = 60\nradius = 0.5\n";
const NET: &str = "engine = 'time'\nduration = 3.0\nfield = [0.0, -1.0]\n[integrator]\nname = 'velocity-verlet'\n\
                   time_step = 0.01\n[box]\nlower = [-4.0, -4.0]\nupper = [4.0, 4.0]\nfaces = 'open'\n\
                   [[particle]]\nposition = [0.0, 0.0]\nheld = ['x', 'y']\n\
                   [[particle]]\nposition = [1.0, 0.0]\ntrail = true\n[[particle]]\nposition = [2.0, 0.0]\n\
                   [[spring]]\nfirst = 0\nsecond = 1\nstiffness = 50.0\nrest_length = 1.0\n\
                   [[spring]]\nfirst = 1\nsecond = 2\nstiffness = 50.0\nrest_length = 1.0\n";

/// A text with one place changed; asserts that the place is there.
fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from} is not in\n{text}");
    text.replacen(from, to, 1)
}

#[test]
fn every_kind_of_box_runs_on_the_event_driven_engine() {
    for faces in ["'walls'", "'periodic'", "['periodic', 'walls']", "['walls', 'open']", "'open'"] {
        run(&with(GAS, "'walls'", faces), 1).unwrap();
    }
    for faces in ["'walls'", "['periodic', 'walls', 'open']"] {
        run(&with(GAS_3, "'periodic'", faces), 1).unwrap();
    }
}

#[test]
fn both_halves_of_a_partitioned_box_stay_apart_unless_it_has_a_hole() {
    let half = GAS.to_owned() + "lower = [0.0, 0.0]\nupper = [6.0, 9.0]\n[[partition]]\naxis = 'x'\nposition = 6.0\n";
    let right = |text: &str| {
        let simulation = run(&with(text, "2.0", "40.0"), 3).unwrap();
        let mut scene = Scene::default();
        simulation.draw(&mut scene);
        let place = |body: &corpuscle_scene::Body| body.position[0] + body.velocity[0] * (scene.time - body.time);
        scene.bodies.iter().filter(|body| place(body) > 6.0).count()
    };
    assert_eq!(right(&half), 0);
    assert!(right(&(half + "hole = { along = 'y', from = 3.0, to = 6.0 }\n")) > 3);
}

#[test]
fn every_integrator_runs_and_every_force_acts() {
    for name in ["explicit-euler", "symplectic-euler", "velocity-verlet", "runge-kutta-4", "yoshida-4", "gauss-radau-15"] {
        let simulation = run(&with(SOFT, "velocity-verlet", name), 1).unwrap();
        assert!(simulation.honesty().engine.ends_with(name));
        run(&with(NET, "velocity-verlet", name), 1).unwrap();
    }
    run(&with(NET, "time_step = 0.01", "").replace("velocity-verlet", "gauss-radau-15"), 1).unwrap();
    run(&with(SOFT, "[forces.wca]", "[forces.lennard_jones]\nsigma = 0.9\ncutoff = 3.0"), 1).unwrap();
    run(&with(&with(SOFT, "[forces.wca]", "[forces.gravity]\nsoftening = 0.1"), "periodic", "walls"), 1).unwrap();
    let soft_3 = SOFT.replace("[0.0, 0.0]", "[0.0, 0.0, 0.0]").replace("[12.0, 12.0]", "[6.0, 6.0, 6.0]");
    run(&soft_3, 1).unwrap();
}

#[test]
fn every_observable_is_measured_and_shown() {
    let observe = "observe = ['temperature', 'pressure', 'speeds', 'mean-squared-displacement', 'radial-distribution']\n";
    for text in [GAS_3, SOFT] {
        let simulation = run(&(observe.to_owned() + text), 1).unwrap();
        let names: Vec<_> = simulation.charts().into_iter().map(|chart| chart.name).collect();
        let all = ["energy", "temperature", "pressure", "speeds", "radial-distribution", "mean-squared-displacement"];
        assert_eq!(names, all);
        assert_eq!(simulation.tables()[0].rows.len(), 1);
        for chart in simulation.charts() {
            assert!(chart.series.iter().all(|series| !series.y.is_empty()), "{} has an empty series", chart.name);
        }
    }
    // A start at rest, and one alone: nothing to divide by.
    run(&(observe.replace(", 'radial-distribution'", "") + NET), 1).unwrap();
    run(
        &with(&with(GAS, "count = 30", "count = 1"), "radius = 0.3", "radius = 0.3\ntemperature = 0.0")
            .replace("'event'", "'event'\nfield = [0.0, -1.0]"),
        1,
    )
    .unwrap();
}

#[test]
fn generated_particles_have_the_temperature_asked_for_and_a_periodic_box_no_drift() {
    for text in [GAS, GAS_3] {
        let text = "observe = ['temperature']\n".to_owned() + &with(text, "radius", "temperature = 2.5\nradius");
        let simulation = started(&text, 8);
        let chart = simulation.charts().into_iter().find(|chart| chart.name == "temperature").unwrap();
        assert!((chart.series[0].y[0] - 2.5).abs() < 1e-12);
    }
}

/// Equation of state, wall against virial, speeds: over independent seeds the scores are standard normal deviates.
#[test]
fn a_hard_sphere_gas_obeys_its_equation_of_state() {
    let text = with(&with(GAS_3, "count = 60", "count = 150"), "2.0", "60.0");
    let scores: Vec<f64> = (0..12).map(|seed| check(&*run(&text, seed).unwrap(), "compressibility").z.unwrap()).collect();
    assert_normal(&scores);
}

#[test]
fn walls_feel_the_pressure_of_the_virial_theorem() {
    let text = "observe = ['pressure']\n".to_owned() + &with(GAS, "2.0", "400.0");
    for seed in 0..4 {
        let simulation = run(&text, seed).unwrap();
        let check = check(&*simulation, "pressure on the walls");
        assert!(check.passed && check.standard_error.unwrap() < 0.01 * check.expected, "{check:?}");
        assert!(simulation.checks().iter().all(|check| check.passed));
    }
}

fn assert_normal(scores: &[f64]) {
    let n = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / n;
    let square = scores.iter().map(|z| z * z).sum::<f64>() / n;
    println!("{n} scores: mean {mean:.2}, mean square {square:.2}");
    assert!((mean * n.sqrt()).abs() < 4.0 && ((square - 1.0) * (n / 2.0).sqrt()).abs() < 4.0, "{scores:?}");
}

#[test]
fn a_symplectic_run_keeps_its_energy() {
    for text in [with(SOFT, "duration = 1.0", "duration = 40.0"), with(NET, "duration = 3.0", "duration = 300.0")] {
        let simulation = run(&text, 2).unwrap();
        let error = check(&*simulation, "largest energy error");
        assert!(error.passed && error.measured > 0.0, "{error:?}");
    }
}

#[test]
fn explicit_euler_does_not() {
    let simulation = run(&with(NET, "velocity-verlet", "explicit-euler"), 1).unwrap();
    assert!(!check(&*simulation, "largest energy error").passed);
    assert!(check(&*run(NET, 1).unwrap(), "largest energy error").passed);
}

#[test]
fn collisions_keep_energy_in_a_field_too_and_inelastic_ones_only_take_it() {
    for text in [GAS, GAS_3] {
        let g = if text == GAS { "[0.3, -1.0]" } else { "[0.0, 0.5, -1.0]" };
        let field = format!("field = {g}\n{}", with(text, "2.0", "20.0"));
        assert!(check(&*run(&field, 1).unwrap(), "largest energy drift").passed);
    }
    let grains = with(GAS_3, "2.0", "20.0") + "[collisions]\nrestitution = 0.8\nelastic_below = 1e-4\n";
    let simulation = run(&grains, 1).unwrap();
    assert!(check(&*simulation, "largest rise").passed && check(&*simulation, "largest momentum").passed);
    let energy = &simulation.charts()[0].series[0].y;
    assert!(*energy.last().unwrap() < 0.5 * energy[0]);
}

#[test]
fn a_projectile_flies_a_parabola() {
    let text = "engine = 'event'\nduration = 1.0\nfield = [0.0, -2.0]\n[box]\nlower = [0.0, 0.0]\nupper = [10.0, 10.0]\n\
                faces = 'walls'\n[[particle]]\nposition = [1.0, 5.0]\nvelocity = [3.0, 1.0]\nradius = 0.1\n";
    let mut simulation = started(text, 1);
    simulation.advance(1.0).unwrap();
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    let body = scene.bodies[0];
    let t = scene.time - body.time;
    let place = [0, 1].map(|k| body.position[k] + body.velocity[k] * t + 0.5 * scene.field[k] * t * t);
    assert!((place[0] - 4.0).abs() < 1e-14 && (place[1] - 5.0).abs() < 1e-14);
}

#[test]
fn where_a_caller_stops_leaves_no_trace() {
    let observe = "observe = ['pressure', 'temperature', 'speeds']\n";
    for text in [GAS, GAS_3, SOFT, NET] {
        let text = observe.to_owned() + text;
        let once = run(&text, 5).unwrap();
        let mut often = started(&text, 5);
        for stop in 1..=977 {
            often.advance(once.end() * f64::from(stop) / 977.0).unwrap();
        }
        assert_eq!(fingerprint(&*once), fingerprint(&*often));
        if text.contains("species") {
            assert_ne!(fingerprint(&*once), fingerprint(&*run(&text, 6).unwrap()));
        }
    }
}

#[test]
fn a_step_that_does_not_divide_the_duration_still_ends() {
    let simulation = run(&with(NET, "time_step = 0.01", "time_step = 0.007"), 1).unwrap();
    assert_eq!(simulation.time(), simulation.end());
}

#[test]
fn velocities_can_be_turned_round() {
    for text in [GAS_3, SOFT] {
        let mut simulation = started(text, 2);
        simulation.advance(0.4).unwrap();
        simulation.act(Action::Reverse).unwrap();
        simulation.advance(simulation.end()).unwrap();
        assert!(simulation.checks().iter().all(|check| check.passed), "{:?}", simulation.checks());
    }
}

fn refused(text: &str) -> Invalid {
    start(&read(text), 1).err().unwrap_or_else(|| panic!("accepted:\n{text}"))
}

#[test]
fn every_refusal_names_the_key_in_the_file() {
    let two = "engine = 'event'\nduration = 1.0\n[box]\nlower = [0.0, 0.0]\nupper = [4.0, 4.0]\nfaces = 'walls'\n\
               [[particle]]\nposition = [1.0, 1.0]\nradius = 0.5\n[[particle]]\nposition = [3.0, 3.0]\nradius = 0.5\n";
    for (text, from, to, key) in [
        (GAS, "radius = 0.3", "radius = -0.3", "species[0].radius"),
        (GAS, "radius = 0.3", "radius = nan", "species[0].radius"),
        (GAS, "radius = 0.3", "radius = inf", "species[0].radius"),
        (GAS, "radius = 0.3", "radius = 0.3\nmass = 0.0", "species[0].mass"),
        (GAS, "radius = 0.3", "radius = 0.3\ntemperature = -1.0", "species[0].temperature"),
        (GAS, "radius = 0.3", "radius = 0.3\nlower = [-1.0, 0.0]", "species[0].lower"),
        (GAS, "radius = 0.3", "radius = 0.3\nupper = [nan, 0.0]", "species[0].upper"),
        (GAS, "count = 30", "count = 0", "species[0].count"),
        (GAS, "count = 30", "count = 3000", "species[0].count"),
        (GAS, "count = 30", "count = 9000000000000000000", "species[0].count"),
        (GAS, "[[species]]\ncount = 30\nradius = 0.3\n", "", "particle"),
        (GAS, "lower = [0.0, 0.0]", "lower = [0.0]", "box.lower"),
        (GAS, "lower = [0.0, 0.0]", "lower = [20.0, 0.0]", "box.lower"),
        (GAS, "lower = [0.0, 0.0]", "lower = [-inf, 0.0]", "box.lower"),
        (GAS, "upper = [12.0, 9.0]", "upper = [12.0, 9.0, 1.0]", "box.upper"),
        (GAS, "upper = [12.0, 9.0]", "upper = [nan, 9.0]", "box.upper"),
        (GAS, "'walls'", "['walls', 'walls', 'open']", "box.faces"),
        (GAS, "duration = 2.0", "duration = 0.0", "duration"),
        (GAS, "duration = 2.0", "duration = inf", "duration"),
        (GAS, "duration = 2.0", "duration = 1e300", "duration"),
        (GAS, "duration = 2.0", "duration = 2.0\nsample_interval = 1e-9", "sample_interval"),
        (GAS, "duration = 2.0", "duration = 2.0\nsample_interval = -1.0", "sample_interval"),
        (GAS, "duration = 2.0", "duration = 2.0\nfield = [0.0, nan]", "field"),
        (GAS, "duration = 2.0", "duration = 2.0\nfield = [0.0, 0.0, 1.0]", "field"),
        (GAS, "duration = 2.0", "duration = 2.0\nobserve = ['radial-distribution']", "observe"),
        (GAS, "[box]", "[collisions]\nrestitution = 1.5\n[box]", "collisions.restitution"),
        (GAS, "[box]", "[collisions]\nelastic_below = -1.0\n[box]", "collisions.elastic_below"),
        (GAS, "[box]", "[[spring]]\nfirst = 0\nsecond = 1\nstiffness = 1.0\n[box]", "spring[0]"),
        (GAS, "[box]", "[forces.wca]\n[box]", "forces"),
        (GAS, "[box]", "[integrator]\nname = 'velocity-verlet'\ntime_step = 0.1\n[box]", "integrator"),
        (GAS, "[box]", "[[partition]]\naxis = 'z'\nposition = 1.0\n[box]", "partition[0].axis"),
        (GAS, "[box]", "[[partition]]\naxis = 'x'\nposition = 12.5\n[box]", "partition[0].position"),
        (GAS, "[box]", "[[partition]]\naxis = 'x'\nposition = nan\n[box]", "partition[0].position"),
        (
            GAS,
            "[box]",
            "[[partition]]\naxis = 'x'\nposition = 5.0\nhole = { along = 'x', from = 1.0, to = 2.0 }\n[box]",
            "partition[0].hole.along",
        ),
        (
            GAS,
            "[box]",
            "[[partition]]\naxis = 'x'\nposition = 5.0\nhole = { along = 'y', from = 3.0, to = 2.0 }\n[box]",
            "partition[0].hole",
        ),
        (two, "position = [3.0, 3.0]", "position = [1.5, 1.0]", "particle[1].position"),
        (two, "position = [3.0, 3.0]", "position = [3.8, 1.0]", "particle[1].position"),
        (two, "position = [3.0, 3.0]", "position = [nan, 1.0]", "particle[1].position"),
        (two, "position = [3.0, 3.0]", "position = [3.0]", "particle[1].position"),
        (two, "position = [1.0, 1.0]", "position = [1.0, 1.0]\nvelocity = [1.0, inf]", "particle[0].velocity"),
        (two, "position = [1.0, 1.0]", "position = [1.0, 1.0]\nmass = 0.0", "particle[0].mass"),
        (two, "position = [1.0, 1.0]", "position = [1.0, 1.0]\nmass = -1.0", "particle[0].mass"),
        (two, "radius = 0.5", "radius = -0.5", "particle[0].radius"),
        (two, "position = [1.0, 1.0]", "position = [1.0, 1.0]\nheld = ['x']", "particle[0].held"),
        (SOFT, "time_step = 0.005", "time_step = 0.0", "integrator.time_step"),
        (SOFT, "time_step = 0.005", "time_step = nan", "integrator.time_step"),
        (SOFT, "time_step = 0.005", "time_step = 1e-300", "integrator.time_step"),
        (SOFT, "time_step = 0.005", "time_step = 3.0", "integrator.time_step"),
        (SOFT, "time_step = 0.005", "", "integrator.time_step"),
        (SOFT, "velocity-verlet", "velocity-varlet", "integrator.name"),
        (SOFT, "[integrator]\nname = 'velocity-verlet'\ntime_step = 0.005\n", "", "integrator"),
        (SOFT, "duration = 1.0", "duration = 1.0\nsample_interval = 0.001", "sample_interval"),
        (SOFT, "duration = 1.0", "duration = 1.0\nfield = [0.0, -1.0]", "field"),
        (SOFT, "[forces.wca]", "[forces.wca]\ncutoff = 2.0", "forces.wca.cutoff"),
        (SOFT, "[forces.wca]", "[forces.wca]\nsigma = 0.0", "forces.wca.sigma"),
        (SOFT, "[forces.wca]", "[forces.lennard_jones]\nepsilon = -1.0", "forces.lennard_jones.epsilon"),
        (SOFT, "[forces.wca]", "[forces.lennard_jones]\ncutoff = nan", "forces.lennard_jones.cutoff"),
        (SOFT, "[forces.wca]", "[forces.lennard_jones]\ncutoff = 7.0", "forces.lennard_jones.cutoff"),
        (SOFT, "[forces.wca]", "[forces.gravity]", "box.faces"),
        (SOFT, "[forces.wca]", "[forces.gravity]\nsoftening = -1.0", "forces.gravity.softening"),
        (SOFT, "[forces.wca]", "[collisions]", "collisions"),
        (SOFT, "[forces.wca]", "[[partition]]\naxis = 'x'\nposition = 3.0", "partition[0]"),
        (NET, "second = 2", "second = 3", "spring[1].second"),
        (NET, "first = 1", "first = 4", "spring[1].first"),
        (NET, "second = 2", "second = 1", "spring[1].second"),
        (NET, "stiffness = 50.0", "stiffness = -1.0", "spring[0].stiffness"),
        (NET, "rest_length = 1.0", "rest_length = nan", "spring[0].rest_length"),
        (NET, "rest_length = 1.0", "rest_length = 1.0\ndamping = -1.0", "spring[0].damping"),
        (NET, "held = ['x', 'y']", "held = ['z']", "particle[0].held"),
        (NET, "position = [1.0, 0.0]", "position = [1.0, 0.0]\nmass = 0.0", "particle[1].mass"),
        (
            &NET.replace("field", "#").replace("'open'", "'periodic'"),
            "rest_length = 1.0",
            "rest_length = 5.0",
            "spring[0].rest_length",
        ),
        (&NET.replace("'open'", "'walls'").replace("velocity-verlet", "gauss-radau-15"), "'time'", "'time'", "integrator.name"),
        (&NET.replace("'open'", "'walls'"), "position = [2.0, 0.0]", "position = [5.0, 0.0]", "particle[2].position"),
    ] {
        let invalid = refused(&with(text, from, to));
        assert_eq!(invalid.key, key, "{to}: {invalid}");
        assert!(!invalid.expected.is_empty() && !invalid.value.is_empty());
    }
}

/// Any number a file can hold, hostile ones first.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -3.0..12.0f64,
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1e300, -1e300, 1e-300, 1e17]),
        1 => any::<f64>(),
    ]
}

fn places(dimension: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(number(), dimension)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn no_numbers_make_a_start_panic(
        base in prop::sample::select(vec![GAS, GAS_3, SOFT, NET]), changes in prop::collection::vec((0..33usize, number()), 1..4),
        count in prop_oneof![4 => 1..80usize, 1 => any::<usize>()], lower in places(2), place in places(3), end: usize, seed: u64
    ) {
        let mut system = read(base);
        let spot = |x: &mut f64, value: f64| *x = value;
        for (which, value) in changes {
            match which {
                0 => spot(&mut system.duration, value),
                1 => system.sample_interval = Some(value),
                2 => spot(&mut system.room.lower[0], value),
                3 => spot(&mut system.room.upper[1], value),
                4 => system.field = vec![value; system.room.lower.len()],
                5 => system.room.lower.clone_from(&lower),
                6 => system.room.upper.clone_from(&place),
                7..=12 => for group in &mut system.species {
                    match which {
                        7 => group.radius = value,
                        8 => group.mass = value,
                        9 => group.temperature = value,
                        10 => group.count = count,
                        11 => group.lower = Some(lower.clone()),
                        _ => group.upper = Some(place.clone()),
                    }
                },
                13..=17 => for single in &mut system.particles {
                    match which {
                        13 => single.position.clone_from(&lower),
                        14 => single.velocity.clone_from(&lower),
                        15 => single.radius = value,
                        16 => single.mass = value,
                        _ => single.position = vec![value, value],
                    }
                },
                18..=20 => for bond in &mut system.springs {
                    match which {
                        18 => bond.first = end,
                        19 => (bond.stiffness, bond.damping) = (value, value),
                        _ => bond.rest_length = value,
                    }
                },
                21 => if let Some(stepper) = &mut system.integrator { stepper.time_step = Some(value); },
                22 => system.partitions.push(spec::Plate { axis: spec::AxisName::X, position: value, hole: Some(spec::Opening { along: spec::AxisName::Y, from: value, to: lower[0] }), removed_at: Some(value) }),
                23 => system.obstacles.push(spec::Peg { centre: lower.clone(), radius: value }),
                24 => system.walls.push(spec::Wall { axis: spec::AxisName::X, side: spec::Side::Upper, temperature: Some(value), path: Some(vec![[0.0, value], [lower[0], lower[1]]]), oscillation: None, opened_at: None }),
                25 => system.walls.push(spec::Wall { axis: spec::AxisName::Y, side: spec::Side::Lower, temperature: None, path: None, oscillation: Some(spec::Swing { centre: value, amplitude: lower[0], angular_frequency: lower[1], phase: value }), opened_at: Some(value) }),
                26 => system.piston = Some(spec::Cylinder { axis: spec::AxisName::X, position: value, velocity: lower[0], mass: lower[1], force: value, stops: None }),
                27 => system.collisions = Some(spec::Collisions { restitution: None, viscoelastic: Some(spec::Viscoelastic { stiffness: value, dissipation_time: lower[0] }), elastic_below: 0.0, well: Some(spec::Well { range: lower[1], depth: value }), shoulder: None }),
                28 => {
                    system.finite.push(spec::Finite { first: end, second: count, count, stiffness: value, longest: lower[0] });
                    system.exponential.push(spec::Exponential { first: end, second: count, count, stiffness: value, steepness: lower[0], rest_length: lower[1] });
                    system.drives.push(spec::Shaker { particle: end, axis: spec::AxisName::Y, amplitude: value, angular_frequency: lower[0], phase: value, ramp: lower[1] });
                },
                29 => if let Some(forces) = &mut system.forces {
                    let charges = [("particles".to_owned(), value)].into();
                    forces.coulomb = Some(spec::Charges { constant: lower[0], charges, accuracy: (seed % 2 == 0).then_some(value) });
                    forces.yukawa = Some(spec::Screened { epsilon: value, sigma: lower[0], screening_length: lower[1], cutoff: value });
                    forces.central = Some(spec::Trap { centre: lower.clone(), strength: value, power: lower[0] });
                    forces.drag = Some(spec::Friction { rate: value });
                },
                30 => if let Some(forces) = &mut system.forces {
                    forces.inverse_power = Some(spec::PowerLaw { epsilon: value, sigma: lower[0], exponent: end as u8, cutoff: Some(lower[1]) });
                    forces.harmonic_repulsion = Some(spec::Grain { stiffness: value, diameter: lower[0] });
                    forces.morse = Some(spec::Valley { epsilon: value, equilibrium: lower[0], steepness: lower[1], cutoff: None });
                    forces.push.push(spec::Push { particle: end, direction: lower.clone(), amplitude: value, angular_frequency: lower[0], phase: value, ramp: lower[1] });
                },
                31 => if let Some(stepper) = &mut system.integrator {
                    stepper.name = ["langevin", "brownian", "stochastic-rescaling", "nose-hoover"][end % 4].into();
                    (stepper.temperature, stepper.friction, stepper.relaxation_time) = (Some(value), Some(lower[0]), Some(lower[1]));
                    match end % 4 {
                        0 | 1 => stepper.relaxation_time = None,
                        _ => stepper.friction = None,
                    }
                },
                _ => if let Some(forces) = &mut system.forces {
                    let pair = spec::Contact { epsilon: value, sigma: lower[0], cutoff: Some(lower[1]), ..spec::Contact::default() };
                    forces.lennard_jones = Some(pair);
                },
            }
        }
        // Nobody waits for millions of particles here.
        if system.species.iter().all(|group| group.count < 1000 || group.count > 2_000_000)
            && let Ok(simulation) = start(&system, seed)
        {
            simulation.draw(&mut Scene::default());
            let _ = (simulation.charts(), simulation.checks(), simulation.honesty(), simulation.tables());
        }
    }
}
