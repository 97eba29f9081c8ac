//! The engine against the plain one, on random systems: the same collisions in the same order, until rounding parts them.

use std::ops::ControlFlow;

use crate::common::{dense_system, random_system, system_of_sizes};
use crate::reference::{Event, Reference};
use corpuscle_core::{Boundary, Contact, Engine, Meeting, Observer, Particles};
use corpuscle_event::{EventDriven, Rules};

type System<const D: usize> = (Boundary<D>, Particles<D>, Rules<D>);

/// How many contacts of each kind have been compared.
#[derive(Debug, Default)]
struct Compared {
    pairs: u64,
    plain_faces: u64,
    warm_faces: u64,
    moving_faces: u64,
    partitions: u64,
    obstacles: u64,
    piston: u64,
}

impl Compared {
    fn add<const D: usize>(&mut self, with: &Meeting<D>, boundary: &Boundary<D>) {
        *match with {
            Meeting::Pair(_) => &mut self.pairs,
            &Meeting::Face { axis, upper } => match &boundary.faces[axis][usize::from(upper)] {
                face if face.motion.is_some() => &mut self.moving_faces,
                face if face.temperature.is_some() => &mut self.warm_faces,
                _ => &mut self.plain_faces,
            },
            Meeting::Partition { .. } => &mut self.partitions,
            Meeting::Obstacle { .. } => &mut self.obstacles,
            Meeting::Piston { .. } => &mut self.piston,
        } += 1;
    }
}

/// Compares the contacts of both engines one by one and answers how many there were.
///
/// Trajectories that differ by rounding part at each collision by a factor of about free path over radius. So a contact
/// whose chain of causes is `depth` contacts long must come at the same time within `1e-12 x 100^depth`. When a chain has
/// reached three, the plain engine takes over the state of the other and the comparison goes on, without a gap.
fn compare<const D: usize>(seed: u64, system: System<D>, wanted: usize, kinds: &mut Compared) -> usize {
    let (boundary, particles, rules) = system;
    let n = particles.len();
    let mut engine = EventDriven::new(boundary.clone(), particles.clone(), rules).unwrap();
    let mut plain = Reference::new(boundary, particles, rules);
    let (mut depth, mut agreed) = (vec![0; n], 0);
    while agreed < wanted {
        let Some(expected) = plain.step(50.0) else { break };
        let mut next = Next(None, None);
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
            plain.boundary.piston = engine.piston();
            plain.time = engine.time();
            depth.fill(0);
        }
        kinds.add(&next.1.unwrap(), engine.boundary());
        agreed += 1;
    }
    agreed
}

/// The first contact, and no more.
struct Next<const D: usize>(Option<Event>, Option<Meeting<D>>);

impl<const D: usize> Observer<D> for Next<D> {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        let second = if let Meeting::Pair(second) = contact.with { Some(second.index) } else { None };
        self.1 = Some(contact.with);
        self.0 = Some(Event { time: contact.time, first: contact.first.index, second });
        ControlFlow::Break(())
    }
}

fn compare_all<const D: usize>(seeds: std::ops::Range<u64>, system: impl Fn(u64) -> System<D>) -> Compared {
    let systems = seeds.end - seeds.start;
    let mut kinds = Compared::default();
    let total: usize = seeds.map(|seed| compare::<D>(seed, system(seed), 60, &mut kinds)).sum();
    println!("{D}-D: {kinds:?}");
    assert!(total as u64 >= 50 * systems, "only {total} contacts compared in {systems} systems");
    kinds
}

fn compare_furnished<const D: usize>(seeds: std::ops::Range<u64>) {
    let Compared { pairs, plain_faces, warm_faces, moving_faces, partitions, obstacles, piston } =
        compare_all::<D>(seeds, random_system);
    for count in [pairs, plain_faces, warm_faces, moving_faces, partitions, obstacles, piston] {
        assert!(count > 100, "a kind of contact is hardly compared");
    }
}

#[test]
fn discs_collide_in_the_same_order() {
    compare_furnished::<2>(0..300);
}

#[test]
fn spheres_collide_in_the_same_order() {
    compare_furnished::<3>(1000..1200);
}

/// Found through neighbour lists.
#[test]
fn dense_discs_collide_in_the_same_order() {
    assert!(compare_all::<2>(0..100, dense_system).obstacles > 100);
}

#[test]
fn dense_spheres_collide_in_the_same_order() {
    compare_all::<3>(0..10, dense_system);
}

/// Found in several grids.
#[test]
fn discs_of_all_sizes_collide_in_the_same_order() {
    let compared = compare_all::<2>(0..200, system_of_sizes);
    assert!(compared.pairs > 1000 && compared.plain_faces > 1000);
}

#[test]
fn spheres_of_all_sizes_collide_in_the_same_order() {
    let compared = compare_all::<3>(0..100, system_of_sizes);
    assert!(compared.pairs > 1000 && compared.plain_faces > 1000);
}
