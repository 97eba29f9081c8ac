//! Square wells and shoulders: against the plain engine, conservation, and the second virial coefficient.

use std::ops::ControlFlow;

use crate::common::{largest_overlap, random_system, same_bits};
use crate::reference::{Event, Reference};
use corpuscle_core::particles::ball_volume;
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Contact, Engine, Meeting, Observer, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Pair, Restitution, Rules};

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

/// Compares event by event as `differential.rs` does, and answers how many there were. The factor by which errors grow
/// includes that of `sqrt(v_n^2 - 2 depth / mu)` where a pair just escapes.
fn compare<const D: usize>(mut engine: EventDriven<D>, mut plain: Reference<D>, seed: u64, wanted: usize) -> usize {
    let (mut depth, mut agreed) = (vec![0; engine.particle_count()], 0);
    while agreed < wanted && plain.scale < 1.0 + 1e-9 {
        let Some(expected) = plain.step(20.0) else { break };
        let mut next = Next::default();
        engine.advance(expected.time + 1e-3, &mut next).unwrap();
        let found = next.0.unwrap_or_else(|| panic!("system {seed}: event {agreed}, {expected:?}, is missing"));
        let chain = 1 + [Some(found.first), found.second].into_iter().flatten().map(|i| depth[i]).max().unwrap_or(0);
        assert_eq!(
            (found.first, found.second),
            (expected.first, expected.second),
            "system {seed}: event {agreed}: {found:?}, {expected:?}"
        );
        let error = (found.time - expected.time).abs();
        assert!(error < 1e-12 * 300f64.powi(chain), "system {seed}: event {agreed}, chain of {chain}: {found:?}, {expected:?}");
        [Some(found.first), found.second].into_iter().flatten().for_each(|i| depth[i] = chain);
        if chain == 3 {
            let radius = std::mem::take(&mut plain.particles.radius);
            plain.particles = Particles { radius, ..engine.snapshot() };
            plain.scale += plain.growth * (engine.time() - plain.time);
            plain.time = engine.time();
            depth.fill(0);
        }
        agreed += 1;
    }
    agreed
}

fn wells_agree<const D: usize>(seeds: std::ops::Range<u64>) {
    let (mut systems, mut events) = (0, 0);
    for seed in seeds {
        let (boundary, particles, mut rules) = random_system::<D>(seed);
        let mut random = Random::new(seed, 9);
        rules.restitution = Restitution::Constant(1.0);
        rules.pair = Pair::Well { range: 1.1 + 0.6 * random.uniform(), depth: 1.5 * random.normal() };
        // Boxes too small for two wells are refused.
        let Ok(engine) = EventDriven::new(boundary.clone(), particles.clone(), rules) else { continue };
        systems += 1;
        events += compare(engine, Reference::new(boundary, particles, rules), seed, 60);
    }
    println!("{D}-D: {events} events in {systems} systems");
    assert!(systems > 50 && events > 50 * systems, "{events} events in {systems} systems");
}

#[test]
fn discs_in_wells_meet_in_the_same_order() {
    wells_agree::<2>(0..150);
}

#[test]
fn spheres_in_wells_meet_in_the_same_order() {
    wells_agree::<3>(1000..1100);
}

fn growth_agrees<const D: usize>(seeds: std::ops::Range<u64>) {
    let (mut systems, mut events) = (0, 0);
    for seed in seeds {
        let (boundary, particles, _) = random_system::<D>(seed);
        let mut random = Random::new(seed, 9);
        let (scale, rate) = (0.2 * random.uniform(), 0.05 + 0.3 * random.uniform());
        let engine = EventDriven::growing(boundary.clone(), particles.clone(), scale, rate).unwrap();
        let mut plain = Reference::new(boundary, particles, Rules::default());
        (plain.scale, plain.growth) = (scale, rate);
        systems += 1;
        events += compare(engine, plain, seed, 60);
    }
    println!("{D}-D: {events} events in {systems} systems");
    assert!(events > 20 * systems, "{events} events in {systems} systems");
}

#[test]
fn growing_discs_and_spheres_meet_in_the_same_order() {
    growth_agrees::<2>(0..100);
    growth_agrees::<3>(1000..1060);
}

