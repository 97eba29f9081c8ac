//! The particles of a free system: those placed by hand, and those generated in number.

use corpuscle_core::placement::{lattice, stop_drift};
use corpuscle_core::{Axis, Boundary, Invalid, Particles, Random, Vector};
use corpuscle_event::grown;
use corpuscle_time::Pin;

use super::{array, axis, not_negative, positive, source};
use crate::free::spec::{EngineKind, Grown, Species, System};

/// Particles a scenario may ask for: an explicit limit instead of a machine without memory.
const MOST_PARTICLES: usize = 2_000_000;
/// Particles that may grow to their places, which takes many collisions each.
const MOST_GROWN: usize = 100_000;
/// Slowest growth: the time it takes is in proportion to its inverse.
const SLOWEST: f64 = 1e-4;
/// Stream of the random numbers of growth; those below are the species' own.
const GROWTH: u64 = 1 << 32;

/// Index of a species of this name, added when new.
fn species(names: &mut Vec<String>, name: &str) -> u16 {
    let place = names.iter().position(|known| known == name).unwrap_or_else(|| {
        names.push(name.into());
        names.len() - 1
    });
    u16::try_from(place).unwrap_or(u16::MAX)
}

type Held<const D: usize> = (Vec<Pin<D>>, Vec<usize>);

/// Adds the particles placed by hand; returns the coordinates that are held, and whose paths are drawn.
pub(super) fn place_singles<const D: usize>(
    system: &System,
    names: &mut Vec<String>,
    particles: &mut Particles<D>,
) -> Result<Held<D>, Invalid> {
    let (mut pins, mut trails) = (vec![], vec![]);
    for (index, single) in system.particles.iter().enumerate() {
        let key = |field: &str| format!("particle[{index}].{field}");
        let velocity = if single.velocity.is_empty() { [0.0; D] } else { array(&key("velocity"), &single.velocity)? };
        not_negative(&key("mass"), single.mass)?;
        not_negative(&key("radius"), single.radius)?;
        let position = array(&key("position"), &single.position)?;
        let particle = particles.push(Vector(position), Vector(velocity), single.mass, single.radius, species(names, &single.name));
        if !single.held.is_empty() {
            let mut axes = [false; D];
            for &name in &single.held {
                axes[axis::<D>(&key("held"), name)?] = true;
            }
            pins.push(Pin { particle, axes });
        }
        if single.trail {
            trails.push(particle);
        }
    }
    Ok((pins, trails))
}

/// Adds the particles generated in number, at the temperatures asked for.
pub(super) fn generate<const D: usize>(
    system: &System,
    boundary: &Boundary<D>,
    seed: u64,
    names: &mut Vec<String>,
    particles: &mut Particles<D>,
) -> Result<(), Invalid> {
    let mut room = boundary.clone();
    for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Walls) {
        (room.lower[k], room.upper[k]) = (boundary.face_at(k, false, 0.0).0, boundary.face_at(k, true, 0.0).0);
    }
    let mut total = particles.len();
    for (index, group) in system.species.iter().enumerate() {
        let key = |field: &str| format!("species[{index}].{field}");
        total = total.saturating_add(group.count);
        if group.count == 0 || total > MOST_PARTICLES {
            let expected = format!("1 or more, and at most {MOST_PARTICLES} particles in all");
            return Err(Invalid::new(key("count"), group.count, expected));
        }
        positive(&key("mass"), group.mass)?;
        not_negative(&key("radius"), group.radius)?;
        not_negative(&key("temperature"), group.temperature)?;
    }
    let mut grown = match &system.growth {
        Some(growth) => grow(system, growth, boundary, seed)?,
        None => vec![],
    }
    .into_iter();
    for (index, group) in system.species.iter().enumerate() {
        let mut random = Random::new(seed, index as u64);
        let places = if system.growth.is_some() {
            grown.by_ref().take(group.count).collect()
        } else {
            sites(index, group, &room, particles, &mut random)?
        };
        let kind = species(names, &group.name);
        let spread = (group.temperature / group.mass).sqrt();
        for place in places {
            particles.push(place, Vector::from_fn(|_| spread * random.normal()), group.mass, group.radius, kind);
        }
    }
    // Particles placed by hand keep the velocities they were given, and then so do all.
    if system.particles.is_empty() {
        let wanted = system.species.iter().map(|group| group.count as f64 * group.temperature).sum::<f64>();
        to_temperature(wanted / particles.len() as f64, boundary, particles);
    }
    Ok(())
}

