//! An engine that is written down, forgotten and taken up again, at any time and however often, does what the unbroken one
//! does, to the last bit.

use crate::common::{Record, dense_system, face_centred, periodic_fluid, random_system, same_bits, system_of_sizes};
use corpuscle_checkpoint::{Reader, Writer};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Meeting, Particles, Piston, Random, Vector};
use corpuscle_event::{Counts, EventDriven, Pair, Rules};

/// Writes an engine down and takes it up again.
fn again<const D: usize>(engine: &EventDriven<D>) -> EventDriven<D> {
    let bytes = written(engine);
    let mut reader = Reader::new(&bytes);
    let again = reader.value("engine").unwrap();
    reader.end().unwrap();
    assert!(written(&again) == bytes, "it is not written down again as it was");
    again
}

fn written<const D: usize>(engine: &EventDriven<D>) -> Vec<u8> {
    let mut out = Writer::new();
    out.value("engine", engine).unwrap();
    out.finish()
}

fn bits<const D: usize>(contact: &Contact<D>) -> (Vec<u64>, String) {
    let numbers = [&[contact.time, contact.impulse, contact.distance][..], &contact.first.after.0, &contact.first.position.0];
    (numbers.concat().iter().map(|x| x.to_bits()).collect(), format!("{:?}", contact.with))
}

/// Runs to `end` unbroken, and in pieces between which the engine is only written down. Answers the number of contacts.
fn compare<const D: usize>(name: &str, unbroken: EventDriven<D>, end: f64, pieces: u32, random: &mut Random) -> usize {
    let (contacts, counts) = follow(name, unbroken, end, pieces, random);
    assert_eq!(counts[0], counts[1], "{name}");
    contacts
}

/// The same, but for what was counted: answers the number of contacts, and the counts of both runs.
fn follow<const D: usize>(
    name: &str,
    mut unbroken: EventDriven<D>,
    end: f64,
    pieces: u32,
    random: &mut Random,
) -> (usize, [Counts; 2]) {
    let mut broken = unbroken.clone();
    let (mut expected, mut found) = (Record::<D>::default(), Record::<D>::default());
    let start = unbroken.time();
    let outcome = unbroken.advance(start + end, &mut expected);
    let mut stops: Vec<f64> = (0..pieces).map(|_| start + end * random.uniform()).collect();
    stops.sort_by(f64::total_cmp);
    // A contact's own time is a time like any other.
    if let Some(contact) = expected.contacts.get(expected.contacts.len() / 2) {
        stops.push(contact.time);
        stops.sort_by(f64::total_cmp);
    }
    let mut of_pieces = Ok(());
    for stop in stops.into_iter().chain([start + end]) {
        of_pieces = broken.advance(stop, &mut found);
        if of_pieces.is_err() {
            break;
        }
        broken = again(&broken);
    }
    assert_eq!(outcome, of_pieces, "{name}");
    for (k, (a, b)) in expected.contacts.iter().zip(&found.contacts).enumerate() {
        assert_eq!(bits(a), bits(b), "{name}: contact {k} at t = {}", a.time);
    }
    assert_eq!(expected.contacts.len(), found.contacts.len(), "{name}");
    assert!(same_bits(&unbroken.snapshot(), &broken.snapshot()), "{name}");
    for i in 0..unbroken.particle_count() {
        assert_eq!((unbroken.lazy(i), unbroken.images(i)), (broken.lazy(i), broken.images(i)), "{name}: particle {i}");
    }
    assert_eq!(unbroken.piston(), broken.piston(), "{name}");
    assert_eq!(unbroken.potential_energy().to_bits(), broken.potential_energy().to_bits(), "{name}");
    (expected.contacts.len(), [unbroken.counts(), broken.counts()])
}

fn start<const D: usize>((boundary, particles, rules): (Boundary<D>, Particles<D>, Rules<D>)) -> EventDriven<D> {
    EventDriven::new(boundary, particles, rules).unwrap()
}

/// Boxes of all kinds with everything that can stand in them: warm and moving faces, pistons, obstacles, plates that go.
#[test]
fn in_random_boxes() {
    let mut random = Random::new(71, 0);
    let mut contacts = 0;
    for seed in 0..300 {
        contacts += compare(&format!("plane {seed}"), start(random_system::<2>(seed)), 10.0, 20, &mut random);
        contacts += compare(&format!("space {seed}"), start(random_system::<3>(seed)), 10.0, 20, &mut random);
    }
    println!("{contacts} contacts");
    assert!(contacts > 100_000);
}

/// Neighbour lists, in fields as well, and mixtures with several grids.
#[test]
fn dense_and_of_many_sizes() {
    let mut random = Random::new(72, 0);
    for seed in 0..60 {
        compare(&format!("dense plane {seed}"), start(dense_system::<2>(seed)), 10.0, 10, &mut random);
        compare(&format!("dense space {seed}"), start(dense_system::<3>(seed)), 3.0, 10, &mut random);
        compare(&format!("sizes, plane {seed}"), start(system_of_sizes::<2>(seed)), 5.0, 10, &mut random);
        compare(&format!("sizes, space {seed}"), start(system_of_sizes::<3>(seed)), 5.0, 10, &mut random);
    }
}

/// Over several epochs, in fluids large enough for particles to be sorted in memory.
#[test]
fn fluids_over_epochs() {
    let mut random = Random::new(73, 0);
    let contacts = [
        compare("dilute", periodic_fluid::<3>(500, 0.1, 1), 800.0, 30, &mut random),
        compare("dense discs", periodic_fluid::<2>(500, 0.68, 2), 40.0, 30, &mut random),
        compare("dense spheres", face_centred(5, 0.5, 3), 40.0, 30, &mut random),
    ];
    assert!(contacts.iter().all(|&contacts| contacts > 3 * (1 << 16)), "{contacts:?}");
}

