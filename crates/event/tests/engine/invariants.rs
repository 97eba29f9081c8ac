//! What must hold for every system: random ones, in both dimensions and all kinds of boxes.

use std::ops::ControlFlow;

use crate::common::{Record, StopAfter, dense_system, largest_overlap, random_system, same_bits, system_of_sizes};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Meeting, Observer, Particles, Vector};
use corpuscle_event::{EventDriven, Rules};
use proptest::prelude::*;

/// Counts contacts and checks that each is sensible by itself.
struct Sane<const D: usize> {
    boundary: Boundary<D>,
    time: f64,
    contacts: usize,
    wanted: usize,
}

impl<const D: usize> Observer<D> for Sane<D> {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        assert!(contact.time >= self.time, "the clock went back from {} to {}", self.time, contact.time);
        assert!(contact.impulse >= 0.0);
        assert!((contact.normal.norm() - 1.0).abs() < 1e-12);
        let Contact { first, normal, impulse, .. } = *contact;
        let mut missing = first.after + normal * (impulse / first.mass) - first.before;
        if let Meeting::Face { axis, upper } = contact.with
            && self.boundary.faces[axis][usize::from(upper)].temperature.is_some()
        {
            // Tangentially it comes out anew.
            missing = normal * missing.dot(normal);
        }
        assert!(missing.norm() < 1e-12 * (1.0 + first.before.norm() + first.after.norm()));
        if let Meeting::Piston { before, after } = contact.with {
            let piston = self.boundary.piston.unwrap();
            let gained = (after - before) * normal[piston.axis] * piston.mass;
            assert!((gained - impulse).abs() < 1e-12 * (1.0 + piston.mass * (before.abs() + after.abs())));
        }
        self.time = contact.time;
        self.contacts += 1;
        if self.contacts < self.wanted { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

fn energy<const D: usize>(engine: &EventDriven<D>) -> f64 {
    engine.kinetic_energy() + engine.potential_energy() + engine.piston().map_or(0.0, |piston| piston.energy())
}

fn holds_its_invariants<const D: usize>(system: (Boundary<D>, Particles<D>, Rules<D>)) {
    let (boundary, particles, rules) = system;
    let scale = particles.kinetic_energy() + 10.0 * rules.field.norm() * particles.mass.iter().sum::<f64>();
    let (start_energy, start_momentum) = {
        let engine = EventDriven::new(boundary.clone(), particles.clone(), rules).unwrap();
        (energy(&engine), engine.momentum())
    };
    let first = particles.position.clone();
    let driven = boundary.faces.iter().flatten().any(|face| face.motion.is_some() || face.temperature.is_some());
    let smallest = particles.radius.iter().copied().fold(f64::INFINITY, f64::min);
    let mut engine = EventDriven::new(boundary.clone(), particles, rules).unwrap();
    let mut sane = Sane { boundary: boundary.clone(), time: 0.0, contacts: 0, wanted: 500 };
    while sane.contacts < sane.wanted && engine.time() < 100.0 {
        engine.advance(engine.time() + 0.5, &mut sane).unwrap();
        let now = engine.snapshot();
        assert!(boundary.largest_overlap(&now) < 2e-10 * smallest, "overlap of {}", boundary.largest_overlap(&now));
        let time = engine.time();
        for (i, (r, radius)) in now.position.iter().zip(&now.radius).enumerate() {
            for k in (0..D).filter(|&k| boundary.axes[k] != Axis::Open) {
                let margin = if boundary.axes[k] == Axis::Walls { radius - 1e-10 } else { 0.0 };
                for (upper, sign) in [(false, 1.0), (true, -1.0)] {
                    let depth = sign * (r[k] - boundary.face_at(k, upper, time).0);
                    let stands = boundary.faces[k][usize::from(upper)].stands_at(time);
                    assert!(depth >= margin || !stands, "outside: {r:?}, {:?} at {time}", boundary.faces[k]);
                }
            }
            for plate in boundary.partitions.iter().filter(|plate| plate.stands_at(time)) {
                assert!(plate.distance(*r) >= radius - 1e-10, "inside a plate: {r:?}");
            }
            for obstacle in &boundary.obstacles {
                let distance = boundary.displacement(obstacle.centre, *r).norm();
                assert!(distance >= radius + obstacle.radius - 1e-10, "inside an obstacle: {r:?}");
            }
            if let (Some(piston), Some(start)) = (engine.piston(), boundary.piston) {
                let side = (first[i][start.axis] - start.position).signum();
                assert!(side * (r[start.axis] - piston.position) >= radius - 1e-10, "through the piston: {r:?}");
                let [low, high] = piston.stops;
                assert!(low - 1e-10 <= piston.position && piston.position <= high + 1e-10, "beyond its stops: {piston:?}");
            }
        }
    }
    let total = energy(&engine);
    if driven {
        // Energy comes and goes.
    } else if rules.restitution.is_elastic() {
        assert!((total - start_energy).abs() < 1e-11 * scale, "energy drifted by {}", total - start_energy);
    } else {
        assert!(total <= start_energy + 1e-11 * scale, "dissipation made energy");
    }
    if boundary.conserves_momentum() {
        assert!((engine.momentum() - start_momentum).norm() < 1e-11 * (1.0 + scale));
    }
}

/// Once to the end, and in many steps with looks at the particles in between.
fn stops_leave_no_trace<const D: usize>(system: (Boundary<D>, Particles<D>, Rules<D>)) {
    let (boundary, particles, rules) = system.clone();
    let mut once = EventDriven::new(boundary, particles, rules).unwrap();
    let mut often = once.clone();
    let (mut a, mut b) = (Record::default(), Record::default());
    once.advance(3.0, &mut a).unwrap();
    for step in 1..=1000 {
        often.advance(0.003 * f64::from(step), &mut b).unwrap();
        let _ = (often.snapshot(), energy(&often));
    }
    often.advance(3.0, &mut b).unwrap();
    assert!(same_bits(&once.snapshot(), &often.snapshot()));
    assert_eq!(once.piston(), often.piston());
    assert_eq!(a.contacts, b.contacts);
    // And stopped by the observer after every contact.
    let (boundary, particles, rules) = system;
    let mut stopped = EventDriven::new(boundary, particles, rules).unwrap();
    while stopped.time() < 3.0 {
        stopped.advance(3.0, &mut StopAfter(1)).unwrap();
    }
    assert!(same_bits(&once.snapshot(), &stopped.snapshot()));
    assert_eq!(once.piston(), stopped.piston());
}

fn returns_when_reversed<const D: usize>(system: (Boundary<D>, Particles<D>, Rules<D>)) {
    let (mut boundary, particles, mut rules) = system;
    rules.restitution = 1.0.into();
    // What has a time of its own does not turn round.
    boundary.faces = std::array::from_fn(|_| Default::default());
    boundary.partitions.iter_mut().for_each(|plate| plate.removed_at = None);
    let mut engine = EventDriven::new(boundary.clone(), particles.clone(), rules).unwrap();
    // One contact a particle in the mean, so that rounding has not grown far.
    let mut sane = Sane { boundary: boundary.clone(), time: 0.0, contacts: 0, wanted: particles.len().div_ceil(2) };
    engine.advance(5.0, &mut sane).unwrap();
    let turn = engine.time();
    engine.reverse_velocities();
    engine.advance(2.0 * turn, &mut ()).unwrap();
    engine.reverse_velocities();
    let back = engine.snapshot();
    for i in 0..particles.len() {
        let error = engine.boundary().displacement(back.position[i], particles.position[i]).norm();
        assert!(error < 1e-5, "particle {i} missed its start by {error}");
        assert!((back.velocity[i] - particles.velocity[i]).norm() < 1e-5);
    }
}

/// So many random systems as a rule, and as many times more as `make fuzz` asks for.
fn cases(usual: u32) -> u32 {
    usual * std::env::var("FUZZ_FACTOR").ok().and_then(|factor| factor.parse().ok()).unwrap_or(1)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases(150)) })]
    #[test]
    fn discs_hold_their_invariants(seed in any::<u64>()) { holds_its_invariants::<2>(random_system(seed)); }
    #[test]
    fn spheres_hold_their_invariants(seed in any::<u64>()) { holds_its_invariants::<3>(random_system(seed)); }
    #[test]
    fn stopping_discs_leaves_no_trace(seed in any::<u64>()) { stops_leave_no_trace::<2>(random_system(seed)); }
    #[test]
    fn stopping_spheres_leaves_no_trace(seed in any::<u64>()) { stops_leave_no_trace::<3>(random_system(seed)); }
    #[test]
    fn reversed_discs_return(seed in any::<u64>()) { returns_when_reversed::<2>(random_system(seed)); }
    #[test]
    fn reversed_spheres_return(seed in any::<u64>()) { returns_when_reversed::<3>(random_system(seed)); }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases(40)) })]
    #[test]
    fn dense_discs_hold_their_invariants(seed in any::<u64>()) { holds_its_invariants::<2>(dense_system(seed)); }
    #[test]
    fn dense_spheres_hold_their_invariants(seed in any::<u64>()) { holds_its_invariants::<3>(dense_system(seed)); }
    #[test]
    fn stopping_dense_discs_leaves_no_trace(seed in any::<u64>()) { stops_leave_no_trace::<2>(dense_system(seed)); }
    #[test]
    fn stopping_dense_spheres_leaves_no_trace(seed in any::<u64>()) { stops_leave_no_trace::<3>(dense_system(seed)); }
    #[test]
    fn reversed_dense_discs_return(seed in any::<u64>()) { returns_when_reversed::<2>(dense_system(seed)); }
    #[test]
    fn reversed_dense_spheres_return(seed in any::<u64>()) { returns_when_reversed::<3>(dense_system(seed)); }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases(60)) })]
    #[test]
    fn discs_of_all_sizes_hold_their_invariants(seed in any::<u64>()) { holds_its_invariants::<2>(system_of_sizes(seed)); }
    #[test]
    fn spheres_of_all_sizes_hold_their_invariants(seed in any::<u64>()) { holds_its_invariants::<3>(system_of_sizes(seed)); }
    #[test]
    fn stopping_discs_of_all_sizes_leaves_no_trace(seed in any::<u64>()) { stops_leave_no_trace::<2>(system_of_sizes(seed)); }
    #[test]
    fn stopping_spheres_of_all_sizes_leaves_no_trace(seed in any::<u64>()) { stops_leave_no_trace::<3>(system_of_sizes(seed)); }
}

