//! Trajectories as fingerprints: the same bits on every machine, in debug and release, however the run is cut up. A change of
//! these numbers is a change of what the engine computes, and has to be meant.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Boundary, Engine, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};

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

const GAS: u64 = 0x60ab_9c8c_37fa_03a5;
const DISCS: u64 = 0xb3aa_6ba7_8010_b416;
