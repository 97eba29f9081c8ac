//! A free system under way: advanced, sampled and drawn.

use std::collections::VecDeque;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis, Engine, Face, Failure, Invalid, Particles, Vector};
use corpuscle_event::Pair;
use corpuscle_observe::{Chart, Check, Estimate, Histogram, RadialDistribution, Schedule, VirialPressure, WallPressure};
use corpuscle_scene::{Colour, Colouring, Line, Scene, TrailPoint};

use super::build::{AnyEngine, Built, build};
use super::spec::{Observable, System};
use super::verdict::Conserved;
use crate::horizon::precision_horizon;
use crate::tally::Tally;
use crate::{Action, Honesty, Simulation, Table, drawing, hand, peek};

/// Samples taken when the file does not say how often.
const SAMPLES: f64 = 500.0;
/// Samples a file may ask for.
const MOST_SAMPLES: f64 = 1e6;
/// Samples that go into the radial distribution, which counts pairs.
const MOST_STRUCTURES: u64 = 500;
/// Points of a trail.
const TRAIL: usize = 2000;
/// Share of the run after which it counts as in equilibrium.
const SETTLED: f64 = 0.2;

/// What is noted at each sampling time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Sample {
    pub(super) time: f64,
    pub(super) kinetic: f64,
    pub(super) potential: f64,
    pub(super) temperature: f64,
    /// Instantaneous virial pressure of a time-driven system.
    pub(super) pressure: f64,
    /// Coordinate of the piston, if there is one.
    pub(super) piston: Option<f64>,
}

/// A step of a path that is drawn.
#[derive(serde::Serialize, serde::Deserialize)]
struct Step<const D: usize> {
    point: TrailPoint,
    unwrapped: Vector<D>,
    /// Through a periodic face since the step before.
    jumps: bool,
}

/// A running free system.
pub(super) struct Free<const D: usize> {
    title: String,
    pub(super) engine: AnyEngine<D>,
    names: Vec<String>,
    pub(super) observe: Vec<Observable>,
    springs: Vec<[usize; 2]>,
    trails: Vec<(usize, VecDeque<Step<D>>)>,
    pub(super) duration: f64,
    /// The time asked for last; a fixed step may end a little before.
    reached: f64,
    schedule: Schedule,
    structure_every: u64,
    pub(super) samples: Vec<Sample>,
    /// Index of the first sample in equilibrium, once there is one.
    pub(super) settled_from: Option<usize>,
    pub(super) momentum: Conserved<3>,
    /// Angular momentum about the origin.
    angular_momentum: Conserved<3>,
    /// Energy against the magnitude of its terms, which rounding is relative to.
    pub(super) energy: Conserved<1>,
    /// Energy against what moves: the largest kinetic energy.
    pub(super) motion: Conserved<1>,
    /// Highest energy so far less the lowest before it: inelastic collisions never raise it.
    pub(super) rise: f64,
    lowest: f64,
    pub(super) wall_pressure: WallPressure<D>,
    pub(super) virial_pressure: VirialPressure<D>,
    pub(super) speeds: Option<Histogram>,
    pub(super) structure: Option<RadialDistribution<D>>,
    start: Vec<Vector<D>>,
    pub(super) displacement: Vec<(f64, f64)>,
    pub(super) start_particles: Particles<D>,
    degrees_of_freedom: usize,
    /// Whether collisions keep energy.
    pub(super) elastic: bool,
    /// Whether forces keep energy.
    pub(super) conservative: bool,
    /// Whether nothing takes up momentum: no wall, no field, nothing held.
    pub(super) closed: bool,
    /// Uniform acceleration; empty for none.
    field: Vec<f64>,
    /// How many coordinates are held.
    held: usize,
    /// When the system counts as in equilibrium: some time after the start, and after a hand has touched it.
    settles_at: f64,
    /// Collisions of each particle since the start.
    tally: Tally,
}

