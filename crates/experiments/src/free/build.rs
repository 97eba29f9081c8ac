//! From the description of a free system to an engine, every number checked on the way.

mod boundary;
mod imported;
mod placement;
mod rules;

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};
use corpuscle_core::{Boundary, Engine, Failure, Invalid, Observer, Particles, Piston, Vector};
use corpuscle_event::EventDriven;
use corpuscle_time::{
    Force, Gravity, Integrator, LennardJones, PairForce, Pin, Spring, Springs, TimeDriven, UniformField, WeeksChandlerAndersen,
};

use super::spec::{AxisName, EngineKind, System};

/// Steps a scenario may ask for: more would never end.
const MOST_STEPS: f64 = 1e12;

/// One of the two engines, behind one name.
pub(super) enum AnyEngine<const D: usize> {
    /// Hard particles.
    Event(Box<EventDriven<D>>),
    /// Soft particles.
    Time(Box<TimeDriven<D>>),
}

impl<const D: usize> AnyEngine<D> {
    pub(super) fn time(&self) -> f64 {
        match self {
            Self::Event(engine) => engine.time(),
            Self::Time(engine) => engine.time(),
        }
    }

    pub(super) fn advance(&mut self, to: f64, observer: &mut impl Observer<D>) -> Result<(), Failure> {
        match self {
            Self::Event(engine) => engine.advance(to, observer),
            Self::Time(engine) => engine.advance(to, observer),
        }
    }

    pub(super) fn boundary(&self) -> &Boundary<D> {
        match self {
            Self::Event(engine) => engine.boundary(),
            Self::Time(engine) => engine.boundary(),
        }
    }

    pub(super) fn piston(&self) -> Option<Piston> {
        match self {
            Self::Event(engine) => engine.piston(),
            Self::Time(_) => None,
        }
    }

    pub(super) fn snapshot(&self) -> Particles<D> {
        match self {
            Self::Event(engine) => engine.snapshot(),
            Self::Time(engine) => engine.snapshot(),
        }
    }

    pub(super) fn unwrapped(&self, i: usize) -> Vector<D> {
        match self {
            Self::Event(engine) => engine.unwrapped(i),
            Self::Time(engine) => engine.unwrapped(i),
        }
    }

    /// Kinetic energy of the particles now, and potential energy with all that a piston has.
    pub(super) fn energies(&self) -> (f64, f64) {
        match self {
            Self::Event(engine) => {
                let piston = engine.piston().map_or(0.0, |piston| piston.energy());
                (engine.kinetic_energy(), engine.potential_energy() + piston)
            }
            Self::Time(engine) => (engine.kinetic_energy(), engine.potential_energy()),
        }
    }
}

impl<const D: usize> Resume for AnyEngine<D> {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        out.fields(1)?;
        match self {
            Self::Event(engine) => out.value("event", engine),
            Self::Time(engine) => out.part("time", engine),
        }
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        from.fields(1)?;
        match self {
            Self::Event(engine) => **engine = from.value("event")?,
            Self::Time(engine) => from.part("time", engine)?,
        }
        Ok(())
    }
}

/// A system ready to run.
pub(super) struct Built<const D: usize> {
    pub(super) engine: AnyEngine<D>,
    /// Names of the species, in the order of their indices.
    pub(super) names: Vec<String>,
    /// Particles whose path is drawn.
    pub(super) trails: Vec<usize>,
    /// How many coordinates are held.
    pub(super) held: usize,
}

/// Builds the engine.
pub(super) fn build<const D: usize>(system: &System, seed: u64) -> Result<Built<D>, Invalid> {
    positive("duration", system.duration)?;
    if let Some(interval) = system.sample_interval {
        positive("sample_interval", interval)?;
    }
    let boundary = boundary::boundary(system)?;
    let mut names: Vec<String> = vec![];
    let mut particles = Particles::<D>::new();
    let (pins, trails) = placement::place_singles(system, &mut names, &mut particles)?;
    match &system.start {
        Some(start) => imported::place(system, start, &boundary, seed, &mut names, &mut particles)?,
        None => placement::generate(system, &boundary, seed, &mut names, &mut particles)?,
    }
    if particles.is_empty() {
        return Err(Invalid::new("particle", 0, "at least one particle, in [[particle]], [[species]] or [start]"));
    }
    let held = pins.iter().flat_map(|pin| pin.axes).filter(|&held| held).count();
    let engine = match system.engine {
        EngineKind::Event => event_driven(system, boundary, particles, seed),
        EngineKind::Time => time_driven(system, boundary, particles, pins),
    };
    Ok(Built { engine: engine.map_err(|error| located(system, error))?, names, trails, held })
}

