//! The set-up of a hard-sphere gas, shared by the experiments on one: boxes from packing fractions, places without
//! overlap, Maxwell's velocities.

use corpuscle_core::particles::ball_volume;
use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Boundary, Invalid, Particles, Random, Vector};

use crate::{Kind, Parameter};

/// The dimension a gas lives in, a parameter of every experiment on one.
pub(crate) const DIMENSION: Parameter = Parameter {
    name: "dimension",
    unit: "",
    help: "Discs in the plane, or spheres in space.",
    kind: Kind::Choice { default: "2", options: &["2", "3"] },
};

/// Particles of one kind, to be added to a gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Species {
    /// How many.
    pub(crate) count: usize,
    /// Radius of each.
    pub(crate) radius: f64,
    /// Mass of each.
    pub(crate) mass: f64,
    /// Index of the species.
    pub(crate) index: u16,
}

/// Side of the cube (square) of which `count` balls of this radius fill the fraction `packing`:
/// `L^D = N v / eta` with the volume `v` of one ball.
pub(crate) fn side<const D: usize>(count: usize, radius: f64, packing: f64) -> f64 {
    let volume = count as f64 * ball_volume::<D>(radius) / packing;
    if D == 2 { volume.sqrt() } else { libm::cbrt(volume) } // sqrt and libm: the same bits on every platform
}

/// Packing fraction of `count` balls of this radius in a cube (square): the inverse of [`side`].
pub(crate) fn packing<const D: usize>(count: usize, radius: f64, side: f64) -> f64 {
    count as f64 * ball_volume::<D>(radius) / side.powi(D as i32)
}

/// Adds a species at rest, on randomly chosen sites of a lattice in `region`, which may be a part of the system's box,
/// clear of all particles that are there already.
///
/// A lattice is no equilibrium: let the gas run for some mean free times and some crossings of the box before measuring.
///
/// # Errors
/// When the region is too small: says how many would fit.
pub(crate) fn add<const D: usize>(
    particles: &mut Particles<D>,
    region: &Boundary<D>,
    species: Species,
    random: &mut Random,
) -> Result<(), Invalid> {
    let Species { count, radius, mass, index } = species;
    let clear = |site: Vector<D>| {
        let taken = particles.position.iter().zip(&particles.radius);
        !taken.into_iter().any(|(&r, &other)| region.displacement(site, r).norm() < radius + other)
    };
    for site in lattice(region, count, radius, random, clear)? {
        particles.push(site, Vector::ZERO, mass, radius, index);
    }
    Ok(())
}

/// Adds a species at rest, each particle at the first place of `draw` that is clear of all particles there already.
///
/// # Errors
/// When no clear place is found in many draws.
pub(crate) fn scatter<const D: usize>(
    particles: &mut Particles<D>,
    region: &Boundary<D>,
    species: Species,
    mut draw: impl FnMut() -> Vector<D>,
) -> Result<(), Invalid> {
    const DRAWS: usize = 10_000;
    let Species { count, radius, mass, index } = species;
    for _ in 0..count {
        let clear = |site: &Vector<D>| {
            let taken = particles.position.iter().zip(&particles.radius);
            !taken.into_iter().any(|(&r, &other)| region.displacement(*site, r).norm() < radius + other)
        };
        let site = (0..DRAWS).map(|_| draw()).find(clear);
        let site = site.ok_or_else(|| Invalid::new("particles", count, "fewer, or a thinner gas: no free place was found"))?;
        particles.push(site, Vector::ZERO, mass, radius, index);
    }
    Ok(())
}

/// Adds particles of radius 1/2 and mass 1 at rest, densely and without order, into an empty box: spheres that have grown.
///
/// # Errors
/// When they jam before they have their size.
pub(crate) fn grow<const D: usize>(
    particles: &mut Particles<D>,
    region: &Boundary<D>,
    count: usize,
    random: &mut Random,
) -> Result<(), Invalid> {
    for place in corpuscle_event::grown(region, &vec![0.5; count], 0.05, random)? {
        particles.push(place, Vector::ZERO, 1.0, 0.5, 0);
    }
    Ok(())
}

