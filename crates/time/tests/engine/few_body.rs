//! Two and three bodies: what is known exactly must come out.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Vector};
use corpuscle_time::{Gravity, Integrator, TimeDriven};

const RADAU: Integrator = Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None };

fn system<const D: usize>(bodies: &[(f64, [f64; D], [f64; D])], integrator: Integrator) -> TimeDriven<D> {
    let mut particles = Particles::new();
    for &(mass, position, velocity) in bodies {
        particles.push(Vector(position), Vector(velocity), mass, 0.0, 0);
    }
    let space = Boundary::new([-5.0; D], [5.0; D], Axis::Open);
    TimeDriven::new(space, particles, vec![Box::new(Gravity::new(1.0, 0.0))], integrator).expect("a valid system")
}

/// Chenciner and Montgomery 2000, doi:10.2307/2661357; initial values of Simo, to 8 digits.
fn figure_eight(integrator: Integrator) -> TimeDriven<2> {
    figure_eight_turned(0.0, integrator)
}

/// The same, turned by an angle.
fn figure_eight_turned(angle: f64, integrator: Integrator) -> TimeDriven<2> {
    let (sine, cosine) = angle.sin_cos();
    let turn = |x: f64, y: f64| [cosine * x - sine * y, sine * x + cosine * y];
    let ([x, y], [u, v]) = (turn(0.970_004_36, -0.243_087_53), turn(-0.932_407_37, -0.864_731_46));
    let half = [-0.5 * u, -0.5 * v];
    system(&[(1.0, [x, y], half), (1.0, [-x, -y], half), (1.0, [0.0; 2], [u, v])], integrator)
}

const FIGURE_EIGHT_PERIOD: f64 = 6.325_913_98;

/// Masses 3, 4, 5 from rest (Burrau 1913; Szebehely and Peters 1967, doi:10.1086/110355).
fn pythagorean() -> TimeDriven<2> {
    let rest = [0.0; 2];
    system(&[(3.0, [1.0, 3.0], rest), (4.0, [-2.0, -1.0], rest), (5.0, [1.0, -1.0], rest)], RADAU)
}

/// After `T = 2 pi sqrt(a^3 / G(m_1 + m_2))` two bodies are where they were. A relative energy error `d` shifts the phase by
/// `3 pi d` an orbit; `d` is at most the rounding of every step, and the positions' own rounding comes on top.
#[test]
fn periods_obey_kepler_s_third_law() {
    for (first, second, axis, e) in [(1.0, 1.0, 1.0, 0.0), (3.0, 0.1, 2.0, 0.5), (0.2, 5.0, 7.0, 0.9)] {
        let total: f64 = first + second;
        let (r, v) = (axis * (1.0 - e), (total / axis * (1.0 + e) / (1.0 - e)).sqrt());
        let (s1, s2) = (-second / total, first / total);
        let bodies = [
            (first, [s1 * r, 0.0, 0.0], [0.0, s1 * v * 0.6, s1 * v * 0.8]),
            (second, [s2 * r, 0.0, 0.0], [0.0, s2 * v * 0.6, s2 * v * 0.8]),
        ];
        let mut engine = system::<3>(&bodies, RADAU);
        let start = engine.snapshot();
        engine.advance(std::f64::consts::TAU * (axis * axis * axis / total).sqrt(), &mut ()).unwrap();
        let off = (engine.particles().position[1] - start.position[1]).norm();
        // An error of phase moves the body by the speed at perihelion, v, not by the mean speed.
        let rounding = f64::EPSILON * engine.steps() as f64 * 3.0 * std::f64::consts::PI * v * (axis * axis * axis / total).sqrt();
        println!("e = {e}: off by {off:.2e}, rounding {rounding:.2e}, {} steps", engine.steps());
        assert!(off < rounding, "e = {e}: {off:e}");
    }
}

/// The initial values have 8 digits: one period later the bodies are back to what these digits allow.
#[test]
fn the_figure_eight_returns_after_one_period() {
    for integrator in [RADAU, Integrator::Yoshida4 { dt: FIGURE_EIGHT_PERIOD / 4000.0 }] {
        let mut engine = figure_eight(integrator);
        let (start, energy) = (engine.snapshot(), engine.energy());
        engine.advance(FIGURE_EIGHT_PERIOD, &mut ()).unwrap();
        let off = (0..3).map(|i| (engine.particles().position[i] - start.position[i]).norm()).fold(0.0, f64::max);
        println!("{}: off {off:.2e}, energy {:.1e}", integrator.name(), (engine.energy() / energy - 1.0).abs());
        assert!(off < 1e-6, "{}: {off:e}", integrator.name());
        // Each step rounds three momenta of about 1.
        assert!(engine.momentum().norm() < engine.steps() as f64 * 3.0 * f64::EPSILON);
    }
}

