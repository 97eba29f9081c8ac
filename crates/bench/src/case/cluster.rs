//! What the cases on many masses share: a cluster, and how far its accelerations are from direct sums.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_experiments::Settings;
use corpuscle_observe::Drift;
use corpuscle_time::{Force, Integrator, TimeDriven};

use super::steps::{self, Steps};
use crate::{Case, Figure, Trouble};

/// Softening length of the cluster, whose density falls off as a normal distribution of standard deviation 1.
pub(super) const SOFTENING: f64 = 0.01;
/// Length of a step, a thousandth of the time in which a body crosses the cluster, or less.
const STEP: f64 = 1e-3;
/// Pairs that the direct sums of a sample may have together.
const PAIRS_OF_SAMPLE: usize = 20_000_000;
/// Most bodies of a sample.
const SAMPLE: usize = 2000;

/// `count` equal masses, 1 together, with places and velocities distributed normally, in the balance of the virial theorem:
/// such a cloud has the potential energy `-1 / (2 sqrt(pi))`, so that the variance of a velocity is `1 / (6 sqrt(pi))`.
pub(super) fn start(count: usize, seed: u64) -> Particles<3> {
    let mut random = Random::new(seed, 0);
    let speed = (1.0 / (6.0 * std::f64::consts::PI.sqrt())).sqrt();
    let mut bodies = Particles::new();
    for _ in 0..count {
        let place = Vector::from_fn(|_| random.normal());
        bodies.push(place, Vector::from_fn(|_| speed * random.normal()), 1.0 / count as f64, 0.0, 0);
    }
    bodies
}

/// What a run of steps shows: how fast they were, and the physics.
pub(super) struct Run {
    pub(super) steps: Steps,
    pub(super) figures: Vec<Figure>,
}

/// Measures leapfrog steps of a cluster under `force`, then compares the accelerations it has reached with direct sums.
pub(super) fn measure<F: Force<3> + Clone + 'static>(
    case: &Case,
    settings: &Settings,
    force: F,
    group: u64,
) -> Result<Run, Trouble> {
    let bodies = start(settings.whole("particles"), settings.seed);
    let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
    let leapfrog = Integrator::VelocityVerlet { dt: STEP };
    let mut engine = TimeDriven::new(space, bodies, vec![Box::new(force.clone())], leapfrog)?;
    // The first step brings memory and caches to where they stay.
    engine.advance(STEP, &mut ())?;
    let (mut energy, mut momentum) = (Drift::<1>::new(), Drift::<3>::new());
    let mut see = |engine: &TimeDriven<3>| {
        let bodies = engine.particles();
        let moving = bodies.mass.iter().zip(&bodies.velocity).map(|(m, v)| m * v.norm()).sum();
        energy.see_energy(engine.energy());
        momentum.see(engine.momentum().0, moving);
    };
    see(&engine);
    let steps = steps::take(&mut engine, case.clock(settings), settings.real("seconds"), group, |_| {})?;
    see(&engine);
    let [median, most, worst] = error_of_forces(force, engine.boundary(), engine.particles());
    let mut figures = steps.figures().to_vec();
    figures.extend([
        Figure::new("relative_energy_drift", energy.largest().unwrap_or(f64::NAN)),
        Figure::new("relative_momentum_drift", momentum.largest().unwrap_or(f64::NAN)),
        Figure::new("force_error_median", median),
        Figure::new("force_error_of_99_in_100_below", most),
        Figure::new("force_error_worst", worst),
    ]);
    Ok(Run { steps, figures })
}

/// Relative errors of the accelerations of a sample against direct sums in plain arithmetic: the median, what 99 of 100 are
/// below, and the worst. The sample is spread evenly over the indices.
fn error_of_forces<F: Force<3>>(mut force: F, space: &Boundary<3>, bodies: &Particles<3>) -> [f64; 3] {
    let mut found = vec![Vector::ZERO; bodies.len()];
    force.accelerate(0.0, space, bodies, &mut found);
    let sample = (PAIRS_OF_SAMPLE / bodies.len()).clamp(10, SAMPLE);
    let each = bodies.len().div_ceil(sample);
    let mut errors: Vec<f64> = (0..bodies.len())
        .step_by(each)
        .map(|i| {
            let exact = direct_sum(bodies, i);
            (found[i] - exact).norm() / exact.norm()
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |share: f64| errors[((errors.len() as f64 * share) as usize).min(errors.len() - 1)];
    [quantile(0.5), quantile(0.99), quantile(1.0)]
}

/// `sum_j m_j r_ij / (r_ij^2 + s^2)^(3/2)`, as the formula reads.
fn direct_sum(bodies: &Particles<3>, i: usize) -> Vector<3> {
    let mut sum = Vector::ZERO;
    for j in (0..bodies.len()).filter(|&j| j != i) {
        let r = bodies.position[j] - bodies.position[i];
        let squared = r.norm_squared() + SOFTENING * SOFTENING;
        sum += r * (bodies.mass[j] / (squared * squared.sqrt()));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_time::{Gravity, TreeGravity};

    #[test]
    fn the_cluster_is_in_the_balance_of_the_virial_theorem() {
        let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
        let ratios: Vec<f64> = (0..20)
            .map(|seed| {
                let bodies = start(1000, seed);
                -2.0 * bodies.kinetic_energy() / Gravity::new(1.0, SOFTENING).energy(0.0, &space, &bodies)
            })
            .collect();
        // Of the pairs of 1000 bodies a thousandth is missing; softening takes s^2 / 4 from each inverse distance.
        let estimate = corpuscle_observe::Estimate::from_replicas(&ratios);
        assert!(estimate.score(1.001).abs() < 4.0, "{estimate:?}");
    }

    #[test]
    fn errors_of_forces_are_seen() {
        let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
        let bodies = start(500, 1);
        let [median, most, worst] = error_of_forces(TreeGravity::new(1.0, SOFTENING, 0.5), &space, &bodies);
        assert!(1e-6 < median && median < most && most <= worst && worst < 0.1, "{median} {most} {worst}");
        assert!(error_of_forces(Gravity::new(1.0, SOFTENING), &space, &bodies)[2] < 1e-13);
        let wrong = error_of_forces(Gravity::new(1.001, SOFTENING), &space, &bodies);
        assert!((wrong[0] - 1e-3).abs() < 1e-12 && (wrong[2] - 1e-3).abs() < 1e-12, "{wrong:?}");
    }
}
