//! The engine's contract: bits, walls, edits, refusals.

use std::ops::ControlFlow;

use corpuscle_core::{Axis, Boundary, Contact, Engine, Meeting, Observer, Particles, Partition, Random, Vector};
use corpuscle_time::{
    DrivingForce, Force, Gravity, Integrator, InversePower, PairForce, Signal, Spring, Springs, TimeDriven, UniformField,
    WeeksChandlerAndersen,
};

#[derive(Default)]
struct Contacts(Vec<Contact<2>>);

impl Observer<2> for Contacts {
    fn contact(&mut self, contact: &Contact<2>) -> ControlFlow<()> {
        self.0.push(*contact);
        ControlFlow::Continue(())
    }
}

fn one(position: [f64; 2], velocity: [f64; 2]) -> Particles<2> {
    let mut particles = Particles::new();
    particles.push(Vector(position), Vector(velocity), 2.0, 0.5, 0);
    particles
}

fn room(axis: Axis) -> Boundary<2> {
    Boundary::new([0.0; 2], [10.0, 4.0], axis)
}

#[test]
fn where_callers_stop_does_not_change_a_bit() {
    for name in Integrator::NAMES {
        let engine = || {
            let mut random = Random::new(1, 0);
            let mut particles = Particles::<3>::new();
            for i in 0..27 {
                let site = Vector::from_fn(|k| 1.2 * (i / 3usize.pow(k as u32) % 3) as f64 + 0.1 * random.uniform());
                particles.push(site, Vector::from_fn(|_| random.normal()), 1.0, 0.0, 0);
            }
            let mut forces: Vec<Box<dyn Force<3>>> = vec![Box::new(Gravity::new(0.5, 0.0))];
            if name == "wisdom-holman" {
                particles.mass[13] = 1e4; // it knows gravity alone, around a heavy star
            } else {
                forces.push(Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0))));
            }
            let space = Boundary::new([0.0; 3], [4.0; 3], Axis::Open);
            TimeDriven::new(space, particles, forces, Integrator::from_name(name, 0.01).unwrap()).unwrap()
        };
        let (mut whole, mut pieces) = (engine(), engine());
        whole.advance(1.0, &mut ()).unwrap();
        for piece in 1..=997 {
            pieces.advance(f64::from(piece) / 997.0, &mut ()).unwrap();
            let _ = (pieces.energy(), pieces.virial(), pieces.snapshot());
        }
        assert_eq!(whole.time(), 1.0);
        assert_eq!((whole.snapshot(), whole.steps(), whole.time()), (pieces.snapshot(), pieces.steps(), pieces.time()), "{name}");
    }
}

/// `advance` takes whole steps only; sums of the caller's that fall short by rounding do not lose one.
#[test]
fn whole_steps_only() {
    let mut engine =
        TimeDriven::new(room(Axis::Open), one([1.0; 2], [1.0, 0.0]), vec![], Integrator::VelocityVerlet { dt: 0.1 }).unwrap();
    engine.advance(0.25, &mut ()).unwrap();
    assert_eq!((engine.steps(), engine.time()), (2, 0.2));
    let mut to = 0.2;
    for _ in 0..1000 {
        to += 0.1;
        engine.advance(to, &mut ()).unwrap();
    }
    assert_eq!(engine.steps(), 1002);
}

/// Free flight between walls: the contacts' times, places and impulses are known.
#[test]
fn walls_reflect_and_report_their_impulse() {
    let mut engine =
        TimeDriven::new(room(Axis::Walls), one([2.0, 2.0], [3.0, 0.0]), vec![], Integrator::VelocityVerlet { dt: 0.01 }).unwrap();
    let mut contacts = Contacts::default();
    engine.advance(9.0, &mut contacts).unwrap();
    // The centre has 9 to go between the walls, 7.5 to the first.
    let expected: Vec<f64> = (0..3).map(|k| (7.5 + 9.0 * f64::from(k)) / 3.0).collect();
    assert_eq!(contacts.0.len(), 3);
    for (number, (contact, time)) in contacts.0.iter().zip(expected).enumerate() {
        assert!((contact.time - time).abs() < 900.0 * 10.0 * f64::EPSILON, "{} against {time}", contact.time);
        assert_eq!(contact.with, Meeting::Face { axis: 0, upper: number % 2 == 0 });
        assert_eq!(contact.impulse, 12.0);
        assert_eq!(contact.normal[0], if number % 2 == 0 { 1.0 } else { -1.0 });
        assert_eq!(contact.first.position[0], if number % 2 == 0 { 9.5 } else { 0.5 });
        assert_eq!(contact.first.after, -contact.first.before);
    }
    assert_eq!(engine.kinetic_energy(), 9.0);
}

