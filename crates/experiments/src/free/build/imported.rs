//! Particles taken from a trajectory.

use corpuscle_core::{Boundary, Invalid, Particles, Random, Vector};

use super::not_negative;
use super::placement::to_temperature;
use crate::free::spec::{Start, System};

/// Adds the particles that were read, in a plane without their third coordinate, and inside the box along periodic axes.
pub(super) fn place<const D: usize>(
    system: &System,
    start: &Start,
    boundary: &Boundary<D>,
    seed: u64,
    names: &mut Vec<String>,
    particles: &mut Particles<D>,
) -> Result<(), Invalid> {
    let others = [
        ("particle[0]", system.particles.is_empty()),
        ("species[0]", system.species.is_empty()),
        ("growth", system.growth.is_none()),
    ];
    if let Some((key, _)) = others.into_iter().find(|(_, absent)| !absent) {
        return Err(Invalid::new(key, "given", "nothing beside [start], which brings all particles"));
    }
    if let Some(temperature) = start.temperature {
        not_negative("start.temperature", temperature)?;
    }
    let Some(read) = &system.imported else {
        return Err(Invalid::new("start.file", &start.file, "a file that has been read: give the scenario as a file"));
    };
    let from = &read.particles;
    names.clone_from(&read.names);
    let mut random = Random::new(seed, 0);
    for i in 0..from.len() {
        let (r, v) = (from.position[i], from.velocity[i]);
        let flat = (D..3).all(|k| r[k] == from.position[0][k] && v[k] == 0.0);
        if !flat {
            let found = format!("particle {i} at {:?} with the velocity {:?}", r.0, v.0);
            return Err(Invalid::new(
                "start.file",
                found,
                "particles in a plane, like the box: all at the same z, without motion along it",
            ));
        }
        let mass = from.mass[i];
        let velocity = match start.temperature {
            Some(temperature) if mass > 0.0 => Vector::from_fn(|_| (temperature / mass).sqrt() * random.normal()),
            Some(_) => Vector::ZERO,
            None => Vector::from_fn(|k| v[k]),
        };
        particles.push(boundary.wrap(Vector::from_fn(|k| r[k])), velocity, mass, from.radius[i], from.species[i]);
    }
    if let Some(temperature) = start.temperature {
        to_temperature(temperature, boundary, particles);
    }
    Ok(())
}
