use super::*;
use corpuscle_core::{Particles, Vector};
use corpuscle_time::Gravity;

/// Kepler's third law, `T = 2 pi sqrt(a^3/(G M))`, for an eccentric pair: control of everything above. A relative energy error
/// `e` shifts the phase by at most `3 pi e` a period; rounding is `4 u sqrt(n)` with the pericentre's amplification `1/(1 - e)`.
#[test]
fn two_bodies_return_after_keplers_period() {
    let (masses, eccentricity, axis): ([f64; 2], f64, f64) = ([3.0, 2.0], 0.6, 1.7);
    let total = masses[0] + masses[1];
    let apart = axis * (1.0 + eccentricity);
    let speed = (total * (2.0 / apart - 1.0 / axis)).sqrt();
    let mut pair = Particles::<2>::new();
    for (mass, share) in [(masses[0], masses[1] / total), (masses[1], -masses[0] / total)] {
        pair.push(Vector([apart * share, 0.0]), Vector([0.0, speed * share]), mass, 0.0, 0);
    }
    let space = corpuscle_core::Boundary::new([-3.0; 2], [3.0; 2], corpuscle_core::Axis::Open);
    let mut engine = corpuscle_time::TimeDriven::new(space, pair.clone(), vec![Box::new(Gravity::new(1.0, 0.0))], PRECISE).unwrap();
    let periods = 10.0;
    engine.advance(periods * std::f64::consts::TAU * (axis * axis * axis / total).sqrt(), &mut ()).unwrap();
    let bound = 4.0 * 0.5 * f64::EPSILON * (7.0 * engine.steps() as f64).sqrt() * 3.0 * std::f64::consts::PI * periods * axis
        / ((1.0 - eccentricity) * (1.0 - eccentricity));
    let missed = farthest(&engine.particles().position, &pair.position);
    println!("missed by {missed:.1e}, bound {bound:.1e}, {} steps", engine.steps());
    assert!(missed <= bound);
}

#[test]
fn rouths_border_separates_stable_from_unstable() {
    // m1m2 + m2m3 + m3m1 = M^2/27 with m3 = 0: m2/M = (1 - sqrt(1 - 4/27))/2 = 0.0385208965...
    let border = 0.5 * (1.0 - (1.0f64 - 4.0 / 27.0).sqrt());
    assert!((border - 0.038_520_896_5).abs() < 1e-10);
    assert_eq!(triangle::growth_rate([1.0 - border + 1e-9, border - 1e-9, 0.0]), 0.0);
    assert!(triangle::growth_rate([1.0 - border - 1e-9, border + 1e-9, 0.0]) > 0.0);
    assert!((triangle::growth_rate([1.0; 3]) - 0.5f64.sqrt()).abs() < 1e-15);
}

#[test]
fn steps_fit_into_the_sampling_interval() {
    let start = Start::figure_eight([1.0; 3], 1.0, 0.0);
    for dt in [1e-3, 0.004, 0.019, 0.5, start.interval] {
        let step = start.fitting_step(dt);
        let count = start.interval / step;
        assert!((count - count.round()).abs() < 1e-9 && step <= dt.min(start.interval) * (1.0 + 1e-9), "{dt} {step}");
    }
}

#[test]
fn scaled_units_change_nothing_but_the_units() {
    let start = Start::figure_eight([2.5; 3], 0.7, 0.0);
    let mut engine = start.engine(PRECISE).unwrap();
    engine.advance(start.period.unwrap(), &mut ()).unwrap();
    assert!(farthest(&engine.particles().position, &start.particles.position) < 1e-6);
}