/// Square wells, where who is in whose well is remembered; and spheres that grow.
#[test]
fn wells_and_growth() {
    let mut random = Random::new(74, 0);
    for seed in 0..10 {
        let fluid = periodic_fluid::<3>(100, 0.2, seed);
        let rules = Rules { pair: Pair::Well { range: 1.4, depth: 0.7 }, ..Rules::default() };
        let wells = EventDriven::new(fluid.boundary().clone(), fluid.snapshot(), rules).unwrap();
        compare(&format!("wells {seed}"), wells, 5.0, 10, &mut random);
        let growing = EventDriven::growing(fluid.boundary().clone(), fluid.snapshot(), 0.3, 0.05).unwrap();
        compare(&format!("growing {seed}"), growing, 12.0, 10, &mut random);
    }
}

/// Events at exactly equal times: a lattice whose particles all move at one speed along its axes.
#[test]
fn ties() {
    let mut random = Random::new(75, 0);
    for seed in 0..20 {
        let boundary = Boundary::<2>::periodic(16.0);
        let mut particles = Particles::new();
        for k in 0..64 {
            let place = Vector([f64::from(k % 8) * 2.0 + 1.0, f64::from(k / 8) * 2.0 + 1.0]);
            let velocity = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]][random.below(4) as usize];
            particles.push(place, Vector(velocity), 1.0, 0.5, 0);
        }
        let engine = EventDriven::new(boundary, particles, Rules::default()).unwrap();
        compare(&format!("ties {seed}"), engine, 20.0, 10, &mut random);
    }
}

/// Rows of discs that meet a piston at exactly the same times, on both sides and while they meet each other.
fn rows_at_a_piston(seed: u64) -> EventDriven<2> {
    let mut random = Random::new(seed, 76);
    let mut room = Boundary::<2>::new([0.0; 2], [16.0; 2], Axis::Walls);
    room.piston = Some(Piston { axis: 0, position: 8.0, velocity: 0.0, mass: 8.0, force: 0.0, stops: [2.0, 14.0] });
    let mut particles = Particles::new();
    for k in 0..64 {
        let place = Vector([f64::from(k % 8) * 2.0 + 1.0, f64::from(k / 8) * 2.0 + 1.0]);
        let velocity = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]][random.below(4) as usize];
        particles.push(place, Vector(velocity), 1.0, 0.5, 0);
    }
    EventDriven::new(room, particles, Rules::default()).unwrap()
}

/// Found by it: with seed 1 the contact of particle 59 at t = 1.7051805070877444 was passed over, where particle 19 pushes the
/// piston one unit of the last digit later.
#[test]
fn ties_at_a_piston() {
    let mut random = Random::new(76, 0);
    for seed in 0..40 {
        let name = format!("piston {seed}");
        let (_, counts) = follow(&name, rows_at_a_piston(seed), 20.0, 20, &mut random);
        // A particle that stands exactly on a face between cells may be found again on the other side of it.
        let [unbroken, broken] = counts.map(|counts| Counts { crossings: 0, ..counts });
        assert_eq!(unbroken, broken, "{name}");
    }
}

/// Six discs side by side reach a piston at one instant. Each that comes pushes it away from the others, but never faster than
/// they come: all meet it at that instant, in the order of their indices.
#[test]
fn contacts_with_a_piston_at_one_instant_come_in_the_order_of_particles() {
    let mut room = Boundary::<2>::new([0.0; 2], [16.0; 2], Axis::Walls);
    room.piston = Some(Piston { axis: 0, position: 8.0, velocity: 0.0, mass: 8.0, force: 0.0, stops: [2.0, 14.0] });
    let mut particles = Particles::new();
    for y in [5.0, 1.0, 13.0, 3.0, 9.0, 7.0] {
        particles.push(Vector([7.0, y]), Vector([1.0, 0.0]), 1.0, 0.5, 0);
    }
    let mut engine = EventDriven::new(room, particles, Rules::default()).unwrap();
    for written_down in [false, true] {
        let mut record = Record::<2>::default();
        let mut engine = if written_down { again(&engine) } else { engine.clone() };
        engine.advance(0.6, &mut record).unwrap();
        assert!(record.contacts.iter().all(|contact| contact.time == 0.5 && matches!(contact.with, Meeting::Piston { .. })));
        let order: Vec<usize> = record.contacts.iter().map(|contact| contact.first.index).collect();
        assert_eq!(order, [0, 1, 2, 3, 4, 5]);
    }
    engine.advance(0.5, &mut ()).unwrap();
    let u = engine.piston().unwrap().velocity;
    // Each takes the seven ninths of what is missing to 1 that the one before left.
    assert!((u - (1.0 - (7.0f64 / 9.0).powi(6))).abs() < 1e-15, "{u}");
}

/// What is no engine is refused, and says why; nothing panics.
#[test]
fn a_state_that_makes_no_sense_is_refused() {
    let good = written(&start(dense_system::<2>(1)));
    let refusal = |bytes: &[u8]| Reader::new(bytes).value::<EventDriven<2>>("engine").map(|_| ()).unwrap_err().to_string();
    assert!(Reader::new(&good).value::<EventDriven<3>>("engine").is_err(), "a plane is no space");
    for end in 0..good.len() {
        refusal(&good[..end]);
    }
    // The first own time becomes something that is no number.
    let at = good.windows(8).position(|window| window == b"own_time").unwrap() + 8;
    let number = good[at..].iter().position(|&byte| byte == 0xcb).unwrap() + at + 1;
    let mut bad = good;
    bad[number..number + 8].copy_from_slice(&f64::NAN.to_be_bytes());
    assert!(refusal(&bad).contains("a finite number"), "{}", refusal(&bad));
}