impl<const D: usize> Free<D> {
    pub(super) fn new(system: &System, seed: u64) -> Result<Self, Invalid> {
        let Built { engine, names, trails, held } = build::<D>(system, seed)?;
        let interval = sample_interval(system, &engine)?;
        let particles = engine.snapshot();
        let count = particles.len();
        let radius = particles.radius.iter().copied().fold(0.0, f64::max);
        let boundary = engine.boundary();
        let structure = if system.observe.contains(&Observable::RadialDistribution) {
            let reach = 0.5 * boundary.extent().0.into_iter().fold(f64::INFINITY, f64::min);
            let wanted = if radius > 0.0 { 10.0 * radius } else { reach };
            let refused = |error: Invalid| Invalid { key: "observe".into(), value: "radial-distribution".into(), ..error };
            Some(RadialDistribution::new(boundary, wanted.min(reach), 100).map_err(refused)?)
        } else {
            None
        };
        let field = system.field.iter().any(|&g| g != 0.0);
        let closed = boundary.conserves_momentum() && !field && held == 0;
        let massive = particles.mass.iter().filter(|&&mass| mass > 0.0).count();
        let shared = if closed && massive > 1 { D } else { 0 };
        let degrees_of_freedom = (D * massive).saturating_sub(held + shared).max(1);
        let elastic = match &engine {
            AnyEngine::Event(engine) => engine.rules().restitution.is_elastic(),
            AnyEngine::Time(_) => true,
        };
        let expected_samples = system.duration * (1.0 - SETTLED) / interval;
        let mut free = Self {
            title: system.title.clone(),
            // Blocks are set up once the system has settled.
            wall_pressure: WallPressure::new(boundary, radius, system.duration),
            virial_pressure: VirialPressure::new(count, boundary.accessible_volume(radius), 0.0, system.duration),
            start: (0..count).map(|i| engine.unwrapped(i)).collect(),
            engine,
            names,
            observe: system.observe.clone(),
            springs: system.springs.iter().map(|bond| [bond.first, bond.second]).collect(),
            trails: trails.into_iter().map(|i| (i, VecDeque::new())).collect(),
            duration: system.duration,
            reached: 0.0,
            schedule: Schedule::new(interval),
            structure_every: (expected_samples as u64).div_ceil(MOST_STRUCTURES).max(1),
            samples: vec![],
            settled_from: None,
            momentum: Conserved::new(),
            angular_momentum: Conserved::new(),
            energy: Conserved::new(),
            motion: Conserved::new(),
            rise: 0.0,
            lowest: f64::INFINITY,
            speeds: None,
            structure,
            displacement: vec![],
            start_particles: particles,
            degrees_of_freedom,
            elastic,
            conservative: system.springs.iter().all(|bond| bond.damping == 0.0),
            closed,
            field: system.field.clone(),
            held,
            settles_at: SETTLED * system.duration,
            tally: Tally::of(count),
        };
        free.sample();
        free.schedule = free.schedule.after_start();
        Ok(free)
    }

    fn sample(&mut self) {
        let time = self.engine.time();
        let particles = self.engine.snapshot();
        let (kinetic, potential) = self.engine.energies();
        let temperature = self.temperature(&particles, kinetic);
        let volume = self.engine.boundary().accessible_volume(self.largest_radius());
        let pressure = match &self.engine {
            AnyEngine::Event(_) => f64::NAN,
            AnyEngine::Time(engine) => (particles.len() as f64 * temperature + engine.virial() / D as f64) / volume,
        };
        let piston = self.engine.piston().map(|piston| piston.position);
        self.samples.push(Sample { time, kinetic, potential, temperature, pressure, piston });
        let moving = particles.velocity.iter().zip(&particles.mass).map(|(v, m)| m * v.norm()).sum();
        self.momentum.see(particles.momentum().to_three(), moving);
        let arms =
            particles.position.iter().zip(&particles.velocity).zip(&particles.mass).map(|((r, v), m)| m * r.norm() * v.norm());
        self.angular_momentum.see(particles.angular_momentum(), arms.sum());
        let energy = kinetic + potential;
        self.energy.see([energy], kinetic + potential.abs());
        self.motion.see([energy], kinetic);
        self.lowest = self.lowest.min(energy);
        self.rise = self.rise.max(energy - self.lowest);
        if self.settled_from.is_none() && time >= self.settles_at {
            self.settle(time, temperature, &particles);
        }
        if self.settled_from.is_some() {
            if let Some(speeds) = &mut self.speeds {
                particles.velocity.iter().for_each(|v| speeds.add(v.norm()));
            }
            if let Some(structure) = &mut self.structure
                && (self.samples.len() as u64).is_multiple_of(self.structure_every)
            {
                structure.add(&particles);
            }
        }
        for (i, path) in &mut self.trails {
            let (place, unwrapped) = (particles.position[*i], self.engine.unwrapped(*i));
            let jumps = path.back().is_some_and(|last| {
                // Through a periodic face: the step between the wrapped places is not the real one.
                let wrapped = place.to_three().into_iter().zip(last.point.position).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
                wrapped.sqrt() > (unwrapped - last.unwrapped).norm() * (1.0 + 1e-6)
            });
            if path.len() == TRAIL {
                path.pop_front();
            }
            path.push_back(Step { point: TrailPoint { position: place.to_three(), time }, unwrapped, jumps });
        }
        if self.observe.contains(&Observable::MeanSquaredDisplacement) {
            let moved: f64 = (0..particles.len()).map(|i| (self.engine.unwrapped(i) - self.start[i]).norm_squared()).sum();
            self.displacement.push((time, moved / particles.len() as f64));
        }
    }

