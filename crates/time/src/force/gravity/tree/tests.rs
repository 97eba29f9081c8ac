use corpuscle_core::{Axis, Particles, Random};

use super::*;
use crate::force::gravity::Gravity;

/// A ball of bodies, denser inside, with as many grains mixed in as asked for.
fn cluster<const D: usize>(masses: usize, grains: usize) -> Particles<D> {
    let mut random = Random::new(11, 0);
    let mut cluster = Particles::new();
    for i in 0..masses + grains {
        let mass = if (i * masses) % (masses + grains) < masses { random.uniform() } else { 0.0 };
        cluster.push(Vector::from_fn(|_| random.normal()), Vector::ZERO, mass, 0.0, 0);
    }
    cluster
}

fn accelerations<const D: usize>(mut force: impl Force<D>, particles: &Particles<D>) -> Vec<Vector<D>> {
    let space = Boundary::new([-5.0; D], [5.0; D], Axis::Open);
    let mut acceleration = vec![Vector::ZERO; particles.len()];
    force.accelerate(0.0, &space, particles, &mut acceleration);
    acceleration
}

/// Relative errors against the direct sum, sorted.
fn errors<const D: usize>(particles: &Particles<D>, softening: f64, theta: f64) -> Vec<f64> {
    let direct = accelerations(Gravity::new(1.0, softening), particles);
    let tree = accelerations(TreeGravity::new(1.0, softening, theta), particles);
    let mut errors: Vec<f64> = tree.iter().zip(&direct).map(|(tree, direct)| (*tree - *direct).norm() / direct.norm()).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// With every cell opened the tree sums the same pairs in another order.
#[test]
fn an_opening_angle_of_zero_is_the_direct_sum() {
    for (masses, grains) in [(1, 5), (2, 0), (20, 300), (900, 200)] {
        let errors = errors(&cluster::<3>(masses, grains), 0.05, 0.0);
        let errors_in_the_plane = self::errors(&cluster::<2>(masses, grains), 0.0, 0.0);
        // Roundings of the sums walk at random; pulls cancel to a tenth at the centre of the cluster.
        let bound = 10.0 * f64::EPSILON * (8.0 + (masses as f64).sqrt());
        let worst = |errors: &[f64]| errors.iter().copied().filter(|error| error.is_finite()).fold(0.0, f64::max);
        assert!(worst(&errors) < bound && worst(&errors_in_the_plane) < bound, "{:e}", worst(&errors));
    }
}

/// The first moment left out is the third: errors fall as the cube of the angle, one power of it more slowly than the last
/// moment would (the worst cells, those just accepted, are at the distance `w/theta`).
#[test]
fn errors_fall_as_the_cube_of_the_opening_angle() {
    let particles = cluster::<3>(3000, 0);
    let median = |theta: f64| errors(&particles, 0.01, theta)[1500];
    let medians = [0.8, 0.4, 0.2].map(median);
    println!("median errors {medians:?}");
    for pair in medians.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 2.5, "{medians:?}");
    }
}

#[test]
fn errors_are_as_small_as_promised() {
    for softening in [0.0, 0.2] {
        let errors = errors(&cluster::<3>(10_000, 1000), softening, 0.5);
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        println!(
            "softening {softening}: median {:.1e}, rms {rms:.1e}, 99 % {:.1e}, worst {:.1e}",
            errors[5500], errors[10_890], errors[10_999]
        );
        assert!(errors[5500] < 2e-4 && errors[10_890] < 1e-3, "median {:e}, 99 % {:e}", errors[5500], errors[10_890]);
    }
}

/// Potential energy and virial, which agree for an unsoftened force of inverse squares.
#[test]
fn energy_and_virial_agree_with_direct_sums() {
    let particles = cluster::<3>(2000, 100);
    let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
    for softening in [0.0, 0.3] {
        let (tree, direct) = (TreeGravity::new(2.0, softening, 0.5), Gravity::new(2.0, softening));
        for (tree, direct) in [
            (tree.energy(0.0, &space, &particles), direct.energy(0.0, &space, &particles)),
            (tree.virial(0.0, &space, &particles), direct.virial(0.0, &space, &particles)),
        ] {
            println!("{tree} {direct}, off by {:.1e}", tree / direct - 1.0);
            assert!((tree / direct - 1.0).abs() < 1e-4, "{tree} {direct}");
        }
    }
}

#[test]
fn bits_depend_neither_on_the_instruction_set_nor_on_threads() {
    let particles = cluster::<3>(1500, 300);
    let run = |instructions| accelerations(TreeGravity { instructions, ..TreeGravity::new(1.0, 0.1, 0.6) }, &particles);
    let plain = run(Instructions::PLAIN);
    for instructions in Instructions::all() {
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| run(instructions)) == plain, "{instructions:?}, {threads} threads");
        }
    }
}

/// Any number of bodies in one place end in one cell; a grain beside them feels them all.
#[test]
fn bodies_in_one_place_do_not_divide_cells_for_ever() {
    let mut particles = Particles::<2>::new();
    for _ in 0..100 {
        particles.push(Vector([1.0, 2.0]), Vector::ZERO, 0.5, 0.0, 0);
    }
    particles.push(Vector([3.0, 2.0]), Vector::ZERO, 0.0, 0.0, 0);
    let found = accelerations(TreeGravity::new(1.0, 0.1, 0.5), &particles);
    let expected = -50.0 * 2.0 / (4.0f64 + 0.01).powf(1.5);
    assert!((found[100][0] / expected - 1.0).abs() < 1e-14 && found[0] == Vector::ZERO, "{:?}", found[100]);
}

#[test]
fn an_impossible_opening_angle_is_named() {
    let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
    for theta in [-0.1, 1.0, f64::NAN] {
        let error = TreeGravity::new(1.0, 0.0, theta).validate(&space, &cluster(2, 0)).unwrap_err();
        assert_eq!(error.key, "opening angle");
    }
}
