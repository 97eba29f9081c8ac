#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Piston};
use corpuscle_event::Rules;
use corpuscle_time::{Integrator, WeeksChandlerAndersen};
use proptest::prelude::*;

use super::*;

/// A gas dense enough that hardly any place is free: packing 0.5 in the plane, 0.3 in space.
fn gas<const D: usize>(axis: Axis, seed: u64) -> EventDriven<D> {
    let side = if D == 2 { 12.53 } else { 6.0 };
    let boundary = Boundary::new([0.0; D], [side; D], axis);
    let mut random = Random::new(seed, 1);
    let mut particles = Particles::new();
    for site in lattice(&boundary, if D == 2 { 100 } else { 124 }, 0.5, &mut random, |_| true).unwrap() {
        particles.push(site, Vector::ZERO, 1.0, 0.5, 0);
    }
    maxwell(&mut particles, 1.0, false, &mut random);
    let mut engine = EventDriven::new(boundary, particles, Rules::default()).unwrap();
    engine.advance(1.0, &mut ()).unwrap();
    engine
}

/// Whatever was done, nothing overlaps, now and after many more collisions, and the engine goes on to have them.
fn sound<const D: usize>(engine: &mut EventDriven<D>) {
    let overlap = |engine: &EventDriven<D>| engine.boundary().largest_overlap(&engine.snapshot());
    assert!(overlap(engine) < 1e-9, "{}", overlap(engine));
    let before = engine.counts().collisions;
    engine.advance(engine.time() + 2.0, &mut ()).unwrap();
    assert!(engine.counts().collisions > before + 50);
    assert!(overlap(engine) < 1e-9, "{} later", overlap(engine));
    present(engine).validate_particles_at(engine.time(), &engine.snapshot()).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Carried to wherever a person points, in or out of the box: a legal state, or a refusal that changes nothing.
    #[test]
    fn a_body_is_carried_to_a_legal_place(x in -2.0..15.0, y in -2.0..15.0, walls: bool, seed in 0u64..50, body in 0usize..100) {
        let mut engine = gas::<2>(if walls { Axis::Walls } else { Axis::Periodic }, seed);
        let (before, energy) = (engine.snapshot(), engine.kinetic_energy());
        if on_hard(&mut engine, Action::Place { body, at: [x, y, 0.0] }).is_ok() {
                let way = engine.boundary().displacement(engine.position(body), engine.boundary().wrap(Vector([x, y])));
                prop_assert!(way.norm() < 8.5, "it is near where it was wanted: {way:?}");
                prop_assert!((engine.kinetic_energy() - energy).abs() < 1e-12 * energy);
        } else {
            prop_assert_eq!(engine.snapshot(), before);
        }
        sound(&mut engine);
    }

    #[test]
    fn a_body_is_carried_in_space(at in proptest::array::uniform3(0.0..6.0), seed in 0u64..50) {
        let mut engine = gas::<3>(Axis::Periodic, seed);
        on_hard(&mut engine, Action::Place { body: 7, at }).unwrap();
        sound(&mut engine);
    }

    /// A plate through a dense gas: those it would cut make room, with a hole or without.
    #[test]
    fn a_partition_comes_into_a_dense_gas(at in 0.7..11.8, hole: bool, axis in 0usize..2, seed in 0u64..50) {
        let mut engine = gas::<2>(Axis::Walls, seed);
        let (before, energy) = (engine.snapshot(), engine.kinetic_energy());
        if on_hard(&mut engine, Action::Partition { axis, at, hole: hole.then_some(3.0) }).is_ok() {
                prop_assert_eq!(engine.boundary().partitions.len(), 1);
                prop_assert!((engine.kinetic_energy() - energy).abs() < 1e-12 * energy);
                sound(&mut engine);
                on_hard(&mut engine, Action::OpenPartitions).unwrap();
        } else {
            prop_assert_eq!(engine.snapshot(), before);
        }
        sound(&mut engine);
    }
}

#[test]
fn a_thrown_body_has_its_new_velocity_and_meets_others_by_it() {
    let mut engine = gas::<2>(Axis::Walls, 3);
    on_hard(&mut engine, Action::Throw { body: 4, velocity: [30.0, -7.0, 99.0] }).unwrap();
    assert_eq!(engine.velocity(4), Vector([30.0, -7.0]));
    sound(&mut engine);
    assert!(on_hard(&mut engine, Action::Throw { body: 4, velocity: [f64::NAN, 0.0, 0.0] }).is_err());
    assert!(on_hard(&mut engine, Action::Throw { body: 100, velocity: [0.0; 3] }).is_err());
}

/// `<theta^2> = strength^2` in the plane for small angles; each speed stays to rounding.
#[test]
fn a_disturbance_turns_velocities_by_the_angle_asked_for() {
    let strength = 1e-3;
    let mut sum = [0.0; 2];
    for seed in 0..20 {
        let mut engine = gas::<2>(Axis::Walls, seed);
        let before = engine.snapshot();
        on_hard(&mut engine, Action::Disturb { strength, seed }).unwrap();
        for (v, w) in before.velocity.iter().zip(engine.snapshot().velocity) {
            assert!((v.norm() - w.norm()).abs() < 1e-14 * v.norm());
            let angle = (v[0] * w[1] - v[1] * w[0]) / v.norm_squared();
            sum = [sum[0] + angle * angle, sum[1] + 1.0];
        }
        sound(&mut engine);
    }
    // The variance of a normal variance estimate over n angles is 2/n of its square.
    let z = (sum[0] / (sum[1] * strength * strength) - 1.0) / (2.0 / sum[1]).sqrt();
    assert!(z.abs() < 4.0, "z = {z}");
    assert!(on_hard(&mut gas::<2>(Axis::Walls, 1), Action::Disturb { strength: 0.0, seed: 1 }).is_err());
}

