//! Forces of a free system, every number checked.

use corpuscle_core::{Axis, Invalid, Particles, Vector};
use corpuscle_time::{
    CentralField, Coulomb, Drag, DrivingForce, Ewald, Force, ForceShifted, Gravity, HarmonicRepulsion, InversePower, LennardJones,
    Morse, PairForce, PairPotential, TreeGravity, WeeksChandlerAndersen, Yukawa,
};

use super::soft::{Context, Named, sine};
use super::{array, finite, not_negative, positive};
use crate::free::spec::{Between, Charges, Contact, Push, System};

/// Cutoff of pair potentials, over their lengths, when the file does not say.
const CUTOFF: f64 = 2.5;
/// Accuracy of Ewald's sum when the file does not say.
const ACCURACY: f64 = 1e-4;

/// All forces, with the tables they come from.
pub(super) fn forces<const D: usize>(
    system: &System,
    particles: &Particles<D>,
    context: &Context<'_>,
) -> Result<Vec<Named<D>>, Invalid> {
    let mut forces: Vec<Named<D>> = vec![];
    let Some(given) = &system.forces else { return Ok(forces) };
    if let Some(gravity) = &given.gravity {
        not_negative("forces.gravity.constant", gravity.constant)?;
        not_negative("forces.gravity.softening", gravity.softening)?;
        let force: Box<dyn Force<D>> = match gravity.opening_angle {
            None => Box::new(Gravity::new(gravity.constant, gravity.softening)),
            Some(angle) => Box::new(TreeGravity::new(gravity.constant, gravity.softening, angle)),
        };
        forces.push(("forces.gravity", force));
    }
    if let Some(charges) = &given.coulomb {
        forces.push(("forces.coulomb", coulomb(system, charges, particles, context)?));
    }
    if let Some(contact) = &given.lennard_jones {
        let cutoff = contact.cutoff.unwrap_or(CUTOFF);
        positive("forces.lennard_jones.cutoff", cutoff)?;
        let potential = |epsilon, sigma| LennardJones { epsilon, sigma, cutoff: cutoff * sigma };
        let force: Box<dyn Force<D>> = if contact.force_shifted {
            pairs("forces.lennard_jones", contact, context, |epsilon, sigma| ForceShifted(potential(epsilon, sigma)))?
        } else {
            pairs("forces.lennard_jones", contact, context, potential)?
        };
        forces.push(("forces.lennard_jones", force));
    }
    if let Some(contact) = &given.wca {
        if let Some(cutoff) = contact.cutoff {
            let expected = "nothing: this potential is cut at its minimum, 2^(1/6) sigma";
            return Err(Invalid::new("forces.wca.cutoff", cutoff, expected));
        }
        if contact.force_shifted {
            return Err(Invalid::new("forces.wca.force_shifted", true, "nothing: this force vanishes at its cutoff anyway"));
        }
        forces.push(("forces.wca", pairs("forces.wca", contact, context, WeeksChandlerAndersen::new)?));
    }
    if let Some(power) = &given.inverse_power {
        let cutoff = power.cutoff.unwrap_or(CUTOFF) * power.sigma;
        let potential = InversePower { epsilon: power.epsilon, sigma: power.sigma, exponent: power.exponent, cutoff };
        forces.push(("forces.inverse_power", Box::new(PairForce::new(potential))));
    }
    if let Some(screened) = &given.yukawa {
        let cutoff = screened.cutoff * screened.sigma;
        let (epsilon, sigma, screening_length) = (screened.epsilon, screened.sigma, screened.screening_length);
        forces.push(("forces.yukawa", Box::new(PairForce::new(Yukawa { epsilon, sigma, screening_length, cutoff }))));
    }
    if let Some(grain) = &given.harmonic_repulsion {
        let potential = HarmonicRepulsion { stiffness: grain.stiffness, diameter: grain.diameter };
        forces.push(("forces.harmonic_repulsion", Box::new(PairForce::new(potential))));
    }
    if let Some(valley) = &given.morse {
        let cutoff = valley.cutoff.unwrap_or(CUTOFF) * valley.equilibrium;
        let (epsilon, equilibrium, steepness) = (valley.epsilon, valley.equilibrium, valley.steepness);
        forces.push(("forces.morse", Box::new(PairForce::new(Morse { epsilon, equilibrium, steepness, cutoff }))));
    }
    if let Some(trap) = &given.central {
        let centre = Vector(array("forces.central.centre", &trap.centre)?);
        forces.push(("forces.central", Box::new(CentralField { centre, strength: trap.strength, power: trap.power })));
    }
    if let Some(friction) = &given.drag {
        not_negative("forces.drag.rate", friction.rate)?;
        forces.push(("forces.drag", Box::new(Drag { rate: friction.rate })));
    }
    for (index, push) in given.push.iter().enumerate() {
        forces.push(("forces.push", Box::new(pushed(index, push, particles)?)));
    }
    Ok(forces)
}

