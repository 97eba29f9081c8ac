//! The order of every integrator, measured; and what symplectic and reversible mean, measured.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_time::{Drag, Force, Gravity, Integrator, Spring, Springs, TimeDriven};

const ECCENTRICITY: f64 = 0.3;
/// Leaves no error to measure with one planet: see `planets.rs`.
const EXACT_FOR_TWO: [&str; 1] = ["wisdom-holman"];

/// A massless planet around a unit mass, starting at perihelion; semi-axis 1, period `2 pi`.
fn planet(integrator: Integrator) -> TimeDriven<2> {
    let e = ECCENTRICITY;
    let mut bodies = Particles::new();
    bodies.push(Vector::ZERO, Vector::ZERO, 1.0, 0.0, 0);
    bodies.push(Vector([1.0 - e, 0.0]), Vector([0.0, ((1.0 + e) / (1.0 - e)).sqrt()]), 0.0, 0.0, 0);
    let space = Boundary::new([-2.0; 2], [2.0; 2], Axis::Open);
    TimeDriven::new(space, bodies, vec![Box::new(Gravity::new(1.0, 0.0))], integrator).unwrap()
}

/// Where the planet is at a time: Kepler's equation `E - e sin E = t` by Newton's iteration.
fn kepler(time: f64) -> Vector<2> {
    let e = ECCENTRICITY;
    let mut anomaly = time;
    for _ in 0..50 {
        anomaly -= (anomaly - e * anomaly.sin() - time) / (1.0 - e * anomaly.cos());
    }
    Vector([anomaly.cos() - e, (1.0 - e * e).sqrt() * anomaly.sin()])
}

/// `log2` of successive error ratios under halving of the step. The error is `C dt^p (1 + O(dt))`: the slope must round to
/// `p` and come closer to it with each halving. Errors below `1e-10` are left out: there the roundings of up to a thousand
/// steps, a few `1e-13`, would show in the slopes.
fn assert_order(what: &str, order: u32, error: impl Fn(f64) -> f64, coarsest: f64) {
    let errors = (0..5).map(|halving| error(coarsest / f64::from(1 << halving)));
    let errors: Vec<f64> = errors.take_while(|error| *error > 1e-10).collect();
    let off: Vec<f64> = errors.windows(2).map(|pair| ((pair[0] / pair[1]).log2() - f64::from(order)).abs()).collect();
    println!("{what}: errors {errors:?}, distances of the slopes from {order}: {off:?}");
    assert!(off.len() >= 2 && off[off.len() - 1] < 0.5, "{what} has not order {order}: {off:?}");
    assert!(off[off.len() / 3..].windows(2).all(|pair| pair[1] < pair[0]), "{what} does not converge to order {order}: {off:?}");
}

#[test]
fn halving_the_step_divides_the_error_by_two_to_the_order() {
    let time = 2.0;
    for (name, coarsest) in [
        ("explicit-euler", 1.0 / 512.0),
        ("symplectic-euler", 1.0 / 512.0),
        ("velocity-verlet", 1.0 / 64.0),
        ("runge-kutta-4", 1.0 / 32.0),
        ("yoshida-4", 1.0 / 32.0),
        ("yoshida-6", 1.0 / 4.0),
        ("yoshida-8", 1.0 / 2.0),
    ] {
        let error = |dt| {
            let mut engine = planet(Integrator::from_name(name, dt).unwrap());
            engine.advance(time, &mut ()).unwrap();
            assert_eq!(engine.time(), time);
            (engine.particles().position[1] - kepler(time)).norm()
        };
        assert_order(name, Integrator::from_name(name, 1.0).unwrap().order(), error, coarsest);
    }
}

/// Friction is shown the velocity extrapolated to the time of the positions, so velocity Verlet keeps its order.
#[test]
fn velocity_verlet_keeps_order_two_with_drag() {
    let error = |dt| {
        let mut one = Particles::<2>::new();
        one.push(Vector::ZERO, Vector([1.0, 0.0]), 1.0, 0.0, 0);
        let space = Boundary::new([-2.0; 2], [2.0; 2], Axis::Open);
        let forces: Vec<Box<dyn Force<2>>> = vec![Box::new(Drag { rate: 0.7 })];
        let mut engine = TimeDriven::new(space, one, forces, Integrator::VelocityVerlet { dt }).unwrap();
        engine.advance(2.0, &mut ()).unwrap();
        (engine.particles().velocity[0][0] - (-1.4f64).exp()).abs()
    };
    assert_order("velocity-verlet with drag", 2, error, 1.0 / 16.0);
}

