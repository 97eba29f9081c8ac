use corpuscle_core::{Engine, Random};

use super::*;
use crate::{Drive, Integrator, Pin, Signal, TimeDriven, UniformField};

/// A net with springs in both directions, in shuffled order and with ends swapped; and a few across, or as many along both diagonals.
fn net(side: usize, like: Spring, regular: bool) -> (Particles<2>, Vec<Spring>) {
    let mut random = Random::new(4, 0);
    let mut beads = Particles::new();
    let mut springs = vec![];
    for i in 0..side * side {
        // Half of the net is of equal masses.
        let mass = if i < side * side / 2 { 0.7 } else { 0.5 + random.uniform() };
        let place = Vector::from_fn(|k| [(i % side) as f64, (i / side) as f64][k] + 0.2 * random.normal());
        beads.push(place, Vector::from_fn(|_| random.normal()), mass, 0.0, 0);
        let (first, last) = (i.is_multiple_of(side), (i + 1).is_multiple_of(side));
        let across = [
            (i + 2 * side + 3, !regular && i.is_multiple_of(5)),
            (i + side + 1, regular && !last),
            (i + side - 1, regular && !first),
        ];
        for (neighbour, there) in [(i + 1, !last), (i + side, true)].into_iter().chain(across) {
            if there && neighbour < side * side {
                let (first, second) = if random.below(2) == 0 { (i, neighbour) } else { (neighbour, i) };
                springs.push(Spring { first, second, ..like });
            }
        }
    }
    random.shuffle(&mut springs);
    (beads, springs)
}

/// Every kind of spring against a loop over the list as it was given.
#[test]
fn runs_are_the_springs_they_were_made_of() {
    let hooke = Spring::new(0, 1, 1.3, 0.0);
    for (like, regular) in [
        (hooke, false),
        (hooke, true),
        (Spring { rest_length: 0.8, ..hooke }, true),
        (Spring { damping: 0.3, ..hooke }, false),
        (Spring { rest_length: 0.8, quadratic: 0.25, cubic: 0.1, damping: 0.2, ..hooke }, false),
    ] {
        let (beads, springs) = net(67, like, regular);
        let boundary = Boundary::new([-2.0; 2], [70.0; 2], Axis::Open);
        let mut expected = vec![(Vector::ZERO, 0.0); beads.len()];
        for spring in &springs {
            let (first, second) = (spring.first, spring.second);
            let r = beads.position[second] - beads.position[first];
            let mut force = spring.elastic(r);
            if spring.damping != 0.0 {
                force += spring.friction(r, beads.velocity[second] - beads.velocity[first]);
            }
            for (end, sign) in [(first, -1.0), (second, 1.0)] {
                expected[end].0 += force * (sign / beads.mass[end]);
                expected[end].1 += force.norm() / beads.mass[end];
            }
        }
        let mut force = Springs::new(springs);
        assert_eq!(force.lattice.is_some(), regular && like == hooke);
        let mut results = vec![];
        for instructions in Instructions::all() {
            force.instructions = instructions;
            if let Some(lattice) = &mut force.lattice {
                lattice.instructions = instructions;
            }
            let mut found = vec![Vector::ZERO; beads.len()];
            force.accelerate(0.0, &boundary, &beads, &mut found);
            for (i, (expected, size)) in expected.iter().enumerate() {
                // Up to ten terms in another order.
                assert!((found[i] - *expected).norm() <= 10.0 * 4.0 * f64::EPSILON * size, "{i}: {:?} {expected:?}", found[i]);
            }
            results.push(found);
        }
        assert!(results.iter().all(|found| *found == results[0]), "bits depend on the instruction set");
    }
}