fn event_driven<const D: usize>(
    system: &System,
    boundary: Boundary<D>,
    particles: Particles<D>,
    seed: u64,
) -> Result<AnyEngine<D>, Invalid> {
    let refuse = |key: &str| Err(Invalid::new(key, "given", "nothing: the event-driven engine has none; choose engine = \"time\""));
    if !system.springs.is_empty() {
        return refuse("spring[0]");
    }
    if system.forces.is_some() {
        return refuse("forces");
    }
    if system.integrator.is_some() {
        return refuse("integrator");
    }
    if let Some(index) = system.particles.iter().position(|single| !single.held.is_empty()) {
        return refuse(&format!("particle[{index}].held"));
    }
    if let Some(i) = particles.mass.iter().position(|&mass| mass <= 0.0) {
        return Err(Invalid::new(
            format!("mass of particle {i}"),
            particles.mass[i],
            "a positive mass: hard particles exchange momentum",
        ));
    }
    Ok(AnyEngine::Event(Box::new(EventDriven::new(boundary, particles, rules::rules(system, seed)?)?)))
}

fn time_driven<const D: usize>(
    system: &System,
    boundary: Boundary<D>,
    particles: Particles<D>,
    pins: Vec<Pin<D>>,
) -> Result<AnyEngine<D>, Invalid> {
    if system.collisions.is_some() {
        return Err(Invalid::new("collisions", "given", "nothing: the time-driven engine has none; choose engine = \"event\""));
    }
    let only_hard = [
        ("partition[0]", !system.partitions.is_empty()),
        ("face[0]", !system.walls.is_empty()),
        ("obstacle[0]", !system.obstacles.is_empty()),
        ("piston", system.piston.is_some()),
    ];
    if let Some((key, _)) = only_hard.into_iter().find(|(_, given)| *given) {
        return Err(Invalid::new(key, "given", "nothing: the time-driven engine has none; choose engine = \"event\""));
    }
    let Some(stepper) = &system.integrator else {
        return Err(Invalid::new("integrator", "missing", "name and time_step of an integrator, for engine = \"time\""));
    };
    let integrator = match (stepper.name.as_str(), stepper.time_step) {
        ("gauss-radau-15", None) => Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None },
        ("dormand-prince-8", None) => Integrator::DormandPrince8 { tolerance: 1e-12, first_step: None },
        (_, None) => return Err(Invalid::new("integrator.time_step", "missing", "a positive number")),
        (name, Some(step)) => Integrator::from_name(name, step).map_err(|error| {
            let key = if error.key == "integrator" { "integrator.name".into() } else { "integrator.time_step".to_string() };
            Invalid { key, ..error }
        })?,
    };
    if let Some(step) = integrator.dt()
        && !(system.duration / MOST_STEPS..=system.duration).contains(&step)
    {
        let expected = format!("a number from {:e} to {}, the duration", system.duration / MOST_STEPS, system.duration);
        return Err(Invalid::new("integrator.time_step", step, expected));
    }
    let mut forces: Vec<Box<dyn Force<D>>> = vec![];
    if let Some(given) = &system.forces {
        if let Some(gravity) = &given.gravity {
            not_negative("forces.gravity.constant", gravity.constant)?;
            not_negative("forces.gravity.softening", gravity.softening)?;
            forces.push(Box::new(Gravity::new(gravity.constant, gravity.softening)));
        }
        if let Some(pair) = &given.lennard_jones {
            let cutoff = pair.cutoff.unwrap_or(2.5);
            positive("forces.lennard_jones.epsilon", pair.epsilon)?;
            positive("forces.lennard_jones.sigma", pair.sigma)?;
            positive("forces.lennard_jones.cutoff", cutoff)?;
            forces.push(Box::new(PairForce::new(LennardJones {
                epsilon: pair.epsilon,
                sigma: pair.sigma,
                cutoff: cutoff * pair.sigma,
            })));
        }
        if let Some(pair) = &given.wca {
            positive("forces.wca.epsilon", pair.epsilon)?;
            positive("forces.wca.sigma", pair.sigma)?;
            if let Some(cutoff) = pair.cutoff {
                return Err(Invalid::new(
                    "forces.wca.cutoff",
                    cutoff,
                    "nothing: this potential is cut at its minimum, 2^(1/6) sigma",
                ));
            }
            forces.push(Box::new(PairForce::new(WeeksChandlerAndersen::new(pair.epsilon, pair.sigma))));
        }
    }
    if !system.springs.is_empty() {
        forces.push(Box::new(Springs::new(springs(system, particles.len())?)));
    }
    let uniform = field::<D>(system)?;
    if uniform != Vector::ZERO {
        forces.push(Box::new(UniformField::new(uniform)));
    }
    let engine = TimeDriven::new(boundary, particles, forces, integrator)?;
    Ok(AnyEngine::Time(Box::new(if pins.is_empty() { engine } else { engine.with_pins(pins)? })))
}

