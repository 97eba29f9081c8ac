//! The massive piston against theory.

use crate::common::{Record, assert_estimate, points};
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Engine, Meeting, Particles, Piston, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::blocking;

fn piston(position: f64, mass: f64, force: f64, stops: [f64; 2]) -> Piston {
    Piston { axis: 0, position, velocity: 0.0, mass, force, stops }
}

/// `N` points under a piston pressed by a force `F` in contact with a wall at `kT` are the isothermal-isobaric ensemble:
/// the height has the density `L^N exp(-F L / kT)`, so its mean is `(N + 1) kT / F` and its variance that times `kT / F`.
/// The pressure `sum m v_x^2 / L` of what is below is `N kT <1 / L> = F` on average, and the piston's kinetic energy `kT / 2`.
/// The wall far away takes up just the force: what is missing is the momentum that gas and piston have.
#[test]
fn points_under_a_loaded_piston_are_isothermal_and_isobaric() {
    let (n, force, temperature) = (12, 10.0, 1.25);
    let mut room = Boundary::<2>::new([0.0; 2], [40.0, 2.0], Axis::Walls);
    room.faces[0][0].temperature = Some(temperature);
    room.piston = Some(piston(1.5, 3.0, -force, [0.0, 40.0]));
    let mut below = room.clone();
    (below.upper[0], below.piston) = (1.5, None);
    let particles = points(&below, n, temperature, &mut Random::new(5, 0), |_| true);
    let mut gas = EventDriven::new(room, particles, Rules { seed: 7, ..Rules::default() }).unwrap();
    gas.advance(200.0, &mut ()).unwrap();
    let mean = (n as f64 + 1.0) * temperature / force;
    let (mut height, mut square, mut kinetic, mut pressure) = (vec![], vec![], vec![], vec![]);
    let momentum = |gas: &EventDriven<2>| gas.momentum()[0] + gas.piston().map_or(0.0, |piston| piston.mass * piston.velocity);
    let (begin, first_momentum, mut impulse) = (gas.time(), momentum(&gas), 0.0);
    for _ in 0..60_000 {
        let mut record = Record::default();
        gas.advance(gas.time() + 1.0, &mut record).unwrap();
        let piston = gas.piston().unwrap();
        height.push(piston.position);
        square.push((piston.position - mean).powi(2));
        kinetic.push(piston.mass * piston.velocity * piston.velocity);
        pressure.push((0..n).map(|i| gas.velocity(i)[0].powi(2)).sum::<f64>() / piston.position);
        let wall = record.contacts.iter().filter(|c| c.with == Meeting::Face { axis: 0, upper: false });
        impulse += wall.map(|c| c.impulse).sum::<f64>();
    }
    assert_estimate("height", blocking(&height).trusted(), mean);
    assert_estimate("variance of the height", blocking(&square).trusted(), mean * temperature / force);
    assert_estimate("M V^2", blocking(&kinetic).trusted(), temperature);
    assert_estimate("pressure times width", blocking(&pressure).trusted(), force);
    let missing = impulse - force * (gas.time() - begin) - (momentum(&gas) - first_momentum);
    assert!(missing.abs() < 1e-12 * impulse, "momentum {missing:e} is missing from {impulse}");
}

