//! Every experiment, written down at any time and taken up again by one set up alike, measures what the unbroken one measures,
//! to the last bit.

#![allow(clippy::unwrap_used, clippy::panic, reason = "in the helpers too: a test that cannot be set up has failed")]

use corpuscle_checkpoint::{Reader, Writer};
use corpuscle_core::Random;
use corpuscle_experiments::{Frame, Honesty, REGISTRY, Settings, Simulation, find, free};

fn written(simulation: &dyn Simulation) -> Vec<u8> {
    let mut out = Writer::new();
    out.part("simulation", simulation.state().unwrap()).unwrap();
    out.finish()
}

/// All there is to tell, with every digit.
fn told(simulation: &dyn Simulation) -> String {
    let (charts, checks, tables) = (simulation.charts(), simulation.checks(), simulation.tables());
    format!("{:?}\n{charts:?}\n{checks:?}\n{tables:?}\n{:?}", simulation.time(), simulation.honesty())
}

/// Runs to `share` of the whole, unbroken and in pieces; tells when that is, and what all particles are doing then.
fn compare(name: &str, set_up: &dyn Fn() -> Box<dyn Simulation>, share: f64) -> (f64, Option<Frame>) {
    let mut random = Random::new(91, 0);
    let mut unbroken = set_up();
    let end = share * unbroken.end();
    let mut stops: Vec<f64> = (0..4).map(|_| end * random.uniform()).collect();
    stops.sort_by(f64::total_cmp);
    let mut broken = set_up();
    for stop in stops.into_iter().chain([end]) {
        broken.advance(stop).unwrap();
        let bytes = written(broken.as_ref());
        broken = set_up();
        let mut from = Reader::new(&bytes);
        from.part("simulation", broken.state_mut().unwrap()).unwrap();
        from.end().unwrap();
        assert!(bytes == written(broken.as_ref()), "{name}: not written down again as it was at t = {stop}");
    }
    unbroken.advance(end).unwrap();
    assert_eq!(told(unbroken.as_ref()), told(broken.as_ref()), "{name}");
    assert_eq!(unbroken.frame(), broken.frame(), "{name}");
    (end, unbroken.frame())
}

/// A frame for a trajectory: particles that are named and finite, at the end of the run.
fn assert_frame(name: &str, (end, frame): (f64, Option<Frame>)) {
    let frame = frame.unwrap_or_else(|| panic!("{name} has particles to show in files"));
    let particles = &frame.particles;
    assert!(particles.position.iter().chain(&particles.velocity).all(|r| r.is_finite()), "{name}");
    let named = (0..particles.len()).all(|i| !frame.name(i).is_empty());
    assert!(named && (end - frame.time).abs() < 0.02 * end, "{name}: {}", frame.time);
}

fn experiment(name: &str, values: &[(&str, &str)], share: f64) -> (f64, Option<Frame>) {
    let experiment = find(name).unwrap();
    let mut settings = Settings::new(experiment.parameters, 5);
    for (key, text) in values {
        settings.set_text(key, text).unwrap();
    }
    compare(name, &|| (experiment.start)(&settings).unwrap(), share)
}

#[test]
fn every_process_of_a_gas() {
    for process in ["effusion", "echo", "recurrence", "relaxation", "demon"] {
        experiment("entropy", &[("process", process), ("particles", "30"), ("replicas", "2")], 0.5);
    }
    for process in ["adiabat", "piston", "warm-walls", "mixture", "isotherms", "isobars"] {
        experiment("ideal-gas", &[("process", process), ("particles", "30"), ("replicas", "3"), ("duration", "5")], 0.5);
    }
    experiment(
        "brownian",
        &[("sweep", "mass"), ("masses", "10,20"), ("particles", "60"), ("replicas", "2"), ("duration", "12")],
        0.5,
    );
}

#[test]
fn every_experiment() {
    for name in REGISTRY.iter().map(|experiment| experiment.name) {
        let (values, share): (&[(&str, &str)], f64) = match name {
            "brownian" => (&[("replicas", "3"), ("particles", "80"), ("duration", "30")], 1.0),
            "entropy" => (&[("replicas", "3"), ("particles", "60"), ("reverse_at", "4")], 1.0),
            "ideal-gas" => (&[("particles", "60"), ("replicas", "3"), ("duration", "30")], 1.0),
            "three-body" => (&[("preset", "lagrange")], 0.3),
            "atmosphere" => (&[("replicas", "2"), ("particles", "40"), ("heavy_particles", "20"), ("duration", "12")], 1.0),
            "billiard" => (&[("replicas", "2"), ("scatterers", "20"), ("particles", "5"), ("duration", "8")], 1.0),
            "lennard-jones" => (&[("particles", "256"), ("duration", "6")], 1.0),
            "granular" => (&[("replicas", "2"), ("particles", "50"), ("crowd", "100"), ("duration", "5")], 1.0),
            "sound" => (&[("replicas", "3"), ("particles", "100"), ("duration", "0.6")], 1.0),
            "galton" => (&[("replicas", "4"), ("balls", "60")], 1.0),
            "diffusion" => (&[("replicas", "3"), ("particles", "150"), ("duration", "0.6")], 1.0),
            "engines" => (&[("replicas", "3"), ("particles", "40"), ("duration", "6")], 1.0),
            "hard-disk-melting" => {
                (&[("side", "8"), ("small_side", "8"), ("packings", "0.6,0.7"), ("replicas", "2"), ("duration", "4")], 1.0)
            }
            _ => (&[], 1.0),
        };
        assert_frame(name, experiment(name, values, share));
    }
}

