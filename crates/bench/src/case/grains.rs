//! Dust around three stars: masses that pull, and grains that do not.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Random, Vector};
use corpuscle_experiments::{Kind, Parameter, Settings};
use corpuscle_observe::Drift;
use corpuscle_time::{Gravity, Integrator, TimeDriven};

use super::steps;
use crate::threads::in_pool;
use crate::{Case, Figure, SECONDS, THREADS, Trouble};

pub(crate) static CASE: Case = Case {
    name: "grains",
    summary: "Massless grains around three stars, leapfrog: particles times steps per second.",
    parameters: &[
        Parameter {
            name: "particles",
            unit: "",
            help: "Number of grains.",
            kind: Kind::Whole { default: 10_000, least: 1, most: 100_000_000 },
        },
        THREADS,
        SECONDS,
    ],
    run: |settings| in_pool(settings, || run(settings)),
};

/// Masses so unequal that Lagrange's triangle is stable: `(m1 m2 + m2 m3 + m3 m1) / M^2 = 0.029`, below `1/27`.
const MASSES: [f64; 3] = [1.0, 0.02, 0.01];
/// Length of a step; a side of the triangle is 1.
const STEP: f64 = 1e-3;
/// Particles times steps between two looks at the clock. Grains are taken along for many steps where nobody looks.
const WORK_OF_GROUP: usize = 16_000_000;
/// The most steps, so that few particles do not take longer than asked for.
const MOST_OF_GROUP: usize = 2000;

/// Three stars on Lagrange's triangle, turning about their centre of mass at `omega = sqrt(M)`, and grains on circles around
/// all of them, in every direction.
fn start(count: usize, seed: u64) -> (Particles<3>, f64) {
    let total: f64 = MASSES.iter().sum();
    let omega = total.sqrt();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.75f64.sqrt(), 0.0]].map(Vector);
    let centre = (0..3).fold(Vector::ZERO, |sum, star| sum + corners[star] * (MASSES[star] / total));
    let mut bodies = Particles::new();
    for (corner, mass) in corners.into_iter().zip(MASSES) {
        let place = corner - centre;
        bodies.push(place, Vector([-omega * place[1], omega * place[0], 0.0]), mass, 0.0, 0);
    }
    let mut random = Random::new(seed, 0);
    for _ in 0..count {
        let mut arrow = || Vector::<3>::from_fn(|_| random.normal());
        let (outwards, other) = (arrow(), arrow());
        let outwards = outwards * (1.0 / outwards.norm());
        let across = other - outwards * other.dot(outwards);
        let radius = 2.0 + 2.0 * random.uniform();
        bodies.push(outwards * radius, across * ((total / radius).sqrt() / across.norm()), 0.0, 0.0, 1);
    }
    (bodies, omega)
}

/// Jacobi's constant of a particle in a potential that turns with the stars: `v^2/2 + Phi - omega (x v_y - y v_x)`.
fn jacobi(bodies: &Particles<3>, omega: f64, grain: usize) -> f64 {
    let (r, v) = (bodies.position[grain], bodies.velocity[grain]);
    let potential: f64 = (0..3).map(|star| -MASSES[star] / (r - bodies.position[star]).norm()).sum();
    0.5 * v.norm_squared() + potential - omega * (r[0] * v[1] - r[1] * v[0])
}

fn run(settings: &Settings) -> Result<Vec<Figure>, Trouble> {
    let count = settings.whole("particles");
    let (bodies, omega) = start(count, settings.seed);
    let before: Vec<f64> = (3..bodies.len()).map(|grain| jacobi(&bodies, omega, grain)).collect();
    let space = Boundary::new([-5.0; 3], [5.0; 3], Axis::Open);
    let leapfrog = Integrator::VelocityVerlet { dt: STEP };
    let mut engine = TimeDriven::new(space, bodies, vec![Box::new(Gravity::new(1.0, 0.0))], leapfrog)?;
    engine.advance(STEP, &mut ())?;
    let mut drift = Drift::<1>::new();
    drift.see_energy(engine.energy());
    let group = WORK_OF_GROUP.div_ceil(count + 3).min(MOST_OF_GROUP) as u64;
    let taken = steps::take(&mut engine, CASE.clock(settings), settings.real("seconds"), group, |engine| {
        drift.see_energy(engine.energy());
    })?;

    let bodies = engine.particles();
    let mut errors: Vec<f64> = before
        .iter()
        .zip(3..)
        .map(|(before, grain)| ((jacobi(bodies, omega, grain) - before) / bodies.velocity[grain].norm_squared() * 2.0).abs())
        .collect();
    errors.sort_by(f64::total_cmp);
    let mut figures = vec![Figure::new("particle_steps_per_second", (count + 3) as f64 * taken.per_second())];
    figures.extend(taken.figures());
    figures.extend([
        Figure::new("time_reached", engine.time()),
        Figure::new("relative_energy_drift_of_stars", drift.largest().unwrap_or(f64::NAN)),
        Figure::new("jacobi_error_over_kinetic_energy_median", errors[errors.len() / 2]),
        Figure::new("jacobi_error_over_kinetic_energy_worst", errors[errors.len() - 1]),
    ]);
    Ok(figures)
}
