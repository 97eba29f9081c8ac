//! Cost of the forces and integrators: `cargo bench -p corpuscle-time`.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector, placement};
use corpuscle_time::{
    Force, Gravity, Integrator, LennardJones, PairForce, PairPotential, Spring, Springs, TimeDriven, TreeGravity,
    WeeksChandlerAndersen,
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

/// Equal stars in a ball, of mass 1 together.
fn cluster(count: usize) -> Particles<3> {
    let mut random = Random::new(1, 0);
    let mut stars = Particles::new();
    for _ in 0..count {
        stars.push(Vector::from_fn(|_| random.normal()), Vector::from_fn(|_| random.normal()), 1.0 / count as f64, 0.0, 0);
    }
    stars
}

/// Direct sum over masses in leapfrog; counts unordered pairs.
#[divan::bench(args = [1000, 4000])]
fn gravity_pairs(bencher: Bencher<'_, '_>, count: usize) {
    let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
    let engine = engine(space, cluster(count), Gravity::new(1.0, 0.01), Integrator::VelocityVerlet { dt: 1e-4 });
    ten_steps(bencher, engine, count * (count - 1) / 2);
}

/// Gravity by a tree, opening angle 0.5; counts particles.
#[divan::bench(args = [10_000, 100_000])]
fn gravity_tree(bencher: Bencher<'_, '_>, count: usize) {
    let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
    let force = TreeGravity::new(1.0, 0.01, 0.5);
    ten_steps(bencher, engine(space, cluster(count), force, Integrator::VelocityVerlet { dt: 1e-4 }), count);
}

/// A star and eight planets by the Wisdom-Holman map; counts planets.
#[divan::bench]
fn planets(bencher: Bencher<'_, '_>) {
    let mut bodies = Particles::<3>::new();
    bodies.push(Vector::ZERO, Vector::ZERO, 1.0, 0.0, 0);
    for i in 0..8 {
        let (axis, (sine, cosine)) = (1.5f64.powi(i), f64::from(i).sin_cos());
        let speed = axis.sqrt().recip();
        bodies.push(Vector([axis * cosine, axis * sine, 0.0]), Vector([-speed * sine, speed * cosine, 0.0]), 1e-5, 0.0, 1);
    }
    let space = Boundary::new([-50.0; 3], [50.0; 3], Axis::Open);
    ten_steps(bencher, engine(space, bodies, Gravity::new(1.0, 0.0), Integrator::WisdomHolman { dt: 0.1 }), 8);
}

/// A chain in a heat bath, Langevin's; counts masses.
#[divan::bench(args = [10_000])]
fn heat_bath(bencher: Bencher<'_, '_>, count: usize) {
    let bath = Integrator::Langevin { dt: 0.1, temperature: 1.0, friction: 1.0, seed: 1 };
    ten_steps(bencher, chain(count, 0.0, bath), count);
}

/// A chain of springs that obey Hooke's law, stretched (rest length 0) or not (1); counts masses.
#[divan::bench(args = [0.0, 1.0])]
fn chain_of_a_million(bencher: Bencher<'_, '_>, rest_length: f64) {
    ten_steps(bencher, chain(1_000_000, rest_length, Integrator::VelocityVerlet { dt: 0.1 }), 1_000_000);
}

fn chain(count: usize, rest_length: f64, integrator: Integrator) -> TimeDriven<3> {
    let mut beads = Particles::<3>::new();
    for i in 0..count {
        beads.push(Vector([i as f64, (0.1 * i as f64).sin(), 0.0]), Vector::ZERO, 1.0, 0.0, 0);
    }
    let springs = (1..count).map(|i| Spring::new(i - 1, i, 1.0, rest_length)).collect();
    engine(Boundary::new([0.0; 3], [count as f64; 3], Axis::Open), beads, Springs::new(springs), integrator)
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

/// The forces of a fluid that has flowed for a while: one evaluation with the list at hand, or one with a new list as well.
fn evaluations<const D: usize>(
    bencher: Bencher<'_, '_>,
    fluid: &TimeDriven<D>,
    potential: impl PairPotential + 'static,
    fresh: bool,
) {
    let mut force = PairForce::<_, D>::new(potential);
    let mut acceleration = vec![Vector::ZERO; fluid.particles().len()];
    bencher.counter(ItemsCount::new(fluid.particles().len())).bench_local(move || {
        if fresh {
            force = PairForce::new(potential);
        }
        force.accelerate(0.0, fluid.boundary(), fluid.particles(), &mut acceleration);
        acceleration[0]
    });
}

/// One evaluation of the forces in the melt, without and with a new list; counts atoms.
#[divan::bench(args = [false, true])]
fn melt_forces(bencher: Bencher<'_, '_>, new_list: bool) {
    let potential = LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 };
    evaluations(bencher, &fluid::<3>(4000, 0.8442, 1.44, potential), potential, new_list);
}

/// One evaluation of the forces between discs, without and with a new list; counts particles.
#[divan::bench(args = [false, true])]
fn disc_forces(bencher: Bencher<'_, '_>, new_list: bool) {
    let potential = WeeksChandlerAndersen::new(1.0, 1.0);
    evaluations(bencher, &fluid::<2>(10_000, 0.6, 1.0, potential), potential, new_list);
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
