//! Against theory: equation of state, collision rate, free path, atmosphere, and the bounds on drift.

use std::ops::ControlFlow;

use crate::common::{Record, largest_overlap, periodic_fluid, run};
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Meeting, Observer, Particles, Partition, Random, Vector};
use corpuscle_event::{EventDriven, Rules};

/// Mean and standard error of blocks long enough to be independent.
fn mean_and_error(blocks: &[f64]) -> (f64, f64) {
    let n = blocks.len() as f64;
    let mean = blocks.iter().sum::<f64>() / n;
    let variance = blocks.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn assert_agrees(what: &str, blocks: &[f64], expected: f64) {
    let (mean, error) = mean_and_error(blocks);
    let z = (mean - expected) / error;
    println!("{what}: {mean:.6} +- {error:.6}, expected {expected:.6}, z = {z:.2}");
    assert!(z.abs() < 3.0, "{what}: {mean} +- {error}, expected {expected}, z = {z}");
    assert!(error < 0.01 * expected.abs(), "{what}: too few data, +- {error}");
}

/// Collisions and their virial, `sum J |r|`.
#[derive(Default)]
struct Virial {
    collisions: u64,
    sum: f64,
}

impl<const D: usize> Observer<D> for Virial {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.collisions += 1;
        self.sum += contact.impulse * contact.distance;
        ControlFlow::Continue(())
    }
}

/// Z from the virial, `1 + sum J s / (D N kT t)`, against the equation of state; the rate of collisions of a particle
/// against Enskog's; the mean free path, mean speed over rate.
fn equilibrium<const D: usize>(packing: f64, z: f64, mean_speed: f64, surface: f64) {
    let n = 4096;
    let mut engine = periodic_fluid::<D>(n, packing, 11);
    run(&mut engine, 50 * n as u64);
    let density = n as f64 / engine.boundary().volume();
    // Z - 1 = 2^(D-1) eta chi, and the rate per particle is (2-D) 2 n s chi sqrt(pi), (3-D) 4 n s^2 chi sqrt(pi).
    let chi = (z - 1.0) / (f64::from(1 << (D - 1)) * packing);
    let rate = surface * density * chi * std::f64::consts::PI.sqrt();
    // Every particle collides eight times in a block.
    let block = 8.0 / rate;
    let (mut zs, mut rates, mut paths) = (vec![], vec![], vec![]);
    for _ in 0..40 {
        let mut virial = Virial::default();
        engine.advance(engine.time() + block, &mut virial).unwrap();
        zs.push(1.0 + virial.sum / (D as f64 * n as f64 * block));
        let measured = 2.0 * virial.collisions as f64 / (n as f64 * block);
        rates.push(measured);
        let speed = engine.snapshot().velocity.iter().map(|v| v.norm()).sum::<f64>() / n as f64;
        paths.push(speed / measured);
    }
    println!("{D}-D, packing {packing}");
    assert_agrees("Z", &zs, z);
    assert_agrees("collision rate", &rates, rate);
    assert_agrees("mean free path", &paths, mean_speed / rate);
    assert!(largest_overlap(&engine) < 1e-10);
}

/// `Z = sum b_n eta^(n-1)` with the virial coefficients to the tenth (Clisby and McCoy, J. Stat. Phys. 122, 15 (2006),
/// doi:10.1007/s10955-005-8080-0, there as `B_n / B_2^(n-1)`). What is left out is below 2e-4 at packing 0.3.
fn virial_series(packing: f64, reduced: [f64; 9], second: f64) -> f64 {
    1.0 + reduced.iter().enumerate().map(|(k, b)| b * (second * packing).powi(k as i32 + 1)).sum::<f64>()
}

/// At packing 0.3 Henderson's `(1 + eta^2 / 8) / (1 - eta)^2` (doi:10.1080/00268977500102511) is 0.0005 too large.
#[test]
fn hard_discs_obey_the_virial_series_and_enskog() {
    let reduced = [1.0, 0.782_004_4, 0.532_231_8, 0.333_556_0, 0.198_842_5, 0.114_872_8, 0.064_993_0, 0.036_219_3, 0.019_953_7];
    for eta in [0.1f64, 0.3] {
        let z = virial_series(eta, reduced, 2.0);
        let henderson = (1.0 + eta * eta / 8.0) / (1.0 - eta).powi(2);
        assert!((henderson - z).abs() < 1e-3);
        equilibrium::<2>(eta, z, (std::f64::consts::PI / 2.0).sqrt(), 2.0);
    }
}

/// At packing 0.3 Carnahan and Starling's `(1 + eta + eta^2 - eta^3) / (1 - eta)^3` (doi:10.1063/1.1672048) is 0.010 too
/// small, which is more than the statistical error here.
#[test]
fn hard_spheres_obey_the_virial_series_and_enskog() {
    let reduced = [1.0, 0.625, 0.286_949_5, 0.110_252_1, 0.038_882_0, 0.013_023_5, 0.004_183_2, 0.001_309_4, 0.000_403_5];
    for eta in [0.1f64, 0.3] {
        let z = virial_series(eta, reduced, 4.0);
        let carnahan_starling = (1.0 + eta + eta * eta - eta.powi(3)) / (1.0 - eta).powi(3);
        assert!((carnahan_starling - z).abs() < 0.011);
        equilibrium::<3>(eta, z, (8.0 / std::f64::consts::PI).sqrt(), 4.0);
    }
}

