//! Trajectories as fingerprints: the same bits on every machine, in debug and release, on any number of threads. A change of
//! these numbers is a change of what the engine computes, and has to be meant.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::process::Command;

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_time::{Force, Gravity, Integrator, LennardJones, PairForce, Spring, Springs, TimeDriven, WeeksChandlerAndersen};

/// FNV-1a of the bits of all positions and velocities.
fn fingerprint<const D: usize>(particles: &Particles<D>) -> u64 {
    let vectors = particles.position.iter().chain(&particles.velocity);
    let bytes = vectors.flat_map(|vector| vector.0).flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// On one, two and three threads: all must leave this fingerprint.
fn check<const D: usize>(name: &str, set_up: impl Fn() -> TimeDriven<D> + Sync, end: f64, golden: u64) {
    for threads in [1, 2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| {
            let mut engine = set_up();
            engine.advance(end, &mut ()).unwrap();
            fingerprint(engine.particles())
        });
        assert_eq!(found, golden, "{name}, {threads} threads: it was {golden:#018x} and is {found:#018x}");
    }
}

fn fluid(axes: Axis, force: fn() -> Box<dyn Force<3>>, integrator: Integrator) -> impl Fn() -> TimeDriven<3> {
    move || {
        let boundary = Boundary::<3>::new([0.0; 3], [10.0; 3], axes);
        let mut random = Random::new(62, 0);
        let mut particles = Particles::new();
        for place in lattice(&boundary, 500, 0.5, &mut random, |_| true).unwrap() {
            particles.push(place, Vector::ZERO, 1.0, 0.3, 0);
        }
        maxwell(&mut particles, 1.0, true, &mut random);
        TimeDriven::new(boundary, particles, vec![force()], integrator).unwrap()
    }
}

#[test]
fn of_fluids() {
    let dt = 0.004;
    let lennard_jones =
        || -> Box<dyn Force<3>> { Box::new(PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 })) };
    let wca = || -> Box<dyn Force<3>> { Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0))) };
    check("periodic", fluid(Axis::Periodic, lennard_jones, Integrator::VelocityVerlet { dt }), 0.8, PERIODIC);
    check("walls", fluid(Axis::Walls, wca, Integrator::Yoshida4 { dt }), 0.4, WALLS);
    let bath = Integrator::Langevin { dt, temperature: 1.0, friction: 1.0, seed: 3 };
    check("bath", fluid(Axis::Periodic, lennard_jones, bath), 0.4, BATH);
}

/// The same numbers with fewer instructions than this machine has: each in a process of its own, since they are chosen once.
#[test]
fn whatever_the_instructions() {
    for instructions in ["plain", "avx2"] {
        let mut command = Command::new(std::env::current_exe().unwrap());
        let output = command.arg("of_").env("CORPUSCLE_INSTRUCTIONS", instructions).output().unwrap();
        let words = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && words.contains(" passed") && !words.contains(" 0 passed"), "{instructions}: {words}");
    }
}

#[test]
fn of_stars_in_open_space() {
    let stars = |integrator: Integrator| {
        move || {
            let mut particles = Particles::<2>::new();
            for (place, mass) in [([1.0, 3.0], 3.0), ([-2.0, -1.0], 4.0), ([1.0, -1.0], 5.0)] {
                particles.push(Vector(place), Vector::ZERO, mass, 0.0, 0);
            }
            let space = Boundary::new([-100.0; 2], [100.0; 2], Axis::Open);
            TimeDriven::new(space, particles, vec![Box::new(Gravity::new(1.0, 0.0))], integrator).unwrap()
        }
    };
    check("gauss-radau", stars(Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None }), 20.0, STARS);
    check("dormand-prince", stars(Integrator::DormandPrince8 { tolerance: 1e-12, first_step: None }), 20.0, STARS_AGAIN);
}

#[test]
fn of_a_chain() {
    let chain = || {
        let mut particles = Particles::<2>::new();
        let mut random = Random::new(63, 0);
        for k in 0..64 {
            particles.push(Vector([f64::from(k), 0.1 * random.normal()]), Vector::ZERO, 1.0, 0.0, 0);
        }
        let springs = (0..63).map(|k| Spring { quadratic: 0.25, ..Spring::new(k, k + 1, 10.0, 0.8) }).collect();
        let space = Boundary::new([-10.0; 2], [80.0; 2], Axis::Open);
        TimeDriven::new(space, particles, vec![Box::new(Springs::new(springs))], Integrator::Yoshida6 { dt: 0.02 }).unwrap()
    };
    check("chain", chain, 40.0, CHAIN);
}

const PERIODIC: u64 = 0xcd6e_49b6_2597_2bff;
const WALLS: u64 = 0x410f_52cd_a2f4_4ebb;
const BATH: u64 = 0x5fb8_fa74_ed10_2285;
const STARS: u64 = 0x4be0_a82f_11f7_8a0b;
const STARS_AGAIN: u64 = 0xc3f5_84b5_601f_84bf;
const CHAIN: u64 = 0xe683_801f_25ae_9276;
