//! The order in which particles are given is a matter of names: it changes no bit of what they do.

use crate::common::{face_centred, periodic_fluid, run, same_bits};
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Boundary, Engine, Particles, Random, Vector};
use corpuscle_event::{Counts, EventDriven, Rules};

/// The particles `order[0]`, `order[1]`, ... of these.
fn arranged<const D: usize>(particles: &Particles<D>, order: &[usize]) -> Particles<D> {
    let mut arranged = Particles::new();
    for &i in order {
        let Particles { position, velocity, mass, radius, species } = particles;
        arranged.push(position[i], velocity[i], mass[i], radius[i], species[i]);
    }
    arranged
}

/// Runs the system and one with its particles in another order through a number of contacts, side by side; answers what
/// has been done in it.
fn the_order_is_of_no_account<const D: usize>(boundary: &Boundary<D>, particles: &Particles<D>, contacts: u64) -> Counts {
    let mut order: Vec<usize> = (0..particles.len()).collect();
    Random::new(31, 3).shuffle(&mut order);
    assert!(order.iter().enumerate().any(|(k, &i)| k != i));
    let start = |particles| EventDriven::new(boundary.clone(), particles, Rules::default()).unwrap();
    let (mut given, mut shuffled) = (start(particles.clone()), start(arranged(particles, &order)));
    while given.counts().collisions < contacts {
        run(&mut given, contacts / 10);
        // Both on to a time that is not quite that of a contact, which may round either way.
        let to = given.time() + 1e-3;
        given.advance(to, &mut ()).unwrap();
        shuffled.advance(to, &mut ()).unwrap();
        assert_eq!(given.counts().collisions, shuffled.counts().collisions);
        assert!(same_bits(&arranged(&given.snapshot(), &order), &shuffled.snapshot()), "they part before t = {}", given.time());
    }
    given.counts()
}

/// More contacts than two epochs have, each of which sorts the particles in memory anew.
const SEVERAL_EPOCHS: u64 = 200_000;

#[test]
fn of_a_dilute_gas() {
    fn check<const D: usize>() {
        let gas = periodic_fluid::<D>(500, 0.1, 41);
        let counts = the_order_is_of_no_account(gas.boundary(), &gas.snapshot(), SEVERAL_EPOCHS);
        assert!(counts.crossings > 0 && counts.rebuilds == 0, "{counts:?}");
    }
    check::<2>();
    check::<3>();
}

#[test]
fn of_a_dense_fluid() {
    let discs = periodic_fluid::<2>(500, 0.65, 42);
    let spheres = face_centred(5, 0.49, 43);
    let counts = [
        the_order_is_of_no_account(discs.boundary(), &discs.snapshot(), SEVERAL_EPOCHS),
        the_order_is_of_no_account(spheres.boundary(), &spheres.snapshot(), SEVERAL_EPOCHS),
    ];
    for counts in counts {
        assert!(counts.rebuilds > 0 && counts.crossings == 0, "{counts:?}");
    }
}

/// Radii over a factor of 30: several grids.
#[test]
fn of_a_mixture_of_sizes() {
    fn check<const D: usize>(side: f64) {
        let boundary = Boundary::<D>::periodic(side);
        let mut random = Random::new(44, 0);
        let mut particles = Particles::new();
        while particles.len() < 400 {
            let radius = if particles.len() < 3 {
                3.0
            } else if particles.len() < 20 {
                0.6
            } else {
                0.1
            };
            let place = Vector::from_fn(|_| side * random.uniform());
            let clear = |k: usize| boundary.displacement(particles.position[k], place).norm() > particles.radius[k] + radius;
            if (0..particles.len()).all(clear) {
                particles.push(place, Vector::ZERO, 1.0 + random.uniform(), radius, 0);
            }
        }
        maxwell(&mut particles, 1.0, true, &mut random);
        let counts = the_order_is_of_no_account(&boundary, &particles, SEVERAL_EPOCHS);
        assert!(counts.crossings > 0, "{counts:?}");
    }
    check::<2>(20.0);
    check::<3>(16.0);
}
