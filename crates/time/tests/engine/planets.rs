//! A star and its planets: the Wisdom-Holman map against what is known and against Gauss-Radau.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_time::{Drag, Force, Gravity, Integrator, TimeDriven};

const RADAU: Integrator = Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None };

/// A star of mass 1 that drifts, two planets near a 5:2 commensurability, and a massless comet.
fn planets(share: f64, integrator: Integrator) -> TimeDriven<3> {
    let mut bodies = Particles::new();
    bodies.push(Vector([1.0, 2.0, 0.0]), Vector([0.1, 0.0, 0.02]), 1.0, 0.0, 0);
    for (mass, axis, e, tilt) in [(share, 1.0, 0.05f64, 0.02), (0.3 * share, 1.84, 0.05, -0.03), (0.0, 4.0, 0.5, 0.2f64)] {
        let (r, v) = (axis * (1.0 - e), ((1.0 + e) / ((1.0 - e) * axis)).sqrt());
        let side = if mass == share { 1.0 } else { -1.0 };
        let place = bodies.position[0] + Vector([side * r, 0.0, 0.0]);
        let velocity = bodies.velocity[0] + Vector([0.0, side * v * tilt.cos(), side * v * tilt.sin()]);
        bodies.push(place, velocity, mass, 0.0, 1);
    }
    let space = Boundary::new([-9.0; 3], [9.0; 3], Axis::Open);
    TimeDriven::new(space, bodies, vec![Box::new(Gravity::new(1.0, 0.0))], integrator).unwrap()
}

/// One planet is a Kepler orbit, whatever the step; the coordinates' rounding grows with the time.
#[test]
fn one_planet_is_on_its_ellipse_at_any_step() {
    for dt in [0.1, 1.0, 10.0] {
        let mut bodies = Particles::<2>::new();
        bodies.push(Vector::ZERO, Vector::ZERO, 1.0, 0.0, 0);
        bodies.push(Vector([0.7, 0.0]), Vector([0.0, (1.3f64 / 0.7).sqrt()]), 0.0, 0.0, 0);
        let space = Boundary::new([-9.0; 2], [9.0; 2], Axis::Open);
        let forces: Vec<Box<dyn Force<2>>> = vec![Box::new(Gravity::new(1.0, 0.0))];
        let mut engine = TimeDriven::new(space, bodies, forces, Integrator::WisdomHolman { dt }).unwrap();
        engine.advance(20.0, &mut ()).unwrap();
        let anomaly = (0..50).fold(20.0f64, |x, _| x - (x - 0.3 * x.sin() - 20.0) / (1.0 - 0.3 * x.cos()));
        let expected = Vector([anomaly.cos() - 0.3, 0.91f64.sqrt() * anomaly.sin()]);
        let off = (engine.particles().position[1] - expected).norm();
        assert!(off < 1e-14 * 20.0 * (1.0 + 1.0 / dt), "dt = {dt}: {off:e}");
    }
}

/// Order 2 against Gauss-Radau, and errors in proportion to the planets' masses.
#[test]
fn errors_fall_as_the_square_of_the_step_and_with_the_masses() {
    let end = 8.0;
    let reference = |share: f64| {
        let mut engine = planets(share, RADAU);
        engine.advance(end, &mut ()).unwrap();
        engine.snapshot()
    };
    let error = |share: f64, dt: f64, reference: &Particles<3>| {
        let mut engine = planets(share, Integrator::WisdomHolman { dt });
        engine.advance(end, &mut ()).unwrap();
        assert_eq!(engine.time(), end);
        (0..4).map(|i| (engine.particles().position[i] - reference.position[i]).norm()).fold(0.0, f64::max)
    };
    let heavy = reference(1e-3);
    let errors: Vec<f64> = (4..8).map(|halving| error(1e-3, 1.0 / f64::from(1 << halving), &heavy)).collect();
    let slopes: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    println!("errors {errors:?}, slopes {slopes:?}");
    assert!((slopes[2] - 2.0).abs() < 0.1 && (slopes[2] - 2.0).abs() <= (slopes[0] - 2.0).abs(), "{slopes:?}");
    let ratio = errors[2] / error(1e-5, 1.0 / 64.0, &reference(1e-5));
    println!("errors of planets 100 times lighter: smaller by {ratio}");
    assert!((50.0..200.0).contains(&ratio), "{ratio}");
}

/// Over `10^6` steps, some 8000 years of the inner planet: the energy stays within its swing of the first century.
#[test]
fn energy_stays_bounded_over_a_million_steps() {
    let dt = 0.05;
    let mut engine = planets(1e-3, Integrator::WisdomHolman { dt });
    let (energy, momentum, spin) = (engine.energy(), engine.momentum(), engine.angular_momentum());
    let mut swing = |from: u32, to: u32, stride: u32| {
        let mut worst: f64 = 0.0;
        for sample in (from..to).step_by(stride as usize) {
            engine.advance(f64::from(sample) * dt, &mut ()).unwrap();
            worst = worst.max((engine.energy() / energy - 1.0).abs());
        }
        worst
    };
    let early = swing(0, 12_000, 1);
    let late = swing(12_000, 1_000_001, 37);
    println!("energy swings by {early:.2e} at first, by {late:.2e} later");
    assert!(late < 1.5 * early, "{early:e} {late:e}");
    // Rounding: a unit in the last place a step, in the worst case always in the same direction.
    let drift = (engine.momentum() - momentum).norm() / momentum.norm();
    let turn = (engine.angular_momentum()[2] / spin[2] - 1.0).abs();
    println!("momentum off by {drift:.1e}, angular momentum by {turn:.1e}");
    assert!(drift < 1e6 * f64::EPSILON && turn < 1e6 * f64::EPSILON, "{drift:e} {turn:e}");
}

#[test]
fn what_is_no_planetary_system_is_refused_by_name() {
    let mut bodies = Particles::<2>::new();
    bodies.push(Vector::ZERO, Vector::ZERO, 1.0, 0.0, 0);
    bodies.push(Vector([1.0, 0.0]), Vector([0.0, 1.0]), 0.0, 0.0, 0);
    let map = Integrator::WisdomHolman { dt: 0.1 };
    let build = |forces: Vec<Box<dyn Force<2>>>, axis| {
        TimeDriven::new(Boundary::new([-9.0; 2], [9.0; 2], axis), bodies.clone(), forces, map).map(|_| ()).unwrap_err()
    };
    assert_eq!(build(vec![Box::new(Gravity::new(1.0, 0.5))], Axis::Open).value, "gravity");
    let two: Vec<Box<dyn Force<2>>> = vec![Box::new(Gravity::new(1.0, 0.0)), Box::new(Drag { rate: 0.1 })];
    assert_eq!(build(two, Axis::Open).value, "2 of them");
    assert_eq!(build(vec![Box::new(Gravity::new(1.0, 0.0))], Axis::Walls).key, "integrator");
}