/// Over `10^6` steps a symplectic integrator's mean energy moves by a tenth of what the energy swings within one orbit, and it swings no wider; the
/// same test catches an integrator that is not symplectic.
#[test]
fn symplectic_integrators_keep_energy_bounded() {
    let e = ECCENTRICITY;
    // The planet has no mass: its energy per mass, by hand.
    let energy = |engine: &TimeDriven<2>| {
        let Particles { position, velocity, .. } = engine.particles();
        0.5 * (velocity[1] - velocity[0]).norm_squared() - 1.0 / (position[1] - position[0]).norm()
    };
    for name in Integrator::NAMES
        .iter()
        .filter(|name| !EXACT_FOR_TWO.contains(name) && Integrator::from_name(name, 1.0).unwrap().dt().is_some())
    {
        // At order 8 the same step would leave nothing but roundings.
        let dt = if *name == "yoshida-8" { 0.2 } else { 0.05 };
        let integrator = Integrator::from_name(name, dt).unwrap();
        let mut engine = planet(integrator);
        let mut stretch = |from: u32, to: u32| {
            let (mut low, mut high, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
            for step in from..to {
                engine.advance(f64::from(step + 1) * dt, &mut ()).unwrap();
                let energy = energy(&engine);
                (low, high, sum) = (low.min(energy), high.max(energy), sum + energy);
            }
            (high - low, sum / f64::from(to - from))
        };
        let (swing, first) = stretch(0, 10_000);
        let (later, last) = stretch(990_000, 1_000_000);
        let bounded = (last - first).abs() < 0.1 * swing && later < 1.1 * swing;
        println!("{name}: swing {swing:.2e}, drift {:.2e}", (last - first).abs());
        // Runge-Kutta drifts, but at this step still swings more than it drifts in a hundredth of the run.
        let per_orbit = swing / (10_000.0 * dt / std::f64::consts::TAU);
        let drifts = (last - first).abs() > per_orbit;
        assert!(bounded || !integrator.is_symplectic(), "{name}: {first} to {last}, swing {swing}");
        assert!(drifts || integrator.is_symplectic(), "{name} should drift: {first} to {last}, e = {e}");
    }
}

fn chain(integrator: Integrator) -> TimeDriven<2> {
    let mut beads = Particles::new();
    for i in 0..20 {
        let x = f64::from(i);
        beads.push(Vector([x + 0.1 * (2.0 * x).sin(), 0.2 * x.cos()]), Vector([0.1 * x.sin(), 0.3 * (3.0 * x).cos()]), 1.0, 0.0, 0);
    }
    let springs = (1..20).map(|i| Spring::new(i - 1, i, 1.0, 0.0)).collect();
    let space = Boundary::new([0.0; 2], [20.0; 2], Axis::Open);
    TimeDriven::new(space, beads, vec![Box::new(Springs::new(springs))], integrator).unwrap()
}

/// Forwards, velocities reversed, back again. A linear system amplifies no error: what is left is the rounding of
/// `2 n` steps of numbers below 20, for a reversible integrator; its truncation error, for another.
#[test]
fn symmetric_integrators_run_backwards() {
    let (dt, steps) = (0.05, 2000u32);
    for (name, reversible) in [
        ("velocity-verlet", true),
        ("yoshida-4", true),
        ("yoshida-6", true),
        ("yoshida-8", true),
        ("runge-kutta-4", false),
        ("symplectic-euler", false),
    ] {
        let mut engine = chain(Integrator::from_name(name, dt).unwrap());
        let start = engine.snapshot();
        engine.advance(f64::from(steps) * dt, &mut ()).unwrap();
        engine.edit(|particles| particles.velocity.iter_mut().for_each(|v| *v = -*v)).unwrap();
        engine.advance(f64::from(2 * steps) * dt, &mut ()).unwrap();
        let off = (0..20).map(|i| (engine.particles().position[i] - start.position[i]).norm()).fold(0.0, f64::max);
        let rounding = 2.0 * f64::from(steps) * 20.0 * f64::EPSILON;
        println!("{name}: {off:.2e} against {rounding:.2e}");
        assert_eq!(off < rounding, reversible, "{name}: {off:e}");
    }
}