/// Rounding alone: every step rounds the energy by about one unit in the last place, in a random direction, so `n` steps
/// leave `sqrt(n)` of them; systematic errors would leave `n` (Rein and Spiegel 2015, section 3.2).
#[test]
fn radau_s_energy_error_is_rounding() {
    let mut engine = figure_eight(RADAU);
    let energy = engine.energy();
    engine.advance(100.0 * FIGURE_EIGHT_PERIOD, &mut ()).unwrap();
    let error = (engine.energy() / energy - 1.0).abs();
    let walk = f64::EPSILON * (engine.steps() as f64).sqrt();
    println!("100 periods: energy {error:.2e}, random walk {walk:.2e}, {} steps", engine.steps());
    assert!(error < 4.0 * walk, "{error:e} after {} steps", engine.steps());
}

/// Seen from sixteen directions the roundings differ, and only what they have in common is a bias: its mean is zero within its
/// standard error. Of all steps each may round the energy by `1.6e-2` of its last digit, the spread of the sixteen.
#[test]
fn rounding_has_no_bias() {
    let periods = 300u32;
    let drift = |direction: u32| {
        let mut engine = figure_eight_turned(0.1 + 0.39 * f64::from(direction), RADAU);
        let energy = engine.energy();
        let off = |k: u32, engine: &mut TimeDriven<2>| {
            engine.advance(f64::from(k) * 0.93 * FIGURE_EIGHT_PERIOD, &mut ()).expect("a smooth orbit");
            engine.energy() / energy - 1.0
        };
        // The mean of many looks, for the energy itself is rounded.
        let mut mean = |from: u32| (from..from + 50).map(|k| off(k, &mut engine)).sum::<f64>() / 50.0;
        let (first, last) = (mean(0), mean(periods - 50));
        (last - first) / engine.steps() as f64
    };
    let drifts: Vec<f64> = (0..16).map(drift).collect();
    let mean = drifts.iter().sum::<f64>() / 16.0;
    let error = (drifts.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (15.0 * 16.0)).sqrt();
    println!("drift {mean:.1e} +- {error:.1e} a step");
    // Student's t with 15 degrees of freedom: |t| > 4.07 has probability 0.001.
    assert!(mean.abs() < 4.07 * error, "{mean:e} +- {error:e}");
    assert!(error < 2e-20, "too noisy to see a bias: {error:e}");
}

/// The bodies meet within 0.006 of each other about 2 from the origin: rounding their positions alone would disturb the
/// energy by `1e-11`; forces from positions of double precision twice do better.
///
/// Body 3 escapes, 4 and 5 stay bound (Szebehely and Peters 1967).
#[test]
fn the_pythagorean_problem_ends_as_published() {
    let mut engine = pythagorean();
    let energy = engine.energy();
    engine.advance(70.0, &mut ()).unwrap();
    let error = (engine.energy() / energy - 1.0).abs();
    let Particles { position: r, velocity: v, .. } = engine.particles();
    let bound = 0.5 * (v[2] - v[1]).norm_squared() - 9.0 / (r[2] - r[1]).norm();
    let centre = (4.0 * r[1] + 5.0 * r[2]) / 9.0;
    let drift = (4.0 * v[1] + 5.0 * v[2]) / 9.0;
    let escape = 0.5 * (v[0] - drift).norm_squared() - 12.0 / (r[0] - centre).norm();
    println!(
        "energy {error:.2e}, {} steps, pair {bound:.4}, third {escape:.4}, distance {:.3}",
        engine.steps(),
        (r[0] - centre).norm()
    );
    assert!(bound < 0.0, "4 and 5 are not bound: {bound}");
    assert!(escape > 0.0 && (v[0] - drift).dot(r[0] - centre) > 0.0, "3 does not escape: {escape}");
    assert!(error < 1e-12, "energy error {error:e}");
    assert!(engine.angular_momentum()[2].abs() < 1e-11, "angular momentum {:?}", engine.angular_momentum());
}

