//! Thermostats: the whole canonical distribution, not its mean alone.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_time::{CentralField, Force, Integrator, Spring, Springs, TimeDriven};

const TEMPERATURE: f64 = 1.7;

/// Four unequal beads on springs in a trap, from rest out of balance: eight degrees of freedom, no momentum conserved.
fn beads(integrator: Integrator) -> TimeDriven<2> {
    beads_on_springs(0.8, integrator)
}

/// Springs without rest length have a smooth force: others pull in a direction that jumps where two beads meet.
fn beads_on_springs(rest_length: f64, integrator: Integrator) -> TimeDriven<2> {
    let mut beads = Particles::new();
    for (i, mass) in [1.0, 0.5, 2.0, 1.3].into_iter().enumerate() {
        beads.push(Vector([i as f64, 0.3 * i as f64]), Vector([0.1, -0.2]), mass, 0.0, 0);
    }
    let springs = (1..4).map(|i| Spring { cubic: 0.2, ..Spring::new(i - 1, i, 1.0, rest_length) }).collect();
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
    let chain = Integrator::NoseHoover { dt, temperature: TEMPERATURE, relaxation_time: 0.5, degrees_of_freedom: 8, links: 4 };
    for integrator in [langevin, rescaling, chain] {
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

/// A harmonic oscillator of period `2 pi`, of one degree of freedom, with a chain of so many links; how often its energy
/// was in each of 16 ranges that are equally likely in the canonical distribution, `1 - exp(-E/k T)`.
fn oscillator_energies(links: u32) -> [u32; 16] {
    let mut bead = Particles::<1>::new();
    bead.push(Vector([1.0]), Vector([0.5]), 1.0, 0.0, 0);
    let trap = CentralField { centre: Vector([0.0]), strength: 1.0, power: 1.0 };
    let space = Boundary::new([-50.0], [50.0], Axis::Open);
    let integrator =
        Integrator::NoseHoover { dt: 0.05, temperature: TEMPERATURE, relaxation_time: 1.0, degrees_of_freedom: 1, links };
    let mut engine = TimeDriven::new(space, bead, vec![Box::new(trap)], integrator).unwrap();
    let mut counts = [0u32; 16];
    for sample in 0..4000 {
        engine.advance(50.0 * f64::from(sample + 1), &mut ()).unwrap();
        counts[(16.0 * (1.0 - (-engine.energy() / TEMPERATURE).exp())) as usize] += 1;
    }
    counts
}

/// One link keeps to a torus and leaves energies out altogether (Hoover 1985, doi:10.1103/PhysRevA.31.1695; Martyna, Klein and
/// Tuckerman 1992); a chain visits all of them as often as it should.
#[test]
fn a_chain_cures_what_a_single_nose_hoover_thermostat_does_to_an_oscillator() {
    let single = oscillator_energies(1);
    println!("1 link: {single:?}, z = {:.1}", z_of_equal_shares(&single));
    assert!(single.iter().filter(|&&count| count == 0).count() >= 4, "{single:?}");
    let chain = oscillator_energies(4);
    let z = z_of_equal_shares(&chain);
    println!("4 links: {chain:?}, z = {z:.2}");
    assert!(z.abs() < 4.0, "z = {z}, {chain:?}");
}

/// The splitting is of order 2 and reversible: with half the step the conserved energy swings a quarter as much, while heat that
/// is worth several `k T` goes in and out.
#[test]
fn the_chain_conserves_its_energy_to_second_order() {
    let swing = |dt: f64| {
        let integrator =
            Integrator::NoseHoover { dt, temperature: TEMPERATURE, relaxation_time: 2.0, degrees_of_freedom: 8, links: 4 };
        let mut engine = beads_on_springs(0.0, integrator);
        let start = engine.conserved_energy();
        assert_eq!(start, engine.energy());
        let (mut squares, mut exchanged) = (0.0, 0.0f64);
        for sample in 1..=1000 {
            engine.advance(0.16 * f64::from(sample), &mut ()).unwrap();
            squares += (engine.conserved_energy() - start).powi(2);
            exchanged = exchanged.max((engine.energy() - start).abs());
        }
        ((squares / 1000.0).sqrt(), exchanged)
    };
    let ((coarse, _), (middle, _), (fine, exchanged)) = (swing(0.04), swing(0.02), swing(0.01));
    println!("off by {coarse:.2e}, {middle:.2e}, {fine:.2e}; {exchanged:.1} exchanged");
    for ratio in [coarse / middle, middle / fine] {
        assert!((ratio.log2() - 2.0).abs() < 0.5, "{coarse:e} {middle:e} {fine:e}");
    }
    assert!(fine < 1e-4 * exchanged, "{fine:e} of {exchanged}");
}

/// A failed step is taken back, and the chain with it: what follows is as if it had not been tried.
#[test]
fn the_chain_goes_back_to_the_last_good_state_with_the_particles() {
    let build = |wall: f64| {
        let mut bead = Particles::<1>::new();
        bead.push(Vector([0.0]), Vector([1.0]), 1.0, 0.0, 0);
        let trap = CentralField { centre: Vector([0.0]), strength: 1.0, power: 1.0 };
        let mut space = Boundary::new([-50.0], [wall], Axis::Open);
        space.axes = [Axis::Walls];
        let integrator =
            Integrator::NoseHoover { dt: 0.05, temperature: TEMPERATURE, relaxation_time: 1.0, degrees_of_freedom: 1, links: 3 };
        TimeDriven::new(space, bead, vec![Box::new(trap)], integrator).unwrap()
    };
    let mut engine = build(50.0);
    engine.advance(2.0, &mut ()).unwrap();
    let (before, held) = (engine.snapshot(), engine.conserved_energy());
    // Faster than the box is wide within a step.
    engine.edit(|particles| particles.velocity[0][0] = 1e5).unwrap();
    let failure = engine.advance(3.0, &mut ()).unwrap_err();
    assert!(failure.particle == Some(0) && failure.cause.contains("smaller dt"), "{failure}");
    engine.edit(|particles| particles.velocity[0] = before.velocity[0]).unwrap();
    assert_eq!((engine.snapshot(), engine.conserved_energy()), (before, held));
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
    let run_with = |integrator, pieces: u32| {
        let mut engine = beads(integrator);
        for piece in 1..=pieces {
            engine.advance(10.0 * f64::from(piece) / f64::from(pieces), &mut ()).unwrap();
        }
        engine.snapshot()
    };
    let run = |seed, pieces| run_with(Integrator::Langevin { dt: 0.02, temperature: TEMPERATURE, friction: 1.0, seed }, pieces);
    let chain =
        Integrator::NoseHoover { dt: 0.02, temperature: TEMPERATURE, relaxation_time: 0.5, degrees_of_freedom: 8, links: 3 };
    assert!(run_with(chain, 1) == run_with(chain, 77));
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
    let chain =
        |temperature, links| Integrator::NoseHoover { dt: 0.1, temperature, relaxation_time: 1.0, degrees_of_freedom: 2, links };
    assert_eq!(refused(chain(0.0, 3), &grain), "temperature");
    assert_eq!(refused(chain(1.0, 0), &grain), "links");
    assert_eq!(refused(chain(1.0, 65), &grain), "links");
    assert_eq!(refused(Integrator::Brownian { dt: 0.1, temperature: 1.0, friction: 0.0, seed: 0 }, &grain), "friction");
}