/// Sites of a lattice in the species' part of the room, clear of particles, partitions, obstacles and the piston.
fn sites<const D: usize>(
    index: usize,
    group: &Species,
    room: &Boundary<D>,
    particles: &Particles<D>,
    random: &mut Random,
) -> Result<Vec<Vector<D>>, Invalid> {
    let key = |field: &str| format!("species[{index}].{field}");
    let mut region = Boundary { axes: room.axes, ..Boundary::new(room.lower.0, room.upper.0, Axis::Walls) };
    if let Some(lower) = &group.lower {
        region.lower = Vector(array(&key("lower"), lower)?);
    }
    if let Some(upper) = &group.upper {
        region.upper = Vector(array(&key("upper"), upper)?);
    }
    for k in 0..D {
        // What is only a part of the box along an axis has edges there, whatever the faces of the box.
        if region.lower[k] != room.lower[k] || region.upper[k] != room.upper[k] || room.axes[k] == Axis::Open {
            region.axes[k] = Axis::Walls;
        }
        if region.lower[k] < room.lower[k] || region.upper[k] > room.upper[k] || region.lower[k] >= region.upper[k] {
            return Err(Invalid::new(
                key("lower"),
                format!("{:?} to {:?}", region.lower.0, region.upper.0),
                format!("a part of the box, {:?} to {:?}", room.lower.0, room.upper.0),
            ));
        }
    }
    let radius = group.radius;
    let clear = |site: Vector<D>| {
        let apart = |r: Vector<D>, other: f64| region.displacement(site, r).norm() >= radius + other;
        particles.position.iter().zip(&particles.radius).all(|(&r, &other)| apart(r, other))
            && room.obstacles.iter().all(|obstacle| apart(obstacle.centre, obstacle.radius))
            && room.partitions.iter().all(|plate| !plate.stands_at(0.0) || plate.distance(site) >= radius)
            && room.piston.is_none_or(|piston| (site[piston.axis] - piston.position).abs() >= radius)
    };
    lattice(&region, group.count, radius, random, clear).map_err(|error| Invalid::new(key("count"), group.count, error.expected))
}

/// Places for all species at once, without order.
fn grow<const D: usize>(system: &System, growth: &Grown, boundary: &Boundary<D>, seed: u64) -> Result<Vec<Vector<D>>, Invalid> {
    let refuse = |key: String| Err(Invalid::new(key, "given", "nothing beside [growth], which fills the whole box"));
    if system.engine == EngineKind::Time {
        return Err(Invalid::new("growth", "given", "nothing: only hard particles grow; choose engine = \"event\""));
    }
    if !system.particles.is_empty() {
        return refuse("particle[0]".into());
    }
    if let Some(part) = system.species.iter().position(|group| group.lower.is_some() || group.upper.is_some()) {
        let field = if system.species[part].lower.is_some() { "lower" } else { "upper" };
        return refuse(format!("species[{part}].{field}"));
    }
    if !(SLOWEST..=1.0).contains(&growth.rate) {
        return Err(Invalid::new("growth.rate", growth.rate, format!("a number from {SLOWEST} to 1")));
    }
    let radii: Vec<f64> = system.species.iter().flat_map(|group| std::iter::repeat_n(group.radius, group.count)).collect();
    if radii.len() > MOST_GROWN {
        return Err(Invalid::new("growth", format!("{} particles", radii.len()), format!("at most {MOST_GROWN}")));
    }
    grown(boundary, &radii, growth.rate, &mut Random::new(seed, GROWTH)).map_err(|error| {
        let words: Vec<&str> = error.key.split(' ').collect();
        let (key, value) = match words[..] {
            [property, "of", "particle", i] => (i.parse().map_or("species".into(), |i| source(system, i, property)), error.value),
            ["packing"] => ("growth".into(), format!("packing fraction {}", error.value)),
            _ => ("growth".into(), format!("{} {}", error.key, error.value)),
        };
        Invalid { key, value, expected: error.expected }
    })
}

/// Brings what was drawn to exactly the temperature asked for, and to rest as a whole where total momentum is conserved.
pub(super) fn to_temperature<const D: usize>(wanted: f64, boundary: &Boundary<D>, particles: &mut Particles<D>) {
    let count = particles.len();
    let closed = boundary.conserves_momentum() && count > 1;
    if closed {
        stop_drift(particles);
    }
    let scale = (wanted / particles.temperature(D * if closed { count - 1 } else { count })).sqrt();
    if scale.is_finite() {
        particles.velocity.iter_mut().for_each(|v| *v = *v * scale);
    }
}
