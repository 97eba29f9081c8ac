//! Thermostats: the whole canonical distribution, not its mean alone.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_time::{CentralField, Force, Integrator, Spring, Springs, TimeDriven};

const TEMPERATURE: f64 = 1.7;

/// Four unequal beads on springs in a trap, from rest out of balance: eight degrees of freedom, no momentum conserved.
fn beads(integrator: Integrator) -> TimeDriven<2> {
    let mut beads = Particles::new();
    for (i, mass) in [1.0, 0.5, 2.0, 1.3].into_iter().enumerate() {
        beads.push(Vector([i as f64, 0.3 * i as f64]), Vector([0.1, -0.2]), mass, 0.0, 0);
    }
    let springs = (1..4).map(|i| Spring { cubic: 0.2, ..Spring::new(i - 1, i, 1.0, 0.8) }).collect();
    let trap = CentralField { centre: Vector([1.0, 0.5]), strength: 0.8, power: 1.0 };
    let forces: Vec<Box<dyn Force<2>>> = vec![Box::new(Springs::new(springs)), Box::new(trap)];
    let space = Boundary::new([-50.0; 2], [50.0; 2], Axis::Open);
    TimeDriven::new(space, beads, forces, integrator).unwrap()
}

/// The probability that the kinetic energy of eight degrees of freedom is below `x k T`: Gamma of shape 4.
fn share_below(x: f64) -> f64 {
    1.0 - (-x).exp() * (1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0)))
}

