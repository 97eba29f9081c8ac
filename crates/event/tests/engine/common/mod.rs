//! Systems the tests start from, and observers they watch with.

#![allow(dead_code, reason = "each test binary uses its own part")]
#![allow(clippy::unwrap_used, reason = "a test that cannot start has failed")]

mod furnish;

use std::ops::ControlFlow;

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Hole, Meeting, Observer, Obstacle, Particles, Partition, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::Estimate;

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

/// A random system of up to 24 spheres: any mix of faces, radii over a factor of 10, masses over a factor of 100, and in
/// every second box whatever else particles can meet.
pub(crate) fn random_system<const D: usize>(seed: u64) -> (Boundary<D>, Particles<D>, Rules<D>) {
    let mut random = Random::new(seed, 1);
    let mut boundary = Boundary::<D>::new([0.0; D], std::array::from_fn(|_| 3.0 + 5.0 * random.uniform()), Axis::Walls);
    for axis in &mut boundary.axes {
        *axis = [Axis::Walls, Axis::Periodic][random.below(2) as usize];
    }
    let walled: Vec<usize> = (0..D).filter(|&k| boundary.axes[k] == Axis::Walls).collect();
    // A plate across a walled axis, its hole along another walled axis if there is one.
    if random.below(2) == 0 && !walled.is_empty() {
        let axis = walled[0];
        let side = boundary.extent();
        let hole =
            walled.get(1).map(|&along| Hole { along, from: 0.3 * side[along], to: (0.5 + 0.2 * random.uniform()) * side[along] });
        boundary.partitions.push(Partition { hole, ..Partition::new(axis, 0.5 * side[axis]) });
    }
    let mut rules = Rules::default();
    if random.below(3) == 0 {
        rules.restitution = (0.5 + 0.5 * random.uniform()).into();
        rules.elastic_below = 0.05;
    }
    if random.below(3) == 0 {
        // Along walled axes, where it cannot heat the system for ever.
        for &k in &walled {
            rules.field[k] = random.normal();
        }
    }
    if random.below(2) == 0 {
        furnish::furnish(&mut boundary, &mut rules, &mut random);
    }
    boundary.validate().unwrap();
    let mut particles = Particles::new();
    let wanted = 4 + random.below(21) as usize;
    let large = random.below(3) == 0;
    for attempt in 0..4000 {
        if particles.len() == wanted {
            break;
        }
        let radius =
            if large && particles.is_empty() && attempt < 100 { 1.0 } else { 0.1 + 0.3 * random.uniform() * random.uniform() };
        let place = Vector::from_fn(|k| boundary.upper[k] * random.uniform());
        let velocity = Vector::from_fn(|_| random.normal());
        let mass = 100f64.powf(random.uniform() - 0.5) * if large && attempt == 0 { 20.0 } else { 1.0 };
        let mut candidate = particles.clone();
        candidate.push(place, velocity, mass, radius, 0);
        if boundary.validate_particles(&candidate).is_ok() {
            particles = candidate;
        }
    }
    (boundary, particles, rules)
}

