//! Systems the tests start from, and observers they watch with.

#![allow(dead_code, reason = "each test binary uses its own part")]

use std::ops::ControlFlow;

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Boundary, Contact, Engine, Meeting, Observer, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};

/// Equal spheres of diameter and mass 1 at temperature 1 in a periodic cube of the given packing fraction.
pub(crate) fn periodic_fluid<const D: usize>(n: usize, packing: f64, seed: u64) -> EventDriven<D> {
    let volume = n as f64 * corpuscle_core::particles::ball_volume::<D>(0.5) / packing;
    let boundary = Boundary::<D>::periodic(volume.powf(1.0 / D as f64));
    let mut random = Random::new(seed, 0);
    let places = lattice(&boundary, n, 0.5, &mut random, |_| true).unwrap();
    let mut particles = Particles::new();
    for place in places {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    maxwell(&mut particles, 1.0, true, &mut random);
    EventDriven::new(boundary, particles, Rules::default()).unwrap()
}

/// `4 c^3` equal spheres of diameter and mass 1 at temperature 1 on a face-centred cubic lattice: dense starts.
pub(crate) fn face_centred(c: usize, packing: f64, seed: u64) -> EventDriven<3> {
    let n = 4 * c.pow(3);
    let side = (n as f64 * corpuscle_core::particles::ball_volume::<3>(0.5) / packing).cbrt();
    let mut particles = Particles::new();
    let step = side / c as f64;
    for cell in 0..c.pow(3) {
        let corner = [cell % c, cell / c % c, cell / (c * c)];
        for basis in [[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]] {
            let place = Vector::from_fn(|k| (corner[k] as f64 + basis[k]) * step);
            particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
        }
    }
    maxwell(&mut particles, 1.0, true, &mut Random::new(seed, 0));
    EventDriven::new(Boundary::periodic(side), particles, Rules::default()).unwrap()
}

/// Keeps every contact.
#[derive(Default)]
pub(crate) struct Record<const D: usize> {
    pub(crate) contacts: Vec<Contact<D>>,
}

impl<const D: usize> Observer<D> for Record<D> {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.contacts.push(*contact);
        ControlFlow::Continue(())
    }
}

/// Stops after a number of contacts between particles.
pub(crate) struct StopAfter(pub(crate) u64);

impl<const D: usize> Observer<D> for StopAfter {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.0 -= u64::from(matches!(contact.with, Meeting::Pair(_)));
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Runs for a number of collisions.
pub(crate) fn run<const D: usize>(engine: &mut EventDriven<D>, collisions: u64) {
    engine.advance(1e12, &mut StopAfter(collisions)).unwrap();
}

/// Deepest overlap of any pair now.
pub(crate) fn largest_overlap<const D: usize>(engine: &EventDriven<D>) -> f64 {
    engine.boundary().largest_overlap(&engine.snapshot())
}

/// The same bits, in positions and velocities?
pub(crate) fn same_bits<const D: usize>(a: &Particles<D>, b: &Particles<D>) -> bool {
    let bits = |v: &[Vector<D>]| v.iter().flat_map(|x| x.0.map(f64::to_bits)).collect::<Vec<_>>();
    bits(&a.position) == bits(&b.position) && bits(&a.velocity) == bits(&b.velocity)
}
