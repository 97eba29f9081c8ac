//! Spheres that grow: dense starts, reached without overlap.

use std::ops::ControlFlow;

use corpuscle_core::particles::ball_volume;
use corpuscle_core::placement::maxwell;
use corpuscle_core::{Axis, Boundary, Contact, Engine, Observer, Obstacle, Particles, Partition, Random, Vector};
use corpuscle_event::{EventDriven, Rules, grown};

/// Grows spheres of these radii to the packing fraction in a box, and answers it with them in it.
fn packed<const D: usize>(radii: &[f64], packing: f64, axes: [Axis; D], rate: f64, seed: u64) -> (Boundary<D>, Particles<D>) {
    let volume = radii.iter().map(|&radius| ball_volume::<D>(radius)).sum::<f64>() / packing;
    let mut boundary = Boundary::<D>::periodic(volume.powf(1.0 / D as f64));
    boundary.axes = axes;
    let mut particles = Particles::new();
    for (place, &radius) in grown(&boundary, radii, rate, &mut Random::new(seed, 0)).unwrap().into_iter().zip(radii) {
        particles.push(place, Vector::ZERO, 1.0, radius, 0);
    }
    boundary.validate_particles(&particles).unwrap();
    assert!(boundary.largest_overlap(&particles) <= 0.0, "{}", boundary.largest_overlap(&particles));
    (boundary, particles)
}

#[test]
fn equal_spheres_grow_to_packings_beyond_freezing() {
    packed::<3>(&[0.5; 1000], 0.60, [Axis::Periodic; 3], 0.01, 1);
    packed::<2>(&[0.5; 1000], 0.84, [Axis::Periodic; 2], 0.01, 1);
}

/// Radii spread evenly in the logarithm, the largest `ratio` times the smallest.
fn spread(count: usize, ratio: f64) -> Vec<f64> {
    (0..count).map(|i| 0.5 * ratio.powf(-(i as f64) / (count - 1) as f64)).collect()
}

#[test]
fn unequal_spheres_grow_between_walls() {
    let walls = Axis::Walls;
    packed::<3>(&spread(400, 5.0), 0.50, [walls; 3], 0.02, 2);
    packed::<3>(&spread(400, 3.0), 0.60, [Axis::Periodic; 3], 0.02, 2);
    packed::<2>(&spread(400, 10.0), 0.70, [walls; 2], 0.02, 3);
    packed::<2>(&spread(400, 1.4), 0.80, [walls, Axis::Periodic], 0.02, 4);
}

/// Partitions and obstacles are kept as clear as walls, and a single sphere or none is a start as well.
#[test]
fn whatever_is_in_the_box_is_kept_clear() {
    let mut boundary = Boundary::<2>::periodic(20.0);
    boundary.partitions.push(Partition::new(0, 7.0));
    boundary.obstacles.push(Obstacle { centre: Vector([14.0, 10.0]), radius: 1.5 });
    for radii in [vec![], vec![3.0], vec![0.5; 200]] {
        let mut particles = Particles::new();
        for (place, &radius) in grown(&boundary, &radii, 0.05, &mut Random::new(1, 0)).unwrap().into_iter().zip(&radii) {
            particles.push(place, Vector::ZERO, 1.0, radius, 0);
        }
        boundary.validate_particles(&particles).unwrap();
    }
}

#[test]
fn growth_is_the_same_to_the_bit() {
    let boundary = Boundary::<3>::periodic(5.0);
    let places = || grown(&boundary, &[0.5; 100], 0.05, &mut Random::new(7, 0)).unwrap();
    assert_eq!(places(), places());
}

#[test]
fn spheres_that_jam_and_nonsense_are_refused() {
    let boundary = Boundary::<3>::periodic(5.0);
    let refusal = |radii: &[f64], rate: f64| grown(&boundary, radii, rate, &mut Random::new(1, 0)).unwrap_err();
    // Packing 0.75: more than any arrangement has.
    let jam = refusal(&vec![0.5; 180], 0.05);
    assert_eq!(jam.key, "packing");
    let reached: f64 = jam.expected.split("at ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((0.58..0.74).contains(&reached), "{jam}");
    assert_eq!(refusal(&[0.5, -1.0], 0.05).key, "radius of particle 1");
    assert_eq!(refusal(&[0.5], 0.0).key, "rate");
    assert_eq!(refusal(&[0.5], f64::NAN).key, "rate");
}

/// At packing 0.60 a metastable fluid has the pressure of Carnahan and Starling, `Z = 25`, and a glass that jams at `eta_J =
/// 0.64` that of its free volume, `3 / (1 - eta / eta_J) = 48`; the crystal has 15 (Speedy, J. Phys.: Condens. Matter 10,
/// 4387 (1998), doi:10.1088/0953-8984/10/20/006). Fast growth leads between the first two.
#[test]
fn fast_growth_leaves_no_crystal() {
    let (boundary, mut particles) = packed::<3>(&[0.5; 1000], 0.60, [Axis::Periodic; 3], 0.02, 5);
    maxwell(&mut particles, 1.0, true, &mut Random::new(5, 1));
    let mut engine = EventDriven::new(boundary, particles, Rules::default()).unwrap();
    let mut virial = Virial(0.0);
    engine.advance(1.0, &mut ()).unwrap();
    engine.advance(2.0, &mut virial).unwrap();
    let z = 1.0 + virial.0 / (3.0 * 1000.0);
    println!("Z = {z}");
    assert!((25.0..48.0).contains(&z), "Z = {z}");
}

/// `sum J r`.
struct Virial(f64);

impl<const D: usize> Observer<D> for Virial {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.0 += contact.impulse * contact.distance;
        ControlFlow::Continue(())
    }
}
