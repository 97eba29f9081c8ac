//! The time-driven engine of a free system.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};
use corpuscle_time::{Drive, Force, Integrator, Pin, Signal, TimeDriven, UniformField};

use super::{AnyEngine, Bath, EnergyLaw, axis, bonds, field, finite, forces, not_negative, stepper};
use crate::free::spec::{Shaker, System};

/// A force, and the table of the file it comes from.
pub(super) type Named<const D: usize> = (&'static str, Box<dyn Force<D>>);

/// What forces and integrators have to know of the rest.
pub(super) struct Context<'a> {
    pub(super) seed: u64,
    /// Names of the species, in the order of their indices.
    pub(super) names: &'a [&'a str],
    pub(super) degrees_of_freedom: usize,
    pub(super) closed: bool,
}

pub(super) fn time_driven<const D: usize>(
    system: &System,
    boundary: Boundary<D>,
    particles: Particles<D>,
    pins: Vec<Pin<D>>,
    context: &Context<'_>,
) -> Result<AnyEngine<D>, Invalid> {
    let only_hard = [
        ("collisions", system.collisions.is_some()),
        ("partition[0]", !system.partitions.is_empty()),
        ("face[0]", !system.walls.is_empty()),
        ("obstacle[0]", !system.obstacles.is_empty()),
        ("piston", system.piston.is_some()),
    ];
    if let Some((key, _)) = only_hard.into_iter().find(|(_, given)| *given) {
        return Err(Invalid::new(key, "given", "nothing: the time-driven engine has none; choose engine = \"event\""));
    }
    let integrator = stepper::integrator(system, context)?;
    if matches!(integrator, Integrator::StochasticRescaling { .. } | Integrator::NoseHoover { .. }) {
        can_be_scaled(&particles, context.closed)?;
    }
    let mut all = forces::forces(system, &particles, context)?;
    all.extend(bonds::forces(system, particles.len())?);
    let uniform = field::<D>(system)?;
    if uniform != Vector::ZERO {
        all.push(("field", Box::new(UniformField::new(uniform))));
    }
    for (table, force) in &all {
        force.validate(&boundary, &particles).map_err(|error| in_table(system, table, error))?;
    }
    let engine = TimeDriven::new(boundary, particles, all.into_iter().map(|(_, force)| force).collect(), integrator)?;
    let engine = if pins.is_empty() { engine } else { engine.with_pins(pins)? };
    let drives = system.drives.iter().enumerate().map(|(index, drive)| prescribed(index, drive, &engine));
    let drives: Vec<Drive> = drives.collect::<Result<_, _>>()?;
    Ok(AnyEngine::Time(Box::new(if drives.is_empty() { engine } else { engine.with_drives(drives)? })))
}

/// A bath that scales all velocities moves nothing that is at rest, and would scale a motion of the whole, too.
fn can_be_scaled<const D: usize>(particles: &Particles<D>, closed: bool) -> Result<(), Invalid> {
    let moving: f64 = particles.velocity.iter().zip(&particles.mass).map(|(v, m)| m * v.norm()).sum();
    if moving == 0.0 {
        let expected = "particles that move: this bath scales velocities, and cannot heat what is at rest";
        return Err(Invalid::new("integrator.name", "a start at rest", expected));
    }
    let momentum = particles.momentum().norm();
    if closed && momentum > 1e-9 * moving {
        let expected = "momenta that add up to zero: this bath scales all velocities, and would heat the motion of the whole";
        return Err(Invalid::new("integrator.name", format!("a total momentum of {momentum:e}"), expected));
    }
    Ok(())
}

