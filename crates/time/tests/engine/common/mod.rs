//! Spheres that repel each other as `k T (s/r)^n`, and hard ones, for a test and for the charts of `docs/hard-limit.md`.

#![allow(clippy::unwrap_used, dead_code, reason = "a start that fails is a mistake here; each user takes its own part")]

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector, placement};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::{Estimate, VirialPressure, blocking, theory};
use corpuscle_time::{Force, Integrator, InversePower, PairForce, TimeDriven};

/// Particles in a box, enough that `Z` is 1 % from its limit at most: hard and soft ones are compared at the same number.
pub(crate) const PARTICLES: usize = 108;

fn start(packing: f64, seed: u64, radius: f64) -> (Boundary<3>, Particles<3>) {
    let side = (PARTICLES as f64 * corpuscle_core::particles::ball_volume::<3>(0.5) / packing).cbrt();
    let boundary = Boundary::periodic(side);
    let mut random = Random::new(seed, 0);
    let mut particles = Particles::new();
    for place in placement::lattice(&boundary, PARTICLES, radius, &mut random, |_| true).unwrap() {
        particles.push(place, Vector::ZERO, 1.0, radius, 0);
    }
    placement::maxwell(&mut particles, 1.0, true, &mut random);
    (boundary, particles)
}

/// The potential `(1/r)^n`, cut where a millionth of `k T` is left.
pub(crate) fn soft(exponent: u8) -> InversePower {
    InversePower { epsilon: 1.0, sigma: 1.0, exponent, cutoff: 1e6f64.powf(1.0 / f64::from(exponent)) }
}

/// `Z = 1 + W/(3 N k T)` of the soft spheres over this time, at constant temperature.
pub(crate) fn soft_compressibility(exponent: u8, packing: f64, time: f64, seed: u64) -> Estimate {
    // The steepest part of a collision at thermal speed takes 1/n.
    let dt = 0.06 / f64::from(exponent);
    let degrees_of_freedom = 3 * (PARTICLES as u32 - 1);
    let integrator = Integrator::StochasticRescaling { dt, temperature: 1.0, relaxation_time: 0.5, degrees_of_freedom, seed };
    let (boundary, particles) = start(packing, seed, 0.0);
    let force: Box<dyn Force<3>> = Box::new(PairForce::new(soft(exponent)));
    let mut engine = TimeDriven::new(boundary, particles, vec![force], integrator).unwrap();
    engine.advance(10.0, &mut ()).unwrap();
    let samples = (64.0 * time) as u32;
    let series: Vec<f64> = (1..=samples)
        .map(|sample| {
            engine.advance(10.0 + f64::from(sample) / 64.0, &mut ()).unwrap();
            1.0 + engine.virial() / (3.0 * PARTICLES as f64)
        })
        .collect();
    blocking(&series).estimate
}

/// `Z` of hard spheres, by the event-driven engine.
pub(crate) fn hard_compressibility(packing: f64, time: f64, seed: u64) -> Estimate {
    let (boundary, particles) = start(packing, seed, 0.5);
    let volume = boundary.volume();
    let mut engine = EventDriven::new(boundary, particles, Rules::default()).unwrap();
    engine.advance(10.0, &mut ()).unwrap();
    let mut pressure = VirialPressure::new(PARTICLES, volume, 1.0, 0.5);
    corpuscle_core::Observer::<3>::begin(&mut pressure, 10.0, &Particles::new());
    engine.advance(10.0 + time, &mut pressure).unwrap();
    corpuscle_core::Observer::<3>::finish(&mut pressure, 10.0 + time, &Particles::new());
    pressure.compressibility()
}

/// `Z` of hard spheres of the diameter `int (1 - exp(-U/kT)) dr = Gamma(1 - 1/n)` (Barker and Henderson 1967,
/// doi:10.1063/1.1701689): right to the first order in `1/n`.
pub(crate) fn barker_henderson(exponent: f64, packing: f64) -> f64 {
    theory::compressibility::<3>(packing * libm::tgamma(1.0 - 1.0 / exponent).powi(3))
}

