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
                let drives = if axis == Axis::Open { vec![Drive { particle: 5, axis: 1, signal }] } else { vec![] };
                let mut forces: Vec<Box<dyn Force<2>>> = vec![Box::new(Springs::new(springs))];
                if accompanied {
                    forces.push(Box::new(UniformField::new(Vector::ZERO)));
                }
                let engine = TimeDriven::new(boundary, beads, forces, integrator).unwrap();
                engine.with_pins(pins).unwrap().with_drives(drives).unwrap()
            };
            for integrator in [Integrator::VelocityVerlet { dt: 0.02 }, Integrator::Yoshida4 { dt: 0.02 }] {
                let mut expected = engine(integrator, true);
                expected.advance(0.38, &mut ()).unwrap();
                for (threads, stop_every) in [(1, 19), (2, 19), (3, 19), (1, 1), (2, 1), (3, 7)] {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    let mut found = engine(integrator, false);
                    while found.steps() < 19 {
                        let to = 0.02 * (found.steps() + stop_every).min(19) as f64;
                        pool.install(|| found.advance(to, &mut ())).unwrap();
                    }
                    let how = format!("{threads} threads, a stop every {stop_every}");
                    assert!(found.particles() == expected.particles(), "{side}, {axis:?}, {}, {how}", integrator.name());
                }
            }
        }
    }
}

#[test]
fn a_membrane_is_a_few_runs() {
    let side = 100;
    let mut springs = vec![];
    for i in 0..side * side {
        if i % side > 0 {
            springs.push(Spring::new(i - 1, i, 1.0, 0.0));
        }
        if i >= side {
            springs.push(Spring::new(i - side, i, 1.0, 0.0));
        }
    }
    let runs = Run::all(&springs, NEAR);
    assert!(runs.len() < 2 * side, "{} runs", runs.len());
    assert_eq!(runs.iter().map(|run| run.springs().count()).sum::<usize>(), springs.len());
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