#[test]
fn a_heated_wall_heats_and_a_cooled_one_is_only_a_wall_again() {
    let mut engine = gas::<2>(Axis::Walls, 5);
    on_hard(&mut engine, Action::Heat { axis: 0, upper: true, temperature: Some(50.0) }).unwrap();
    sound(&mut engine);
    let hot = engine.kinetic_energy();
    assert!(hot > 400.0, "100 particles began with about 100: {hot}");
    on_hard(&mut engine, Action::Heat { axis: 0, upper: true, temperature: None }).unwrap();
    let before = engine.kinetic_energy();
    sound(&mut engine);
    assert!((engine.kinetic_energy() - before).abs() < 1e-10 * before);
    assert!(on_hard(&mut engine, Action::Heat { axis: 0, upper: true, temperature: Some(-1.0) }).is_err());
    let mut periodic = gas::<2>(Axis::Periodic, 5);
    assert!(on_hard(&mut periodic, Action::Heat { axis: 0, upper: true, temperature: Some(1.0) }).is_err());
}

#[test]
fn bodies_come_and_go() {
    let mut engine = gas::<2>(Axis::Walls, 6);
    let (time, collisions) = (engine.time(), engine.counts().collisions);
    on_hard(&mut engine, Action::Add { at: [3.0, 3.0, 0.0], velocity: [1.0, 2.0, 0.0], like: 8 }).unwrap();
    assert_eq!((engine.particle_count(), engine.time(), engine.counts().collisions), (101, time, collisions));
    assert_eq!(engine.velocity(100), Vector([1.0, 2.0]));
    sound(&mut engine);
    let kept: Vec<_> = (1..101).map(|i| (engine.position(i), engine.velocity(i))).collect();
    on_hard(&mut engine, Action::Remove { body: 0 }).unwrap();
    assert_eq!(kept, (0..100).map(|i| (engine.position(i), engine.velocity(i))).collect::<Vec<_>>());
    sound(&mut engine);
}

/// Carried from one side of a piston to the other, a body pushes it from there.
#[test]
fn a_piston_knows_on_which_side_a_body_is() {
    let mut boundary = Boundary::<2>::new([0.0; 2], [10.0, 4.0], Axis::Walls);
    boundary.piston = Some(Piston { axis: 0, position: 5.0, velocity: 0.0, mass: 10.0, force: 0.0, stops: [1.0, 9.0] });
    let mut particles = Particles::new();
    particles.push(Vector([2.0, 2.0]), Vector([1.0, 0.0]), 1.0, 0.2, 0);
    let mut engine = EventDriven::new(boundary, particles, Rules::default()).unwrap();
    engine.advance(0.5, &mut ()).unwrap();
    on_hard(&mut engine, Action::Place { body: 0, at: [8.0, 2.0, 0.0] }).unwrap();
    on_hard(&mut engine, Action::Throw { body: 0, velocity: [-1.0, 0.0, 0.0] }).unwrap();
    engine.advance(4.0, &mut ()).unwrap();
    assert!(engine.piston().unwrap().velocity < 0.0 && engine.position(0)[0] > engine.piston().unwrap().position);
    on_hard(&mut engine, Action::Push { velocity: [0.5, 9.0, 9.0] }).unwrap();
    assert_eq!(engine.piston().unwrap().velocity, 0.5);
    assert!(on_hard(&mut gas::<2>(Axis::Walls, 1), Action::Push { velocity: [1.0; 3] }).is_err());
}

#[test]
fn soft_particles_are_carried_thrown_added_and_taken_away() {
    let mut random = Random::new(3, 1);
    let boundary = Boundary::<2>::periodic(12.0);
    let mut particles = Particles::new();
    for site in lattice(&boundary, 60, 0.5, &mut random, |_| true).unwrap() {
        particles.push(site, Vector::ZERO, 1.0, 0.5, 0);
    }
    maxwell(&mut particles, 1.0, true, &mut random);
    let forces: Vec<Box<dyn corpuscle_time::Force<2>>> =
        vec![Box::new(corpuscle_time::PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0)))];
    let mut engine = TimeDriven::new(boundary, particles, forces, Integrator::VelocityVerlet { dt: 0.005 }).unwrap();
    engine.advance(1.0, &mut ()).unwrap();
    on_soft(&mut engine, Action::Place { body: 3, at: [6.0, 6.0, 0.0] }).unwrap();
    let near = (0..60).filter(|&j| j != 3).map(|j| {
        let particles = engine.particles();
        engine.boundary().displacement(particles.position[3], particles.position[j]).norm()
    });
    assert!(near.fold(f64::INFINITY, f64::min) >= 1.0);
    on_soft(&mut engine, Action::Throw { body: 3, velocity: [2.0, 0.0, 0.0] }).unwrap();
    on_soft(&mut engine, Action::Add { at: [1.0, 1.0, 0.0], velocity: [0.0; 3], like: 0 }).unwrap();
    on_soft(&mut engine, Action::Remove { body: 5 }).unwrap();
    on_soft(&mut engine, Action::Disturb { strength: 1e-3, seed: 1 }).unwrap();
    let before = engine.energy();
    engine.advance(3.0, &mut ()).unwrap();
    assert_eq!(engine.particles().len(), 60);
    assert!((engine.energy() - before).abs() < 0.02 * engine.kinetic_energy(), "{} {before}", engine.energy());
    assert!(on_soft(&mut engine, Action::Push { velocity: [1.0; 3] }).is_err());
}
