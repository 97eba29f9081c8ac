use corpuscle_core::{Axis, Boundary, Instructions, Particles, Random, Vector};

use super::*;

fn cloud<const D: usize>(masses: usize, grains: usize) -> Particles<D> {
    let mut random = Random::new(5, 0);
    let mut cloud = Particles::new();
    for i in 0..masses + grains {
        // Grains and masses mixed.
        let mass = if (i * masses) % (masses + grains) < masses { 0.5 + random.uniform() } else { 0.0 };
        cloud.push(Vector::from_fn(|_| random.normal()), Vector::ZERO, mass, 0.0, 0);
    }
    cloud
}

fn accelerations<const D: usize>(force: &mut impl Force<D>, particles: &Particles<D>, remainder: &[Vector<D>]) -> Vec<Vector<D>> {
    let space = Boundary::new([-5.0; D], [5.0; D], Axis::Open);
    let mut acceleration = vec![Vector::ZERO; particles.len()];
    force.accelerate_precisely(0.0, &space, particles, remainder, &mut acceleration);
    acceleration
}

/// The sum as the textbook has it, with the sum of magnitudes, on which its rounding error depends.
fn textbook<const D: usize>(constant: f64, softening: f64, particles: &Particles<D>) -> Vec<(Vector<D>, f64)> {
    let Particles { position, mass, .. } = particles;
    let pull = |i: usize| {
        let (mut sum, mut magnitude) = (Vector::ZERO, 0.0);
        for j in (0..particles.len()).filter(|&j| j != i && mass[j] > 0.0) {
            let arrow = position[j] - position[i];
            let pull = arrow * (constant * mass[j] * inverse_cube(arrow.norm_squared(), softening * softening));
            sum += pull;
            magnitude += pull.norm();
        }
        (sum, magnitude)
    };
    (0..particles.len()).map(pull).collect()
}

fn agrees_with_the_textbook<const D: usize>() {
    for (masses, grains) in [(2, 0), (2, 9), (3, 30), (13, 0), (40, 1), (129, 300), (700, 513), (4200, 3)] {
        let particles = cloud::<D>(masses, grains);
        for softening in [0.0, 0.3] {
            let mut force = Gravity::new(0.7, softening);
            let found = accelerations(&mut force, &particles, &[]);
            for (i, (expected, magnitude)) in textbook(0.7, softening, &particles).into_iter().enumerate() {
                // Roundings of a sum of n terms walk at random; 8 for those of each term.
                let bound = magnitude * f64::EPSILON * (8.0 + (masses as f64).sqrt());
                assert!((found[i] - expected).norm() < bound, "{masses} + {grains}: {i}: {:?} {expected:?}", found[i]);
            }
        }
    }
}

#[test]
fn lanes_blocks_and_rounds_leave_out_no_pair() {
    agrees_with_the_textbook::<2>();
    agrees_with_the_textbook::<3>();
}

#[test]
fn bits_depend_neither_on_the_instruction_set_nor_on_threads() {
    let particles = cloud::<3>(1500, 700);
    let zero = vec![Vector([1e-18; 3]); particles.len()];
    for remainder in [&[][..], &zero] {
        let run = |instructions| {
            let mut force = Gravity { instructions, ..Gravity::new(1.0, 0.1) };
            accelerations(&mut force, &particles, remainder)
        };
        let plain = run(Instructions::PLAIN);
        for instructions in Instructions::all() {
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                assert!(pool.install(|| run(instructions)) == plain, "{instructions:?}, {threads} threads");
            }
        }
    }
}

/// A pair closer than the rounding of its coordinates: only the remainders know its distance.
#[test]
fn remainders_count() {
    let mut particles = cloud::<3>(300, 0);
    let mut remainder = vec![Vector::ZERO; 300];
    particles.position[17] = Vector([2.0, 1.0, 1.0]);
    particles.position[250] = particles.position[17];
    remainder[250] = Vector([1e-17, 0.0, 0.0]);
    let found = accelerations(&mut Gravity::new(1.0, 0.0), &particles, &remainder);
    let expected = particles.mass[250] / 1e-34;
    assert!((found[17][0] / expected - 1.0).abs() < 8.0 * f64::EPSILON, "{:?}", found[17]);
}

/// Lengths of galaxies in metres, and of atoms: scaled by a power of two, the same bits but for the factor.
#[test]
fn units_do_not_matter() {
    let particles = cloud::<3>(200, 20);
    let found = accelerations(&mut Gravity::new(1.0, 0.0), &particles, &[]);
    for factor in [2f64.powi(70), 2f64.powi(-90)] {
        let mut scaled = particles.clone();
        scaled.position.iter_mut().for_each(|r| *r = *r * factor);
        let scaled = accelerations(&mut Gravity::new(factor * factor, 0.0), &scaled, &[]);
        assert!(scaled == found, "{factor:e}");
    }
}

#[test]
fn momentum_is_conserved_to_rounding() {
    let particles = cloud::<3>(2000, 0);
    let found = accelerations(&mut Gravity::new(1.0, 0.0), &particles, &[]);
    let (mut total, mut magnitude) = (Vector::ZERO, 0.0);
    for (a, &m) in found.iter().zip(&particles.mass) {
        total += *a * m;
        magnitude += a.norm() * m;
    }
    assert!(total.norm() < magnitude * f64::EPSILON * 2000f64.sqrt(), "{total:?}");
}