/// A potential of two numbers, or a table of them by the names of the particles.
fn pairs<P: PairPotential + 'static, const D: usize>(
    table: &str,
    contact: &Contact,
    context: &Context<'_>,
    potential: impl Fn(f64, f64) -> P,
) -> Result<Box<dyn Force<D>>, Invalid> {
    positive(&format!("{table}.epsilon"), contact.epsilon)?;
    positive(&format!("{table}.sigma"), contact.sigma)?;
    if contact.between.is_empty() {
        return Ok(Box::new(PairForce::new(potential(contact.epsilon, contact.sigma))));
    }
    let mut numbers = vec![(contact.epsilon, contact.sigma); context.names.len() * context.names.len()];
    for (index, Between { names, epsilon, sigma }) in contact.between.iter().enumerate() {
        let key = |field: &str| format!("{table}.between[{index}].{field}");
        positive(&key("epsilon"), *epsilon)?;
        positive(&key("sigma"), *sigma)?;
        let [a, b] = [kind(&key("names"), &names[0], context)?, kind(&key("names"), &names[1], context)?];
        for (a, b) in [(a, b), (b, a)] {
            numbers[a * context.names.len() + b] = (*epsilon, *sigma);
        }
    }
    let kinds = context.names.len();
    let between = |a: u16, b: u16| {
        let (epsilon, sigma) = numbers[usize::from(a) * kinds + usize::from(b)];
        potential(epsilon, sigma)
    };
    // Places and velocities fill the memory long before names of particles outnumber an index.
    Ok(Box::new(PairForce::between_species(u16::try_from(kinds).unwrap_or(u16::MAX), between)))
}

/// Index of the species of that name.
fn kind(key: &str, name: &str, context: &Context<'_>) -> Result<usize, Invalid> {
    let expected = || format!("a name of particles: {}", context.names.join(", "));
    context.names.iter().position(|known| *known == name).ok_or_else(|| Invalid::new(key, name, expected()))
}

/// Charges in open space or between walls, or with all their periodic images.
fn coulomb<const D: usize>(
    system: &System,
    given: &Charges,
    particles: &Particles<D>,
    context: &Context<'_>,
) -> Result<Box<dyn Force<D>>, Invalid> {
    finite("forces.coulomb.constant", given.constant)?;
    let mut of_kind = vec![0.0; context.names.len()];
    for (name, &charge) in &given.charges {
        let key = format!("forces.coulomb.charges.{name}");
        finite(&key, charge)?;
        of_kind[kind(&key, name, context)?] = charge;
    }
    let charges: Vec<f64> = particles.species.iter().map(|&species| of_kind[usize::from(species)]).collect();
    let axes = super::boundary::boundary::<D>(system)?.axes;
    if axes.iter().all(|&axis| axis == Axis::Periodic) {
        return match ewald(Ewald::new(given.constant, charges, given.accuracy.unwrap_or(ACCURACY))) {
            Some(force) => Ok(force),
            None => Err(Invalid::new("box.faces", "periodic", "walls or open: charges in a plane have no periodic images here")),
        };
    }
    match given.accuracy {
        Some(accuracy) => {
            Err(Invalid::new("forces.coulomb.accuracy", accuracy, "nothing: without periodic images the sum is exact"))
        }
        None => Ok(Box::new(Coulomb::new(given.constant, charges))),
    }
}

/// Ewald's sum as a force of this dimension: there is one in space.
fn ewald<const D: usize>(sum: Ewald) -> Option<Box<dyn Force<D>>> {
    let space: Box<dyn std::any::Any> = Box::new(Box::new(sum) as Box<dyn Force<3>>);
    space.downcast::<Box<dyn Force<D>>>().ok().map(|force| *force)
}

fn pushed<const D: usize>(index: usize, push: &Push, particles: &Particles<D>) -> Result<DrivingForce<D>, Invalid> {
    let key = |field: &str| format!("forces.push[{index}].{field}");
    if push.particle >= particles.len() {
        return Err(Invalid::new(key("particle"), push.particle, format!("the index of a particle, 0 to {}", particles.len() - 1)));
    }
    let direction = Vector(array(&key("direction"), &push.direction)?);
    let signal = sine(&key, [push.amplitude, push.angular_frequency, push.phase, push.ramp])?;
    Ok(DrivingForce { particle: push.particle, direction, signal })
}
