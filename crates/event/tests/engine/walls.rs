//! Faces of the box that are warm, move or open, against theory.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use crate::common::{Record, assert_estimate, assert_score, points};
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Meeting, Motion, Observer, Particles, Partition, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::distribution::normal_cdf;
use corpuscle_observe::{Estimate, Histogram, blocking};

/// What leaves a warm wall is independent each time: normal speeds obey `1 - exp(-m v^2 / 2 kT)`, tangential velocities
/// are normal with variance `kT/m`, relative to the wall.
#[test]
fn warm_walls_emit_a_flux_weighted_maxwell_distribution() {
    let (temperature, mass) = (1.7, 2.5);
    let mut room = Boundary::<3>::new([0.0; 3], [2.0; 3], Axis::Walls);
    for face in &mut room.faces[1] {
        face.temperature = Some(temperature);
    }
    let mut one = Particles::new();
    one.push(Vector([1.0; 3]), Vector([0.3, 1.0, 0.2]), mass, 0.25, 0);
    let mut engine = EventDriven::new(room, one, Rules { seed: 3, ..Rules::default() }).unwrap();
    let mut record = Record::default();
    engine.advance(40_000.0, &mut record).unwrap();
    let spread = (temperature / mass).sqrt();
    let [mut normal, mut tangential] = [Histogram::new(0.0, 4.0 * spread, 40), Histogram::new(-3.0 * spread, 3.0 * spread, 40)];
    let mut energies = vec![];
    for contact in record.contacts.iter().filter(|contact| matches!(contact.with, Meeting::Face { axis: 1, .. })) {
        let after = contact.first.after;
        normal.add(-after.dot(contact.normal));
        tangential.add(after[0]);
        tangential.add(after[2]);
        energies.push(0.5 * mass * after.norm_squared());
    }
    assert!(energies.len() > 10_000);
    let rayleigh = |v: f64| 1.0 - (-0.5 * (v.max(0.0) / spread).powi(2)).exp();
    assert_score("normal speeds", normal.chi_squared(rayleigh, 1.0, 0).unwrap().score());
    assert_score("tangential velocities", tangential.chi_squared(|v| normal_cdf(v / spread), 1.0, 0).unwrap().score());
    // (D + 1) / 2 kT each, against D / 2 kT in the gas.
    assert_estimate("energy of what leaves", Estimate::from_replicas(&energies), 2.0 * temperature);
}

/// Energy that came into the gas through the two faces across axis 0.
#[derive(Default)]
struct Heat([f64; 2]);

impl<const D: usize> Observer<D> for Heat {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        if let Meeting::Face { axis: 0, upper } = contact.with {
            let gained = contact.first.after.norm_squared() - contact.first.before.norm_squared();
            self.0[usize::from(upper)] += 0.5 * contact.first.mass * gained;
        }
        ControlFlow::Continue(())
    }
}

/// A cold gas between walls of one temperature comes to it: mean and variance of its energy are those of the canonical
/// distribution, `D N / 2` times `kT` and `(kT)^2`; no heat flows.
#[test]
fn a_gas_between_warm_walls_becomes_canonical() {
    let (n, temperature) = (24, 1.5);
    let mut room = Boundary::<2>::new([0.0; 2], [8.0, 6.0], Axis::Walls);
    for face in &mut room.faces[0] {
        face.temperature = Some(temperature);
    }
    let mut random = Random::new(8, 0);
    let mut particles = Particles::new();
    for place in lattice(&room, n, 0.3, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, 0.3, 0);
    }
    maxwell(&mut particles, 0.3, false, &mut random);
    let mut gas = EventDriven::new(room, particles, Rules { seed: 1, ..Rules::default() }).unwrap();
    gas.advance(200.0, &mut ()).unwrap();
    let (mut energy, mut square, mut flow) = (vec![], vec![], vec![]);
    let mean = n as f64 * temperature;
    for _ in 0..60_000 {
        let mut heat = Heat::default();
        gas.advance(gas.time() + 1.0, &mut heat).unwrap();
        energy.push(gas.kinetic_energy());
        square.push((gas.kinetic_energy() - mean).powi(2));
        flow.push(0.5 * (heat.0[0] - heat.0[1]));
    }
    assert_estimate("energy", blocking(&energy).trusted(), mean);
    assert_estimate("its variance", blocking(&square).trusted(), n as f64 * temperature * temperature);
    assert_estimate("heat from the lower to the upper wall", blocking(&flow).trusted(), 0.0);
}

