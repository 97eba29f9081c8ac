//! Cost of the forces and integrators: `cargo bench -p corpuscle-time`.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector, placement};
use corpuscle_time::{
    Force, Gravity, Integrator, LennardJones, PairForce, PairPotential, Spring, Springs, TimeDriven, WeeksChandlerAndersen,
};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

fn engine<const D: usize>(
    boundary: Boundary<D>,
    particles: Particles<D>,
    force: impl Force<D> + 'static,
    integrator: Integrator,
) -> TimeDriven<D> {
    TimeDriven::new(boundary, particles, vec![Box::new(force)], integrator).expect("a valid system")
}

/// Times ten steps at a time; the count is the work in ten steps.
fn ten_steps<const D: usize>(bencher: Bencher<'_, '_>, mut engine: TimeDriven<D>, work_per_step: usize) {
    let dt = engine.integrator().dt().expect("a fixed step");
    bencher.counter(ItemsCount::new(10 * work_per_step)).bench_local(move || {
        let next = engine.steps() + 10;
        engine.advance(next as f64 * dt, &mut ()).expect("a stable run");
    });
}

/// Direct sum over masses in leapfrog; counts unordered pairs.
#[divan::bench(args = [1000, 4000])]
fn gravity_pairs(bencher: Bencher<'_, '_>, count: usize) {
    let mut random = Random::new(1, 0);
    let mut stars = Particles::<3>::new();
    for _ in 0..count {
        stars.push(Vector::from_fn(|_| random.normal()), Vector::from_fn(|_| random.normal()), 1.0 / count as f64, 0.0, 0);
    }
    let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
    let engine = engine(space, stars, Gravity::new(1.0, 0.01), Integrator::VelocityVerlet { dt: 1e-4 });
    ten_steps(bencher, engine, count * (count - 1) / 2);
}

/// Three stars and massless grains in leapfrog; counts particles.
#[divan::bench(args = [10_000])]
fn grains(bencher: Bencher<'_, '_>, count: usize) {
    let mut random = Random::new(1, 0);
    let mut bodies = Particles::<3>::new();
    for place in [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.5, 0.0]] {
        bodies.push(Vector(place), Vector::from_fn(|_| 0.3 * random.normal()), 1.0, 0.0, 0);
    }
    for _ in 0..count {
        bodies.push(Vector::from_fn(|_| 10.0 * random.normal()), Vector::from_fn(|_| random.normal()), 0.0, 0.0, 1);
    }
    let space = Boundary::new([-20.0; 3], [20.0; 3], Axis::Open);
    ten_steps(bencher, engine(space, bodies, Gravity::new(1.0, 0.0), Integrator::VelocityVerlet { dt: 1e-4 }), count + 3);
}

fn fluid<const D: usize>(count: usize, density: f64, temperature: f64, potential: impl PairPotential + 'static) -> TimeDriven<D> {
    let boundary = Boundary::periodic((count as f64 / density).powf(1.0 / D as f64));
    let mut random = Random::new(1, 0);
    let mut particles = Particles::new();
    for place in placement::lattice(&boundary, count, 0.0, &mut random, |_| true).expect("room enough") {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    placement::maxwell(&mut particles, temperature, true, &mut random);
    let mut fluid = engine(boundary, particles, PairForce::new(potential), Integrator::VelocityVerlet { dt: 0.005 });
    fluid.advance(0.5, &mut ()).expect("a stable melt");
    fluid
}

/// The melt all codes are compared on: density 0.8442, temperature 1.44, cutoff 2.5, skin 0.3, step 0.005; counts atoms.
#[divan::bench(args = [4000, 32_000])]
fn lennard_jones(bencher: Bencher<'_, '_>, count: usize) {
    let potential = LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 };
    ten_steps(bencher, fluid::<3>(count, 0.8442, 1.44, potential), count);
}

/// Soft discs of density 0.6 at temperature 1; counts particles.
#[divan::bench(args = [10_000])]
fn soft_discs(bencher: Bencher<'_, '_>, count: usize) {
    ten_steps(bencher, fluid::<2>(count, 0.6, 1.0, WeeksChandlerAndersen::new(1.0, 1.0)), count);
}

/// A square membrane; counts masses.
#[divan::bench(args = [100, 1000])]
fn membrane(bencher: Bencher<'_, '_>, side: usize) {
    let mut beads = Particles::<3>::new();
    let mut springs = vec![];
    for i in 0..side * side {
        let (x, y) = (i % side, i / side);
        beads.push(Vector([x as f64, y as f64, (0.1 * x as f64).sin()]), Vector::ZERO, 1.0, 0.0, 0);
        if x > 0 {
            springs.push(Spring::new(i - 1, i, 1.0, 0.0));
        }
        if y > 0 {
            springs.push(Spring::new(i - side, i, 1.0, 0.0));
        }
    }
    let space = Boundary::new([0.0; 3], [side as f64; 3], Axis::Open);
    ten_steps(bencher, engine(space, beads, Springs::new(springs), Integrator::VelocityVerlet { dt: 0.1 }), side * side);
}

/// The figure-eight over ten periods with the adaptive integrator; counts periods.
#[divan::bench]
fn figure_eight(bencher: Bencher<'_, '_>) {
    let (x, v) = (Vector([0.970_004_36, -0.243_087_53]), Vector([-0.932_407_37, -0.864_731_46]));
    bencher.counter(ItemsCount::new(10usize)).bench_local(|| {
        let mut bodies = Particles::<2>::new();
        bodies.push(x, v * -0.5, 1.0, 0.0, 0);
        bodies.push(-x, v * -0.5, 1.0, 0.0, 0);
        bodies.push(Vector::ZERO, v, 1.0, 0.0, 0);
        let space = Boundary::new([-2.0; 2], [2.0; 2], Axis::Open);
        let radau = Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None };
        let mut engine = engine(space, bodies, Gravity::new(1.0, 0.0), radau);
        engine.advance(63.259_139_8, &mut ()).expect("a periodic orbit");
        engine.energy()
    });
}