    /// From now on the system counts as in equilibrium: averages begin.
    fn settle(&mut self, time: f64, temperature: f64, particles: &Particles<D>) {
        self.settled_from = Some(self.samples.len() - 1);
        let block = (self.duration - time).max(0.0) / 256.0;
        let block = if block > 0.0 { block } else { self.duration };
        let (boundary, radius) = (self.engine.boundary(), self.largest_radius());
        self.wall_pressure = WallPressure::new(boundary, radius, block);
        self.virial_pressure = VirialPressure::new(particles.len(), boundary.accessible_volume(radius), temperature, block);
        self.watch(time);
        if self.observe.contains(&Observable::Speeds) && temperature > 0.0 {
            let lightest = particles.mass.iter().copied().filter(|&mass| mass > 0.0).fold(f64::INFINITY, f64::min);
            self.speeds = Some(Histogram::new(0.0, 5.0 * (temperature / lightest).sqrt(), 50));
        }
    }

    /// A hand has touched the system: what is conserved counts from here, and unless all was turned round, which changes no
    /// average, equilibrium is waited for anew.
    fn begin_again(&mut self, action: Action) {
        (self.momentum, self.angular_momentum) = (Conserved::new(), Conserved::new());
        if action == Action::Reverse {
            return;
        }
        (self.energy, self.motion) = (Conserved::new(), Conserved::new());
        (self.rise, self.lowest) = (0.0, f64::INFINITY);
        (self.settled_from, self.settles_at) = (None, self.reached + SETTLED * self.duration);
        self.displacement.clear();
        let particles = self.engine.snapshot();
        self.start = (0..particles.len()).map(|i| self.engine.unwrapped(i)).collect();
        if let Action::Remove { body } = action {
            // Those behind it have moved up, and their trails with them.
            self.trails.retain(|(i, _)| *i != body);
            self.trails.iter_mut().filter(|(i, _)| *i > body).for_each(|(i, _)| *i -= 1);
        }
        if particles.len() != self.start_particles.len() {
            self.tally = Tally::of(particles.len());
            let massive = particles.mass.iter().filter(|&&mass| mass > 0.0).count();
            let shared = if self.closed && massive > 1 { D } else { 0 };
            self.degrees_of_freedom = (D * massive).saturating_sub(self.held + shared).max(1);
        }
        self.closed &= self.engine.boundary().conserves_momentum();
        self.start_particles = particles;
    }

    /// Tells the observers of the pressure how late it is, so that no block stays open for want of a collision.
    fn watch(&mut self, time: f64) {
        use corpuscle_core::Observer;
        let nobody = Particles::<D>::new();
        let _ = self.wall_pressure.sample(time, &nobody);
        let _ = self.virial_pressure.sample(time, &nobody);
    }