/// A random dense system of nearly equal spheres, as large as neighbour lists need it: any mix of faces, radii over a
/// factor of 1.1, masses over a factor of 10.
pub(crate) fn dense_system<const D: usize>(seed: u64) -> (Boundary<D>, Particles<D>, Rules<D>) {
    let mut random = Random::new(seed, 2);
    let spacing = 1.02;
    let side = if D == 2 { 7 } else { 6 };
    let mut boundary = Boundary::<D>::new([0.0; D], [spacing * f64::from(side); D], Axis::Periodic);
    let mut rules = Rules::default();
    for k in 0..D {
        if random.below(3) == 0 {
            boundary.axes[k] = Axis::Walls;
            rules.field[k] = if random.below(2) == 0 { random.normal() } else { 0.0 };
        }
    }
    if random.below(3) == 0 {
        (rules.restitution, rules.elastic_below) = ((0.5 + 0.5 * random.uniform()).into(), 0.05);
    }
    let mut particles = Particles::new();
    for number in 0..(side as usize).pow(D as u32) {
        let place = Vector::from_fn(|k| (0.5 + (number / (side as usize).pow(k as u32) % side as usize) as f64) * spacing);
        let velocity = Vector::from_fn(|_| random.normal());
        particles.push(place, velocity, 10f64.powf(random.uniform()), 0.45 + 0.05 * random.uniform(), 0);
    }
    if random.below(2) == 0 {
        // Pegs in the middle between the places.
        for _ in 0..8 {
            let centre = Vector::from_fn(|_| f64::from(random.below(side as u32)) * spacing);
            boundary.obstacles.push(Obstacle { centre, radius: 0.1 + 0.1 * random.uniform() });
        }
    }
    (boundary, particles, rules)
}

/// A random system whose radii and masses are spread evenly in the logarithm over a factor of 1000, as many as fit: any mix
/// of faces, small ones in every corner that large ones leave.
pub(crate) fn system_of_sizes<const D: usize>(seed: u64) -> (Boundary<D>, Particles<D>, Rules<D>) {
    let mut random = Random::new(seed, 4);
    let mut boundary = Boundary::<D>::new([0.0; D], std::array::from_fn(|_| 3.0 + 2.0 * random.uniform()), Axis::Walls);
    for axis in &mut boundary.axes {
        *axis = [Axis::Walls, Axis::Periodic][random.below(2) as usize];
    }
    let mut radii: Vec<f64> = (0..20).map(|_| 1000f64.powf(-random.uniform())).collect();
    radii.sort_by(|a, b| b.total_cmp(a));
    let mut particles = Particles::new();
    for radius in radii {
        let mass = 1000f64.powf(random.uniform());
        for _ in 0..50 {
            let place = Vector::from_fn(|k| boundary.upper[k] * random.uniform());
            let mut candidate = particles.clone();
            candidate.push(place, Vector::from_fn(|_| random.normal() / mass.sqrt()), mass, radius, 0);
            if boundary.validate_particles(&candidate).is_ok() {
                particles = candidate;
                break;
            }
        }
    }
    // Names say nothing of sizes.
    let mut order: Vec<usize> = (0..particles.len()).collect();
    random.shuffle(&mut order);
    let Particles { position, velocity, mass, radius, .. } = particles;
    let mut shuffled = Particles::new();
    for i in order {
        shuffled.push(position[i], velocity[i], mass[i], radius[i], 0);
    }
    (boundary, shuffled, Rules::default())
}

/// So many points at a temperature, evenly over the places where `keep` allows them.
pub(crate) fn points<const D: usize>(
    boundary: &Boundary<D>,
    n: usize,
    temperature: f64,
    random: &mut Random,
    keep: impl Fn(Vector<D>) -> bool,
) -> Particles<D> {
    let mut particles = Particles::new();
    while particles.len() < n {
        let place = Vector::from_fn(|k| boundary.lower[k] + boundary.extent()[k] * random.uniform());
        if keep(place) {
            particles.push(place, Vector::ZERO, 1.0, 0.0, 0);
        }
    }
    maxwell(&mut particles, temperature, false, random);
    particles
}

/// Asserts that a score is one of a standard normal deviate, and says what it is.
pub(crate) fn assert_score(what: &str, score: f64) {
    println!("{what}: z = {score:.2}");
    assert!(score.abs() < 3.0, "{what}: z = {score}");
}

/// Asserts that an estimate agrees with theory.
pub(crate) fn assert_estimate(what: &str, estimate: Estimate, expected: f64) {
    let Estimate { mean, standard_error, .. } = estimate;
    assert_score(&format!("{what}: {mean:.6} +- {standard_error:.6}, expected {expected:.6}"), estimate.score(expected));
}
