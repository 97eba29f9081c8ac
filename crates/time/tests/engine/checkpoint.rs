//! An engine that is written down, set up again and put where it was does what the unbroken one does, to the last bit.

use std::f64::consts::TAU;

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_time::{
    Drag, Drive, Force, Gravity, Integrator, LennardJones, PairForce, Pin, Signal, Spring, Springs, TimeDriven, TreeGravity,
    UniformField,
};

fn written<const D: usize>(engine: &TimeDriven<D>) -> Vec<u8> {
    let mut out = Writer::new();
    out.part("engine", engine).unwrap();
    out.finish()
}

fn load<const D: usize>(bytes: &[u8], engine: &mut TimeDriven<D>) -> Result<(), Fault> {
    let mut from = Reader::new(bytes);
    from.part("engine", engine)?;
    from.end()
}

/// Runs to `end` unbroken, and in pieces, each by an engine set up anew.
fn compare<const D: usize>(name: &str, set_up: impl Fn() -> TimeDriven<D>, end: f64) {
    let mut random = Random::new(81, 0);
    let (mut unbroken, mut broken) = (set_up(), set_up());
    let mut stops: Vec<f64> = (0..8).map(|_| end * random.uniform()).collect();
    stops.sort_by(f64::total_cmp);
    for stop in stops.into_iter().chain([end]) {
        // The unbroken one stops as well: here an adaptive integrator interpolates, which is no part of the trajectory.
        unbroken.advance(stop, &mut ()).unwrap();
        broken.advance(stop, &mut ()).unwrap();
        let bytes = written(&broken);
        assert!(bytes == written(&unbroken), "{name}: not the same at t = {stop}");
        broken = set_up();
        load(&bytes, &mut broken).unwrap();
        assert!(bytes == written(&broken), "{name}: not written down again as it was");
        assert_eq!(unbroken.energy().to_bits(), broken.energy().to_bits(), "{name}");
    }
}

fn fluid(axes: Axis, forces: impl Fn() -> Vec<Box<dyn Force<3>>>, integrator: Integrator) -> impl Fn() -> TimeDriven<3> {
    move || {
        let boundary = Boundary::<3>::new([0.0; 3], [9.0; 3], axes);
        let mut random = Random::new(82, 0);
        let mut particles = Particles::new();
        for place in lattice(&boundary, 300, 0.5, &mut random, |_| true).unwrap() {
            particles.push(place, Vector::ZERO, 1.0, 0.3, 0);
        }
        maxwell(&mut particles, 1.2, true, &mut random);
        TimeDriven::new(boundary, particles, forces(), integrator).unwrap()
    }
}

fn lennard_jones() -> Vec<Box<dyn Force<3>>> {
    vec![Box::new(PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 }))]
}

#[test]
fn every_integrator_of_a_fluid() {
    let dt = 0.004;
    let (temperature, seed) = (1.0, 7);
    let mut integrators: Vec<Integrator> = ["explicit-euler", "velocity-verlet", "runge-kutta-4", "yoshida-4", "yoshida-8"]
        .iter()
        .map(|name| Integrator::from_name(name, dt).unwrap())
        .collect();
    integrators.push(Integrator::Langevin { dt, temperature, friction: 1.0, seed });
    integrators.push(Integrator::Brownian { dt: 1e-4, temperature, friction: 10.0, seed });
    let degrees_of_freedom = 3 * 299;
    integrators.push(Integrator::StochasticRescaling { dt, temperature, relaxation_time: 0.5, degrees_of_freedom, seed });
    for integrator in integrators {
        let end = 60.0 * integrator.dt().unwrap();
        compare(integrator.name(), fluid(Axis::Periodic, lennard_jones, integrator), end);
    }
}

/// Forces that depend on velocity remember the last accelerations; walls reflect.
#[test]
fn drag_between_walls() {
    let forces = || -> Vec<Box<dyn Force<3>>> {
        let field = UniformField { acceleration: Vector([0.0, 0.0, -1.0]) };
        let [potential] = <[_; 1]>::try_from(lennard_jones()).ok().unwrap();
        vec![potential, Box::new(Drag { rate: 0.3 }), Box::new(field)]
    };
    for name in ["velocity-verlet", "runge-kutta-4", "yoshida-6"] {
        compare(name, fluid(Axis::Walls, forces, Integrator::from_name(name, 0.004).unwrap()), 0.4);
    }
}

