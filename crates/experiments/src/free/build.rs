//! From the description of a free system to an engine, every number checked on the way.

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};
use corpuscle_core::placement::stop_drift;
use corpuscle_core::{Axis, Boundary, Engine, Failure, Hole, Invalid, Observer, Particles, Partition, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_time::{
    Force, Gravity, Integrator, LennardJones, PairForce, Pin, Spring, Springs, TimeDriven, UniformField, WeeksChandlerAndersen,
};

use super::spec::{AxisName, EngineKind, Face, Faces, System};
use crate::gas;

/// Particles a scenario may ask for: an explicit limit instead of a machine without memory.
const MOST_PARTICLES: usize = 2_000_000;
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

    /// Kinetic and potential energy now.
    pub(super) fn energies(&self) -> (f64, f64) {
        match self {
            Self::Event(engine) => (engine.kinetic_energy(), engine.potential_energy()),
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
    let boundary = boundary(system)?;
    let mut names: Vec<String> = vec![];
    let mut particles = Particles::<D>::new();
    let (pins, trails) = place_singles(system, &mut names, &mut particles)?;
    generate(system, &boundary, seed, &mut names, &mut particles)?;
    if particles.is_empty() {
        return Err(Invalid::new("particle", 0, "at least one particle, in [[particle]] or [[species]]"));
    }
    let held = pins.iter().flat_map(|pin| pin.axes).filter(|&held| held).count();
    let engine = match system.engine {
        EngineKind::Event => event_driven(system, boundary, particles),
        EngineKind::Time => time_driven(system, boundary, particles, pins),
    };
    Ok(Built { engine: engine.map_err(|error| located(system, error))?, names, trails, held })
}

fn boundary<const D: usize>(system: &System) -> Result<Boundary<D>, Invalid> {
    let room = &system.room;
    let kind = |face: Face| match face {
        Face::Periodic => Axis::Periodic,
        Face::Walls => Axis::Walls,
        Face::Open => Axis::Open,
    };
    let (lower, upper): ([f64; D], [f64; D]) = (array("box.lower", &room.lower)?, array("box.upper", &room.upper)?);
    // The difference counts, too: it is what may overflow, or vanish beside the corners.
    if (0..D).any(|k| !(upper[k] - lower[k] > 0.0 && (upper[k] - lower[k]).is_finite())) {
        return Err(Invalid::new("box.lower", format!("{lower:?}"), format!("numbers below those of box.upper, {upper:?}")));
    }
    let mut boundary = Boundary::new(lower, upper, Axis::Walls);
    match &room.faces {
        Faces::All(face) => boundary.axes = [kind(*face); D],
        Faces::Each(faces) => {
            let faces: [Face; D] = faces
                .clone()
                .try_into()
                .map_err(|_| Invalid::new("box.faces", format!("{} words", faces.len()), format!("one word, or {D}")))?;
            boundary.axes = faces.map(kind);
        }
    }
    for (index, plate) in system.partitions.iter().enumerate() {
        let key = |field: &str| format!("partition[{index}].{field}");
        let hole = match &plate.hole {
            None => None,
            Some(hole) => Some(Hole { along: axis::<D>(&key("hole.along"), hole.along)?, from: hole.from, to: hole.to }),
        };
        boundary.partitions.push(Partition { hole, ..Partition::new(axis::<D>(&key("axis"), plate.axis)?, plate.position) });
        boundary.validate().map_err(|error| {
            let field = error.key.strip_prefix("partition ").unwrap_or(&error.key).replace("hole ", "hole.");
            Invalid { key: key(&field), ..error }
        })?;
    }
    Ok(boundary)
}

/// Index of a species of this name, added when new.
fn species(names: &mut Vec<String>, name: &str) -> u16 {
    let place = names.iter().position(|known| known == name).unwrap_or_else(|| {
        names.push(name.into());
        names.len() - 1
    });
    u16::try_from(place).unwrap_or(u16::MAX)
}

type Held<const D: usize> = (Vec<Pin<D>>, Vec<usize>);

fn place_singles<const D: usize>(
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

fn generate<const D: usize>(
    system: &System,
    boundary: &Boundary<D>,
    seed: u64,
    names: &mut Vec<String>,
    particles: &mut Particles<D>,
) -> Result<(), Invalid> {
    for (index, group) in system.species.iter().enumerate() {
        let key = |field: &str| format!("species[{index}].{field}");
        if group.count == 0 || particles.len().saturating_add(group.count) > MOST_PARTICLES {
            return Err(Invalid::new(
                key("count"),
                group.count,
                format!("1 or more, and at most {MOST_PARTICLES} particles in all"),
            ));
        }
        positive(&key("mass"), group.mass)?;
        not_negative(&key("radius"), group.radius)?;
        not_negative(&key("temperature"), group.temperature)?;
        let mut region = boundary.clone();
        region.partitions.clear();
        if let Some(lower) = &group.lower {
            region.lower = Vector(array(&key("lower"), lower)?);
        }
        if let Some(upper) = &group.upper {
            region.upper = Vector(array(&key("upper"), upper)?);
        }
        for k in 0..D {
            // What is only a part of the box along an axis has edges there, whatever the faces of the box.
            if region.lower[k] != boundary.lower[k] || region.upper[k] != boundary.upper[k] || boundary.axes[k] == Axis::Open {
                region.axes[k] = Axis::Walls;
            }
            if region.lower[k] < boundary.lower[k] || region.upper[k] > boundary.upper[k] || region.lower[k] >= region.upper[k] {
                return Err(Invalid::new(
                    key("lower"),
                    format!("{:?} to {:?}", region.lower.0, region.upper.0),
                    format!("a part of the box, {:?} to {:?}", boundary.lower.0, boundary.upper.0),
                ));
            }
        }
        let mut random = Random::new(seed, index as u64);
        let mut fresh = particles.clone();
        let kind = gas::Species { count: group.count, radius: group.radius, mass: group.mass, index: species(names, &group.name) };
        gas::add(&mut fresh, &region, kind, &mut random)
            .map_err(|error| Invalid::new(key("count"), group.count, error.expected))?;
        let spread = (group.temperature / group.mass).sqrt();
        for i in particles.len()..fresh.len() {
            fresh.velocity[i] = Vector::from_fn(|_| spread * random.normal());
        }
        *particles = fresh;
    }
    if system.particles.is_empty() {
        to_temperature(system, boundary, particles);
    }
    Ok(())
}

/// Brings what was drawn to exactly the temperature asked for, the mean over the species, and to rest as a whole where
/// total momentum is conserved. Particles placed by hand keep the velocities they were given, and then so do all.
fn to_temperature<const D: usize>(system: &System, boundary: &Boundary<D>, particles: &mut Particles<D>) {
    let count = particles.len();
    let closed = boundary.conserves_momentum() && count > 1;
    if closed {
        stop_drift(particles);
    }
    let wanted = system.species.iter().map(|group| group.count as f64 * group.temperature).sum::<f64>() / count as f64;
    let scale = (wanted / particles.temperature(D * if closed { count - 1 } else { count })).sqrt();
    if scale.is_finite() {
        particles.velocity.iter_mut().for_each(|v| *v = *v * scale);
    }
}

fn event_driven<const D: usize>(system: &System, boundary: Boundary<D>, particles: Particles<D>) -> Result<AnyEngine<D>, Invalid> {
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
    let mut rules = Rules { field: field(system)?, ..Rules::default() };
    if let Some(collisions) = &system.collisions {
        (rules.restitution, rules.elastic_below) = (collisions.restitution.into(), collisions.elastic_below);
    }
    rules.validate().map_err(|error| Invalid { key: format!("collisions.{}", error.key), ..error })?;
    Ok(AnyEngine::Event(Box::new(EventDriven::new(boundary, particles, rules)?)))
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
    if !system.partitions.is_empty() {
        return Err(Invalid::new("partition[0]", "given", "nothing: the time-driven engine has none; choose engine = \"event\""));
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
    let index = |text: &str| text.parse::<usize>().ok();
    let words: Vec<&str> = error.key.split(' ').collect();
    let key = match words[..] {
        [property, "of", "particle", i] => index(i).map(|i| source(system, i, property)),
        ["particles", i, "and", j] => {
            // Only those placed by hand can overlap: what is generated keeps clear.
            let key = index(i).zip(index(j)).map(|(i, j)| source(system, i.max(j), "position"));
            let value = format!("{} {}", error.key, error.value);
            return Invalid { key: key.unwrap_or(error.key), value, expected: error.expected };
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