/// Equal spheres in wells in a periodic cube.
fn fluid<const D: usize>(n: usize, packing: f64, temperature: f64, pair: Pair, seed: u64) -> EventDriven<D> {
    let volume = n as f64 * ball_volume::<D>(0.5) / packing;
    let boundary = Boundary::<D>::periodic(volume.powf(1.0 / D as f64));
    let mut random = Random::new(seed, 0);
    let mut particles = Particles::new();
    for place in lattice(&boundary, n, 0.5, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    maxwell(&mut particles, temperature, true, &mut random);
    EventDriven::new(boundary, particles, Rules { pair, ..Rules::default() }).unwrap()
}

/// Virial `sum J r` over all events, attraction counted negative, and how many there were.
#[derive(Default)]
struct Virial {
    sum: f64,
    events: u64,
}

impl<const D: usize> Observer<D> for Virial {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        self.sum += contact.impulse * contact.distance;
        self.events += 1;
        ControlFlow::Continue(())
    }
}

/// Pairs nearer than the edge, counted by brute force, without those that rounding leaves undecided.
fn pairs_within<const D: usize>(engine: &EventDriven<D>, edge: f64) -> (usize, usize) {
    let (mut within, mut undecided) = (0, 0);
    let places: Vec<_> = (0..engine.particle_count()).map(|i| engine.position(i)).collect();
    for (i, &r) in places.iter().enumerate() {
        for &other in &places[..i] {
            let distance = engine.boundary().displacement(r, other).norm();
            within += usize::from(distance < edge * (1.0 - 1e-12));
            undecided += usize::from((distance / edge - 1.0).abs() <= 1e-12);
        }
    }
    (within, undecided)
}

fn energy_stays<const D: usize>(pair: Pair, packing: f64) {
    let Pair::Well { range, depth } = pair else { return };
    let mut engine = fluid::<D>(600, packing, 1.0, pair, 4);
    let kinetic = engine.kinetic_energy();
    let energy = kinetic + engine.potential_energy();
    for _ in 0..10 {
        let mut virial = Virial::default();
        while virial.events < 100_000 {
            engine.advance(engine.time() + 0.2, &mut virial).unwrap();
        }
        let drift = (engine.kinetic_energy() + engine.potential_energy() - energy).abs() / kinetic;
        assert!(drift < 1e-12, "energy drifted by {drift:e}");
        assert!(engine.momentum().norm() < 1e-11, "momentum drifted to {}", engine.momentum().norm());
        assert!(largest_overlap(&engine) < 1e-12);
        let (within, undecided) = pairs_within(&engine, range);
        let bonds = (-engine.potential_energy() / depth).round() as usize;
        assert!(within <= bonds && bonds <= within + undecided, "{bonds} pairs in their wells, {within} + {undecided} found");
    }
    let counts = engine.counts();
    println!("{D}-D, {pair:?}: {counts:?}");
    assert!(counts.edges > 100_000 && counts.collisions > 10_000);
}

#[test]
fn energy_and_momentum_stay_in_wells_and_on_shoulders() {
    energy_stays::<3>(Pair::Well { range: 1.5, depth: 1.0 }, 0.3);
    energy_stays::<3>(Pair::Well { range: 1.2, depth: -1.0 }, 0.4);
    energy_stays::<2>(Pair::Well { range: 2.0, depth: 0.5 }, 0.4);
    energy_stays::<2>(Pair::Well { range: 1.4, depth: -2.0 }, 0.5);
}

#[test]
fn stops_leave_no_trace_and_reversal_leads_back() {
    let pair = Pair::Well { range: 1.5, depth: 0.8 };
    let mut once = fluid::<2>(100, 0.3, 1.0, pair, 2);
    let (mut often, start) = (once.clone(), once.snapshot());
    once.advance(3.0, &mut ()).unwrap();
    for step in 1..=1000 {
        often.advance(0.003 * f64::from(step), &mut ()).unwrap();
    }
    often.advance(3.0, &mut ()).unwrap();
    assert_eq!(once.counts(), often.counts());
    assert!(same_bits(&once.snapshot(), &often.snapshot()));
    let mut echo = fluid::<2>(100, 0.3, 1.0, pair, 2);
    echo.advance(0.5, &mut ()).unwrap();
    echo.reverse_velocities();
    echo.advance(1.0, &mut ()).unwrap();
    assert!(echo.counts().edges > 20);
    for (i, &place) in start.position.iter().enumerate() {
        assert!(echo.boundary().displacement(echo.position(i), place).norm() < 1e-6);
    }
}