/// Gives every particle a velocity from Maxwell's distribution, then scales all of them so that the kinetic temperature
/// `2 E / (D N)` is exactly `temperature`: a start between walls, which conserve energy but not momentum, so that all
/// `D N` degrees of freedom count. In a periodic box use [`maxwell`] with `exact`, which has `D (N - 1)`.
pub(crate) fn heat<const D: usize>(particles: &mut Particles<D>, temperature: f64, random: &mut Random) {
    maxwell(particles, temperature, false, random);
    let scale = (temperature / particles.temperature(D * particles.len())).sqrt();
    if scale.is_finite() {
        particles.velocity.iter_mut().for_each(|v| *v = *v * scale);
    }
}

/// `ln Q` of hard particles of this diameter whose centres have a box with the sides `a_k`: `Q = V^N (1 - W/V^2)^(N(N-1)/2)` with
/// the volume `W = integral over |u| < s of prod (a_k - |u_k|) du` that two keep from each other. Exact for two, to first order in
/// the packing for more. The sides are longer than a diameter.
pub(crate) fn ln_configurations<const D: usize>(count: usize, sides: [f64; D], diameter: f64) -> f64 {
    let (n, s) = (count as f64, diameter);
    let volume: f64 = sides.iter().product();
    let sum: f64 = sides.iter().sum();
    let pi = std::f64::consts::PI;
    let overlap = if D == 2 {
        pi * s.powi(2) * volume - 4.0 / 3.0 * s.powi(3) * sum + 0.5 * s.powi(4)
    } else {
        let faces: f64 = sides.iter().map(|side| volume / side).sum();
        4.0 / 3.0 * pi * s.powi(3) * volume - 0.5 * pi * s.powi(4) * faces + 8.0 / 15.0 * s.powi(5) * sum - s.powi(6) / 6.0
    };
    n * libm::log(volume) + 0.5 * n * (n - 1.0) * libm::log1p(-overlap / (volume * volume))
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Axis;

    const SMALL: Species = Species { count: 60, radius: 0.5, mass: 1.0, index: 0 };

    #[test]
    fn a_gas_fills_the_fraction_asked_for_and_has_its_temperature() {
        let box_side = side::<3>(60, 0.5, 0.1);
        let room = Boundary::<3>::new([0.0; 3], [box_side; 3], Axis::Walls);
        let mut gas = Particles::new();
        let mut random = Random::new(1, 0);
        add(&mut gas, &room, SMALL, &mut random).unwrap();
        heat(&mut gas, 2.5, &mut random);
        room.validate_particles(&gas).unwrap();
        assert!((gas.occupied_volume() / room.volume() - 0.1).abs() < 1e-14);
        assert!((gas.temperature(180) - 2.5).abs() < 1e-14);
    }

    #[test]
    fn a_bath_keeps_clear_of_what_is_there() {
        let room = Boundary::<2>::periodic(20.0);
        let mut gas = Particles::new();
        gas.push(Vector([0.5, 19.5]), Vector::ZERO, 50.0, 3.0, 1); // across the corner of the box
        add(&mut gas, &room, SMALL, &mut Random::new(1, 0)).unwrap();
        assert_eq!(gas.len(), 61);
        room.validate_particles(&gas).unwrap();
    }

    #[test]
    fn too_many_are_refused() {
        let room = Boundary::<2>::new([0.0; 2], [5.0; 2], Axis::Walls);
        assert!(add(&mut Particles::new(), &room, SMALL, &mut Random::new(1, 0)).unwrap_err().expected.contains("25"));
    }

    /// Two discs or spheres in a small box, by Monte Carlo: the volume they keep from each other is exact.
    #[test]
    fn two_particles_exclude_what_the_formula_says() {
        fn score<const D: usize>(sides: [f64; D]) -> f64 {
            let (draws, mut random) = (2_000_000, Random::new(3, 0));
            let mut apart = 0;
            for _ in 0..draws {
                let square: f64 = sides.iter().map(|a| (a * (random.uniform() - random.uniform())).powi(2)).sum();
                apart += u32::from(square > 1.0);
            }
            let volume: f64 = sides.iter().product();
            let p = libm::exp(ln_configurations(2, sides, 1.0)) / (volume * volume);
            (f64::from(apart) / f64::from(draws) - p) / (p * (1.0 - p) / f64::from(draws)).sqrt()
        }
        assert!(score([3.0, 2.0]).abs() < 4.0);
        assert!(score([3.0, 2.0, 1.5]).abs() < 4.0);
    }
}
