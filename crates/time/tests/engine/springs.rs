//! Chains of springs: normal modes, pinned and driven ends.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_time::{Drive, Integrator, Pin, Signal, Spring, Springs, TimeDriven};
use std::f64::consts::PI;

const BEADS: usize = 16;

/// A string of unit masses and springs between two pinned ends, displaced sideways.
fn string(displacement: impl Fn(usize) -> f64, integrator: Integrator) -> TimeDriven<2> {
    string_of(BEADS, displacement, integrator)
}

fn string_of(count: usize, displacement: impl Fn(usize) -> f64, integrator: Integrator) -> TimeDriven<2> {
    let mut beads = Particles::new();
    for i in 0..count + 2 {
        beads.push(Vector([i as f64, displacement(i)]), Vector::ZERO, 1.0, 0.0, 0);
    }
    let springs = (1..count + 2).map(|i| Spring::new(i - 1, i, 1.0, 0.0)).collect();
    let space = Boundary::new([0.0, -2.0], [count as f64 + 1.0, 2.0], Axis::Open);
    let ends = [0, count + 1].map(|particle| Pin { particle, axes: [true; 2] });
    TimeDriven::new(space, beads, vec![Box::new(Springs::new(springs))], integrator).unwrap().with_pins(ends.to_vec()).unwrap()
}

/// `omega_j = 2 sqrt(k/m) sin(j pi / 2(N + 1))`; velocity Verlet turns it into `omega'` with
/// `sin(omega' dt/2) = omega dt/2`, exactly. Rounding of `n` steps moves amplitude and phase by `n` roundings each a step.
#[test]
fn normal_modes_swing_at_verlet_s_frequency() {
    let (dt, steps) = (0.1, 2000u32);
    for mode in [1.0, 2.0, 7.0, 16.0] {
        let shape = |i: usize| (mode * PI * i as f64 / (BEADS as f64 + 1.0)).sin();
        let omega = 2.0 * (0.5 * mode * PI / (BEADS as f64 + 1.0)).sin();
        let shifted = 2.0 / dt * (0.5 * omega * dt).asin();
        let mut engine = string(shape, Integrator::VelocityVerlet { dt });
        let (mut worst, mut unshifted) = (0.0f64, 0.0f64);
        for step in 1..=steps {
            engine.advance(f64::from(step) * dt, &mut ()).unwrap();
            let amplitude =
                (1..=BEADS).map(|i| shape(i) * engine.particles().position[i][1]).sum::<f64>() * 2.0 / (BEADS as f64 + 1.0);
            worst = worst.max((amplitude - (shifted * f64::from(step) * dt).cos()).abs());
            unshifted = unshifted.max((amplitude - (omega * f64::from(step) * dt).cos()).abs());
        }
        let rounding = f64::from(steps).powi(2) * f64::EPSILON;
        println!("mode {mode}: {worst:.2e} (without the shift {unshifted:.2e})");
        assert!(worst < rounding, "mode {mode}: {worst:e}");
        assert!(unshifted > rounding);
        assert_eq!(engine.particles().position[0], Vector([0.0, shape(0)]));
    }
}

/// Beyond `omega dt = 2` velocity Verlet is unstable: the highest mode grows and ends as a failure that names what helps.
#[test]
fn too_large_a_step_fails_with_the_last_good_state() {
    let shape = |i: usize| if i.is_multiple_of(2) { 0.1 } else { -0.1 };
    let integrator = Integrator::VelocityVerlet { dt: 1.2 };
    // Of the long one several steps are taken together.
    for count in [BEADS, 40_000] {
        let mut engine = string_of(count, shape, integrator);
        let failure = engine.advance(1e5, &mut ()).unwrap_err();
        assert!(failure.cause.contains("smaller dt") && failure.particle.is_some(), "{failure}");
        assert!(failure.time > engine.time());
        let state = engine.snapshot();
        state.validate().unwrap();
        // The state reported is the one a run up to that time ends with, and the next step fails.
        let mut again = string_of(count, shape, integrator);
        again.advance(engine.time(), &mut ()).unwrap();
        assert_eq!((again.snapshot() == state, again.steps()), (true, engine.steps()));
        let next = again.advance(failure.time, &mut ()).unwrap_err();
        assert_eq!((next.time, next.particle, next.cause), (failure.time, failure.particle, failure.cause));
    }
}

/// A driven end is where its signal says at the end of every step, whatever the integrator; the string follows.
#[test]
fn a_driven_end_moves_as_prescribed() {
    let signal = Signal::Pulse { amplitude: 0.5, centre: 4.0, width: 1.0 };
    // The map for planets knows no springs.
    for name in Integrator::NAMES.into_iter().filter(|&name| name != "wisdom-holman") {
        let engine = string(|_| 0.0, Integrator::from_name(name, 0.05).unwrap());
        let drive = Drive { particle: 1, axis: 1, signal };
        let mut engine = engine.with_drives(vec![drive]).unwrap();
        let at_start = signal.at(0.0).0;
        let mut heard = 0.0f64;
        for step in 1..=300 {
            engine.advance(0.05 * f64::from(step), &mut ()).unwrap();
            let position = engine.particles().position[1][1];
            assert!((position - (signal.at(engine.time()).0 - at_start)).abs() < 4.0 * f64::EPSILON, "{name} at {}", engine.time());
            heard = heard.max(engine.particles().position[8][1]);
        }
        // The pulse runs at speed 1 and is long against the spacing: it passes bead 8 with little dispersion.
        println!("{name}: pulse height {heard:.4}");
        assert!((0.4..=0.5 + 0.05).contains(&heard), "{name}: {heard}");
    }
}

#[test]
fn pins_and_drives_that_make_no_sense_are_refused() {
    let rest = || string(|_| 0.0, Integrator::VelocityVerlet { dt: 0.1 });
    let pin = Pin { particle: 99, axes: [true, false] };
    assert!(rest().with_pins(vec![pin]).err().unwrap().to_string().contains("99"));
    let drive = |axis, width| Drive { particle: 1, axis, signal: Signal::Pulse { amplitude: 1.0, centre: 0.0, width } };
    assert!(rest().with_drives(vec![drive(2, 1.0)]).err().unwrap().to_string().contains("axis"));
    assert_eq!(rest().with_drives(vec![drive(1, 0.0)]).err().unwrap().key, "pulse width");
}
