//! Trajectories as fingerprints: the same bits on every machine, in debug and release, with any vector instructions, however the
//! run is cut up. A change of these numbers is a change of what the engine computes, and has to be meant.

use std::process::Command;

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Engine, Hole, Motion, Obstacle, Particles, Partition, Piston, Random, Vector};
use corpuscle_event::{EventDriven, Pair, Restitution, Rules};

/// FNV-1a of the bits of all positions, velocities and own times, of the piston, and of the number of contacts.
fn fingerprint<const D: usize>(engine: &EventDriven<D>) -> u64 {
    let counts = engine.counts();
    let particles = (0..engine.particle_count()).map(|i| engine.lazy(i));
    let bits = particles.flat_map(|lazy| [&lazy.position.0[..], &lazy.velocity.0, &[lazy.time]].concat()).map(f64::to_bits);
    let piston = engine.piston().into_iter().flat_map(|piston| [piston.position.to_bits(), piston.velocity.to_bits()]);
    let all = bits.chain(piston).chain([counts.collisions, counts.edges, counts.wall_collisions]);
    all.flat_map(u64::to_le_bytes).fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// Discs or spheres of radius 0.5 and unequal masses, clear of what stands in the box.
fn gas<const D: usize>(boundary: &Boundary<D>, count: usize) -> Particles<D> {
    let mut random = Random::new(61, 0);
    let mut particles = Particles::new();
    let clear = |site: Vector<D>| {
        let mut one = Particles::new();
        one.push(site, Vector::ZERO, 1.0, 0.5, 0);
        boundary.validate_particles(&one).is_ok()
    };
    // Open space has no end; the lattice is given one.
    let mut room = Boundary { axes: boundary.axes, ..Boundary::new(boundary.lower.0, boundary.upper.0, Axis::Walls) };
    for axis in room.axes.iter_mut().filter(|axis| **axis == Axis::Open) {
        *axis = Axis::Walls;
    }
    for place in lattice(&room, count, 0.5, &mut random, clear).unwrap() {
        particles.push(place, Vector::ZERO, 1.0 + random.uniform(), 0.5, 0);
    }
    maxwell(&mut particles, 1.0, boundary.conserves_momentum(), &mut random);
    particles
}

/// Runs to `end` at once and in uneven pieces: both must leave this fingerprint. Answers what is wrong.
fn check<const D: usize>(
    name: &str,
    boundary: Boundary<D>,
    rules: Rules<D>,
    count: usize,
    end: f64,
    golden: u64,
) -> Option<String> {
    let particles = gas(&boundary, count);
    let mut whole = EventDriven::new(boundary, particles, rules).unwrap();
    let mut pieces = whole.clone();
    whole.advance(end, &mut ()).unwrap();
    for piece in 1..=37 {
        pieces.advance(end * f64::from(piece * piece) / (37.0 * 37.0), &mut ()).unwrap();
    }
    let (whole, pieces) = (fingerprint(&whole), fingerprint(&pieces));
    assert_eq!(whole, pieces, "{name} in {D}-D: cut up it is another");
    (whole != golden).then(|| format!("{name} in {D}-D: it was {golden:#018x} and is {whole:#018x}"))
}

/// The fingerprints of one kind of box in the plane and in space.
fn both(name: &str, kind: &impl Kind, golden: [u64; 2]) -> Vec<String> {
    let (plane, space) = (kind.of::<2>(), kind.of::<3>());
    let plane = check(name, plane.0, plane.1, 80, 20.0, golden[0]);
    plane.into_iter().chain(check(name, space.0, space.1, 240, 12.0, golden[1])).collect()
}

/// A box and rules of the same kind in either dimension.
trait Kind {
    fn of<const D: usize>(&self) -> (Boundary<D>, Rules<D>);
}

macro_rules! kinds {
    ($($kind:ident |$boundary:ident, $rules:ident| $set_up:block)*) => {$(
        struct $kind;
        impl Kind for $kind {
            fn of<const D: usize>(&self) -> (Boundary<D>, Rules<D>) {
                #[allow(unused_mut, reason = "not every kind changes both")]
                let (mut $boundary, mut $rules) = (Boundary::<D>::new([0.0; D], [12.0; D], Axis::Walls), Rules { seed: 5, ..Rules::default() });
                $set_up
                ($boundary, $rules)
            }
        }
    )*};
}

kinds! {
    Reflecting |boundary, rules| {}
    Mixed |boundary, rules| { boundary.axes[0] = Axis::Periodic; rules.field[1] = -0.3; }
    Warm |boundary, rules| {
        boundary.faces[0][0].temperature = Some(0.5);
        boundary.faces[0][1].temperature = Some(2.0);
    }
    Moving |boundary, rules| {
        boundary.faces[0][0].motion = Some(Motion::Oscillation { centre: 0.3, amplitude: 0.3, angular_frequency: 2.0, phase: -1.5 });
        boundary.faces[1][1].motion = Some(Motion::Path(vec![(1.0, 12.0), (5.0, 11.5), (8.0, 11.8)]));
    }
    Opening |boundary, rules| {
        boundary.partitions.push(Partition { hole: Some(Hole { along: 1, from: 5.0, to: 7.5 }), ..Partition::new(0, 6.0) });
        boundary.partitions[0].removed_at = Some(4.0);
        boundary.faces[1][1].opened_at = Some(9.0);
    }
    Furnished |boundary, rules| {
        let at = |x: f64, y: f64| Vector::from_fn(|k| if k == 0 { x } else { y });
        boundary.obstacles = vec![
            Obstacle { centre: at(3.0, 4.0), radius: 0.8 },
            Obstacle { centre: at(9.0, 5.0), radius: 0.3 },
            Obstacle { centre: at(6.0, 9.0), radius: 0.0 },
        ];
        rules.field[1] = -0.5;
    }
    OpenSpace |boundary, rules| { boundary.axes = [Axis::Open; D]; rules.field[0] = 0.2; }
    Wells |boundary, rules| { boundary.axes = [Axis::Periodic; D]; rules.pair = Pair::Well { range: 1.3, depth: 0.6 }; }
    Shoulders |boundary, rules| { rules.pair = Pair::Well { range: 1.2, depth: -0.8 }; }
    Pushed |boundary, rules| {
        boundary.piston = Some(Piston { axis: 0, position: 6.0, velocity: 0.2, mass: 20.0, force: -1.0, stops: [0.5, 11.5] });
        boundary.faces[0][0].temperature = Some(1.5);
    }
    Grains |boundary, rules| {
        rules.restitution = Restitution::Viscoelastic { stiffness: 20.0, dissipation_time: 0.03 };
        rules.elastic_below = 0.05;
        rules.field[1] = -0.2;
    }
}

#[test]
fn of_a_periodic_gas() {
    let wrong = [
        check("cells", Boundary::<3>::periodic(12.0), Rules::default(), 300, 30.0, CELLS),
        check("lists", Boundary::<2>::periodic(12.0), Rules::default(), 120, 30.0, LISTS),
    ];
    assert_eq!(wrong, [None, None]);
}

const CELLS: u64 = 0x60ab_9c8c_37fa_03a5;
const LISTS: u64 = 0xb3aa_6ba7_8010_b416;

#[test]
fn of_every_kind_of_box() {
    let wrong: Vec<String> = [
        both("reflecting walls", &Reflecting, REFLECTING),
        both("a periodic axis between walls, and a field", &Mixed, MIXED),
        both("warm walls", &Warm, WARM),
        both("moving walls", &Moving, MOVING),
        both("a plate with a hole that goes, a wall that opens", &Opening, OPENING),
        both("obstacles in a field", &Furnished, FURNISHED),
        both("open space", &OpenSpace, OPEN),
        both("square wells", &Wells, WELLS),
        both("square shoulders between walls", &Shoulders, SHOULDERS),
        both("a loaded piston on a warm gas", &Pushed, PISTON),
        both("viscoelastic grains in a field", &Grains, GRAINS),
    ]
    .concat();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
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

const REFLECTING: [u64; 2] = [0x7a9b_892f_fe76_74a4, 0x53f9_8762_f8fa_8b7f];
const MIXED: [u64; 2] = [0x42e7_c38d_02d6_1286, 0xf050_7edb_dfd4_43da];
const WARM: [u64; 2] = [0xe74a_9d15_0b5a_c1d0, 0x4872_b8bb_9737_e3b1];
const MOVING: [u64; 2] = [0xb367_5f49_a52e_3413, 0x9f24_6a0f_4a66_fead];
const OPENING: [u64; 2] = [0xcda2_857e_f915_f681, 0xd2a3_9bcc_04ef_764f];
const FURNISHED: [u64; 2] = [0xcbdb_29be_e348_3aa2, 0x6644_de3c_cf83_2c30];
const OPEN: [u64; 2] = [0x737e_111a_2fb2_8a99, 0x5311_aca8_ed3f_0cb1];
const WELLS: [u64; 2] = [0xf58c_0ea9_e514_e7e6, 0x9efb_b394_6b8d_2140];
const SHOULDERS: [u64; 2] = [0xd8b2_5797_f196_24ab, 0x1b9a_2ee1_69ca_06f9];
const PISTON: [u64; 2] = [0xa5c2_569c_cc8d_9c00, 0x1da1_93a9_4a52_5c2f];
const GRAINS: [u64; 2] = [0xb601_9998_b029_2919, 0x93ea_4a22_c086_de47];
