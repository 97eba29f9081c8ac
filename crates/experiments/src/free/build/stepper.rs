//! The integrator of a free system, with its heat bath.

use corpuscle_core::Invalid;
use corpuscle_time::Integrator;

use super::soft::Context;
use super::{not_negative, positive};
use crate::free::spec::{Stepper, System};

/// Steps a scenario may ask for: more would never end.
const MOST_STEPS: f64 = 1e12;
/// Thermostats of a chain, when the file does not say.
const LINKS: u32 = 3;
/// Names of those that are heat baths.
const BATHS: [&str; 4] = ["langevin", "brownian", "stochastic-rescaling", "nose-hoover"];

/// The integrator as the file has it: no key is needed that is missing, none is there that it does not know.
pub(super) fn integrator(system: &System, context: &Context<'_>) -> Result<Integrator, Invalid> {
    let Some(stepper) = &system.integrator else {
        return Err(Invalid::new("integrator", "missing", "name and time_step of an integrator, for engine = \"time\""));
    };
    let integrator = if BATHS.contains(&stepper.name.as_str()) { bath(stepper, context)? } else { plain(stepper)? };
    if let Some(step) = integrator.dt()
        && !(system.duration / MOST_STEPS..=system.duration).contains(&step)
    {
        let expected = format!("a number from {:e} to {}, the duration", system.duration / MOST_STEPS, system.duration);
        return Err(Invalid::new("integrator.time_step", step, expected));
    }
    Ok(integrator)
}

fn plain(stepper: &Stepper) -> Result<Integrator, Invalid> {
    let name = stepper.name.as_str();
    let known = || [&Integrator::NAMES[..], &BATHS].concat().join(", ");
    let found = Integrator::from_name(name, stepper.time_step.unwrap_or(1.0)).map_err(|error| match error.key.as_str() {
        "integrator" => Invalid::new("integrator.name", name, format!("one of {}", known())),
        _ => Invalid { key: "integrator.time_step".into(), ..error },
    })?;
    unknown_to(stepper, &["temperature", "friction", "relaxation_time", "links"])?;
    let first_step = stepper.time_step;
    match found {
        Integrator::GaussRadau15 { tolerance, .. } => {
            Ok(Integrator::GaussRadau15 { tolerance: own_tolerance(stepper, tolerance)?, first_step })
        }
        Integrator::DormandPrince8 { tolerance, .. } => {
            Ok(Integrator::DormandPrince8 { tolerance: own_tolerance(stepper, tolerance)?, first_step })
        }
        fixed => {
            unknown_to(stepper, &["tolerance"])?;
            needed("time_step", stepper.time_step, "a positive number")?;
            Ok(fixed)
        }
    }
}

fn own_tolerance(stepper: &Stepper, usual: f64) -> Result<f64, Invalid> {
    let tolerance = stepper.tolerance.unwrap_or(usual);
    if tolerance > 0.0 && tolerance <= 1.0 {
        Ok(tolerance)
    } else {
        Err(Invalid::new("integrator.tolerance", tolerance, "a number above 0, at most 1"))
    }
}

fn bath(stepper: &Stepper, context: &Context<'_>) -> Result<Integrator, Invalid> {
    let dt = needed("time_step", stepper.time_step, "a positive number")?;
    positive("integrator.time_step", dt)?;
    let temperature = needed("temperature", stepper.temperature, "the temperature of the bath")?;
    positive("integrator.temperature", temperature)?;
    unknown_to(stepper, &["tolerance"])?;
    let seed = context.seed;
    let friction = || -> Result<f64, Invalid> {
        unknown_to(stepper, &["relaxation_time", "links"])?;
        needed("friction", stepper.friction, "a rate")
    };
    let relaxation_time = || -> Result<f64, Invalid> {
        unknown_to(stepper, &["friction"])?;
        let time = needed("relaxation_time", stepper.relaxation_time, "a time")?;
        positive("integrator.relaxation_time", time)?;
        Ok(time)
    };
    let degrees_of_freedom = u32::try_from(context.degrees_of_freedom).unwrap_or(u32::MAX);
    match stepper.name.as_str() {
        "langevin" => {
            let friction = friction()?;
            not_negative("integrator.friction", friction)?;
            Ok(Integrator::Langevin { dt, temperature, friction, seed })
        }
        "brownian" => {
            let friction = friction()?;
            positive("integrator.friction", friction)?;
            Ok(Integrator::Brownian { dt, temperature, friction, seed })
        }
        "stochastic-rescaling" => {
            unknown_to(stepper, &["links"])?;
            let relaxation_time = relaxation_time()?;
            Ok(Integrator::StochasticRescaling { dt, temperature, relaxation_time, degrees_of_freedom, seed })
        }
        _ => {
            let relaxation_time = relaxation_time()?;
            let links = stepper.links.unwrap_or(LINKS);
            if !(1..=64).contains(&links) {
                return Err(Invalid::new("integrator.links", links, "1 to 64"));
            }
            Ok(Integrator::NoseHoover { dt, temperature, relaxation_time, degrees_of_freedom, links })
        }
    }
}

fn needed(key: &str, value: Option<f64>, what: &str) -> Result<f64, Invalid> {
    value.ok_or_else(|| Invalid::new(format!("integrator.{key}"), "missing", what))
}

/// Refuses keys this integrator has no use for.
fn unknown_to(stepper: &Stepper, keys: &[&str]) -> Result<(), Invalid> {
    let given = [
        ("tolerance", stepper.tolerance),
        ("temperature", stepper.temperature),
        ("friction", stepper.friction),
        ("relaxation_time", stepper.relaxation_time),
        ("links", stepper.links.map(f64::from)),
    ];
    match given.into_iter().find_map(|(key, value)| value.filter(|_| keys.contains(&key)).map(|value| (key, value))) {
        Some((key, value)) => Err(Invalid::new(format!("integrator.{key}"), value, format!("nothing: {} has none", stepper.name))),
        None => Ok(()),
    }
}
