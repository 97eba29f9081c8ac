//! Every force against the derivative of its energy.

use super::*;
use corpuscle_core::{Axis, Random};

/// A few particles of different masses in general position, none closer than about 0.9.
fn cluster<const D: usize>(seed: u64) -> (Boundary<D>, Particles<D>) {
    let mut random = Random::new(seed, 0);
    let mut particles = Particles::new();
    for i in 0..3usize.pow(D as u32) {
        let place = Vector::from_fn(|k| 1.3 * ((i / 3usize.pow(k as u32)) % 3) as f64 + 0.2 * random.uniform());
        let velocity = Vector::from_fn(|_| random.normal());
        particles.push(place, velocity, 1.0 + 0.5 * (i % 3) as f64, 0.0, (i % 3) as u16);
    }
    (Boundary::new([0.0; D], [5.2; D], Axis::Open), particles)
}

/// `m a = -dU/dr` by central differences of step `h`, for every coordinate. Their error is `h^2 U'''/6` from truncation,
/// measured by halving `h`, plus the rounding `e |U| / h`, plus what rounding a pair's force to its quantum leaves.
fn check<const D: usize>(boundary: &Boundary<D>, particles: &Particles<D>, force: &mut dyn Force<D>) {
    force.validate(boundary, particles).unwrap();
    let mut acceleration = vec![Vector::ZERO; particles.len()];
    force.accelerate(0.0, boundary, particles, &mut acceleration);
    let slope = |force: &dyn Force<D>, i: usize, k: usize, h: f64| {
        let mut moved = particles.clone();
        let mut energy = |x| {
            moved.position[i][k] = particles.position[i][k] + x;
            force.energy(0.0, boundary, &moved)
        };
        (energy(h) - energy(-h)) / (2.0 * h)
    };
    let size = force.energy(0.0, boundary, particles).abs() + 1.0;
    for i in 0..particles.len() {
        for k in 0..D {
            let h = 1e-4;
            let (fine, coarse) = (slope(force, i, k, h), slope(force, i, k, 2.0 * h));
            let quanta = 27.0 * 0.5 * 2f64.powi(-36) * 30.0;
            let bound = (coarse - fine).abs() + 100.0 * f64::EPSILON * size / h + quanta;
            let expected = -fine / particles.mass[i];
            assert!((acceleration[i][k] - expected).abs() <= bound, "{}: {} against {expected}", force.name(), acceleration[i][k]);
        }
    }
}

fn check_all<const D: usize>() {
    let (open, particles) = cluster::<D>(7);
    let mut periodic = open.clone();
    periodic.axes = [Axis::Periodic; D];
    let springs = (1..particles.len()).map(|i| Spring::new(i - 1, i, 0.5 + i as f64 * 0.1, 0.3 * (i % 3) as f64)).collect();
    for boundary in [&open, &periodic] {
        // The force jumps at the cutoff, which therefore keeps clear of every pair's distance.
        let apart = |i: usize, j: usize| boundary.displacement(particles.position[i], particles.position[j]).norm();
        assert!((0..particles.len()).all(|i| (0..i).all(|j| (apart(i, j) - 2.41).abs() > 1e-3)));
        check(boundary, &particles, &mut PairForce::new(LennardJones { epsilon: 1.2, sigma: 1.0, cutoff: 2.41 }));
        check(boundary, &particles, &mut PairForce::new(WeeksChandlerAndersen::new(0.7, 1.3)));
        let cutoff = 2.41;
        let lennard_jones = LennardJones { epsilon: 1.2, sigma: 1.0, cutoff };
        check(boundary, &particles, &mut PairForce::new(lennard_jones).unshifted());
        check(boundary, &particles, &mut PairForce::new(ForceShifted(lennard_jones)));
        check(boundary, &particles, &mut PairForce::new(InversePower { epsilon: 0.8, sigma: 1.1, exponent: 13, cutoff }));
        check(boundary, &particles, &mut PairForce::new(Yukawa { epsilon: 2.0, sigma: 1.0, screening_length: 0.8, cutoff }));
        check(boundary, &particles, &mut PairForce::new(HarmonicRepulsion { stiffness: 30.0, diameter: 1.7 }));
        check(boundary, &particles, &mut PairForce::new(Morse { epsilon: 1.5, equilibrium: 1.2, steepness: 3.0, cutoff }));
        let between = |a: u16, b: u16| LennardJones { epsilon: 1.0 + f64::from(a + b), sigma: 1.0 + 0.1 * f64::from(b), cutoff };
        check(boundary, &particles, &mut PairForce::between_species(3, between));
        check(boundary, &particles, &mut Springs::new(Clone::clone(&springs)));
    }
    let born_mayer = BornMayer { epsilon: 1.2, sigma: 1.1, hardness: 0.3, dispersion: 0.4, higher_dispersion: 0.2, cutoff: 2.41 };
    check(&open, &particles, &mut PairForce::new(born_mayer));
    let charges: Vec<f64> = (0..particles.len()).map(|i| [1.0, -2.0, 0.5][i % 3]).collect();
    check(&open, &particles, &mut Coulomb::new(1.3, charges));
    check(&open, &particles, &mut Gravity::new(1.5, 0.0));
    check(&open, &particles, &mut Gravity::new(1.5, 0.2));
    check(&open, &particles, &mut UniformField::new(Vector::from_fn(|k| 0.3 - k as f64)));
}

#[test]
fn forces_are_the_slopes_of_their_energies_in_the_plane() {
    check_all::<2>();
}

#[test]
fn forces_are_the_slopes_of_their_energies_in_space() {
    check_all::<3>();
}