/// A ball on a floor in a uniform field: Verlet's drifts are reflected exactly, so its energy stays bounded; the bounce takes
/// `2 v / g`.
#[test]
fn a_ball_bounces_for_ever() {
    let field: Box<dyn Force<2>> = Box::new(UniformField::new(Vector([0.0, -1.0])));
    let mut engine =
        TimeDriven::new(room(Axis::Walls), one([5.0, 2.5], [0.0, 0.0]), vec![field], Integrator::VelocityVerlet { dt: 0.001 })
            .unwrap();
    let energy = engine.energy();
    let mut contacts = Contacts::default();
    engine.advance(200.0, &mut contacts).unwrap();
    // Falls 2 (the radius is taken off): v = 2, first contact at 2, then one every 4.
    assert_eq!(contacts.0.len(), 50);
    // A bounce within a step misses at most the kick of the field over that step, 2 m g v dt, once and not cumulatively.
    assert!((engine.energy() - energy).abs() < 2.0 * 2.0 * 1.0 * 2.0 * 0.001, "{}", engine.energy() - energy);
}

/// The same with integrators of higher order. They follow a parabola exactly, and a reflection that knows the parabola throws the ball
/// back at exactly its speed: nothing but rounding is left. A mirror image of what went through the floor would win or lose about
/// `m g v dt` at each of the fifty bounces.
#[test]
fn a_ball_bounces_to_the_same_height_whatever_the_order() {
    for name in ["runge-kutta-4", "yoshida-4", "yoshida-6", "yoshida-8"] {
        let field: Box<dyn Force<2>> = Box::new(UniformField::new(Vector([0.0, -1.0])));
        let integrator = Integrator::from_name(name, 0.007).unwrap();
        let mut engine = TimeDriven::new(room(Axis::Walls), one([5.0, 2.5], [0.0, 0.0]), vec![field], integrator).unwrap();
        let energy = engine.energy();
        let mut contacts = Contacts::default();
        engine.advance(200.0, &mut contacts).unwrap();
        assert_eq!(contacts.0.len(), 50, "{name}");
        for (bounce, contact) in contacts.0.iter().enumerate() {
            let expected = 2.0 + 4.0 * bounce as f64;
            assert!((contact.time - expected).abs() < 1e-9 && (contact.impulse - 8.0).abs() < 1e-9, "{name}: {contact:?}");
        }
        assert!((engine.energy() - energy).abs() < 1e-9, "{name}: {:e}", engine.energy() - energy);
    }
}

#[test]
fn a_particle_faster_than_the_box_is_wide_is_a_failure() {
    let mut engine =
        TimeDriven::new(room(Axis::Walls), one([5.0, 2.0], [1.0, 1e4]), vec![], Integrator::VelocityVerlet { dt: 0.01 }).unwrap();
    let failure = engine.advance(1.0, &mut ()).unwrap_err();
    assert!(failure.to_string().contains("particle 0") && failure.cause.contains("smaller dt"), "{failure}");
    assert_eq!((engine.time(), engine.particles()), (0.0, &one([5.0, 2.0], [1.0, 1e4])));
}

/// A force that overflows, whatever the integrator: two particles shot at each other meet in one step, or a spring is so stiff that
/// velocities grow without bound. Named are one of them, the time and the cause; left is the last good state, bit for bit.
#[test]
fn a_force_that_overflows_is_a_failure_that_leaves_the_last_good_state() {
    let dt = 0.01;
    for integrator in [Integrator::VelocityVerlet { dt }, Integrator::Yoshida4 { dt }, Integrator::RungeKutta4 { dt }] {
        for stiff in [false, true] {
            let build = || {
                let mut particles = Particles::<2>::new();
                particles.push(Vector([-50.0, 30.0]), Vector([0.3, 0.0]), 1.0, 0.0, 0);
                // They meet after 47 steps.
                particles.push(Vector([-1e5 * dt * 47.0, 0.0]), Vector([1e5, 0.0]), 1.0, 0.0, 0);
                particles.push(Vector([1e3 * dt * 47.0, 0.0]), Vector([-1e3, 0.0]), 1.0, 0.0, 0);
                let force: Box<dyn Force<2>> = if stiff {
                    Box::new(Springs::new(vec![Spring::new(1, 2, 1e9, 1.0)]))
                } else {
                    Box::new(PairForce::new(InversePower { epsilon: 1.0, sigma: 1.0, exponent: 200, cutoff: 2.0 }))
                };
                let space = Boundary::new([-1e6; 2], [1e6; 2], Axis::Open);
                TimeDriven::new(space, particles, vec![force], integrator).unwrap()
            };
            let mut engine = build();
            let failure = engine.advance(100.0, &mut ()).unwrap_err();
            println!("{}, stiff {stiff}: {failure}", integrator.name());
            assert!(matches!(failure.particle, Some(1 | 2)), "{failure}");
            assert!(failure.cause.contains("overflowed") && failure.cause.contains("smaller dt"), "{failure}");
            assert!((failure.time - engine.time() - dt).abs() < 1e-9, "{failure}, but the time is {}", engine.time());
            assert!(engine.steps() > 0);
            let mut again = build();
            again.advance(engine.time(), &mut ()).unwrap();
            assert_eq!((engine.snapshot(), engine.steps()), (again.snapshot(), again.steps()));
            assert!(engine.snapshot().validate().is_ok());
        }
    }
}

