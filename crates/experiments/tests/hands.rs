//! A hand on every experiment that takes one: the state stays legal, and what is measured does not change.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

mod common;

use corpuscle_experiments::{Action, REGISTRY, Simulation};
use corpuscle_scene::{Body, Scene};

/// Parameters that make an experiment small.
fn quick(name: &str) -> &'static [(&'static str, &'static str)] {
    match name {
        "brownian" => &[("particles", "60"), ("replicas", "2")],
        "entropy" => &[("particles", "40"), ("replicas", "2")],
        "ideal-gas" => &[("particles", "40"), ("replicas", "3"), ("points", "3"), ("dense_packings", "0.1")],
        "granular" => &[("crowd", "300"), ("replicas", "2")],
        "sound" => &[("particles", "200"), ("replicas", "3")],
        "lennard-jones" => &[("particles", "250"), ("duration", "20")],
        "atmosphere" | "billiard" | "diffusion" | "engines" | "galton" => &[("replicas", "3")],
        "hard-disk-melting" => &[("side", "8"), ("small_side", "8"), ("packings", "0.7"), ("replicas", "2"), ("duration", "4")],
        _ => &[],
    }
}

fn scene(simulation: &dyn Simulation) -> Scene {
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    scene
}

fn place(body: &Body, scene: &Scene) -> [f64; 3] {
    let dt = scene.time - body.time;
    std::array::from_fn(|k| body.position[k] + (body.velocity[k] + 0.5 * scene.field[k] * dt) * dt)
}

/// The least of `distance / contact - 1` over all pairs of a picture.
fn clearance(scene: &Scene) -> f64 {
    let places: Vec<[f64; 3]> = scene.bodies.iter().map(|body| place(body, scene)).collect();
    let mut least = f64::INFINITY;
    for (i, a) in places.iter().enumerate() {
        for (j, b) in places.iter().enumerate().skip(i + 1) {
            let across = |k: usize| {
                let d = a[k] - b[k];
                if scene.period[k] > 0.0 { d - scene.period[k] * (d / scene.period[k]).round() } else { d }
            };
            let distance = (0..3).map(|k| across(k).powi(2)).sum::<f64>().sqrt();
            least = least.min(distance / (scene.bodies[i].radius + scene.bodies[j].radius) - 1.0);
        }
    }
    least
}

/// Experiments of hard bodies that meet each other, whose pictures must not show an overlap.
const HARD: [&str; 8] = ["brownian", "entropy", "ideal-gas", "atmosphere", "granular", "sound", "diffusion", "hard-disk-melting"];

#[test]
fn hands_leave_every_experiment_legal_and_its_measurement_alone() {
    let mut taken = vec![];
    for experiment in REGISTRY {
        let name = experiment.name;
        let [mut touched, mut left] = [0, 1].map(|_| common::start(name, 2, quick(name)).unwrap());
        let end = touched.end();
        let mut at = 0.01 * end;
        touched.advance(at).unwrap();
        let (first, middle) = {
            let scene = scene(&*touched);
            (place(scene.bodies.first().unwrap_or(&Body::default()), &scene), scene.bodies.len() / 2)
        };
        let actions = [
            Action::Place { body: middle, at: first },
            Action::Throw { body: middle, velocity: [1.0, -0.5, 0.3] },
            Action::Partition { axis: 0, at: first[0] + 3.0, hole: None },
            Action::Reverse,
            Action::Disturb { strength: 0.1, seed: 5 },
        ];
        touched.probe(Some([[-1e9; 2], [1e9; 2]]));
        let mut done = 0;
        for action in actions {
            let refused = touched.refusal(action);
            let outcome = touched.act(action);
            match refused {
                Some(expected) => assert_eq!(outcome.unwrap_err().expected, expected, "{name}"),
                // There may be no room for a plate between periodic images or obstacles, or for a body.
                None => done += usize::from(outcome.is_ok()),
            }
            if HARD.contains(&name) {
                let clearance = clearance(&scene(&*touched));
                assert!(clearance > -1e-9, "{name} after {action:?}: {clearance}");
            }
            at += 0.005 * end;
            touched.advance(at).unwrap();
        }
        if HARD.contains(&name) {
            assert!(clearance(&scene(&*touched)) > -1e-9, "{name}");
        }
        if done > 0 {
            taken.push((name, done));
        }
        if HARD.contains(&name) {
            let probed = touched.probed();
            assert!(probed.is_some_and(|probed| probed.contacts > 0 && probed.kinetic.is_some()), "{name}: {probed:?}");
        }
        left.advance(at).unwrap();
        // A reversal of the wave is measured, and so is the room of the entropy.
        if !["wave", "entropy"].contains(&name) {
            assert_eq!(format!("{:?}", touched.checks()), format!("{:?}", left.checks()), "{name}");
            assert_eq!(format!("{:?}", touched.charts()), format!("{:?}", left.charts()), "{name}");
        }
    }
    let names: Vec<&str> = taken.iter().map(|(name, _)| *name).collect();
    for name in HARD.into_iter().chain(["billiard", "newton-cradle", "lennard-jones", "wave", "three-body"]) {
        assert!(names.contains(&name), "{name} takes no hand: {taken:?}");
    }
    assert!(taken.iter().all(|&(_, done)| done >= 3), "{taken:?}");
}