fn stars(integrator: Integrator, tree: bool) -> impl Fn() -> TimeDriven<3> {
    move || {
        let space = Boundary::<3>::new([-50.0; 3], [50.0; 3], Axis::Open);
        let mut random = Random::new(83, 0);
        let mut particles = Particles::new();
        particles.push(Vector::ZERO, Vector::ZERO, 1000.0, 0.0, 0);
        for k in 0..12 {
            let distance = 1.0 + f64::from(k);
            let (sine, cosine) = (TAU * random.uniform()).sin_cos();
            let speed = (1000.0 / distance).sqrt();
            let place = Vector([cosine, sine, 0.01 * random.normal()]) * distance;
            particles.push(place, Vector([-sine, cosine, 0.0]) * speed, 0.1 * f64::from(k % 3), 0.0, 0);
        }
        let gravity: Box<dyn Force<3>> =
            if tree { Box::new(TreeGravity::new(1.0, 0.0, 0.5)) } else { Box::new(Gravity::new(1.0, 0.0)) };
        TimeDriven::new(space, particles, vec![gravity], integrator).unwrap()
    }
}

/// Steps that are chosen, and stops within a step.
#[test]
fn gravity_with_chosen_steps() {
    let first_step = Some(1e-3);
    compare("gauss-radau", stars(Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None }, false), 2.0);
    compare("gauss-radau", stars(Integrator::GaussRadau15 { tolerance: 1e-9, first_step }, false), 2.0);
    compare("dormand-prince", stars(Integrator::DormandPrince8 { tolerance: 1e-12, first_step }, false), 2.0);
    compare("wisdom-holman", stars(Integrator::WisdomHolman { dt: 1e-3 }, false), 2.0);
    compare("tree", stars(Integrator::VelocityVerlet { dt: 1e-3 }, true), 1.0);
}

/// What is held, shaken and damped: the shaker's place of rest is part of the state.
#[test]
fn a_driven_chain() {
    let chain = |name: &'static str| {
        move || {
            let space = Boundary::<2>::new([0.0, -5.0], [21.0, 5.0], Axis::Open);
            let mut particles = Particles::new();
            for k in 0..22 {
                particles.push(Vector([f64::from(k), 0.0]), Vector::ZERO, 1.0, 0.0, 0);
            }
            let springs = (0..21).map(|k| Spring { damping: 0.05, cubic: 0.2, ..Spring::new(k, k + 1, 30.0, 0.7) }).collect();
            let signal = Signal::Sine { amplitude: 0.4, angular_frequency: 3.0, phase: 0.2, ramp: 1.0 };
            let integrator = Integrator::from_name(name, 0.01).unwrap();
            TimeDriven::new(space, particles, vec![Box::new(Springs::new(springs))], integrator)
                .unwrap()
                .with_pins(vec![Pin { particle: 21, axes: [true, true] }, Pin { particle: 0, axes: [true, false] }])
                .unwrap()
                .with_drives(vec![Drive { particle: 0, axis: 1, signal }])
                .unwrap()
        }
    };
    for name in ["velocity-verlet", "runge-kutta-4", "gauss-radau-15", "dormand-prince-8"] {
        compare(name, chain(name), 5.0);
    }
}

#[test]
fn what_is_not_this_engine_is_refused() {
    let verlet = fluid(Axis::Periodic, lennard_jones, Integrator::VelocityVerlet { dt: 0.01 });
    let bytes = written(&verlet());
    let mut other = stars(Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None }, false)();
    assert!(load(&bytes, &mut other).unwrap_err().to_string().starts_with("engine.integrator"));
    for end in (0..bytes.len()).step_by(101) {
        assert!(load(&bytes[..end], &mut verlet()).is_err());
    }
    let mut out = Writer::new();
    let mut fewer = verlet();
    fewer.edit(|particles| particles.position.truncate(300)).unwrap();
    fewer.save(&mut out).unwrap();
}