/// Chi squared of `counts` against equal shares, as a standard normal deviate (Wilson and Hilferty 1931).
fn z_of_equal_shares(counts: &[u32]) -> f64 {
    let expected = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
    let chi_squared: f64 = counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
    let freedom = counts.len() as f64 - 1.0;
    let spread = 2.0 / (9.0 * freedom);
    ((chi_squared / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Samples are ten relaxation times apart: correlated by `exp(-10)`. The step's own error in the kinetic energy,
/// `(omega dt)^2/4 < 1e-3`, is far below the counts' fluctuations.
#[test]
fn kinetic_energy_is_canonically_distributed() {
    let dt = 0.02;
    let langevin = Integrator::Langevin { dt, temperature: TEMPERATURE, friction: 1.0, seed: 3 };
    let rescaling =
        Integrator::StochasticRescaling { dt, temperature: TEMPERATURE, relaxation_time: 0.5, degrees_of_freedom: 8, seed: 3 };
    for integrator in [langevin, rescaling] {
        let mut engine = beads(integrator);
        let mut counts = [0u32; 16];
        for sample in 0..4000 {
            engine.advance(20.0 + 5.0 * f64::from(sample), &mut ()).unwrap();
            counts[(16.0 * share_below(engine.kinetic_energy() / TEMPERATURE)) as usize] += 1;
        }
        let z = z_of_equal_shares(&counts);
        println!("{}: {counts:?}, z = {z:.2}", integrator.name());
        assert!(z.abs() < 4.0, "{}: z = {z}, {counts:?}", integrator.name());
    }
}

/// One bead in a trap: `x sqrt(k / k T)` is a standard normal deviate, the sum of its two squares over 2 exponential.
#[test]
fn brownian_positions_follow_boltzmann() {
    let (strength, friction) = (2.0, 5.0);
    let mut bead = Particles::new();
    bead.push(Vector([1.0, 0.0]), Vector::ZERO, 1.5, 0.0, 0);
    let trap = CentralField { centre: Vector::ZERO, strength, power: 1.0 };
    let space = Boundary::new([-50.0; 2], [50.0; 2], Axis::Open);
    let integrator = Integrator::Brownian { dt: 0.05, temperature: TEMPERATURE, friction, seed: 8 };
    let mut engine = TimeDriven::<2>::new(space, bead, vec![Box::new(trap)], integrator).unwrap();
    let mut counts = [0u32; 16];
    for sample in 0..4000 {
        // Positions relax at the rate strength/friction.
        engine.advance(25.0 * f64::from(sample + 1), &mut ()).unwrap();
        let energy = 0.5 * 1.5 * strength * engine.particles().position[0].norm_squared();
        counts[(16.0 * (1.0 - (-energy / TEMPERATURE).exp())) as usize] += 1;
    }
    let z = z_of_equal_shares(&counts);
    println!("{counts:?}, z = {z:.2}");
    assert!(z.abs() < 4.0, "z = {z}, {counts:?}");
}

/// Free Brownian motion: `<r^2> = 2 D d t` with `d = k T/(m gamma)`, over a thousand independent particles.
#[test]
fn free_particles_diffuse_as_einstein_says() {
    let (friction, mass, time) = (4.0, 2.0, 3.0);
    let mut cloud = Particles::<3>::new();
    for _ in 0..1000 {
        cloud.push(Vector::ZERO, Vector::ZERO, mass, 0.0, 0);
    }
    let space = Boundary::new([-50.0; 3], [50.0; 3], Axis::Open);
    let integrator = Integrator::Brownian { dt: 0.01, temperature: TEMPERATURE, friction, seed: 2 };
    let mut engine = TimeDriven::new(space, cloud, vec![], integrator).unwrap();
    engine.advance(time, &mut ()).unwrap();
    let mean = engine.particles().position.iter().map(|r| r.norm_squared()).sum::<f64>() / 1000.0;
    // The mean of two neighbouring noises takes half a step's variance from each end of the path.
    let expected = 6.0 * TEMPERATURE / (mass * friction) * (time - 0.5 * 0.01);
    let z = (mean / expected - 1.0) / (2.0f64 / 3000.0).sqrt();
    println!("{mean} against {expected}, z = {z:.2}");
    assert!(z.abs() < 4.0, "{mean} against {expected}, z = {z}");
}

/// Without friction Langevin's equation is Newton's, and the splitting velocity Verlet: two half drifts round where a whole one
/// does, some `1e-16` a step, and nearby paths part slowly.
#[test]
fn no_friction_no_heat() {
    let dt = 0.02;
    let mut langevin = beads(Integrator::Langevin { dt, temperature: TEMPERATURE, friction: 0.0, seed: 1 });
    let mut verlet = beads(Integrator::VelocityVerlet { dt });
    for tenth in 1..=20 {
        langevin.advance(0.1 * f64::from(tenth), &mut ()).unwrap();
        verlet.advance(0.1 * f64::from(tenth), &mut ()).unwrap();
        let apart = |i: usize| (langevin.particles().position[i] - verlet.particles().position[i]).norm();
        let apart = (0..4).map(apart).fold(0.0, f64::max);
        println!("{tenth}: {apart:.1e}");
        assert!(apart < 1e-13, "{apart:e} at {}", verlet.time());
    }
}

/// The same bits however the way is cut up, and from one seed only.
#[test]
fn noise_belongs_to_the_step() {
    let run = |seed: u64, pieces: u32| {
        let mut engine = beads(Integrator::Langevin { dt: 0.02, temperature: TEMPERATURE, friction: 1.0, seed });
        for piece in 1..=pieces {
            engine.advance(10.0 * f64::from(piece) / f64::from(pieces), &mut ()).unwrap();
        }
        engine.snapshot()
    };
    assert!(run(1, 1) == run(1, 77) && run(1, 1) != run(2, 1));
}

#[test]
fn impossible_baths_are_refused_by_name() {
    let mut random = Random::new(1, 0);
    let mut grain = Particles::<2>::new();
    grain.push(Vector([random.uniform(), 0.0]), Vector::ZERO, 0.0, 0.0, 0);
    let space = Boundary::new([-5.0; 2], [5.0; 2], Axis::Open);
    let refused = |integrator, particles: &Particles<2>| {
        TimeDriven::new(space.clone(), particles.clone(), vec![], integrator).map(|_| ()).unwrap_err().key
    };
    let langevin = |temperature, friction| Integrator::Langevin { dt: 0.1, temperature, friction, seed: 0 };
    assert_eq!(refused(langevin(1.0, 1.0), &grain), "mass of particle 0");
    grain.mass[0] = 1.0;
    assert_eq!(refused(langevin(-1.0, 1.0), &grain), "temperature");
    assert_eq!(refused(langevin(1.0, f64::NAN), &grain), "friction");
    assert_eq!(refused(Integrator::Brownian { dt: 0.1, temperature: 1.0, friction: 0.0, seed: 0 }, &grain), "friction");
}