fn prescribed<const D: usize>(index: usize, drive: &Shaker, engine: &TimeDriven<D>) -> Result<Drive, Invalid> {
    let key = |field: &str| format!("drive[{index}].{field}");
    let particles = engine.particles().len();
    if drive.particle >= particles {
        return Err(Invalid::new(key("particle"), drive.particle, format!("the index of a particle, 0 to {}", particles - 1)));
    }
    let axis = axis::<D>(&key("axis"), drive.axis)?;
    if engine.boundary().axes[axis] == Axis::Periodic {
        return Err(Invalid::new(key("axis"), drive.axis.letter(), "an axis with walls, or open"));
    }
    let signal = sine(&key, [drive.amplitude, drive.angular_frequency, drive.phase, drive.ramp])?;
    Ok(Drive { particle: drive.particle, axis, signal })
}

/// A sine of amplitude, angular frequency, phase, and time over which it is switched on.
pub(super) fn sine(key: &impl Fn(&str) -> String, numbers: [f64; 4]) -> Result<Signal, Invalid> {
    let [amplitude, angular_frequency, phase, ramp] = numbers;
    finite(&key("amplitude"), amplitude)?;
    finite(&key("angular_frequency"), angular_frequency)?;
    finite(&key("phase"), phase)?;
    not_negative(&key("ramp"), ramp)?;
    Ok(Signal::Sine { amplitude, angular_frequency, phase, ramp })
}

/// The error of a force, which knows its own words, with the key that stands in the file. What it says of particles and of the box is
/// looked for by [`located`](super::located).
fn in_table(system: &System, table: &str, error: Invalid) -> Invalid {
    let words: Vec<&str> = error.key.split(' ').collect();
    let key = match words[..] {
        [.., "particle", _] | ["axis" | "uniform", ..] | ["masses"] => return error,
        ["ends" | "length", "of", "bond", i] => bonds::key_of(system, table, i),
        [.., "of", "spring", i] => format!("{}.{}", bonds::key_of(system, table, i), words[..words.len() - 3].join("_")),
        _ => {
            let own = words.iter().position(|&word| word == "of").unwrap_or(words.len());
            let key = words[..own].join("_");
            // The range of the repulsive part follows from its diameter.
            let key = if table == "forces.wca" && key == "cutoff" { "sigma" } else { &key };
            if table == "fene" { format!("fene[0].{key}") } else { format!("{table}.{key}") }
        }
    };
    Invalid { key, ..error }
}

/// Whether something else than particles takes up momentum, or forces keep it only as well as they are approximated.
pub(super) fn feels_the_outside(system: &System) -> bool {
    let of_forces = system.forces.as_ref().is_some_and(|forces| {
        let tree = forces.gravity.as_ref().is_some_and(|gravity| gravity.opening_angle.is_some());
        forces.central.is_some() || forces.drag.is_some() || !forces.push.is_empty() || tree
    });
    of_forces || system.integrator.as_ref().is_some_and(|stepper| matches!(stepper.name.as_str(), "langevin" | "brownian"))
}

fn is_driven(system: &System) -> bool {
    !system.drives.is_empty() || system.forces.as_ref().is_some_and(|forces| !forces.push.is_empty())
}

fn has_friction(system: &System) -> bool {
    system.springs.iter().any(|bond| bond.damping != 0.0) || system.forces.as_ref().is_some_and(|forces| forces.drag.is_some())
}

/// What the forces and the bath do to the energy.
pub(super) fn energy_law(system: &System) -> EnergyLaw {
    let name = system.integrator.as_ref().map_or("", |stepper| stepper.name.as_str());
    if is_driven(system) || matches!(name, "langevin" | "brownian" | "stochastic-rescaling") {
        EnergyLaw::Free
    } else if !has_friction(system) {
        EnergyLaw::Stays
    } else if name == "nose-hoover" {
        EnergyLaw::Free
    } else {
        EnergyLaw::Falls
    }
}

/// The heat bath, where the integrator is one.
pub(super) fn bath(system: &System) -> Option<Bath> {
    let stepper = system.integrator.as_ref()?;
    let temperature = stepper.temperature?;
    let alone = !is_driven(system) && !has_friction(system);
    Some(Bath { temperature, thermal: stepper.name != "brownian", alone })
}
