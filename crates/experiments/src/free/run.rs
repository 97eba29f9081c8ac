//! A free system under way: advanced, sampled and drawn.

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Axis, Face, Failure, Invalid, Particles, Vector};
use corpuscle_event::Pair;
use corpuscle_observe::{Chart, Check, Estimate, Histogram, RadialDistribution, Schedule, VirialPressure, WallPressure};
use corpuscle_scene::Scene;

use super::build::{AnyEngine, Bath, Built, EnergyLaw, build, degrees_of_freedom};
use super::given::Given;
use super::picture::Trail;
use super::sample::Sample;
use super::spec::{Observable, System};
use super::verdict::Conserved;
use crate::probe::{self, Region};
use crate::tally::Tally;
use crate::{Action, Frame, Honesty, Probed, Simulation, Table, hand, peek};

/// Samples taken when the file does not say how often.
const SAMPLES: f64 = 500.0;
/// Samples a file may ask for.
const MOST_SAMPLES: f64 = 1e6;
/// Samples that go into the radial distribution, which counts pairs.
const MOST_STRUCTURES: u64 = 500;
/// Share of the run after which it counts as in equilibrium.
const SETTLED: f64 = 0.2;

/// A running free system.
pub(super) struct Free<const D: usize> {
    pub(super) title: String,
    pub(super) engine: AnyEngine<D>,
    pub(super) names: Vec<String>,
    pub(super) observe: Vec<Observable>,
    /// Ends of springs and other bonds.
    pub(super) bonds: Vec<[usize; 2]>,
    pub(super) trails: Vec<(usize, Trail<D>)>,
    pub(super) duration: f64,
    /// The time asked for last; a fixed step may end a little before.
    reached: f64,
    schedule: Schedule,
    pub(super) structure_every: u64,
    pub(super) samples: Vec<Sample>,
    /// Index of the first sample in equilibrium, once there is one.
    pub(super) settled_from: Option<usize>,
    pub(super) momentum: Conserved<3>,
    /// Angular momentum about the origin.
    pub(super) angular_momentum: Conserved<3>,
    /// Energy without what walls gave, against the magnitude of its terms, which rounding is relative to.
    pub(super) energy: Conserved<1>,
    /// Energy against what moves: the largest kinetic energy.
    pub(super) motion: Conserved<1>,
    /// Highest energy so far less the lowest before it, both without what walls gave: inelastic collisions never raise it.
    pub(super) rise: f64,
    pub(super) lowest: f64,
    /// What warm and moving walls gave.
    pub(super) given: Given,
    pub(super) wall_pressure: WallPressure<D>,
    pub(super) virial_pressure: VirialPressure<D>,
    pub(super) speeds: Option<Histogram>,
    pub(super) structure: Option<RadialDistribution<D>>,
    pub(super) start: Vec<Vector<D>>,
    pub(super) displacement: Vec<(f64, f64)>,
    pub(super) start_particles: Particles<D>,
    pub(super) degrees_of_freedom: usize,
    /// Whether collisions keep energy.
    pub(super) elastic: bool,
    /// What forces do to the energy.
    pub(super) energy_law: EnergyLaw,
    /// The heat bath of soft particles.
    pub(super) bath: Option<Bath>,
    /// Whether nothing takes up momentum: no wall, no field, nothing held.
    pub(super) closed: bool,
    /// Whether a field makes some places denser than others.
    layered: bool,
    /// How many coordinates are held.
    held: usize,
    /// When the system counts as in equilibrium: some time after the start, and after a hand has touched it.
    pub(super) settles_at: f64,
    /// Collisions of each particle since the start.
    pub(super) tally: Tally,
}