fn drifts_little<const D: usize>(mut engine: EventDriven<D>, collisions: u64) {
    let energy = engine.kinetic_energy();
    run(&mut engine, collisions);
    let drift = (engine.kinetic_energy() / energy - 1.0).abs();
    println!(
        "{D}-D: relative drift {drift:.2e}, momentum {:.2e}, overlap {:.2e}",
        engine.momentum().norm(),
        largest_overlap(&engine)
    );
    assert!(drift < 1e-11);
    assert!(engine.momentum().norm() < 1e-11 * engine.particle_count() as f64);
    assert!(largest_overlap(&engine) < 1e-10);
}

#[test]
fn energy_stays_after_ten_million_collisions_of_discs() {
    drifts_little(periodic_fluid::<2>(400, 0.6, 5), 10_000_000);
}

#[test]
fn energy_stays_after_a_million_collisions_of_dense_spheres() {
    drifts_little(crate::common::face_centred(5, 0.49, 5), 1_000_000);
}

/// In a column without a lid `n(h) ~ exp(-m g h / kT)`, so the mean of `m g h` is `kT`, whatever the number of particles
/// (both are `E / 2 N` on average in 2-D, at fixed energy too). Discs are so small that their second virial
/// coefficient shifts this by less than a tenth of the standard error.
#[test]
fn an_atmosphere_is_barometric() {
    let (n, radius, width, g) = (60, 0.004, 10.0, 1.0);
    let room = Boundary::<2>::new([0.0; 2], [width, 60.0], Axis::Walls);
    let mut random = Random::new(3, 0);
    let start = Boundary::<2>::new([0.0; 2], [width, 4.0], Axis::Walls);
    let mut particles = Particles::new();
    for place in lattice(&start, n, radius, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, radius, 0);
    }
    maxwell(&mut particles, 1.0, false, &mut random);
    let mut air = EventDriven::new(room, particles, Rules { field: Vector([0.0, -g]), ..Rules::default() }).unwrap();
    let energy = air.kinetic_energy() + air.potential_energy();
    air.advance(300.0, &mut ()).unwrap();
    let (mut ratios, mut above) = (vec![], vec![]);
    for _ in 0..40 {
        let (mut height, mut kinetic, mut high, samples) = (0.0, 0.0, 0.0, 1200);
        for _ in 0..samples {
            air.advance(air.time() + 1.0, &mut ()).unwrap();
            kinetic += air.kinetic_energy();
            for i in 0..n {
                let h = air.position(i)[1] - radius;
                height += h;
                high += f64::from(u8::from(h > 1.0));
            }
        }
        ratios.push(g * height / kinetic);
        // The fraction above h = 1 at the temperature of the run.
        above.push(high / f64::from(samples) / n as f64);
    }
    assert_agrees("m g h / kT", &ratios, 1.0);
    let temperature = (energy - n as f64 * g * radius) / (2.0 * n as f64);
    // Exactly, at fixed energy E of 2 N quadratic and linear terms of E / 2 N each: (1 - m g h / E)^(2 N - 1).
    let expected = (1.0 - g / (2.0 * n as f64 * temperature)).powi(2 * n as i32 - 1);
    assert_agrees("fraction above", &above, expected);
    let drift = (air.kinetic_energy() + air.potential_energy()) / energy - 1.0;
    assert!(drift.abs() < 1e-11, "energy drifted by {drift:e}");
    assert!(air.counts().collisions > 1000, "discs must have met");
}

/// Through a hole little wider than a particle: rims are hit, no particle cuts the plate, energy stays.
fn passes_the_hole<const D: usize>(field: Vector<D>) {
    let mut room = Boundary::<D>::new([0.0; D], [6.0; D], Axis::Walls);
    room.partitions.push(Partition::new(0, 3.0).with_hole(1, 2.0, 4.0));
    let mut random = Random::new(4, 0);
    let mut particles = Particles::new();
    let clear = |place: Vector<D>| (place[0] - 3.0).abs() > 0.31;
    for place in lattice(&room, 40, 0.3, &mut random, clear).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, 0.3, 0);
    }
    maxwell(&mut particles, 1.0, false, &mut random);
    let mut gas = EventDriven::new(room.clone(), particles, Rules { field, ..Rules::default() }).unwrap();
    let energy = gas.kinetic_energy() + gas.potential_energy();
    let mut record = Record::default();
    let (mut side, mut passages) = (vec![], 0);
    for _ in 0..2000 {
        gas.advance(gas.time() + 0.05, &mut record).unwrap();
        let now: Vec<bool> = (0..40).map(|i| gas.position(i)[0] > 3.0).collect();
        passages += side.iter().zip(&now).filter(|(a, b)| a != b).count();
        side = now;
        for i in 0..40 {
            assert!(room.partitions[0].distance(gas.position(i)) > 0.3 * (1.0 - 1e-10));
        }
    }
    let rims = record.contacts.iter().filter(|c| matches!(c.with, Meeting::Partition { .. }) && c.normal[0].abs() < 0.999).count();
    println!("{D}-D: {passages} passages, {rims} rim contacts");
    assert!(passages > 20 && rims > 20, "{passages} passages, {rims} contacts with rims");
    let drift = (gas.kinetic_energy() + gas.potential_energy() - energy).abs() / energy.abs().max(gas.kinetic_energy());
    assert!(drift < 1e-11, "energy drifted by {drift:e}");
}

#[test]
fn discs_pass_a_hole() {
    passes_the_hole::<2>(Vector::ZERO);
    passes_the_hole::<2>(Vector([0.3, -1.0]));
}

#[test]
fn spheres_pass_a_slit() {
    passes_the_hole::<3>(Vector::ZERO);
    passes_the_hole::<3>(Vector([0.3, -1.0, 0.5]));
}