/// What the tests of dense systems rely on.
#[test]
fn dense_systems_use_neighbour_lists() {
    fn check<const D: usize>(seed: u64) {
        let (boundary, particles, rules) = dense_system::<D>(seed);
        let mut engine = EventDriven::new(boundary, particles, rules).unwrap();
        engine.advance(5.0, &mut ()).unwrap();
        let counts = engine.counts();
        assert!(counts.rebuilds > 0 && counts.crossings == 0, "{counts:?}");
    }
    (0..20).for_each(check::<2>);
    (0..20).for_each(check::<3>);
}

/// Time is counted from a new epoch every 65536 contacts here: that depends on no stop either.
#[test]
fn stops_leave_no_trace_across_epochs() {
    let mut once = crate::common::periodic_fluid::<2>(64, 0.5, 9);
    let mut often = once.clone();
    once.advance(600.0, &mut ()).unwrap();
    for step in 1..=6000 {
        often.advance(0.1 * f64::from(step), &mut ()).unwrap();
    }
    assert!(once.counts().collisions > 100_000, "{:?}", once.counts());
    assert_eq!(once.counts(), often.counts());
    assert!(same_bits(&once.snapshot(), &often.snapshot()));
}

#[test]
fn a_lone_particle_counts_its_turns_round_the_box() {
    let mut one = Particles::<2>::new();
    one.push(Vector([0.5, 0.5]), Vector([1.0, -0.25]), 1.0, 0.1, 0);
    let mut engine = EventDriven::new(Boundary::periodic(2.0), one, Rules::default()).unwrap();
    engine.advance(1000.0, &mut ()).unwrap();
    assert_eq!(engine.images(0), [500, -125]);
    assert!((engine.unwrapped(0) - Vector([1000.5, -249.5])).norm() < 1e-11);
}

