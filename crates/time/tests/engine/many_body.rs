//! Soft spheres: conservation, images, and independence of the neighbour lists over whole runs.

use corpuscle_core::{Axis, Boundary, Engine, Failure, Particles, Random, Vector, placement};
use corpuscle_time::{
    Force, Gravity, Integrator, LennardJones, PairForce, Spring, Springs, TimeDriven, UniformField, WeeksChandlerAndersen,
};
use proptest::prelude::*;

const LENNARD_JONES: LennardJones = LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 };

fn fluid<const D: usize>(count: usize, density: f64, force: Box<dyn Force<D>>, dt: f64, seed: u64) -> TimeDriven<D> {
    let boundary = Boundary::periodic((count as f64 / density).powf(1.0 / D as f64));
    let mut random = Random::new(seed, 0);
    let mut particles = Particles::new();
    for place in placement::lattice(&boundary, count, 0.0, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    placement::maxwell(&mut particles, 1.0, true, &mut random);
    TimeDriven::new(boundary, particles, vec![force], Integrator::VelocityVerlet { dt }).unwrap()
}

/// In each run the energy is averaged over ten stretches, and a line is fitted through them. Over eight independent runs the
/// slope must be zero within its standard error: |z| < 4 fails once in 16,000 by chance.
#[test]
fn energy_of_a_fluid_does_not_drift() {
    let slopes: Vec<f64> = (0..8)
        .map(|seed| {
            let dt = 0.004;
            let mut engine = fluid::<3>(108, 0.6, Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0))), dt, seed);
            engine.advance(4.0, &mut ()).unwrap();
            let means: Vec<f64> = (0..10)
                .map(|stretch| {
                    let mean = (0..50).map(|sample| {
                        engine.advance(4.0 + (f64::from(stretch * 50 + sample) + 1.0) * 10.0 * dt, &mut ()).unwrap();
                        engine.energy()
                    });
                    mean.sum::<f64>() / 50.0
                })
                .collect();
            let mean = means.iter().sum::<f64>() / 10.0;
            means.iter().enumerate().map(|(i, e)| (i as f64 - 4.5) * (e - mean)).sum::<f64>() / 82.5
        })
        .collect();
    let mean = slopes.iter().sum::<f64>() / 8.0;
    let error = (slopes.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (7.0 * 8.0)).sqrt();
    println!("slope {mean:.2e} +- {error:.2e} a stretch of 2 time units");
    // Student's t with 7 degrees of freedom: |t| > 5.4 has probability 0.001.
    assert!(mean.abs() < 5.4 * error, "{mean:e} +- {error:e}");
}

/// The trajectory's bits do not depend on the skin of the neighbour list, nor on when it was built.
#[test]
fn whole_runs_do_not_depend_on_the_neighbour_list() {
    let run = |skin: f64| {
        let mut engine = fluid::<3>(256, 0.7, Box::new(PairForce::with_skin(LENNARD_JONES, skin)), 0.004, 5);
        engine.advance(2.0, &mut ()).unwrap();
        (engine.snapshot(), engine.energy(), engine.virial())
    };
    let tight = run(0.05);
    assert_eq!(tight, run(0.4));
    assert_eq!(tight, run(50.0));
}

/// Large enough for every pass over the particles to be shared among threads; long enough to build lists more than once, and to
/// cross faces.
#[test]
fn whole_runs_do_not_depend_on_the_number_of_threads_nor_on_stops() {
    let count = 30_000;
    let run = |threads: usize, stops: u32| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut engine = fluid::<2>(count, 0.7, Box::new(PairForce::new(LENNARD_JONES)), 0.004, 6);
            for stop in 1..=stops {
                engine.advance(0.24 * f64::from(stop) / f64::from(stops), &mut ()).unwrap();
            }
            let images: Vec<_> = (0..count).map(|i| engine.images(i)).collect();
            (engine.snapshot(), images, engine.energy())
        })
    };
    let alone = run(1, 1);
    assert!(alone.1.iter().any(|images| *images != [0; 2]));
    assert!(run(3, 1) == alone, "threads");
    assert!(run(2, 7) == alone, "stops");
}

