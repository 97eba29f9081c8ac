//! Trajectories as fingerprints: the same bits on every machine, in debug and release, on any number of threads. A change of
//! these numbers is a change of what the engine computes, and has to be meant.

use std::process::Command;

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_time::{
    Drive, Force, Gravity, Integrator, LennardJones, PairForce, Pin, Signal, Spring, Springs, TimeDriven, WeeksChandlerAndersen,
};

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

/// So many particles in a box ten wide.
fn fluid<const D: usize>(
    (count, axes): (usize, [Axis; D]),
    force: fn() -> Box<dyn Force<D>>,
    integrator: Integrator,
) -> impl Fn() -> TimeDriven<D> {
    move || {
        let boundary = Boundary { axes, ..Boundary::<D>::new([0.0; D], [10.0; D], Axis::Walls) };
        let mut random = Random::new(62, 0);
        let mut particles = Particles::new();
        for place in lattice(&boundary, count, 0.5, &mut random, |_| true).unwrap() {
            particles.push(place, Vector::ZERO, 1.0, 0.3, 0);
        }
        maxwell(&mut particles, 1.0, true, &mut random);
        TimeDriven::new(boundary, particles, vec![force()], integrator).unwrap()
    }
}

fn lennard_jones<const D: usize>() -> Box<dyn Force<D>> {
    Box::new(PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 }))
}

fn wca<const D: usize>() -> Box<dyn Force<D>> {
    Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0)))
}

const STEP: f64 = 0.004;

#[test]
fn of_a_periodic_fluid() {
    let verlet = Integrator::VelocityVerlet { dt: STEP };
    check("periodic", fluid((500, [Axis::Periodic; 3]), lennard_jones, verlet), 0.8, PERIODIC);
}

#[test]
fn of_a_periodic_fluid_in_the_plane() {
    let verlet = Integrator::VelocityVerlet { dt: STEP };
    check("plane", fluid((64, [Axis::Periodic; 2]), lennard_jones, verlet), 4.0, PERIODIC_PLANE);
}

#[test]
fn of_a_fluid_between_walls() {
    check("walls", fluid((500, [Axis::Walls; 3]), wca, Integrator::Yoshida4 { dt: STEP }), 0.4, WALLS);
}

#[test]
fn of_a_fluid_between_walls_in_the_plane() {
    check("walls", fluid((64, [Axis::Walls; 2]), wca, Integrator::RungeKutta4 { dt: STEP }), 4.0, WALLS_PLANE);
}

#[test]
fn of_a_mixed_box() {
    let axes = [Axis::Walls, Axis::Periodic, Axis::Open];
    check("mixed", fluid((500, axes), lennard_jones, Integrator::VelocityVerlet { dt: STEP }), 0.4, MIXED);
}

#[test]
fn of_a_mixed_box_in_the_plane() {
    let axes = [Axis::Periodic, Axis::Walls];
    check("mixed", fluid((64, axes), wca, Integrator::Yoshida6 { dt: STEP }), 4.0, MIXED_PLANE);
}

#[test]
fn of_a_heat_bath() {
    let bath = Integrator::Langevin { dt: STEP, temperature: 1.0, friction: 1.0, seed: 3 };
    check("bath", fluid((500, [Axis::Periodic; 3]), lennard_jones, bath), 0.4, BATH);
}

/// The same numbers with fewer instructions than this machine has: each in a process of its own, since they are chosen once.
#[test]
fn whatever_the_instructions() {
    for instructions in ["plain", "avx2"] {
        let mut command = Command::new(std::env::current_exe().unwrap());
        let output = command.arg("golden::of_").env("CORPUSCLE_INSTRUCTIONS", instructions).output().unwrap();
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

/// Large enough for several steps in one sweep, and for threads.
#[test]
fn of_a_membrane() {
    let (width, height) = (200, 150);
    let membrane = || {
        let mut particles = Particles::<3>::new();
        let mut random = Random::new(64, 0);
        let (mut springs, mut rim) = (vec![], vec![]);
        for k in 0..width * height {
            let (x, y) = (k % width, k / width);
            particles.push(Vector([x as f64, y as f64, random.normal()]), Vector::ZERO, 1.0, 0.0, 0);
            springs.extend((x > 0).then(|| Spring::new(k - 1, k, 1.0, 0.0)));
            springs.extend((y > 0).then(|| Spring::new(k - width, k, 0.7, 0.0)));
            if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
                rim.push(Pin { particle: k, axes: [true; 3] });
            }
        }
        let signal = Signal::Sine { amplitude: 2.0, angular_frequency: 0.5, phase: 0.0, ramp: 3.0 };
        let drive = Drive { particle: 75 * width + 60, axis: 2, signal };
        let space = Boundary::new([0.0; 3], [width as f64; 3], Axis::Open);
        let engine =
            TimeDriven::new(space, particles, vec![Box::new(Springs::new(springs))], Integrator::VelocityVerlet { dt: 0.1 });
        engine.unwrap().with_pins(rim).unwrap().with_drives(vec![drive]).unwrap()
    };
    check("membrane", membrane, 10.0, MEMBRANE);
}

const PERIODIC: u64 = 0xcd6e_49b6_2597_2bff;
const PERIODIC_PLANE: u64 = 0x366a_b24b_730a_7adc;
const WALLS_PLANE: u64 = 0xbbac_8b3d_cf8c_5665;
const MIXED: u64 = 0xa5b8_a7ae_4ff8_8e17;
const MIXED_PLANE: u64 = 0x40e5_0b67_199f_02a3;
const WALLS: u64 = 0xf5dd_8703_0956_5931;
const BATH: u64 = 0x5fb8_fa74_ed10_2285;
const STARS: u64 = 0x4be0_a82f_11f7_8a0b;
const STARS_AGAIN: u64 = 0xc3f5_84b5_601f_84bf;
const CHAIN: u64 = 0xe683_801f_25ae_9276;
const MEMBRANE: u64 = 0x950d_36f2_1b4c_e9fc;