#[test]
fn other_settings() {
    experiment("brownian", &[("replicas", "2"), ("particles", "60"), ("dimension", "3"), ("duration", "12")], 1.0);
    experiment("three-body", &[("preset", "pythagorean"), ("integrator", "velocity-verlet")], 0.1);
    experiment("three-body", &[("show", "basins"), ("resolution", "40"), ("duration", "6")], 1.0);
    experiment("wave", &[("start", "drive")], 0.5);
    for preset in ["matched-end", "damped-mode", "resonance"] {
        experiment("wave", &[("preset", preset), ("masses", "20"), ("mode", "2"), ("pulse_width", "1")], 1.0);
    }
    experiment("lennard-jones", &[("state", "solid"), ("particles", "256"), ("duration", "6")], 1.0);
    experiment("newton-cradle", &[("masses", "1,3,0.5,2"), ("lifted", "1"), ("restitution", "0.8")], 1.0);
    experiment("atmosphere", &[("replicas", "2"), ("particles", "20"), ("floor", "insulating"), ("duration", "12")], 1.0);
}

/// Experiments in a room of their own, which are none of an engine's particles: they once had no frames.
#[test]
fn other_rooms_have_particles_too() {
    for (name, preset, given, share) in [
        ("three-body", "restricted", &[("grains", "4"), ("duration", "9")][..], 1.0),
        ("wave", "fermi-pasta", &[], 0.05),
        ("wave", "solitons", &[], 0.2),
        ("wave", "two-sources", &[], 0.1),
        ("wave", "double-slit", &[], 0.1),
    ] {
        assert_frame(preset, experiment(name, &[&[("preset", preset)], given].concat(), share));
    }
}

#[test]
fn free_systems() {
    for (name, text) in SYSTEMS {
        let system: free::System = toml::from_str(text).unwrap();
        assert_frame(name, compare(name, &|| free::start(&system, 3).unwrap(), 1.0));
    }
}

/// Hard particles that overlap, or gain energy, and anything that is no number: not a run to go on with. An integrator's own
/// error is another matter.
#[test]
fn a_broken_invariant_is_seen() {
    let hard =
        |overlap: f64, drift: f64| Honesty { largest_overlap: Some(overlap), energy_drift: Some(drift), ..Honesty::default() };
    assert_eq!(hard(6e-16, 2.3e-12).broken(), None);
    assert!(hard(1e-3, 1e-12).broken().unwrap().contains("overlap is 1.0e-3"));
    assert!(hard(1e-15, 1e-3).broken().unwrap().contains("energy drift"));
    assert!(hard(f64::NAN, 0.0).broken().unwrap().contains("NaN"));
    let soft = |drift: f64| Honesty { energy_drift: Some(drift), ..Honesty::default() };
    assert_eq!(soft(1e-3).broken(), None);
    assert!(soft(f64::INFINITY).broken().is_some());
}

const SYSTEMS: [(&str, &str); 3] = [
    (
        "gas",
        "engine = \"event\"\nduration = 20.0\nobserve = [\"temperature\", \"pressure\", \"speeds\", \"radial-distribution\", \
         \"mean-squared-displacement\"]\n[box]\nlower = [0.0, 0.0]\nupper = [12.0, 12.0]\nfaces = \"periodic\"\n\
         [[species]]\ncount = 120\nradius = 0.4\n",
    ),
    (
        "fall",
        "engine = \"event\"\nduration = 8.0\nfield = [0.0, 0.0, -1.0]\nobserve = [\"temperature\"]\n[collisions]\nrestitution = 0.9\nelastic_below = 0.01\n\
         [box]\nlower = [0.0, 0.0, 0.0]\nupper = [8.0, 8.0, 8.0]\nfaces = \"walls\"\n[[species]]\ncount = 60\nradius = 0.5\n\
         [[particle]]\nposition = [4.0, 4.0, 4.0]\nradius = 0.4\ntrail = true\n",
    ),
    (
        "argon",
        "engine = \"time\"\nduration = 2.0\nobserve = [\"temperature\", \"pressure\"]\n[integrator]\nname = \"velocity-verlet\"\n\
         time_step = 0.005\n[box]\nlower = [0.0, 0.0]\nupper = [14.0, 14.0]\nfaces = \"periodic\"\n[[species]]\ncount = 100\n\
         radius = 0.5\ntemperature = 0.7\n[forces.lennard_jones]\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n",
    ),
];