/// A bound pair that drifts through the faces of a periodic box moves as in open space. Every step rounds positions and
/// forces; in a bound orbit such errors grow in proportion to time, so that `n` steps leave `n^2` roundings at worst.
#[test]
fn a_pair_crossing_the_boundary_moves_as_in_open_space() {
    let (side, dt, steps) = (6.0, 0.002, 5000u32);
    let run = |axis| {
        let mut pair = Particles::<2>::new();
        pair.push(Vector([5.5, 0.3]), Vector([0.9, -1.3]), 1.0, 0.0, 0);
        pair.push(Vector([6.6, 0.3]), Vector([0.9, -1.1]), 2.0, 0.0, 0);
        let boundary = Boundary::new([0.0; 2], [side; 2], axis);
        let force: Box<dyn Force<2>> = Box::new(PairForce::new(LENNARD_JONES));
        let mut engine = TimeDriven::new(boundary, pair, vec![force], Integrator::VelocityVerlet { dt }).unwrap();
        engine.advance(f64::from(steps) * dt, &mut ()).unwrap();
        engine
    };
    let (open, periodic) = (run(Axis::Open), run(Axis::Periodic));
    let bound = f64::from(steps).powi(2) * f64::EPSILON * 2.0 * side;
    for i in 0..2 {
        // The second starts outside, is brought in by one side, and keeps count of it.
        let off = (periodic.unwrapped(i) - open.particles().position[i]).norm();
        assert!(off < bound, "particle {i}: {off:e} against {bound:e}");
        assert_ne!(periodic.images(i), [0, 0]);
    }
    assert!((open.energy() - periodic.energy()).abs() < bound);
}

/// Virial and energy: `W = -dU/d ln(scale)`, the pressure route, by central differences of the scaled system.
#[test]
fn the_virial_is_the_response_of_the_energy_to_scaling() {
    let mut engine = fluid::<2>(100, 0.6, Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0))), 0.004, 2);
    engine.advance(1.0, &mut ()).unwrap();
    let energy = |scale: f64| {
        let mut boundary = engine.boundary().clone();
        (boundary.lower, boundary.upper) = (boundary.lower * scale, boundary.upper * scale);
        let mut particles = engine.snapshot();
        particles.position.iter_mut().for_each(|r| *r = *r * scale);
        let force = PairForce::<_, 2>::new(WeeksChandlerAndersen::new(1.0, 1.0));
        force.energy(0.0, &boundary, &particles)
    };
    let slope = |h: f64| (energy(1.0 + h) - energy(1.0 - h)) / (2.0 * h);
    // Truncation, measured by doubling the difference, and rounding.
    let bound = (slope(2e-5) - slope(1e-5)).abs() + 100.0 * f64::EPSILON * energy(1.0) / 1e-5;
    assert!((engine.virial() + slope(1e-5)).abs() <= bound, "{} against {}", engine.virial(), -slope(1e-5));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Forces between particles add no momentum. Each step rounds every particle's velocity, of at most `v`, once a force.
    #[test]
    fn momentum_is_conserved(seed in any::<u64>(), kind in 0..4usize, integrator in 0..5usize, periodic in any::<bool>()) {
        let mut random = Random::new(seed, 0);
        let mut particles = Particles::<3>::new();
        for i in 0..64 {
            let site = Vector::from_fn(|k| 0.5 + 1.4 * (i / 4usize.pow(k as u32) % 4) as f64 + 0.2 * random.uniform());
            particles.push(site, Vector::from_fn(|_| random.normal()), 0.5 + random.uniform(), 0.0, 0);
        }
        let force: Box<dyn Force<3>> = match kind {
            0 => Box::new(PairForce::new(LennardJones { cutoff: 2.4, ..LENNARD_JONES })),
            1 => Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0))),
            2 => Box::new(Springs::new((1..64).map(|i| Spring { damping: 0.1, ..Spring::new(i / 2, i, 2.0, 0.8) }).collect())),
            _ => Box::new(Gravity::new(0.1, 0.3)),
        };
        let axis = if periodic && kind != 3 { Axis::Periodic } else { Axis::Open };
        let boundary = Boundary::new([0.0; 3], [5.6; 3], axis);
        let integrator = Integrator::from_name(Integrator::NAMES[integrator], 0.001).unwrap();
        let mut engine = TimeDriven::new(boundary, particles, vec![force], integrator).unwrap();
        let before = engine.momentum();
        engine.advance(0.2, &mut ()).unwrap();
        let scale: f64 = engine.particles().velocity.iter().zip(&engine.particles().mass).map(|(v, m)| m * v.norm()).sum();
        let bound = engine.steps() as f64 * 4.0 * f64::EPSILON * scale;
        prop_assert!((engine.momentum() - before).norm() < bound, "{:?}", engine.momentum() - before);
    }
}

/// How a run is cut up: so many steps in all, and from stop to stop; and whether a second force does nothing, in whose company no
/// force moves particles by itself.
#[derive(Clone, Copy)]
struct Way {
    steps: u64,
    every: u64,
    accompanied: bool,
}

