//! Long runs: what a million contacts hide, a thousand million show. `make soak` runs them whole, `make test` a hundredth
//! or a tenth of them.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::common::{face_centred, largest_overlap};
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Observer, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Restitution, Rules};

/// Looks at the system between its parts.
const PARTS: u64 = 50;

/// Counts contacts of every kind, and stops after the last.
struct Contacts(u64);

impl<const D: usize> Observer<D> for Contacts {
    fn contact(&mut self, _: &Contact<D>) -> ControlFlow<()> {
        self.0 -= 1;
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Goes through `contacts` contacts in parts and looks after each: at the clock, which must go on as at the start, and at
/// the deepest overlap, which must stay at rounding level, and at the energy, which no contact may raise.
fn soak<const D: usize>(
    mut engine: EventDriven<D>,
    contacts: u64,
    mut drive: impl FnMut(&mut EventDriven<D>, u64),
    mut look: impl FnMut(&EventDriven<D>) -> String,
) {
    let (started, part) = (Instant::now(), contacts / PARTS);
    let smallest = (0..engine.particle_count()).map(|i| engine.radius(i)).fold(f64::INFINITY, f64::min);
    let mut usual = 0.0;
    for done in 1..=PARTS {
        let (before, energy) = (engine.time(), engine.kinetic_energy() + engine.potential_energy());
        engine.advance(f64::MAX, &mut Contacts(part)).unwrap();
        let gained = engine.time() - before;
        let rise = (engine.kinetic_energy() + engine.potential_energy()) / energy - 1.0;
        assert!(rise < 1e-11, "energy rises by {rise:e}");
        let overlap = largest_overlap(&engine);
        if done % 5 == 0 {
            let (wall, seen) = (started.elapsed().as_secs_f64(), look(&engine));
            println!(
                "{:.2e} contacts, {wall:.0} s: t = {:.6e}, overlap {overlap:.1e}, {seen}",
                (done * part) as f64,
                engine.time()
            );
        }
        assert!(overlap < 1e-9 * smallest, "spheres overlap by {overlap:e}");
        if done <= 5 {
            usual += gained / 5.0;
        } else {
            assert!(gained > 0.02 * usual, "the clock stalls: {gained:e} in place of {usual:e} in {part} contacts");
        }
        drive(&mut engine, done);
    }
}

/// 4000 elastic spheres just below freezing: energy and momentum stay.
fn dense_fluid(collisions: u64) {
    let engine = face_centred(10, 0.49, 3);
    let start = engine.snapshot();
    let energy = engine.kinetic_energy();
    let scale: f64 = start.velocity.iter().map(|v| v.norm()).sum();
    soak(
        engine,
        collisions,
        |_, _| {},
        |engine| {
            let (drift, momentum) = (engine.kinetic_energy() / energy - 1.0, engine.momentum().norm() / scale);
            assert!(drift.abs() < 1e-10, "energy drifted by {drift:e}");
            assert!(momentum < 1e-10, "momentum drifted by {momentum:e}");
            format!("energy drift {drift:.1e}, momentum {momentum:.1e}")
        },
    );
}

/// Inelastic grains on a floor in gravity, at rest in the mean: every so often those below are thrown up again.
///
/// Between two throws they settle towards a heap whose contacts follow one another ever faster, which is where a clock
/// stalls and where rounding could let grains sink into the floor or into one another. Throws leave the heap's mean
/// velocity along the floor at zero: nothing else would stop it.
fn grains(contacts: u64) {
    let (count, radius) = (400, 0.5);
    let restitution = Restitution::Constant(0.9);
    let mut boundary = Boundary::<3>::new([0.0; 3], [10.0, 10.0, 25.0], Axis::Periodic);
    boundary.axes[2] = Axis::Walls;
    let low = Boundary { upper: Vector([10.0, 10.0, 20.0]), ..boundary.clone() };
    let mut random = Random::new(5, 0);
    let mut particles = Particles::new();
    for place in lattice(&low, count, radius, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, radius, 0);
    }
    maxwell(&mut particles, 1.0, true, &mut random);
    let rules = Rules { restitution, elastic_below: 0.02, field: Vector([0.0, 0.0, -1.0]), ..Rules::default() };
    let engine = EventDriven::new(boundary, particles, rules).unwrap();
    let throw = |engine: &mut EventDriven<3>, step: u64| {
        let heights: Vec<f64> = (0..count).map(|i| engine.position(i)[2]).collect();
        engine.set_velocities(|i, velocity| {
            if heights[i] < 2.0 {
                let mut random = Random::at(5, 1, step, i as u64);
                *velocity += Vector([0.5 * random.normal(), 0.5 * random.normal(), 4.0 + random.normal().abs()]);
            }
        });
        let drift = engine.momentum() / count as f64;
        engine.set_velocities(|_, velocity| *velocity -= Vector([drift[0], drift[1], 0.0]));
    };
    soak(engine, contacts, throw, |engine| {
        let place = |i: usize| engine.position(i)[2];
        let lowest = (0..count).map(place).fold(f64::INFINITY, f64::min);
        let mean = (0..count).map(place).sum::<f64>() / count as f64;
        assert!(lowest > radius * (1.0 - 1e-9), "a grain sinks to {lowest}");
        assert!(mean < 10.0, "the grains leave: mean height {mean}");
        format!(
            "kinetic energy {:.1}, lowest grain {:.1e} above the floor, mean height {mean:.2}",
            engine.kinetic_energy(),
            lowest - radius
        )
    });
}

#[test]
fn ten_million_collisions_of_a_dense_fluid() {
    dense_fluid(10_000_000);
}

#[test]
fn five_million_contacts_of_grains() {
    grains(5_000_000);
}

#[test]
#[ignore = "an hour: make soak"]
fn a_thousand_million_collisions_of_a_dense_fluid() {
    dense_fluid(1_000_000_000);
}

#[test]
#[ignore = "minutes: make soak"]
fn a_hundred_million_contacts_of_grains() {
    grains(100_000_000);
}