/// The closest approach of the three, near `t = 15.83` between bodies 4 and 5 (their distance there is about 0.01).
#[test]
fn the_closest_encounter_comes_when_it_should() {
    let mut engine = pythagorean();
    let closest = (15_800..15_860).map(|step| {
        let time = f64::from(step) * 1e-3;
        engine.advance(time, &mut ()).unwrap();
        let r = &engine.particles().position;
        ((r[1] - r[2]).norm().min((r[0] - r[1]).norm()).min((r[0] - r[2]).norm()), time)
    });
    let (distance, time) = closest.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    println!("closest {distance:.5} at {time}");
    assert!((time - 15.83).abs() < 0.005 && distance < 0.02, "{distance} at {time}");
}

/// States between two steps come from the step's polynomial and conserve energy as the steps do.
#[test]
fn dense_output_lies_on_the_orbit() {
    let mut engine = figure_eight(RADAU);
    let energy = engine.energy();
    let worst = (1..2000).map(|step| {
        engine.advance(f64::from(step) * 0.003, &mut ()).unwrap();
        assert_eq!(engine.time(), f64::from(step) * 0.003);
        (engine.energy() / energy - 1.0).abs()
    });
    let worst = worst.fold(0.0, f64::max);
    // The last coefficient is at most the tolerance, 1e-9, of the acceleration; between the nodes the polynomial is off by
    // less than the next one, (1e-9)^(8/7), times max |h (h - h_1) ... (h - h_7)| < 2e-5.
    println!("worst {worst:.2e}");
    assert!(worst < 1e-9f64.powf(8.0 / 7.0) * 2e-5 + 100.0 * f64::EPSILON, "{worst:e}");
}

/// A planet of eccentricity 0.3 around a fixed star for ten years, seen at 1000 times: each step may be off by the tolerance, and
/// an error in energy grows into one of phase, `3 pi` a year.
#[test]
fn dormand_prince_keeps_to_its_tolerance() {
    let e = 0.3f64;
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let bodies = [(1.0, [0.0; 2], [0.0; 2]), (0.0, [1.0 - e, 0.0], [0.0, ((1.0 + e) / (1.0 - e)).sqrt()])];
        let mut engine = system::<2>(&bodies, Integrator::DormandPrince8 { tolerance, first_step: None });
        let mut worst: f64 = 0.0;
        for sample in 1..=1000 {
            let time = f64::from(sample) * 0.02 * std::f64::consts::PI;
            engine.advance(time, &mut ()).unwrap();
            assert_eq!(engine.time(), time);
            let anomaly =
                (0..50).fold(time, |anomaly, _| anomaly - (anomaly - e * anomaly.sin() - time) / (1.0 - e * anomaly.cos()));
            let expected = Vector([anomaly.cos() - e, (1.0 - e * e).sqrt() * anomaly.sin()]);
            worst = worst.max((engine.particles().position[1] - expected).norm());
        }
        let bound = tolerance * engine.steps() as f64 * 10.0 * 3.0 * std::f64::consts::PI;
        println!("tolerance {tolerance:e}: worst {worst:.1e}, bound {bound:.1e}, {} steps", engine.steps());
        assert!(worst < bound, "{worst:e}");
    }
}

/// Two bodies falling onto each other reach a singularity: said, not passed over.
#[test]
fn a_collision_of_points_is_a_failure_with_a_cause() {
    for integrator in [RADAU, Integrator::DormandPrince8 { tolerance: 1e-12, first_step: None }] {
        let mut engine = system(&[(1.0, [0.0, 0.0], [0.0; 2]), (1.0, [1.0, 0.0], [0.0; 2])], integrator);
        // Free fall from rest at distance d: t = (pi/2) sqrt(d^3 / (2 G M)).
        let meeting = std::f64::consts::FRAC_PI_2 * 0.5;
        let failure = engine.advance(1.0, &mut ()).unwrap_err();
        println!("{}: {failure}", integrator.name());
        assert!((failure.time - meeting).abs() < 1e-6, "{failure}");
        assert!(failure.particle.is_some() && failure.cause.contains("soften"));
        assert!(engine.snapshot().validate().is_ok());
        assert_eq!(engine.time(), failure.time);
    }
}
