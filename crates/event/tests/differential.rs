//! The engine against the plain one, on random systems: the same collisions in the same order, until rounding parts them.

mod reference;

use std::ops::ControlFlow;

use corpuscle_core::{Axis, Boundary, Contact, Engine, Hole, Meeting, Observer, Particles, Partition, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use reference::{Event, Reference};

/// A random system of up to 24 spheres: any mix of faces, radii over a factor of 10, masses over a factor of 100.
fn random_system<const D: usize>(seed: u64) -> (Boundary<D>, Particles<D>, Rules<D>) {
    let mut random = Random::new(seed, 1);
    let mut boundary =
        Boundary::<D>::new([0.0; D], std::array::from_fn(|_| 3.0 + 5.0 * random.uniform()), Axis::Walls);
    for axis in &mut boundary.axes {
        *axis = [Axis::Walls, Axis::Periodic][random.below(2) as usize];
    }
    let walled: Vec<usize> = (0..D).filter(|&k| boundary.axes[k] == Axis::Walls).collect();
    // A plate across a walled axis, its hole along another walled axis if there is one.
    if random.below(2) == 0 && !walled.is_empty() {
        let axis = walled[0];
        let side = boundary.extent();
        let hole = walled.get(1).map(|&along| Hole { along, from: 0.3 * side[along], to: (0.5 + 0.2 * random.uniform()) * side[along] });
        boundary.partitions.push(Partition { axis, position: 0.5 * side[axis], hole });
    }
    let mut rules = Rules::default();
    if random.below(3) == 0 {
        rules.restitution = 0.5 + 0.5 * random.uniform();
        rules.elastic_below = 0.05;
    }
    if random.below(3) == 0 {
        // Along walled axes, where it cannot heat the system for ever.
        walled.iter().for_each(|&k| rules.field[k] = random.normal());
    }
    let mut particles = Particles::new();
    let wanted = 4 + random.below(21) as usize;
    let large = random.below(3) == 0;
    for attempt in 0..4000 {
        if particles.len() == wanted {
            break;
        }
        let radius = if large && particles.is_empty() { 1.0 } else { 0.1 + 0.3 * random.uniform() * random.uniform() };
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

/// Compares the contacts of both engines one by one and answers how many there were.
///
/// Trajectories that differ by rounding part at each collision by a factor of about free path over radius. So a contact
/// whose chain of causes is `depth` contacts long must come at the same time within `1e-12 x 100^depth`. When a chain has
/// reached three, the plain engine takes over the state of the other and the comparison goes on, without a gap.
fn compare<const D: usize>(seed: u64, wanted: usize) -> usize {
    let (boundary, particles, rules) = random_system::<D>(seed);
    let n = particles.len();
    let mut engine = EventDriven::new(boundary.clone(), particles.clone(), rules).unwrap();
    let mut plain = Reference::new(boundary, particles, rules);
    let (mut depth, mut agreed) = (vec![0; n], 0);
    while agreed < wanted {
        let Some(expected) = plain.step(50.0) else { break };
        let mut next = Next::default();
        engine.advance(expected.time + 1e-3, &mut next).unwrap();
        let found = next.0.unwrap_or_else(|| panic!("system {seed}: contact {agreed}, {expected:?}, is missing"));
        let who = (found.first, found.second);
        let chain = 1 + [Some(found.first), found.second].into_iter().flatten().map(|i| depth[i]).max().unwrap_or(0);
        let tolerance = 1e-12 * 100f64.powi(chain);
        assert_eq!(who, (expected.first, expected.second), "system {seed}: contact {agreed}: {found:?}, {expected:?}");
        assert!(
            (found.time - expected.time).abs() < tolerance,
            "system {seed}: contact {agreed}, chain of {chain}: {found:?}, {expected:?}"
        );
        [Some(found.first), found.second].into_iter().flatten().for_each(|i| depth[i] = chain);
        if chain == 3 {
            plain.particles = engine.snapshot();
            plain.time = engine.time();
            depth.fill(0);
        }
        agreed += 1;
    }
    agreed
}

/// The first contact, and no more.
#[derive(Default)]
struct Next(Option<Event>);

impl<const D: usize> Observer<D> for Next {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        let second = if let Meeting::Pair(second) = contact.with { Some(second.index) } else { None };
        self.0 = Some(Event { time: contact.time, first: contact.first.index, second });
        ControlFlow::Break(())
    }
}

fn compare_all<const D: usize>(seeds: std::ops::Range<u64>) {
    let systems = seeds.end - seeds.start;
    let total: usize = seeds.map(|seed| compare::<D>(seed, 60)).sum();
    assert!(total as u64 >= 50 * systems, "only {total} contacts compared in {systems} systems");
}

#[test]
fn discs_collide_in_the_same_order() {
    compare_all::<2>(0..300);
}

#[test]
fn spheres_collide_in_the_same_order() {
    compare_all::<3>(1000..1200);
}