/// Head-on encounters at relative speeds as they occur in a gas, from random phases of the step.
fn encounters(pairs: u32, seed: u64) -> impl Iterator<Item = (f64, f64)> {
    let mut random = Random::new(seed, 1);
    // The flux-weighted distribution of the relative speed, v exp(-v^2/4).
    (0..pairs).map(move |_| (2.0 * (-libm::log(1.0 - random.uniform())).sqrt(), random.uniform()))
}

fn pair(speed: f64, distance: f64, radius: f64) -> Particles<2> {
    let mut pair = Particles::new();
    pair.push(Vector::ZERO, Vector([0.5 * speed, 0.0]), 1.0, radius, 0);
    pair.push(Vector([distance, 0.0]), Vector([-0.5 * speed, 0.0]), 1.0, radius, 0);
    pair
}

const SPACE: f64 = 1e3;

/// Of so many head-on encounters of soft spheres with a fixed step: how many pass through each other, and how many else come out
/// with an energy that is off by a tenth or more. An overflow counts as the second.
pub(crate) fn missed(exponent: u8, dt: f64, pairs: u32, seed: u64) -> [u32; 2] {
    let mut missed = [0; 2];
    for (speed, phase) in encounters(pairs, seed) {
        let cutoff = soft(exponent).cutoff;
        let distance = cutoff + phase * speed * dt;
        let force: Box<dyn Force<2>> = Box::new(PairForce::new(soft(exponent)));
        let space = Boundary::new([-SPACE; 2], [SPACE; 2], Axis::Open);
        let start = pair(speed, distance, 0.0);
        let mut engine = TimeDriven::new(space, start, vec![force], Integrator::VelocityVerlet { dt }).unwrap();
        let before = engine.kinetic_energy();
        let steps = ((distance + cutoff + 1.0) / (speed * dt)).ceil() + 2.0;
        let overflow = engine.advance(steps * dt, &mut ()).is_err();
        let r = &engine.particles().position;
        if !overflow && r[0][0] > r[1][0] {
            missed[0] += 1;
        } else if overflow || (engine.kinetic_energy() / before - 1.0).abs() > 0.1 {
            missed[1] += 1;
        }
    }
    missed
}

/// The same encounters of hard spheres, by the event-driven engine.
pub(crate) fn missed_by_events(pairs: u32, seed: u64) -> [u32; 2] {
    let mut missed = [0; 2];
    for (speed, phase) in encounters(pairs, seed) {
        let space = Boundary::new([-SPACE; 2], [SPACE; 2], Axis::Open);
        let start = pair(speed, 1.0 + phase, 0.5);
        let before = start.kinetic_energy();
        let mut engine = EventDriven::new(space, start, Rules::default()).unwrap();
        engine.advance(4.0 / speed, &mut ()).unwrap();
        let after = engine.snapshot();
        missed[0] += u32::from(after.position[0][0] > after.position[1][0]);
        missed[1] += u32::from((after.kinetic_energy() / before - 1.0).abs() > 0.1);
    }
    missed
}

/// The parabola of least `chi^2` through points `(x, y, standard error)`: its value at zero.
pub(crate) fn extrapolate(points: &[(f64, f64, f64)]) -> Estimate {
    let mut matrix = [[0.0; 4]; 3];
    for &(x, y, error) in points {
        let (powers, weight) = ([1.0, x, x * x], 1.0 / (error * error));
        for (row, a) in matrix.iter_mut().zip(powers) {
            for (entry, b) in row.iter_mut().zip([1.0, x, x * x, y]) {
                *entry += weight * a * b;
            }
        }
    }
    // Cramer's rule; the variance of the first parameter is the first entry of the inverse.
    let minor = |a: usize, b: usize| matrix[1][a] * matrix[2][b] - matrix[1][b] * matrix[2][a];
    let determinant = matrix[0][0] * minor(1, 2) - matrix[0][1] * minor(0, 2) + matrix[0][2] * minor(0, 1);
    let value = matrix[0][3] * minor(1, 2) - matrix[0][1] * minor(3, 2) + matrix[0][2] * minor(3, 1);
    Estimate::new(value / determinant, (minor(1, 2) / determinant).sqrt())
}