/// Between walls of two temperatures heat flows from the warm one; in a collisionless gas every passage carries
/// `(D + 1) / 2 kT` of the wall it started from.
#[test]
fn heat_flows_from_warm_to_cold() {
    let mut room = Boundary::<2>::new([0.0; 2], [3.0, 2.0], Axis::Walls);
    let temperatures = [2.0, 0.5];
    for (face, temperature) in room.faces[0].iter_mut().zip(temperatures) {
        face.temperature = Some(temperature);
    }
    let particles = points(&room, 50, 1.0, &mut Random::new(1, 0), |_| true);
    let mut gas = EventDriven::new(room, particles, Rules { seed: 2, ..Rules::default() }).unwrap();
    let mut record = Record::default();
    gas.advance(20.0, &mut ()).unwrap();
    gas.advance(1500.0, &mut record).unwrap();
    for (upper, start) in [(true, temperatures[0]), (false, temperatures[1])] {
        let arrivals = record.contacts.iter().filter(|c| c.with == Meeting::Face { axis: 0, upper });
        let energies: Vec<f64> = arrivals.map(|c| 0.5 * c.first.before.norm_squared()).collect();
        assert_estimate("energy that arrives", Estimate::from_replicas(&energies), 1.5 * start);
    }
}

/// A receding wall gives `v' = 2 u - v`: between it and a fixed one the contacts come at times known in closed form.
#[test]
fn a_ball_loses_twice_the_speed_of_a_receding_wall_each_time() {
    let (u, v, start) = (0.125, 2.0, 2.0);
    let mut room = Boundary::<1>::new([0.0], [1e3], Axis::Walls);
    room.faces[0][1].motion = Some(Motion::Path(vec![(0.0, start), (7000.0, start + 7000.0 * u)]));
    let mut one = Particles::new();
    one.push(Vector([0.0]), Vector([v]), 1.0, 0.0, 0);
    let mut engine = EventDriven::new(room, one, Rules::default()).unwrap();
    let mut record = Record::default();
    engine.advance(6000.0, &mut record).unwrap();
    let met: Vec<_> = record.contacts.iter().filter(|c| c.with == Meeting::Face { axis: 0, upper: true }).collect();
    // 2 -> 1.75 -> ... -> 0.25, and then 0.25 -> 0: eight contacts.
    assert_eq!(met.len(), 8);
    let (mut time, mut speed, mut place) = (0.0, v, 0.0);
    for contact in met {
        let wait = (start + u * time - place) / (speed - u);
        (time, place) = (time + wait, place + speed * wait);
        assert!((contact.time - time).abs() < 1e-12 * time, "{} instead of {time}", contact.time);
        assert!((contact.first.after[0] - (2.0 * u - speed)).abs() < 1e-12);
        // Back to the fixed wall.
        speed -= 2.0 * u;
        (time, place) = (time + if speed > 0.0 { place / speed } else { 0.0 }, 0.0);
    }
}