const ONE_BY_ONE: Way = Way { steps: 60, every: 1, accompanied: true };
const TOGETHER: Way = Way { steps: 60, every: 60, accompanied: false };

/// The outcome of a run, the steps taken, and places on the path through the images, velocities and images, to the bit.
type Ending = (Result<(), Failure>, u64, Vec<u64>);

fn go<const D: usize>(
    boundary: Boundary<D>,
    particles: Particles<D>,
    force: Box<dyn Force<D>>,
    integrator: Integrator,
    way: Way,
) -> Ending {
    let before = particles.position.clone();
    let mut forces = vec![force];
    if way.accompanied {
        forces.push(Box::new(UniformField::new(Vector::ZERO)));
    }
    let mut engine = TimeDriven::new(boundary, particles, forces, integrator).unwrap();
    let dt = integrator.dt().unwrap();
    let mut outcome = Ok(());
    while outcome.is_ok() && engine.steps() < way.steps {
        outcome = engine.advance((engine.steps() + way.every).min(way.steps) as f64 * dt, &mut ());
    }
    assert!(engine.steps() == 0 || engine.particles().position != before, "{} steps, and nobody has moved", engine.steps());
    let Particles { position, velocity, .. } = engine.particles();
    let numbers = position.iter().chain(velocity).flat_map(|vector| vector.0).map(f64::to_bits);
    let images = (0..position.len()).flat_map(|i| engine.images(i)).map(|image| image as u64);
    (outcome, engine.steps(), numbers.chain(images).collect())
}

/// A gas at random places, so that forces are of all sizes, some of its particles fast enough for several turns around the box.
fn hot_gas<const D: usize>(
    (count, side, seed): (usize, f64, u64),
    axes: [Axis; D],
    (kinds, integrator): (u16, Integrator),
    way: Way,
) -> Ending {
    let boundary = Boundary { axes, ..Boundary::new([-1.0; D], [side - 1.0; D], Axis::Open) };
    let mut random = Random::new(seed, 0);
    let mut particles = Particles::new();
    for i in 0..count {
        let place = Vector::from_fn(|k| boundary.lower[k] + side * random.uniform());
        let speed = if i % 50 == 0 { 300.0 } else { 1.0 };
        let velocity = Vector::from_fn(|_| speed * random.normal());
        particles.push(place, velocity, 0.5 + random.uniform(), 0.0, i as u16 % kinds);
    }
    let potential = |a: u16, b: u16| WeeksChandlerAndersen::new(1.0 / f64::from(1 + a + b), 0.8 + 0.1 * f64::from(a.min(b)));
    let force = if kinds == 1 { PairForce::new(potential(0, 0)) } else { PairForce::between_species(kinds, potential) };
    go(boundary, particles, Box::new(force), integrator, way)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Where nobody looks, particles stay in the order of the neighbour list for many steps, and are moved by whoever finds their
    /// forces. Whoever stops after every step has them back in their own each time. Neither shows, nor who else helps.
    #[test]
    fn steps_taken_together_are_those_taken_one_by_one(
        seed in any::<u64>(),
        solid in any::<bool>(),
        periodic in prop::array::uniform3(any::<bool>()),
        kinds in 1..3u16,
        integrator in prop::sample::select(vec!["velocity-verlet", "symplectic-euler", "yoshida-4", "yoshida-6"]),
        threads in 1..4usize,
        dt in prop::sample::select(vec![1e-6, 1e-4, 1e-3]),
    ) {
        let axes = periodic.map(|periodic| if periodic { Axis::Periodic } else { Axis::Open });
        let law = (kinds, Integrator::from_name(integrator, dt).unwrap());
        let run = |threads: usize, way: Way| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                if solid {
                    hot_gas((500, 8.0, seed), axes, law, way)
                } else {
                    hot_gas((3000, 60.0, seed), [axes[0], axes[1]], law, way)
                }
            })
        };
        let one_by_one = run(1, ONE_BY_ONE);
        let together = run(threads, TOGETHER);
        prop_assert_eq!((&one_by_one.0, one_by_one.1), (&together.0, together.1));
        prop_assert!(one_by_one.2 == together.2);
        let in_pieces = run(threads, Way { every: 7, ..TOGETHER });
        prop_assert!(in_pieces.2 == one_by_one.2);
    }
}