/// Beside another force all accelerations are found and kept; else they are found as particles move, in several steps at once unless
/// somebody stops after each. Any way, on any number of threads, the bits are the same.
#[test]
fn particles_move_while_springs_are_stretched() {
    let hooke = Spring::new(0, 1, 1.3, 0.0);
    // More than a few blocks, and enough for threads.
    let stiff = Spring { rest_length: 0.8, ..hooke };
    for (side, like, regular) in [
        (12, hooke, false),
        (67, stiff, false),
        (67, hooke, true),
        (170, hooke, false),
        (170, hooke, true),
        (170, Spring { cubic: 0.1, ..hooke }, false),
    ] {
        for (axis, alike) in [(Axis::Open, false), (Axis::Open, true), (Axis::Periodic, false)] {
            let engine = |integrator, accompanied: bool| {
                let (mut beads, springs) = net(side, like, regular);
                if alike {
                    beads.mass.fill(0.7);
                }
                let boundary = Boundary::new([-4.0; 2], [side as f64 + 4.0; 2], axis);
                let pins = (0..side).rev().map(|x| Pin { particle: x * side + 7, axes: [true, x % 2 == 0] }).collect();
                let signal = Signal::Sine { amplitude: 0.5, angular_frequency: 1.0, phase: 0.3, ramp: 0.0 };
                // One of what is pinned, too: it is driven.
                let drives = [(5, 1), (7, 0)].map(|(particle, axis)| Drive { particle, axis, signal });
                let drives = if axis == Axis::Open { drives.to_vec() } else { vec![] };
                let mut forces: Vec<Box<dyn Force<2>>> = vec![Box::new(Springs::new(springs))];
                if accompanied {
                    forces.push(Box::new(UniformField::new(Vector::ZERO)));
                }
                let engine = TimeDriven::new(boundary, beads, forces, integrator).unwrap();
                engine.with_pins(pins).unwrap().with_drives(drives).unwrap()
            };
            for integrator in [Integrator::VelocityVerlet { dt: 0.02 }, Integrator::Yoshida4 { dt: 0.02 }] {
                // Half-way somebody makes one mass another, and puts what is held elsewhere.
                let go = |engine: &mut TimeDriven<2>, stop_every: u64| {
                    for end in [19, 30] {
                        while engine.steps() < end {
                            let to = 0.02 * (engine.steps() + stop_every).min(end) as f64;
                            engine.advance(to, &mut ()).unwrap();
                        }
                        let change = |beads: &mut Particles<2>| {
                            beads.mass[side + 3] = 0.9;
                            beads.position[2 * side + 7] += Vector([0.1, -0.2]);
                        };
                        engine.edit(change).unwrap();
                    }
                };
                let mut expected = engine(integrator, true);
                go(&mut expected, 19);
                for (threads, stop_every) in [(1, 19), (2, 19), (3, 19), (1, 1), (2, 1), (3, 7)] {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    let mut found = engine(integrator, false);
                    pool.install(|| go(&mut found, stop_every));
                    let how = format!("{threads} threads, a stop every {stop_every}");
                    let same = bits(found.particles()) == bits(expected.particles());
                    assert!(same, "{side}, {axis:?}, {}, {how}", integrator.name());
                }
            }
        }
    }
}

/// Positions and velocities; a comparison of numbers would not tell the signs of zeros.
fn bits(particles: &Particles<2>) -> Vec<u64> {
    [&particles.position, &particles.velocity].iter().flat_map(|all| Vector::components(all)).map(|x| x.to_bits()).collect()
}

#[test]
fn a_membrane_is_a_few_runs() {
    let (side, springs) = (100, membrane(100));
    let runs = Run::all(&springs, NEAR);
    assert!(runs.len() < 2 * side, "{} runs", runs.len());
    assert_eq!(runs.iter().map(|run| run.springs().count()).sum::<usize>(), springs.len());
}

/// All within the rim is one stretch, the two ends of rows that meet in memory are exceptions; each side and each corner is another.
#[test]
fn a_membrane_is_a_few_stretches() {
    let lattice = Lattice::new(&membrane(100)).unwrap();
    let within = lattice.stretches.iter().find(|stretch| stretch.particles.contains(&5050)).unwrap();
    assert_eq!(within.particles, 101..9899);
    assert_eq!(lattice.stretches.len(), 9);
    let exceptions = lattice.exceptions(&[]);
    assert_eq!(exceptions.len(), 2 * 97);
    assert!(exceptions.iter().all(|exception| lattice.neighbours(exception.neighbours.as_ref().unwrap()).len() == 3));
    // Particles held still are exceptions, too, each of them once.
    let still = [0, 200, 5050, 9999];
    let with_still = lattice.exceptions(&still);
    assert!(with_still.is_sorted_by(|one, next| one.particle < next.particle));
    assert_eq!(with_still.len(), exceptions.len() + 3);
    let kept: Vec<_> = with_still.iter().filter(|exception| exception.neighbours.is_none()).map(|one| one.particle).collect();
    assert_eq!(kept, still);
}

fn membrane(side: usize) -> Vec<Spring> {
    let mut springs = vec![];
    for i in 0..side * side {
        if i % side > 0 {
            springs.push(Spring::new(i - 1, i, 1.0, 0.0));
        }
        if i >= side {
            springs.push(Spring::new(i - side, i, 1.0, 0.0));
        }
    }
    springs
}

/// Central differences of the energy: truncation `h^2 U'''/6` and rounding `U eps/h`, both below `1e-8` here.
#[test]
fn tension_is_the_slope_of_the_energy() {
    for spring in [Spring::new(0, 1, 2.0, 0.7), Spring { quadratic: 0.25, cubic: 0.4, ..Spring::new(0, 1, 2.0, 0.7) }] {
        for step in 1..30 {
            let (length, h) = (0.1 * f64::from(step), 1e-5);
            let slope = (spring.energy(length + h) - spring.energy(length - h)) / (2.0 * h);
            assert!((spring.elastic(Vector([length, 0.0]))[0] + slope).abs() < 1e-8, "{spring:?} at {length}");
        }
    }
}