/// Slow compression along one axis is adiabatic: the volume of phase space `E^(D N / 2) Q` stays, with the configurational
/// integral `Q` of `N` discs. For points, `Q = A^N`, that is `T V^(gamma - 1) = const`, or `P V^gamma = const`,
/// `gamma = (D + 2) / D = 2`. For discs of diameter `s` in the area `A = a b` open to their centres
///
/// > `ln Q = N ln A - N (N - 1) / 2 (pi s^2 A - 4 s^3 (a + b) / 3 + s^4 / 2) / A^2 - 3.128 N eta^2 / 2`,
///
/// the second virial coefficient in a finite box, and the third (Tonks 1936: `4 (4/3 - sqrt(3)/pi)`) as in the bulk.
#[test]
fn slow_compression_is_adiabatic() {
    let (n, radius, from, to, u) = (150, 0.1, 24.0, 14.4, 0.004);
    let mut ratios = vec![];
    for replica in 0..24 {
        let mut room = Boundary::<2>::new([0.0; 2], [from, 12.0], Axis::Walls);
        let end = (from - to) / u;
        room.faces[0][1].motion = Some(Motion::Path(vec![(0.0, from), (end, to)]));
        let mut random = Random::new(replica, 0);
        let mut particles = Particles::new();
        for place in lattice(&room, n, radius, &mut random, |_| true).unwrap() {
            particles.push(place, Vector::ZERO, 1.0, radius, 0);
        }
        maxwell(&mut particles, 1.0, false, &mut random);
        let mut gas = EventDriven::new(room, particles, Rules::default()).unwrap();
        let start = gas.kinetic_energy();
        gas.advance(end + 1.0, &mut ()).unwrap();
        let warm = gas.kinetic_energy();
        gas.advance(end + 50.0, &mut ()).unwrap();
        assert!((gas.kinetic_energy() / warm - 1.0).abs() < 1e-12, "the face has stopped");
        ratios.push((warm / start).ln());
    }
    let ln_q = |side: f64| {
        let (n, s, a, b) = (n as f64, 2.0 * radius, side - 2.0 * radius, 12.0 - 2.0 * radius);
        let excluded = PI * s * s * a * b - 4.0 / 3.0 * s.powi(3) * (a + b) + 0.5 * s.powi(4);
        let (area, third) = (a * b, 4.0 * (4.0 / 3.0 - 3f64.sqrt() / PI));
        let packing = n * PI * radius * radius / area;
        n * area.ln() - 0.5 * n * (n - 1.0) * excluded / (area * area) - 0.5 * n * third * packing * packing
    };
    let expected = (ln_q(from) - ln_q(to)) / n as f64;
    println!("points would give {:.6}", ((from - 2.0 * radius) / (to - 2.0 * radius)).ln());
    assert_estimate("ln T2/T1", Estimate::from_replicas(&ratios), expected);
}

/// Nothing passes a plate before it goes; then the gas expands freely and keeps its energy. A face that opens lets all out.
#[test]
fn what_is_removed_at_a_time_is_there_before_and_not_after() {
    let mut room = Boundary::<2>::new([0.0; 2], [10.0, 4.0], Axis::Walls);
    room.partitions.push(Partition { removed_at: Some(30.0), ..Partition::new(0, 5.0) });
    room.faces[1][1].opened_at = Some(60.0);
    let mut half = room.clone();
    (half.upper[0], half.partitions) = (5.0, vec![]);
    let mut random = Random::new(2, 0);
    let mut particles = Particles::new();
    for place in lattice(&half, 30, 0.2, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, 0.2, 0);
    }
    maxwell(&mut particles, 1.0, false, &mut random);
    let mut gas = EventDriven::new(room, particles, Rules::default()).unwrap();
    let energy = gas.kinetic_energy();
    let right = |gas: &EventDriven<2>| (0..30).filter(|&i| gas.position(i)[0] > 5.0).count();
    let outside = |gas: &EventDriven<2>| (0..30).filter(|&i| gas.position(i)[1] > 4.0).count();
    gas.advance(30.0, &mut ()).unwrap();
    assert_eq!(right(&gas), 0);
    gas.advance(59.999, &mut ()).unwrap();
    assert!((5..=25).contains(&right(&gas)) && outside(&gas) == 0);
    gas.advance(1000.0, &mut ()).unwrap();
    assert!(outside(&gas) >= 29, "only {} have left", outside(&gas));
    assert!((gas.kinetic_energy() / energy - 1.0).abs() < 1e-12);
}