/// Grains around a few masses; some are thrown out of all that there was, unless others come from farther away.
fn dust(seed: u64, masses: usize) -> Particles<3> {
    let mut random = Random::new(seed, 0);
    let mut bodies = Particles::new();
    for i in 0..400 {
        let mass = if i * masses / 400 == (i + 1) * masses / 400 { 0.0 } else { 0.2 + random.uniform() };
        let size = if seed.is_multiple_of(2) && i % 37 == 5 { 1e12 } else { 3.0 };
        let speed = if i % 41 == 7 { 1e9 } else { 0.5 };
        bodies.push(Vector::from_fn(|_| size * random.normal()), Vector::from_fn(|_| speed * random.normal()), mass, 0.0, 0);
    }
    bodies
}

const SPACE: [[f64; 3]; 2] = [[-5.0; 3], [5.0; 3]];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Grains are taken along for many steps before the next are looked at, unless somebody stops after each.
    #[test]
    fn steps_of_grains_taken_together_are_those_taken_one_by_one(
        seed in any::<u64>(),
        masses in 1..20usize,
        softened in any::<bool>(),
        integrator in prop::sample::select(vec!["velocity-verlet", "symplectic-euler", "yoshida-4", "yoshida-6"]),
        threads in 1..4usize,
        dt in prop::sample::select(vec![1e-3, 0.1]),
    ) {
        let run = |threads: usize, way: Way| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let gravity = Gravity::new(1.0, if softened { 0.3 } else { 0.0 });
                let space = Boundary::new(SPACE[0], SPACE[1], Axis::Open);
                go(space, dust(seed, masses), Box::new(gravity), Integrator::from_name(integrator, dt).unwrap(), way)
            })
        };
        let one_by_one = run(1, Way { steps: 150, ..ONE_BY_ONE });
        let together = run(threads, Way { steps: 150, every: 150, ..TOGETHER });
        prop_assert_eq!((&one_by_one.0, one_by_one.1), (&together.0, together.1));
        prop_assert!(one_by_one.2 == together.2);
        let in_pieces = run(threads, Way { steps: 150, every: 7, ..TOGETHER });
        prop_assert!(in_pieces.2 == one_by_one.2);
    }
}

/// Somebody meets a star in one place, in the middle of steps that are taken together: a grain, or another star. Gravity is so weak
/// that until then all fly straight, a whole number a step.
#[test]
fn a_meeting_among_grains_is_named_with_its_step() {
    for mass in [0.0, 1.0] {
        let mut bodies = Particles::<3>::new();
        bodies.push(Vector::ZERO, Vector::ZERO, 1.0, 0.0, 0);
        bodies.push(Vector([-47.0, 0.0, 0.0]), Vector([2.0, 0.0, 0.0]), mass, 0.0, 0);
        for i in 0..200 {
            bodies.push(Vector([f64::from(i), 300.0, 0.0]), Vector([0.0, 0.0, 1.0]), 0.0, 0.0, 0);
        }
        let run = |way| {
            let space = Boundary::new(SPACE[0], SPACE[1], Axis::Open);
            let verlet = Integrator::VelocityVerlet { dt: 0.5 };
            go(space, bodies.clone(), Box::new(Gravity::new(1e-200, 0.0)), verlet, Way { steps: 100, ..way })
        };
        let (outcome, steps, numbers) = run(Way { every: 100, ..TOGETHER });
        let failure = outcome.unwrap_err();
        assert!(failure.particle.is_some_and(|particle| particle < 2) && failure.cause.contains("smaller dt"), "{failure}");
        assert!((46..=47).contains(&steps), "{steps}");
        let (other, others_steps, others_numbers) = run(ONE_BY_ONE);
        assert_eq!((other.unwrap_err(), others_steps), (failure, steps));
        assert!(others_numbers == numbers);
    }
}

/// Of a long string several steps are taken together. With symplectic Euler, which owes nothing at a stop, the last of them used to be
/// forgotten.
#[test]
fn a_long_string_arrives_whatever_the_integrator() {
    let count = 40_000;
    let mut random = Random::new(8, 0);
    let mut beads = Particles::<2>::new();
    for i in 0..count {
        beads.push(Vector([i as f64, random.normal()]), Vector([0.0, random.normal()]), 1.0, 0.0, 0);
    }
    for name in ["velocity-verlet", "symplectic-euler", "yoshida-4"] {
        let run = |way| {
            let springs = Springs::new((1..count).map(|i| Spring::new(i - 1, i, 1.0, 0.0)).collect());
            let space = Boundary::new([-1.0; 2], [1.0; 2], Axis::Open);
            go(space, beads.clone(), Box::new(springs), Integrator::from_name(name, 0.05).unwrap(), way)
        };
        let one_by_one = run(Way { steps: 13, ..ONE_BY_ONE });
        for every in [13, 5] {
            assert!(run(Way { steps: 13, every, ..TOGETHER }) == one_by_one, "{name}, {every}");
        }
    }
}