/// A list with a wide skin holds every pair of this small system, in the same order: the same bits come out.
#[test]
fn pair_forces_do_not_depend_on_the_neighbour_list() {
    let mut random = Random::new(3, 0);
    let boundary = Boundary::<3>::periodic(8.0);
    let mut particles = Particles::new();
    for i in 0..512 {
        let site = Vector::from_fn(|k| (i / 8usize.pow(k as u32) % 8) as f64 + 0.1 * random.uniform());
        particles.push(site, Vector::ZERO, 1.0 + random.uniform(), 0.0, 0);
    }
    let potential = LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.5 };
    let (mut tight, mut all) = (PairForce::with_skin(potential, 0.0), PairForce::with_skin(potential, 20.0));
    let mut accelerations = [vec![Vector::ZERO; 512], vec![Vector::ZERO; 512]];
    tight.accelerate(0.0, &boundary, &particles, &mut accelerations[0]);
    all.accelerate(0.0, &boundary, &particles, &mut accelerations[1]);
    assert!(all.neighbours().len() > 3 * tight.neighbours().len());
    assert_eq!(accelerations[0], accelerations[1]);
    assert_eq!(tight.energy(0.0, &boundary, &particles), all.energy(0.0, &boundary, &particles));
}

/// Charges against the plain sum over pairs, with remainders and more than one group of lanes; the same bits from one thread and three.
#[test]
fn charges_in_open_space_push_as_coulomb_says() {
    let mut random = Random::new(9, 0);
    let (mut ions, mut charges) = (Particles::<3>::new(), vec![]);
    for _ in 0..701 {
        ions.push(Vector::from_fn(|_| random.normal()), Vector::ZERO, 1.0 + random.uniform(), 0.0, 0);
        charges.push(random.normal());
    }
    let open = Boundary::new([-9.0; 3], [9.0; 3], Axis::Open);
    let remainder: Vec<Vector<3>> = (0..701).map(|_| Vector::from_fn(|_| 1e-3 * random.normal())).collect();
    for remainder in [&[][..], &remainder] {
        let with = |threads: usize| {
            let mut acceleration = vec![Vector::ZERO; 701];
            let mut force = Coulomb::new(0.7, charges.clone());
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| force.accelerate_precisely(0.0, &open, &ions, remainder, &mut acceleration));
            acceleration
        };
        let found = with(1);
        assert_eq!(found, with(3));
        let place = |i: usize| ions.position[i] + remainder.get(i).copied().unwrap_or(Vector::ZERO);
        let (mut net, mut size) = (Vector::<3>::ZERO, 0.0);
        for i in 0..701 {
            let (mut expected, mut magnitude) = (Vector::ZERO, 0.0);
            for j in (0..701).filter(|&j| j != i) {
                let arrow = place(i) - place(j);
                let push = arrow * (0.7 * charges[i] * charges[j] / ions.mass[i] / arrow.norm().powi(3));
                expected += push;
                magnitude += push.norm();
            }
            // Roundings of a sum of n terms walk at random; near pairs lose what the rounding of their places leaves.
            let bound = magnitude * f64::EPSILON * (1e3 + 701f64.sqrt());
            assert!((found[i] - expected).norm() < bound, "{i}: {:?} {expected:?}", found[i]);
            net += found[i] * ions.mass[i];
            size += magnitude * ions.mass[i];
        }
        assert!(net.norm() < 30.0 * f64::EPSILON * size, "{}", net.norm());
    }
}

/// Grains go through another kernel than masses: a mass too small to matter must feel the same as a grain.
#[test]
fn a_grain_feels_what_a_tiny_mass_feels() {
    let (boundary, mut particles) = cluster::<3>(5);
    let tiny = f64::MIN_POSITIVE;
    for i in (0..27).filter(|i| i % 4 != 0) {
        particles.mass[i] = tiny;
    }
    let pull = |particles: &Particles<3>| {
        let mut acceleration = vec![Vector::ZERO; 27];
        Gravity::new(1.0, 0.1).accelerate(0.0, &boundary, particles, &mut acceleration);
        acceleration
    };
    let felt = pull(&particles);
    particles.mass.iter_mut().filter(|mass| **mass == tiny).for_each(|mass| *mass = 0.0);
    for (grain, mass) in pull(&particles).iter().zip(&felt) {
        // Seven terms summed in two orders.
        assert!((*grain - *mass).norm() <= 7.0 * 4.0 * f64::EPSILON * mass.norm().max(1.0));
    }
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    let (boundary, mut particles) = cluster::<2>(1);
    let refused = |force: &dyn Force<2>, boundary: &Boundary<2>, particles: &Particles<2>| {
        force.validate(boundary, particles).unwrap_err().to_string()
    };
    let periodic = Boundary::periodic(5.2);
    let lennard_jones = PairForce::new(LennardJones { epsilon: 1.0, sigma: 1.0, cutoff: 2.7 });
    assert!(refused(&lennard_jones, &periodic, &particles).contains("cutoff of Lennard-Jones = 2.7"));
    assert!(refused(&Gravity::new(1.0, 0.0), &periodic, &particles).contains("periodic"));
    assert!(refused(&Springs::new(vec![Spring::new(0, 99, 1.0, 0.0)]), &boundary, &particles).contains("99"));
    assert!(refused(&UniformField::new(Vector([0.0, -1.0])), &periodic, &particles).contains("axis 1"));
    particles.mass[4] = 0.0;
    assert!(refused(&lennard_jones, &boundary, &particles).contains("mass of particle 4 = 0"));
    assert!(refused(&Springs::new(vec![Spring::new(3, 4, 1.0, 0.0)]), &boundary, &particles).contains("particle 4"));
}