fn springs(system: &System, particles: usize) -> Result<Vec<Spring>, Invalid> {
    let mut springs = vec![];
    for (index, bond) in system.springs.iter().enumerate() {
        let key = |field: &str| format!("spring[{index}].{field}");
        for (field, end) in [("first", bond.first), ("second", bond.second)] {
            if end >= particles {
                return Err(Invalid::new(key(field), end, format!("the index of a particle, 0 to {}", particles - 1)));
            }
        }
        if bond.first == bond.second {
            return Err(Invalid::new(key("second"), bond.second, "another particle than the first"));
        }
        not_negative(&key("stiffness"), bond.stiffness)?;
        not_negative(&key("rest_length"), bond.rest_length)?;
        not_negative(&key("damping"), bond.damping)?;
        let mut spring = Spring::new(bond.first, bond.second, bond.stiffness, bond.rest_length);
        spring.damping = bond.damping;
        springs.push(spring);
    }
    Ok(springs)
}

fn field<const D: usize>(system: &System) -> Result<Vector<D>, Invalid> {
    if system.field.is_empty() { Ok(Vector::ZERO) } else { array("field", &system.field).map(Vector) }
}

fn axis<const D: usize>(key: &str, name: AxisName) -> Result<usize, Invalid> {
    let index = name as usize;
    if index < D { Ok(index) } else { Err(Invalid::new(key, "z", "x or y: the box is a plane")) }
}

fn array<const D: usize>(key: &str, list: &[f64]) -> Result<[f64; D], Invalid> {
    match list.try_into() {
        Ok(array) if list.iter().all(|x| x.is_finite()) => Ok(array),
        _ => Err(Invalid::new(key, format!("{list:?}"), format!("{D} finite numbers, as many as box.lower has"))),
    }
}

fn positive(key: &str, value: f64) -> Result<(), Invalid> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(Invalid::new(key, value, "a positive number")) }
}

fn not_negative(key: &str, value: f64) -> Result<(), Invalid> {
    if value >= 0.0 && value.is_finite() { Ok(()) } else { Err(Invalid::new(key, value, "a number, zero or more")) }
}

/// The error of an engine, which counts particles and knows no file, with the key that stands in the file.
fn located(system: &System, error: Invalid) -> Invalid {
    if system.start.is_some() && error.key.contains("particle") {
        let value = format!("{} {}", error.key, error.value);
        return Invalid { key: "start.file".into(), value, ..error };
    }
    let index = |text: &str| text.parse::<usize>().ok();
    let words: Vec<&str> = error.key.split(' ').collect();
    let key = match words[..] {
        ["velocity", "of", "particle", i] if index(i).is_some_and(|i| i >= system.particles.len()) => {
            // A generated particle got its velocity from a temperature.
            let key = index(i).map(|i| source(system, i, "temperature"));
            return Invalid { key: key.unwrap_or(error.key.clone()), value: format!("{}, {}", error.key, error.value), ..error };
        }
        [property, "of", "particle", i] => index(i).map(|i| source(system, i, property)),
        ["particles", i, "and", j] => {
            // Only those placed by hand can overlap: what is generated keeps clear.
            let key = index(i).zip(index(j)).map(|(i, j)| source(system, i.max(j), "position"));
            let value = format!("{} {}", error.key, error.value);
            return Invalid { key: key.unwrap_or(error.key), value, expected: error.expected };
        }
        ["particle", i, "and", "obstacle", j] => {
            // What is generated keeps clear of them, too.
            let key = index(i).map(|i| source(system, i, "position"));
            return Invalid { key: key.unwrap_or(error.key.clone()), value: format!("obstacle[{j}] {}", error.value), ..error };
        }
        ["box"] => {
            let shoulder = system.collisions.as_ref().is_some_and(|collisions| collisions.shoulder.is_some());
            let key = if shoulder { "collisions.shoulder.range" } else { "collisions.well.range" };
            let expected = format!("wells that fit into the box, which is {}: {}", error.value, error.expected);
            let range = system.collisions.as_ref().and_then(|collisions| {
                collisions.well.as_ref().map(|well| well.range).or(collisions.shoulder.as_ref().map(|shoulder| shoulder.range))
            });
            return Invalid::new(key, range.unwrap_or(f64::NAN), expected);
        }
        ["cutoff", "of", ..] => {
            let long = system.forces.as_ref().is_some_and(|forces| forces.lennard_jones.is_some());
            Some(if long { "forces.lennard_jones.cutoff" } else { "forces.wca.sigma" }.into())
        }
        ["rest", "length", "of", "spring", i] => Some(format!("spring[{i}].rest_length")),
        ["axis", _, "of", "the", "box"] => Some("box.faces".into()),
        ["uniform", "field", ..] => Some("field".into()),
        ["masses"] => Some("particle".into()),
        ["integrator"] if Integrator::NAMES.contains(&error.value.as_str()) => Some("integrator.name".into()),
        _ => None,
    };
    Invalid { key: key.unwrap_or(error.key), ..error }
}

/// Where particle `i` comes from: those placed by hand are the first.
fn source(system: &System, i: usize, property: &str) -> String {
    if i < system.particles.len() {
        return format!("particle[{i}].{property}");
    }
    let mut end = system.particles.len();
    let group = system.species.iter().position(|group| {
        end = end.saturating_add(group.count);
        i < end
    });
    group.map_or_else(|| format!("{property} of particle {i}"), |group| format!("species[{group}].{property}"))
}
