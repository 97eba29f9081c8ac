//! Trajectories as fingerprints: the same bits on every machine, in debug and release, however the run is cut up. A change of
//! these numbers is a change of what the engine computes, and has to be meant.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Engine, Obstacle, Particles, Piston, Random, Vector};
use corpuscle_event::{EventDriven, Pair, Rules};

/// FNV-1a of the bits of all positions, velocities and own times, and of the number of contacts.
fn fingerprint<const D: usize>(engine: &EventDriven<D>) -> u64 {
    let counts = engine.counts();
    let particles = (0..engine.particle_count()).map(|i| engine.lazy(i));
    let bits = particles.flat_map(|lazy| [&lazy.position.0[..], &lazy.velocity.0, &[lazy.time]].concat()).map(f64::to_bits);
    let all = bits.chain([counts.collisions, counts.edges, counts.wall_collisions]);
    all.flat_map(u64::to_le_bytes).fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

fn gas<const D: usize>(boundary: &Boundary<D>, count: usize, radius: f64) -> Particles<D> {
    let mut random = Random::new(61, 0);
    let mut particles = Particles::new();
    for place in lattice(boundary, count, radius, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0 + random.uniform(), radius, 0);
    }
    maxwell(&mut particles, 1.0, boundary.conserves_momentum(), &mut random);
    particles
}

/// Runs to `end` at once and in uneven pieces: both must leave this fingerprint.
fn check<const D: usize>(name: &str, engine: &EventDriven<D>, end: f64, golden: u64) {
    let (mut whole, mut pieces) = (engine.clone(), engine.clone());
    whole.advance(end, &mut ()).unwrap();
    for piece in 1..=37 {
        pieces.advance(end * f64::from(piece * piece) / (37.0 * 37.0), &mut ()).unwrap();
    }
    let (whole, pieces) = (fingerprint(&whole), fingerprint(&pieces));
    assert_eq!(whole, pieces, "{name}: cut up it is another");
    assert_eq!(whole, golden, "{name}: it was {golden:#018x} and is {whole:#018x}");
}

#[test]
fn of_a_periodic_gas() {
    let boundary = Boundary::<3>::periodic(12.0);
    check("cells", &EventDriven::new(boundary.clone(), gas(&boundary, 300, 0.5), Rules::default()).unwrap(), 30.0, GAS);
    let boundary = Boundary::<2>::periodic(12.0);
    check("lists", &EventDriven::new(boundary.clone(), gas(&boundary, 120, 0.5), Rules::default()).unwrap(), 30.0, DISCS);
}

#[test]
fn of_grains_that_fall_in_a_box() {
    let boundary = Boundary::<2>::new([0.0; 2], [15.0; 2], Axis::Walls);
    let rules = Rules { restitution: 0.9.into(), elastic_below: 1e-3, field: Vector([0.0, -1.0]), ..Rules::default() };
    check("walls", &EventDriven::new(boundary.clone(), gas(&boundary, 80, 0.5), rules).unwrap(), 20.0, GRAINS);
}

#[test]
fn of_a_furnished_box() {
    let mut boundary = Boundary::<2>::new([0.0; 2], [20.0; 2], Axis::Walls);
    boundary.axes[1] = Axis::Periodic;
    boundary.faces[0][0].temperature = Some(2.0);
    boundary.obstacles.push(Obstacle { centre: Vector([5.0, 5.0]), radius: 1.5 });
    let mut left = boundary.clone();
    left.upper[0] = 14.0;
    let mut particles = gas(&left, 60, 0.3);
    let clear = |r: Vector<2>| (r - Vector([5.0, 5.0])).norm() > 2.0;
    let kept: Vec<usize> = (0..particles.len()).filter(|&i| clear(particles.position[i])).collect();
    let mut rest = Particles::new();
    for i in kept {
        rest.push(particles.position[i], particles.velocity[i], particles.mass[i], particles.radius[i], 0);
    }
    particles = rest;
    boundary.piston = Some(Piston { axis: 0, position: 16.0, velocity: 0.0, mass: 20.0, force: -5.0, stops: [2.0, 19.0] });
    let rules = Rules { seed: 9, ..Rules::default() };
    check("furnished", &EventDriven::new(boundary, particles, rules).unwrap(), 30.0, FURNISHED);
}

#[test]
fn of_spheres_in_wells() {
    let boundary = Boundary::<3>::periodic(10.0);
    let rules = Rules { pair: Pair::Well { range: 1.5, depth: 0.8 }, ..Rules::default() };
    check("wells", &EventDriven::new(boundary.clone(), gas(&boundary, 120, 0.5), rules).unwrap(), 15.0, WELLS);
}

const GAS: u64 = 0;
const DISCS: u64 = 0;
const GRAINS: u64 = 0;
const FURNISHED: u64 = 0;
const WELLS: u64 = 0;