/// A particle that leaves through a wall after many good steps: the steps before it are not lost.
#[test]
fn a_particle_that_leaves_is_a_failure_that_keeps_the_steps_before_it() {
    let build = || {
        let kick = DrivingForce {
            particle: 0,
            direction: Vector([0.0, 1.0]),
            signal: Signal::Pulse { amplitude: 1e6, centre: 0.73, width: 0.01 },
        };
        let forces: Vec<Box<dyn Force<2>>> = vec![Box::new(kick)];
        TimeDriven::new(room(Axis::Walls), one([5.0, 2.0], [1.0, 0.3]), forces, Integrator::VelocityVerlet { dt: 0.01 }).unwrap()
    };
    let mut engine = build();
    let failure = engine.advance(2.0, &mut ()).unwrap_err();
    println!("{failure}");
    assert!(failure.particle == Some(0) && failure.cause.contains("through the wall across axis 1"), "{failure}");
    assert!(engine.steps() > 60 && (failure.time - engine.time() - 0.01).abs() < 1e-12, "{failure}, {}", engine.time());
    let mut again = build();
    again.advance(engine.time(), &mut ()).unwrap();
    assert_eq!(engine.snapshot(), again.snapshot());
}

#[test]
fn an_observer_can_stop_the_run() {
    struct Stop;
    impl Observer<2> for Stop {
        fn contact(&mut self, _: &Contact<2>) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }
    let mut engine =
        TimeDriven::new(room(Axis::Walls), one([5.0, 2.0], [1.0, 0.0]), vec![], Integrator::VelocityVerlet { dt: 0.1 }).unwrap();
    engine.advance(100.0, &mut Stop).unwrap();
    assert!((engine.time() - 4.5).abs() <= 0.1 + 1e-12, "{}", engine.time());
}

#[test]
fn edits_are_checked_and_undone_when_refused() {
    let mut engine =
        TimeDriven::new(room(Axis::Walls), one([5.0, 2.0], [1.0, 0.0]), vec![], Integrator::VelocityVerlet { dt: 0.1 }).unwrap();
    engine.advance(1.0, &mut ()).unwrap();
    let before = engine.snapshot();
    assert!(engine.edit(|particles| particles.position[0][1] = 3.9).unwrap_err().key.contains("particle 0"));
    assert!(engine.edit(|particles| particles.velocity[0][1] = f64::NAN).unwrap_err().key.contains("velocity"));
    assert_eq!(engine.snapshot(), before);
    assert!(engine.set_boundary(Boundary::new([0.0; 2], [5.0, 4.0], Axis::Walls)).is_err());
    assert_eq!(engine.boundary(), &room(Axis::Walls));
    engine.edit(|particles| _ = particles.push(Vector([1.0, 1.0]), Vector::ZERO, 1.0, 0.5, 0)).unwrap();
    engine.advance(2.0, &mut ()).unwrap();
    assert_eq!(engine.particles().len(), 2);
}

#[test]
fn systems_that_make_no_sense_are_refused() {
    let new = |boundary: Boundary<2>, particles, name, dt| {
        let integrator = Integrator::from_name(name, dt)?;
        TimeDriven::new(boundary, particles, vec![], integrator).map(|_| ())
    };
    let verlet = "velocity-verlet";
    assert_eq!(new(room(Axis::Open), Particles::new(), verlet, 0.1).unwrap_err().key, "particles");
    assert_eq!(new(room(Axis::Open), one([1.0; 2], [f64::INFINITY; 2]), verlet, 0.1).unwrap_err().key, "velocity of particle 0");
    assert_eq!(new(room(Axis::Walls), one([0.1, 2.0], [0.0; 2]), verlet, 0.1).unwrap_err().key, "position of particle 0");
    assert_eq!(new(room(Axis::Open), one([1.0; 2], [0.0; 2]), verlet, f64::NAN).unwrap_err().key, "dt");
    assert_eq!(new(room(Axis::Walls), one([1.0; 2], [0.0; 2]), "gauss-radau-15", 0.1).unwrap_err().key, "integrator");
    let mut divided = room(Axis::Walls);
    divided.partitions.push(Partition::new(0, 5.0));
    assert_eq!(new(divided, one([1.0; 2], [0.0; 2]), verlet, 0.1).unwrap_err().key, "partitions");
}