    fn advance_sampling(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            self.advance_engine(time)?;
            self.sample();
        }
        self.advance_engine(to)
    }

    fn advance_engine(&mut self, to: f64) -> Result<(), Failure> {
        if self.settled_from.is_none() {
            return self.engine.advance(to, &mut self.tally);
        }
        self.engine.advance(to, &mut (&mut self.wall_pressure, &mut self.virial_pressure, &mut self.tally))?;
        self.watch(self.engine.time());
        Ok(())
    }

    /// Kinetic temperature of the motion relative to the centre of mass where that moves freely, of all motion elsewhere.
    fn temperature(&self, particles: &Particles<D>, kinetic: f64) -> f64 {
        let mass: f64 = particles.mass.iter().sum();
        let drift =
            if self.closed && particles.len() > 1 && mass > 0.0 { 0.5 * particles.momentum().norm_squared() / mass } else { 0.0 };
        2.0 * (kinetic - drift).max(0.0) / self.degrees_of_freedom as f64
    }

    /// Whether nothing takes up angular momentum: no faces at all.
    fn keeps_angular_momentum(&self) -> bool {
        self.closed && self.conservative && self.engine.boundary().axes.iter().all(|&axis| axis == Axis::Open)
    }

    pub(super) fn largest_radius(&self) -> f64 {
        self.start_particles.radius.iter().copied().fold(0.0, f64::max)
    }

    /// Samples after the start has been forgotten.
    pub(super) fn settled(&self) -> &[Sample] {
        self.settled_from.map_or(&[], |first| &self.samples[first..])
    }

    /// Whether the run has reached its end.
    pub(super) fn done(&self) -> bool {
        self.reached >= self.duration
    }

    /// Whether a pressure is one number: no field that layers the system, no wall that opens or moves, nothing in the box
    /// but particles.
    pub(super) fn has_pressure(&self) -> bool {
        let boundary = self.engine.boundary();
        let empty = boundary.partitions.is_empty() && boundary.obstacles.is_empty() && boundary.piston.is_none();
        let still = boundary.is_closed() && boundary.faces.iter().flatten().all(|face| face.motion.is_none());
        self.field.iter().all(|&g| g == 0.0) && empty && still
    }

    /// Whether no wall gives or takes energy, by its temperature or its motion.
    pub(super) fn isolated(&self) -> bool {
        let quiet = |face: &Face| face.temperature.is_none() && face.motion.is_none();
        self.engine.boundary().faces.iter().flatten().all(quiet)
    }

    /// Whether particles are hard and keep their temperature: what the virial of collisions is measured under.
    pub(super) fn keeps_temperature(&self) -> bool {
        matches!(&self.engine, AnyEngine::Event(engine) if engine.rules().pair == Pair::Hard) && self.elastic && self.isolated()
    }
}

fn sample_interval<const D: usize>(system: &System, engine: &AnyEngine<D>) -> Result<f64, Invalid> {
    let step = match engine {
        AnyEngine::Event(_) => 0.0,
        AnyEngine::Time(engine) => engine.integrator().dt().unwrap_or(0.0),
    };
    let Some(interval) = system.sample_interval else { return Ok((system.duration / SAMPLES).max(step)) };
    let least = step.max(system.duration / MOST_SAMPLES);
    if interval < least {
        let expected = format!("at least {least}: one step of time, and a million samples in all");
        return Err(Invalid::new("sample_interval", interval, expected));
    }
    Ok(interval)
}

resume!(Free<const D> {
    values: [
        trails, reached, schedule, samples, settled_from, momentum, angular_momentum, energy, motion, rise, lowest, wall_pressure, virial_pressure,
        speeds, structure, displacement
    ],
    parts: [engine],
    set_up: [
        title, names, observe, springs, duration, structure_every, start, start_particles, degrees_of_freedom, elastic, conservative,
        closed, field, held, settles_at, tally
    ],
});