/// A partition right behind a periodic face is met through it.
#[test]
fn a_plate_is_met_through_a_periodic_face() {
    let mut boundary = Boundary::<2>::periodic(4.0);
    boundary.partitions.push(corpuscle_core::Partition::new(0, 0.25));
    let mut one = Particles::new();
    one.push(Vector([2.0, 2.0]), Vector([1.0, 0.5]), 1.0, 0.5, 0);
    let mut engine = EventDriven::new(boundary, one, Rules::default()).unwrap();
    let mut record = Record::default();
    engine.advance(6.0, &mut record).unwrap();
    let times: Vec<f64> = record.contacts.iter().map(|contact| contact.time).collect();
    // To 3.75 (1.75 away), back to 0.75 (3 away), and so on.
    assert_eq!(times, [1.75, 4.75]);
    assert!(engine.position(0)[0] > 0.75);
}

/// An inelastic ball comes to rest after `sqrt(2 h / g) (1 + e) / (1 - e)`: the engine says so rather than hang, and with
/// `elastic_below` goes on.
#[test]
fn a_ball_at_rest_is_reported_and_a_rule_keeps_it_alive() {
    let mut ball = Particles::<2>::new();
    ball.push(Vector([5.0, 3.0]), Vector::ZERO, 1.0, 1.0, 0);
    let room = Boundary::new([0.0; 2], [10.0; 2], Axis::Walls);
    let mut rules = Rules { restitution: 0.5.into(), field: Vector([0.0, -4.0]), ..Rules::default() };
    let mut engine = EventDriven::new(room.clone(), ball.clone(), rules).unwrap();
    let failure = engine.advance(10.0, &mut ()).unwrap_err();
    assert_eq!(failure.particle, Some(0));
    assert!((failure.time - 3.0).abs() < 1e-9, "{failure}");
    assert!(failure.cause.contains("elastic_below"));
    rules.elastic_below = 0.01;
    let mut engine = EventDriven::new(room, ball, rules).unwrap();
    engine.advance(10.0, &mut ()).unwrap();
    assert!((engine.position(0)[1] - 1.0).abs() < 1e-4);
}