impl<const D: usize> Free<D> {
    pub(super) fn new(system: &System, seed: u64) -> Result<Self, Invalid> {
        let Built { engine, names, trails, held, degrees_of_freedom, closed, energy, bath, bonds } = build::<D>(system, seed)?;
        observable(system, bath)?;
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
            bonds,
            trails: trails.into_iter().map(|i| (i, Trail::new())).collect(),
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
            given: Given::default(),
            speeds: None,
            structure,
            displacement: vec![],
            start_particles: particles,
            degrees_of_freedom,
            elastic,
            energy_law: energy,
            bath,
            layered: layered(system),
            closed,
            held,
            settles_at: SETTLED * system.duration,
            tally: Tally::of(count),
        };
        free.sample();
        free.schedule = free.schedule.after_start();
        Ok(free)
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
            self.tally.begin_again(particles.len());
            self.degrees_of_freedom = degrees_of_freedom(&particles, self.held, self.closed);
        }
        self.closed &= self.engine.boundary().conserves_momentum();
        self.start_particles = particles;
    }

    /// Tells the observers of the pressure how late it is, so that no block stays open for want of a collision.
    pub(super) fn watch(&mut self, time: f64) {
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
        // Without walls that give energy, and before averages begin, fewer watch: that is faster.
        let isolated = self.isolated();
        let (wall, virial, given) = (&mut self.wall_pressure, &mut self.virial_pressure, &mut self.given);
        let tally = &mut self.tally;
        match (self.settled_from, isolated) {
            (None, true) => return self.engine.advance(to, tally),
            (None, false) => return self.engine.advance(to, &mut (given, tally)),
            (Some(_), true) => self.engine.advance(to, &mut (wall, virial, tally))?,
            (Some(_), false) => self.engine.advance(to, &mut ((wall, virial), (given, tally)))?,
        }
        self.watch(self.engine.time());
        Ok(())
    }

    /// Whether nothing takes up angular momentum: no faces at all.
    pub(super) fn keeps_angular_momentum(&self) -> bool {
        self.closed && self.energy_law == EnergyLaw::Stays && self.engine.boundary().axes.iter().all(|&axis| axis == Axis::Open)
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
        !self.layered && empty && still
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

/// Whether a field from outside makes some places denser than others.
fn layered(system: &System) -> bool {
    let central = system.forces.as_ref().is_some_and(|forces| forces.central.is_some());
    central || system.field.iter().any(|&g| g != 0.0)
}

/// Velocities that are no velocities of heat have no temperature.
fn observable(system: &System, bath: Option<Bath>) -> Result<(), Invalid> {
    if bath.is_none_or(|bath| bath.thermal) {
        return Ok(());
    }
    let asked = |wanted: Observable| system.observe.contains(&wanted);
    let refused = |word: &str| Err(Invalid::new("observe", word, "other words: Brownian dynamics has no velocities of heat"));
    if asked(Observable::Temperature) {
        return refused("temperature");
    }
    if asked(Observable::Speeds) { refused("speeds") } else { Ok(()) }
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
        trails, reached, schedule, samples, settled_from, momentum, angular_momentum, energy, motion, rise, lowest, given, wall_pressure, virial_pressure,
        speeds, structure, displacement
    ],
    parts: [engine],
    set_up: [
        title, names, observe, bonds, duration, structure_every, start, start_particles, degrees_of_freedom, elastic, energy_law,
        bath, closed, layered, held, settles_at, tally
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
        self.show(scene);
    }

    fn frame(&self) -> Option<Frame> {
        Some(Frame::new(self.engine.time(), self.engine.boundary(), &self.engine.snapshot(), &self.names))
    }

    fn charts(&self) -> Vec<Chart> {
        self.all_charts()
    }

    fn checks(&self) -> Vec<Check> {
        self.all_checks()
    }

    fn honesty(&self) -> Honesty {
        self.quality()
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

    fn probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        if let AnyEngine::Event(engine) = &self.engine {
            self.tally.lay(corners.and_then(|corners| Region::lay(engine, corners)));
        }
    }

    fn probed(&self) -> Option<Probed> {
        match &self.engine {
            AnyEngine::Event(engine) => probe::read(engine, &self.tally),
            AnyEngine::Time(_) => None,
        }
    }

    fn refusal(&self, action: Action) -> Option<&'static str> {
        match &self.engine {
            AnyEngine::Event(engine) => hand::wanting_of_hard(engine, action),
            AnyEngine::Time(_) if matches!(action, Action::Remove { .. }) && !self.bonds.is_empty() => {
                Some("particles without bonds, which would hang on nothing")
            }
            AnyEngine::Time(_) => hand::wanting_of_soft(action),
        }
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        action.allowed(self)?;
        match &mut self.engine {
            AnyEngine::Event(engine) => hand::on_hard(engine, action)?,
            AnyEngine::Time(engine) => hand::on_soft(engine, action)?,
        }
        self.begin_again(action);
        Ok(())
    }
}