/// A free piston between two gases at one temperature equalises their pressures: for points its place has the density
/// `x^N1 (L - x)^N2`, mean `L (N1 + 1) / (N1 + N2 + 2)`, and on either side the pressure is `(N1 + N2 + 1) kT / L` on average.
#[test]
fn a_free_piston_equalises_pressures() {
    let (first, second, side) = (10, 20, 3.0);
    let mut room = Boundary::<2>::new([0.0; 2], [side, 1.0], Axis::Walls);
    for face in &mut room.faces[0] {
        face.temperature = Some(1.0);
    }
    room.piston = Some(piston(1.0, 4.0, 0.0, [0.0, side]));
    let mut random = Random::new(6, 0);
    let mut particles = Particles::new();
    for i in 0..first + second {
        let (from, width) = if i < first { (0.0, 1.0) } else { (1.0, 2.0) };
        particles.push(Vector([from + width * random.uniform(), random.uniform()]), Vector::ZERO, 1.0, 0.0, 0);
    }
    maxwell(&mut particles, 1.0, false, &mut random);
    let mut gas = EventDriven::new(room, particles, Rules { seed: 9, ..Rules::default() }).unwrap();
    gas.advance(200.0, &mut ()).unwrap();
    let (mut place, mut pressures) = (vec![], [vec![], vec![]]);
    for _ in 0..40_000 {
        gas.advance(gas.time() + 1.0, &mut ()).unwrap();
        let x = gas.piston().unwrap().position;
        place.push(x);
        let pressure =
            |range: std::ops::Range<i32>, length: f64| range.map(|i| gas.velocity(i as usize)[0].powi(2)).sum::<f64>() / length;
        pressures[0].push(pressure(0..first, x));
        pressures[1].push(pressure(first..first + second, side - x));
    }
    let n = f64::from(first + second);
    assert_estimate("place of the piston", blocking(&place).trusted(), side * (f64::from(first) + 1.0) / (n + 2.0));
    for pressure in pressures {
        assert_estimate("pressure on one side", blocking(&pressure).trusted(), (n + 1.0) / side);
    }
    let piston = gas.piston().unwrap();
    for i in 0..gas.particle_count() {
        assert_eq!(gas.position(i)[0] <= piston.position, i < first as usize, "particle {i} has changed sides");
    }
}

/// Energy of gas and piston, over many contacts in gravity with discs on both sides; momentum at each contact.
#[test]
fn energy_stays_with_a_piston_among_discs() {
    let mut room = Boundary::<2>::new([0.0; 2], [12.0, 6.0], Axis::Walls);
    room.piston = Some(piston(5.0, 20.0, -3.0, [1.0, 11.0]));
    let mut random = Random::new(3, 0);
    let mut particles = Particles::new();
    for place in lattice(&room, 60, 0.25, &mut random, |place| (place[0] - 5.0).abs() > 0.26).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, 0.25, 0);
    }
    maxwell(&mut particles, 1.0, false, &mut random);
    let rules = Rules { field: Vector([-0.2, 0.1]), ..Rules::default() };
    let mut gas = EventDriven::new(room, particles, rules).unwrap();
    let energy = |gas: &EventDriven<2>| gas.kinetic_energy() + gas.potential_energy() + gas.piston().unwrap().energy();
    let start = energy(&gas);
    let mut pushes = 0;
    for _ in 0..200 {
        let mut record = Record::default();
        gas.advance(gas.time() + 10.0, &mut record).unwrap();
        for contact in &record.contacts {
            if let Meeting::Piston { before, after } = contact.with {
                let lost = contact.first.mass * (contact.first.before[0] - contact.first.after[0]);
                assert!((lost - 20.0 * (after - before)).abs() < 1e-12);
                pushes += 1;
            }
        }
    }
    let drift = (energy(&gas) - start).abs() / gas.kinetic_energy();
    println!("{pushes} contacts with the piston, {:?}, drift {drift:e}", gas.counts());
    assert!(pushes > 10_000);
    assert!(drift < 1e-11, "energy drifted by {drift:e}");
}

/// A piston that lies on its stop stays there until it is hit.
#[test]
fn a_piston_rests_on_its_stop_until_it_is_hit() {
    let mut room = Boundary::<1>::new([0.0], [10.0], Axis::Walls);
    room.piston = Some(piston(4.0, 1.0, -1.0, [4.0, 10.0]));
    let mut one = Particles::new();
    one.push(Vector([1.0]), Vector([1.0]), 1.0, 0.5, 0);
    let mut engine = EventDriven::new(room, one, Rules::default()).unwrap();
    engine.advance(2.0, &mut ()).unwrap();
    assert_eq!(engine.piston().unwrap().position, 4.0);
    // Hit at 2.5 by its like, it takes over the speed, and is back on its stop after 2 v / a = 2.
    engine.advance(3.5, &mut ()).unwrap();
    assert_eq!(engine.piston().unwrap().position, 4.5);
    assert_eq!(engine.velocity(0), Vector([0.0]));
}
