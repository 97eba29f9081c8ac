//! Chains of beads: their bonds follow Boltzmann, and break with a word.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_observe::Estimate;
use corpuscle_time::{
    BondLaw, Bonds, FiniteExtension, Force, Integrator, PairForce, PairPotential, TimeDriven, WeeksChandlerAndersen,
};

const BOND: FiniteExtension = FiniteExtension { stiffness: 30.0, longest: 1.5 };

/// Pairs of beads bonded as in the chains of Kremer and Grest, far from one another, in a bath of `k T = 1`.
fn dimers(count: usize, dt: f64, seed: u64) -> TimeDriven<3> {
    let space = Boundary::new([0.0; 3], [1.0e4; 3], Axis::Open);
    let mut beads = Particles::new();
    let mut random = Random::new(seed, 0);
    for i in 0..count {
        let place = Vector([100.0 * i as f64, 0.0, 0.0]);
        for x in [0.0, 0.97] {
            beads.push(place + Vector([x, 0.0, 0.0]), Vector::from_fn(|_| random.normal()), 1.0, 0.5, 0);
        }
    }
    let bonds = Bonds::new(BOND, (0..count).map(|i| (2 * i, 2 * i + 1)).collect());
    let forces: Vec<Box<dyn Force<3>>> = vec![Box::new(PairForce::new(WeeksChandlerAndersen::new(1.0, 1.0))), Box::new(bonds)];
    TimeDriven::new(space, beads, forces, Integrator::Langevin { dt, temperature: 1.0, friction: 1.0, seed }).unwrap()
}

/// `<r>` and `<r^2>` of a bond in a bath, by quadrature of `r^2 exp(-U(r)/k T)`: the trapezoidal rule on a function that vanishes with
/// all its derivatives at both ends is as exact as the numbers.
fn expected() -> [f64; 2] {
    let wca = WeeksChandlerAndersen::new(1.0, 1.0);
    let repulsion = |r2: f64| if r2 < wca.cutoff() * wca.cutoff() { wca.energy(r2) } else { 0.0 };
    let mut sums = [0.0; 3];
    let steps = 100_000;
    for step in 1..steps {
        let r = 0.3 + 1.2 * f64::from(step) / f64::from(steps);
        let weight = r * r * (-repulsion(r * r) - BOND.energy(r * r)).exp();
        (0..3).for_each(|n| sums[n] += weight * r.powi(n as i32));
    }
    [sums[1] / sums[0], sums[2] / sums[0]]
}

/// Dimers are independent of each other: each one's mean over its own run is one sample of the standard error. The step is so short
/// that its own error, `(omega dt)^2/24` of the second moment's spread, is a tenth of that.
#[test]
fn bonds_in_a_bath_have_the_lengths_boltzmann_says() {
    let count = 64;
    let mut engine = dimers(count, 0.002, 5);
    let mut means = vec![[0.0; 2]; count];
    let samples = 400;
    for sample in 0..samples {
        engine.advance(10.0 + f64::from(sample), &mut ()).unwrap();
        for (i, mean) in means.iter_mut().enumerate() {
            let r = (engine.particles().position[2 * i + 1] - engine.particles().position[2 * i]).norm();
            mean[0] += r / f64::from(samples);
            mean[1] += r * r / f64::from(samples);
        }
    }
    for (moment, expected) in expected().into_iter().enumerate() {
        let values: Vec<f64> = means.iter().map(|mean| mean[moment]).collect();
        let estimate = Estimate::from_replicas(&values);
        let z = estimate.score(expected);
        println!("moment {}: {} +- {}, expected {expected}, z = {z:.2}", moment + 1, estimate.mean, estimate.standard_error);
        assert!(z.abs() < 4.0, "moment {}: z = {z}", moment + 1);
    }
}

/// Steps far too long tear bonds: the failure names a bead of the pair, the time and the lengths, and the engine goes back to the last
/// good state.
#[test]
fn a_torn_bond_ends_the_run_with_its_name_and_the_last_good_state() {
    let mut engine = dimers(8, 0.08, 5);
    let failure = engine.advance(1000.0, &mut ()).unwrap_err();
    let bead = failure.particle.unwrap();
    let pair = format!("particles {} and {}", bead / 2 * 2, bead / 2 * 2 + 1);
    assert!(failure.cause.contains(&pair) && failure.cause.contains("beyond 1.5"), "{failure}");
    assert!(engine.time() < failure.time && engine.energy().is_finite());
    let place = &engine.particles().position;
    assert!((0..8).all(|i| (place[2 * i] - place[2 * i + 1]).norm() < 1.5));
}
