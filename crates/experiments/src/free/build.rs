//! From the description of a free system to an engine, every number checked on the way.

mod bonds;
mod boundary;
mod forces;
mod imported;
mod placement;
mod rules;
mod soft;
mod stepper;

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};
use corpuscle_core::{Boundary, Engine, Failure, Invalid, Observer, Particles, Piston, Vector};
use corpuscle_event::EventDriven;
use corpuscle_time::TimeDriven;

use super::spec::{AxisName, EngineKind, System};

/// Times the box is crossed at most in a run: years of computing.
const MOST_CROSSINGS: f64 = 1e15;

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

    /// Whoever looks on: the engines' loops are compiled anew for every type of observer they meet.
    pub(super) fn advance(&mut self, to: f64, mut observer: &mut dyn Observer<D>) -> Result<(), Failure> {
        match self {
            Self::Event(engine) => engine.advance(to, &mut observer),
            Self::Time(engine) => engine.advance(to, &mut observer),
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

    /// What a heat bath holds, of those that count it.
    pub(super) fn bath_energy(&self) -> f64 {
        match self {
            Self::Event(_) => 0.0,
            Self::Time(engine) => engine.bath_energy(),
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
    /// Velocities that move freely.
    pub(super) degrees_of_freedom: usize,
    /// Whether nothing takes up momentum: no wall, no field, nothing held.
    pub(super) closed: bool,
    /// What forces do to the energy; collisions have rules of their own.
    pub(super) energy: EnergyLaw,
    /// The heat bath.
    pub(super) bath: Option<Bath>,
    /// Ends of springs and other bonds.
    pub(super) bonds: Vec<[usize; 2]>,
}

/// What forces do to the energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EnergyLaw {
    /// It stays, a bath's own energy included.
    Stays,
    /// Friction takes some.
    Falls,
    /// A bath or a drive gives and takes some, which is not counted.
    Free,
}

/// The heat bath of a soft system.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bath {
    pub(super) temperature: f64,
    /// Whether velocities are thermal: those of Brownian dynamics are a mean drift.
    pub(super) thermal: bool,
    /// Whether nothing else gives or takes heat.
    pub(super) alone: bool,
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
    finishable(system, &boundary, &particles)?;
    let held = pins.iter().flat_map(|pin| pin.axes).filter(|&held| held).count() + system.drives.len();
    let still = !system.field.iter().any(|&g| g != 0.0) && held == 0;
    let closed = boundary.conserves_momentum() && still && !soft::feels_the_outside(system);
    let degrees_of_freedom = degrees_of_freedom(&particles, held, closed);
    let engine = match system.engine {
        EngineKind::Event => event_driven(system, boundary, particles, seed),
        EngineKind::Time => {
            let kinds: Vec<&str> = names.iter().map(String::as_str).collect();
            let context = soft::Context { seed, names: &kinds, degrees_of_freedom, closed };
            soft::time_driven(system, boundary, particles, pins, &context)
        }
    };
    Ok(Built {
        engine: engine.map_err(|error| located(system, error))?,
        names,
        trails,
        held,
        degrees_of_freedom,
        closed,
        energy: soft::energy_law(system),
        bath: soft::bath(system),
        bonds: bonds::all_ends(system),
    })
}

/// Velocities that move freely.
pub(super) fn degrees_of_freedom<const D: usize>(particles: &Particles<D>, held: usize, closed: bool) -> usize {
    let massive = particles.mass.iter().filter(|&&mass| mass > 0.0).count();
    let shared = if closed && massive > 1 { D } else { 0 };
    (D * massive).saturating_sub(held + shared).max(1)
}

/// Refuses what nobody could wait for, and what a clock of 53 bits could not tell apart: a particle that crosses the box over and over.
fn finishable<const D: usize>(system: &System, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
    let fastest = particles.velocity.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let longest = boundary.extent().0.into_iter().fold(0.0, f64::max);
    let most = MOST_CROSSINGS * longest / fastest;
    if system.duration <= most {
        return Ok(());
    }
    let expected = format!("at most {most:e}: by then the fastest particle has crossed the box {MOST_CROSSINGS:e} times");
    Err(Invalid::new("duration", system.duration, expected))
}

fn event_driven<const D: usize>(
    system: &System,
    boundary: Boundary<D>,
    particles: Particles<D>,
    seed: u64,
) -> Result<AnyEngine<D>, Invalid> {
    let refuse = |key: &str| Err(Invalid::new(key, "given", "nothing: the event-driven engine has none; choose engine = \"time\""));
    if let Some(key) = bonds::first_key(system) {
        return refuse(key);
    }
    if !system.drives.is_empty() {
        return refuse("drive[0]");
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

fn finite(key: &str, value: f64) -> Result<(), Invalid> {
    if value.is_finite() { Ok(()) } else { Err(Invalid::new(key, value, "a finite number")) }
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
        ["axis", _, "of", "the", "box"] => Some("box.faces".into()),
        ["uniform", "field", ..] => Some("field".into()),
        ["masses"] => Some("particle".into()),
        // What the engine says of the kind; what is missing or too much stands for itself.
        ["integrator"] if !["missing", "given"].contains(&error.value.as_str()) => Some("integrator.name".into()),
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