/// `Z - 1` at this density with its standard error, and the mean kinetic temperature.
fn excess<const D: usize>(packing: f64, pair: Pair, blocks: usize) -> (f64, f64, f64) {
    let n = 1000;
    let mut engine = fluid::<D>(n, packing, 1.5, pair, 17);
    let density = n as f64 / engine.boundary().volume();
    // Of the order of the mean time between a particle's collisions.
    let mean_free_time = 0.3 / density;
    engine.advance(20.0 * mean_free_time, &mut ()).unwrap();
    let (mut zs, mut temperature) = (vec![], 0.0);
    for _ in 0..blocks {
        let mut virial = Virial::default();
        let start = engine.time();
        let mut heat = 0.0;
        for _ in 0..10 {
            engine.advance(engine.time() + mean_free_time, &mut virial).unwrap();
            heat += 0.1 * 2.0 * engine.kinetic_energy() / (D * (n - 1)) as f64;
        }
        temperature += heat / blocks as f64;
        zs.push(virial.sum / (D as f64 * n as f64 * heat * (engine.time() - start)));
    }
    let mean = zs.iter().sum::<f64>() / blocks as f64;
    let variance = zs.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / (blocks - 1) as f64;
    // A pair has n - 1 partners, not n.
    let finite = 1.0 / (1.0 - 1.0 / n as f64);
    (mean * finite, (variance / blocks as f64).sqrt() * finite, temperature)
}

/// `Z - 1 = B2 n + B3 n^2 + ...`: at the densities `n` and `2 n` together, `(4 f(n) - f(2 n)) / (2 n)` is `B2` without the
/// third coefficient; the fourth leaves `-2 B4 n^2`, some 1e-3 of the `b0` of hard cores at this density.
fn second_virial_coefficient<const D: usize>(range: f64, depth: f64) {
    let pair = Pair::Well { range, depth };
    let packing = 0.006;
    // In units of b0 n = 2^(D-1) eta.
    let cores = f64::from(1 << (D - 1)) * packing;
    let theory = |temperature: f64| 1.0 - (range.powi(D as i32) - 1.0) * ((depth / temperature).exp() - 1.0);
    let (f1, error1, t1) = excess::<D>(packing, pair, 80);
    let (f2, error2, t2) = excess::<D>(2.0 * packing, pair, 80);
    let found = (4.0 * f1 - f2) / (2.0 * cores);
    let error = (16.0 * error1 * error1 + error2 * error2).sqrt() / (2.0 * cores);
    // The temperatures of the two runs differ a little.
    let expected = 2.0 * theory(t1) - theory(t2);
    let z = (found - expected) / error;
    println!(
        "{D}-D, range {range}, depth {depth}: B2/b0 = {found:.4} +- {error:.4}, expected {expected:.4}, z = {z:.2}; f {f1:.5} {f2:.5} T {t1:.4} {t2:.4}"
    );
    assert!(z.abs() < 4.0, "B2/b0 = {found} +- {error}, expected {expected}");
    assert!(error < 0.05, "too few events: +- {error}");
}

#[test]
fn wells_have_their_second_virial_coefficient() {
    second_virial_coefficient::<3>(1.5, 1.0);
    second_virial_coefficient::<2>(1.5, 1.0);
}

#[test]
fn shoulders_have_their_second_virial_coefficient() {
    second_virial_coefficient::<3>(1.5, -1.5);
    second_virial_coefficient::<2>(2.0, -1.0);
}

#[test]
fn nonsense_is_refused_by_name() {
    let start = |side: f64, range: f64, depth: f64| {
        let mut one = Particles::<2>::new();
        one.push(Vector([1.0, 1.0]), Vector::ZERO, 1.0, 0.5, 0);
        let rules = Rules { pair: Pair::Well { range, depth }, ..Rules::default() };
        EventDriven::new(Boundary::new([0.0; 2], [side; 2], Axis::Periodic), one, rules).err().map(|error| error.key)
    };
    assert_eq!(start(10.0, 1.5, 1.0), None);
    assert_eq!(start(10.0, 1.0, 1.0).as_deref(), Some("range"));
    assert_eq!(start(10.0, f64::NAN, 1.0).as_deref(), Some("range"));
    assert_eq!(start(10.0, 1.5, 0.0).as_deref(), Some("depth"));
    assert_eq!(start(10.0, 1.5, f64::INFINITY).as_deref(), Some("depth"));
    assert_eq!(start(3.0, 1.5, 1.0).as_deref(), Some("box"));
}