#[test]
fn nonsense_is_refused_by_name() {
    let start = |mass: f64, rules: Rules<2>| {
        let mut one = Particles::<2>::new();
        one.push(Vector([5.0, 5.0]), Vector::ZERO, mass, 1.0, 0);
        EventDriven::new(Boundary::periodic(10.0), one, rules).err().map(|error| error.key)
    };
    assert_eq!(start(1.0, Rules::default()), None);
    assert_eq!(start(0.0, Rules::default()).as_deref(), Some("mass of particle 0"));
    assert_eq!(start(1.0, Rules { restitution: 1.5.into(), ..Rules::default() }).as_deref(), Some("restitution"));
    assert_eq!(start(1.0, Rules { elastic_below: f64::NAN, ..Rules::default() }).as_deref(), Some("elastic_below"));
    assert_eq!(start(1.0, Rules { field: Vector([f64::INFINITY, 0.0]), ..Rules::default() }).as_deref(), Some("field"));
}

#[test]
fn a_shift_into_another_particle_is_refused_and_changes_nothing() {
    let mut engine = crate::common::periodic_fluid::<2>(16, 0.3, 1);
    engine.advance(1.0, &mut ()).unwrap();
    let before = engine.snapshot();
    let onto = engine.position(1) - engine.position(0);
    assert!(engine.shift_position(0, onto).is_err());
    assert!(same_bits(&before, &engine.snapshot()));
    engine.shift_position(0, Vector([1e-9, 0.0])).unwrap();
    engine.advance(20.0, &mut ()).unwrap();
    assert!(largest_overlap(&engine) < 1e-10);
}

/// Removing a partition lets the gas through; a box that cuts particles is refused.
#[test]
fn a_box_can_change_between_two_events() {
    let (mut boundary, particles, _) = random_system::<2>(1);
    boundary.axes = [Axis::Walls; 2];
    (boundary.faces, boundary.obstacles, boundary.piston) = (Default::default(), vec![], None);
    let mut engine = EventDriven::new(Boundary { axes: [Axis::Open; 2], ..boundary.clone() }, particles, Rules::default()).unwrap();
    let smaller = Boundary { upper: boundary.upper * 0.5, axes: [Axis::Walls; 2], ..boundary.clone() };
    assert!(engine.set_boundary(smaller).is_err());
    let energy = engine.kinetic_energy();
    boundary.partitions.clear();
    boundary.axes = [Axis::Open; 2];
    engine.set_boundary(boundary).unwrap();
    engine.advance(10.0, &mut ()).unwrap();
    assert!((engine.kinetic_energy() - energy).abs() < 1e-12 * energy);
}