impl<const D: usize> Simulation for Free<D> {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.reached
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let outcome = self.advance_sampling(to);
        self.reached = if outcome.is_ok() { self.reached.max(to) } else { self.engine.time() };
        outcome
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let speeds = self.names.len() < 2 && self.start.len() > 20;
        match &self.engine {
            AnyEngine::Event(engine) => {
                let species = &self.start_particles.species;
                drawing::add_event_driven(scene, engine, &self.tally, 0.0, |i| f64::from(species[i]));
            }
            AnyEngine::Time(engine) => {
                let particles = engine.particles();
                scene.time = engine.time();
                scene.field = [0.0; 3];
                let size = engine.boundary().extent().norm();
                // A point mass has no size; it is drawn as a dot, half of which is the picture's two-hundredth.
                let radius = |i: usize| if particles.radius[i] > 0.0 { particles.radius[i] } else { 0.005 * size };
                drawing::add_particles(scene, engine.time(), particles, radius);
                drawing::add_boundary(scene, engine.boundary(), engine.time());
                for &[first, second] in &self.springs {
                    let from = particles.position[first];
                    let to = from + engine.boundary().displacement(from, particles.position[second]);
                    scene.lines.push(Line { from: from.to_three(), to: to.to_three(), width: 1.5, colour: Colour::Faint });
                }
            }
        }
        scene.colouring = if speeds {
            // Of late: a gas that cools keeps its contrast, and colours do not flicker.
            let late = &self.samples[self.samples.len().saturating_sub(25)..];
            let temperature = late.iter().map(|sample| sample.temperature).sum::<f64>() / late.len() as f64;
            Colouring::Speed {
                most: 3.0 * (temperature / self.start_particles.mass[0].max(f64::MIN_POSITIVE)).sqrt(),
                unit: String::new(),
            }
        } else {
            Colouring::Species(self.names.clone())
        };
        for (i, path) in &self.trails {
            let trail = scene.trail(*i as u32, TRAIL, Colour::Accent(self.start_particles.species[*i] as u8));
            let drawn = trail.points().back().map_or(f64::NEG_INFINITY, |last| last.time);
            for step in path.iter().filter(|step| step.point.time > drawn) {
                if step.jumps { trail.jump(step.point) } else { trail.push(step.point) }
            }
        }
        scene.title.clone_from(&self.title);
        let (kinetic, potential) = self.engine.energies();
        scene.caption = format!("{} particles   E = {:.6}", self.start.len(), kinetic + potential);
    }

    fn charts(&self) -> Vec<Chart> {
        self.all_charts()
    }

    fn checks(&self) -> Vec<Check> {
        self.all_checks()
    }

    fn honesty(&self) -> Honesty {
        let (engine, work, work_unit, largest_overlap) = match &self.engine {
            AnyEngine::Event(engine) => {
                let counts = engine.counts();
                let diameter = 2.0 * self.start_particles.radius.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
                let overlap = engine.boundary().largest_overlap(&engine.snapshot()) / diameter;
                ("event-driven".into(), counts.collisions + counts.wall_collisions, "collisions", Some(overlap))
            }
            AnyEngine::Time(engine) => (format!("time-driven, {}", engine.integrator().name()), engine.steps(), "steps", None),
        };
        Honesty {
            engine,
            work,
            work_unit,
            largest_overlap,
            energy_drift: match &self.engine {
                AnyEngine::Event(_) => (self.elastic && self.isolated()).then(|| self.energy.relative()),
                AnyEngine::Time(_) => self.conservative.then(|| self.motion.relative()),
            },
            momentum_drift: self.closed.then(|| self.momentum.relative()),
            angular_momentum_drift: self.keeps_angular_momentum().then(|| self.angular_momentum.relative()),
            rejected_events: match &self.engine {
                AnyEngine::Event(engine) => Some(engine.counts().stale),
                AnyEngine::Time(_) => None,
            },
            precision_horizon: match &self.engine {
                AnyEngine::Event(engine) => precision_horizon(engine),
                AnyEngine::Time(_) => None,
            },
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        let row = |(_, estimate): &(&str, Estimate)| vec![estimate.mean, estimate.standard_error];
        let rows: Vec<_> = self.pressures().iter().map(row).collect();
        let columns = vec!["pressure".into(), "standard_error".into()];
        if rows.is_empty() { vec![] } else { vec![Table { name: "pressure".into(), columns, rows }] }
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.5 * self.duration]
    }

    fn next_event(&self) -> Option<f64> {
        match &self.engine {
            AnyEngine::Event(engine) => peek::next_contact(engine, 1.5 * self.end()),
            AnyEngine::Time(_) => None,
        }
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        match &mut self.engine {
            AnyEngine::Event(engine) => hand::on_hard(engine, action)?,
            AnyEngine::Time(_) if matches!(action, Action::Remove { .. }) && !self.springs.is_empty() => {
                return action.refused("particles without springs, which would hang on nothing");
            }
            AnyEngine::Time(engine) => hand::on_soft(engine, action)?,
        }
        self.begin_again(action);
        Ok(())
    }
}
