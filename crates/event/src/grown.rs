//! Dense starts: spheres that grow from points while they fly.

use corpuscle_core::placement::{lattice, maxwell};
use corpuscle_core::{Axis, Boundary, Engine, Invalid, Particles, Partition, Random, Vector};

use crate::EventDriven;

/// Places for spheres of these radii in a box, periodic or with walls, without order and without overlap.
///
/// Points on random sites of a lattice fly off and grow, all in proportion, until they have their radii (Lubachevsky and
/// Stillinger, J. Stat. Phys. 60, 561 (1990), doi:10.1007/BF01025983). In unit time a sphere flies about the mean
/// diameter and grows by `rate` of its final radius. The faster, the less order: with 0.01 equal spheres come to a packing
/// fraction of 0.60 amorphous, while with 0.0001 they have the time to crystallise on the way. Equal discs order at
/// any rate, in grains. Collisions between growing spheres heat them; they are cooled again and again.
///
/// From the beginning centres stay as far from walls, partitions, obstacles and a piston as they must in the end; whatever
/// moves or goes in the box stays as it is at the start.
///
/// # Errors
/// Names the radius, the rate or the box that makes no sense, or the packing fraction at which the spheres jam.
pub fn grown<const D: usize>(
    boundary: &Boundary<D>,
    radii: &[f64],
    rate: f64,
    random: &mut Random,
) -> Result<Vec<Vector<D>>, Invalid> {
    boundary.validate()?;
    if let Some(i) = radii.iter().position(|radius| !(*radius > 0.0 && radius.is_finite())) {
        return Err(Invalid::new(format!("radius of particle {i}"), radii[i], "a positive number"));
    }
    if !(rate > 0.0 && rate <= 1.0) {
        return Err(Invalid::new(
            "rate",
            rate,
            "a number above 0 and up to 1, the part of its radius a sphere grows by in unit time",
        ));
    }
    if radii.is_empty() {
        return Ok(vec![]);
    }
    let boundary = &still(boundary);
    let mut particles = points(boundary, radii, random)?;
    let packing = particles.occupied_volume() / boundary.volume();
    let scale = first_scale(boundary, &particles);
    let diameter = 2.0 * radii.iter().sum::<f64>() / radii.len() as f64;
    let temperature = diameter * diameter;
    maxwell(&mut particles, temperature, false, random);
    let degrees_of_freedom = D * radii.len();
    let mut engine = EventDriven::growing(boundary.clone(), particles, scale, rate)?;
    // A hair beyond their radii, so that rounding leaves no overlap.
    let end = (1.0 + 1e-11 - scale) / rate;
    // Short enough for spheres to stay about as warm; the denser, the shorter.
    let mut slice = 0.01 / rate;
    while engine.time() < end {
        engine.advance((engine.time() + slice).min(end), &mut ()).map_err(|failure| jammed(packing, &format!("({failure})")))?;
        let heat = 2.0 * engine.kinetic_energy() / (degrees_of_freedom as f64 * temperature);
        if heat > 1.2 {
            let cooling = 1.0 / heat.sqrt();
            engine.set_velocities(|_, velocity| *velocity = *velocity * cooling);
            slice *= (0.5 / (heat - 1.0)).min(1.0);
        } else {
            slice *= 1.2;
        }
        if slice < SHORTEST / rate {
            let reached = packing * (scale + rate * engine.time()).powi(D as i32);
            return Err(jammed(packing, &format!("at {reached:.4}, if they grow at the rate {rate}")));
        }
    }
    Ok(engine.snapshot().position)
}

/// Growth in a slice, in units of the final radius, below which the spheres count as jammed: with the pressure
/// `Z = 1/(1 - eta/eta_J)` this close to the jammed packing, `2 D Z` slices would be needed to get half way there.
const SHORTEST: f64 = 1e-7;

fn jammed(packing: f64, cause: &str) -> Invalid {
    Invalid::new("packing", packing, format!("less: the spheres jam {cause}"))
}

/// The box as it is at the start, with nothing in it that moves or goes.
fn still<const D: usize>(boundary: &Boundary<D>) -> Boundary<D> {
    let mut still = boundary.clone();
    for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Walls) {
        (still.lower[k], still.upper[k]) = (boundary.face_at(k, false, 0.0).0, boundary.face_at(k, true, 0.0).0);
    }
    still.faces = std::array::from_fn(|_| Default::default());
    still.partitions.iter_mut().for_each(|plate| plate.removed_at = None);
    if let Some(piston) = still.piston.take() {
        still.partitions.push(Partition::new(piston.axis, piston.position));
    }
    still
}

/// Points as far from walls as the spheres will have to be, on random sites of a lattice.
fn points<const D: usize>(boundary: &Boundary<D>, radii: &[f64], random: &mut Random) -> Result<Particles<D>, Invalid> {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let mut inner = boundary.clone();
    for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Walls) {
        (inner.lower[k], inner.upper[k]) = (boundary.lower[k] + largest, boundary.upper[k] - largest);
        if inner.lower[k] >= inner.upper[k] {
            return Err(Invalid::new("radius", largest, "a diameter smaller than the box between two walls"));
        }
    }
    let clear = |site: Vector<D>| {
        let mut alone = Particles::new();
        alone.push(site, Vector::ZERO, 1.0, largest, 0);
        boundary.validate_particles(&alone).is_ok()
    };
    let mut particles = Particles::new();
    for (place, &radius) in lattice(&inner, radii.len(), 0.0, random, clear)?.into_iter().zip(radii) {
        particles.push(place, Vector::ZERO, 1.0, radius, 0);
    }
    Ok(particles)
}

/// What part of their radii the points can begin with: half of what just fits, and not more than half in all.
fn first_scale<const D: usize>(boundary: &Boundary<D>, particles: &Particles<D>) -> f64 {
    let largest = particles.radius.iter().copied().fold(0.0, f64::max);
    // Where all are as large as their share of the volume, the nearest pair overlaps deepest.
    let share = libm::pow(boundary.volume() / particles.len() as f64, 1.0 / D as f64);
    let mut wide = particles.clone();
    wide.radius.fill(share);
    let empty = Boundary { obstacles: vec![], ..boundary.clone() };
    let nearest = 2.0 * share - empty.largest_overlap(&wide);
    (0.5 * nearest / (2.0 * largest)).min(0.5)
}
