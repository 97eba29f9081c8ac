//! A free system under way: sampled, drawn, and held against what conservation laws and equations of state say.

use corpuscle_core::particles::ball_volume;
use corpuscle_core::{Axis as Faces, Engine, Failure, Invalid, Particles, Vector};
use corpuscle_observe::chart::{Axis, Chart, Scale, Series, Style};
use corpuscle_observe::{
    Check, Conservation, Drift, Estimate, Histogram, RadialDistribution, Schedule, SpeedDistribution, VirialPressure, WallPressure,
    blocking, fit, theory,
};
use corpuscle_scene::{Colour, Colouring, Line, Scene, TrailPoint};

use super::build::{AnyEngine, Built, build};
use super::spec::{Observable, System};
use crate::{Action, Honesty, Simulation, Table, drawing};

/// Samples taken when the file does not say how often.
const SAMPLES: f64 = 500.0;
/// Samples a file may ask for.
const MOST_SAMPLES: f64 = 1e6;
/// Points of a trail.
const TRAIL: usize = 2000;
/// Points of a chart.
const CHART: usize = 1000;
/// Share of the run after which it counts as in equilibrium.
const SETTLED: f64 = 0.2;

/// What is noted at each sampling time.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time: f64,
    kinetic: f64,
    potential: f64,
    temperature: f64,
    /// Instantaneous virial pressure of a time-driven system.
    pressure: f64,
}

/// A running free system.
pub(super) struct Free<const D: usize> {
    title: String,
    engine: AnyEngine<D>,
    names: Vec<String>,
    observe: Vec<Observable>,
    springs: Vec<[usize; 2]>,
    trails: Vec<(usize, Vec<TrailPoint>)>,
    duration: f64,
    schedule: Schedule,
    samples: Vec<Sample>,
    conservation: Conservation,
    energy: Drift<1>,
    wall_pressure: WallPressure<D>,
    virial_pressure: VirialPressure<D>,
    speeds: Histogram,
    structure: Option<RadialDistribution<D>>,
    start: Vec<Vector<D>>,
    displacement: Vec<(f64, f64)>,
    start_particles: Particles<D>,
    elastic: bool,
    conservative: bool,
}

impl<const D: usize> Free<D> {
    pub(super) fn new(system: &System, seed: u64) -> Result<Self, Invalid> {
        let Built { engine, names, trails } = build::<D>(system, seed)?;
        let interval = system.sample_interval.unwrap_or(system.duration / SAMPLES);
        if system.duration / interval > MOST_SAMPLES {
            return Err(Invalid::new(
                "sample_interval",
                interval,
                format!("at least {}: a million samples", system.duration / MOST_SAMPLES),
            ));
        }
        let particles = engine.snapshot();
        let count = particles.len();
        let radius = particles.radius.iter().copied().fold(0.0, f64::max);
        let block = (system.duration / 256.0).max(interval);
        let temperature = particles.temperature(degrees_of_freedom(&engine, count));
        let boundary = engine.boundary();
        let volume = boundary.accessible_volume(radius);
        let structure = if system.observe.contains(&Observable::RadialDistribution) {
            let reach = 0.5 * boundary.extent().0.into_iter().fold(f64::INFINITY, f64::min);
            let wanted = if radius > 0.0 { 10.0 * radius } else { reach };
            let refused = |error: Invalid| Invalid { key: "observe".into(), value: "radial-distribution".into(), ..error };
            Some(RadialDistribution::new(boundary, wanted.min(reach), 100).map_err(refused)?)
        } else {
            None
        };
        let mass = particles.mass.iter().copied().filter(|&mass| mass > 0.0).fold(f64::INFINITY, f64::min);
        let fastest = 5.0 * (temperature / mass).sqrt().max(f64::MIN_POSITIVE);
        let mut free = Self {
            speeds: Histogram::new(0.0, fastest, 50),
            structure,
            title: system.title.clone(),
            wall_pressure: WallPressure::new(boundary, radius, block),
            virial_pressure: VirialPressure::new(count, volume, temperature, block),
            start: (0..count).map(|i| engine.unwrapped(i)).collect(),
            engine,
            names,
            observe: system.observe.clone(),
            springs: system.springs.iter().map(|bond| [bond.first, bond.second]).collect(),
            trails: trails.into_iter().map(|i| (i, vec![])).collect(),
            duration: system.duration,
            schedule: Schedule::new(interval),
            samples: vec![],
            conservation: Conservation::default(),
            energy: Drift::new(),
            displacement: vec![],
            start_particles: particles,
            elastic: system.collisions.as_ref().is_none_or(|collisions| collisions.restitution == 1.0),
            conservative: system.springs.iter().all(|bond| bond.damping == 0.0),
        };
        free.sample();
        free.schedule = free.schedule.after_start();
        Ok(free)
    }

    fn sample(&mut self) {
        let time = self.engine.time();
        let particles = self.engine.snapshot();
        let (kinetic, potential) = self.engine.energies();
        let temperature = particles.temperature(degrees_of_freedom(&self.engine, particles.len()));
        let volume = self.engine.boundary().volume();
        let pressure = match &self.engine {
            AnyEngine::Event(_) => f64::NAN,
            AnyEngine::Time(engine) => (2.0 * kinetic + engine.virial()) / (D as f64 * volume),
        };
        self.samples.push(Sample { time, kinetic, potential, temperature, pressure });
        self.conservation.see(&particles);
        let scale = kinetic.abs() + potential.abs();
        self.energy.see([kinetic + potential], scale);
        if time >= SETTLED * self.duration {
            if self.observe.contains(&Observable::Speeds) {
                particles.velocity.iter().for_each(|v| self.speeds.add(v.norm()));
            }
            if let Some(structure) = &mut self.structure {
                structure.add(&particles);
            }
        }
        for (i, points) in &mut self.trails {
            points.push(TrailPoint { position: particles.position[*i].to_three(), time });
        }
        if self.observe.contains(&Observable::MeanSquaredDisplacement) {
            let moved: f64 = (0..particles.len()).map(|i| (self.engine.unwrapped(i) - self.start[i]).norm_squared()).sum();
            self.displacement.push((time, moved / particles.len() as f64));
        }
    }

    /// Samples after the start has been forgotten.
    fn settled(&self) -> &[Sample] {
        let first = self.samples.partition_point(|sample| sample.time < SETTLED * self.duration);
        &self.samples[first..]
    }

    /// Whether all particles are hard spheres of one radius and one mass: then the equation of state applies.
    fn uniform_hard_spheres(&self) -> Option<f64> {
        let particles = &self.start_particles;
        let (radius, mass) = (particles.radius[0], particles.mass[0]);
        let alike = particles.radius.iter().all(|&r| r == radius) && particles.mass.iter().all(|&m| m == mass);
        let AnyEngine::Event(engine) = &self.engine else { return None };
        let bulk = engine.boundary().axes.iter().all(|&axis| axis == Faces::Periodic) && engine.boundary().partitions.is_empty();
        let free = engine.rules().field == Vector::ZERO && self.elastic;
        // A finite system in a periodic box misses a pair term of order 1/N: below a hundred it would show.
        (alike && bulk && free && radius > 0.0 && particles.len() >= 100).then_some(radius)
    }

    fn energy_chart(&self) -> Chart {
        let series = |name: &str, value: fn(&Sample) -> f64| {
            Series::new(name, Style::Line, thin(&self.samples).map(|sample| (sample.time, value(sample))))
        };
        let mut chart = Chart::new("energy", "Energy", Axis::linear("time t", ""), Axis::linear("energy E", ""))
            .with(series("kinetic", |sample| sample.kinetic));
        if self.samples.iter().any(|sample| sample.potential != 0.0) {
            chart = chart
                .with(series("potential", |sample| sample.potential))
                .with(series("total", |sample| sample.kinetic + sample.potential));
        }
        chart
    }

    fn temperature_chart(&self) -> Chart {
        Chart::new("temperature", "Temperature", Axis::linear("time t", ""), Axis::linear("temperature k_B T", "")).with(
            Series::new("kinetic temperature", Style::Line, thin(&self.samples).map(|sample| (sample.time, sample.temperature))),
        )
    }

    fn displacement_chart(&self) -> Option<Chart> {
        let points = self.displacement.iter().filter(|(time, moved)| *time > 0.0 && *moved > 0.0).copied();
        (self.displacement.len() > 1).then(|| {
            Chart::new(
                "mean-squared-displacement",
                "Mean squared displacement",
                Axis::logarithmic("time t", ""),
                Axis::logarithmic("⟨|r(t) − r(0)|²⟩", ""),
            )
            .with(Series::new("measured", Style::Line, points))
        })
    }

    fn speed_chart(&self) -> Option<Chart> {
        let particles = &self.start_particles;
        let mass = particles.mass[0];
        let alike = mass > 0.0 && particles.mass.iter().all(|&m| m == mass);
        if self.speeds.total() == 0 || !alike {
            return None;
        }
        let settled = self.settled();
        let temperature = settled.iter().map(|sample| sample.temperature).sum::<f64>() / settled.len() as f64;
        let maxwell = SpeedDistribution::maxwell(D, temperature, mass);
        let bars = self.speeds.densities().into_iter().map(|(speed, density)| (speed, density.mean));
        let last = self.speeds.edges().last().copied()?;
        Some(
            Chart::new(
                "speeds",
                "Distribution of speeds",
                Axis::linear("speed v", ""),
                Axis::linear("probability density f(v)", ""),
            )
            .with(Series::new("measured", Style::Bars, bars))
            .with(Series::theory("Maxwell", 0.0, last, 200, Scale::Linear, |speed| maxwell.density(speed))),
        )
    }

    fn structure_chart(&self) -> Option<Chart> {
        let structure = self.structure.as_ref().filter(|structure| structure.samples() > 0)?;
        let points = structure.points().into_iter().map(|(r, g)| (r, g.mean, g.standard_error));
        Some(
            Chart::new("radial-distribution", "Radial distribution", Axis::linear("distance r", ""), Axis::linear("g(r)", ""))
                .with(Series::with_errors("measured", Style::Line, points)),
        )
    }

    /// Pressure with its error, by each way that applies.
    fn pressures(&self) -> Vec<(&'static str, Estimate)> {
        let mut pressures = vec![];
        if self.wall_pressure.hits() > 0 {
            pressures.push(("pressure on the walls P", self.wall_pressure.estimate()));
        }
        match &self.engine {
            AnyEngine::Event(_) => pressures.push(("pressure from the virial P", self.virial_pressure.estimate())),
            AnyEngine::Time(_) => {
                let series: Vec<f64> = self.settled().iter().map(|sample| sample.pressure).collect();
                pressures.push(("pressure from the virial P", blocking(&series).estimate));
            }
        }
        pressures
    }

    /// Energy of a time-driven system may fluctuate with the step, but must not drift: the slope against zero, with the
    /// error from the scatter of the means over tenths of the run.
    fn energy_slope(&self) -> Option<Check> {
        const PARTS: usize = 10;
        if self.samples.len() < 10 * PARTS {
            return None;
        }
        let scale = self.samples.iter().map(|sample| sample.kinetic.abs() + sample.potential.abs()).sum::<f64>()
            / self.samples.len() as f64;
        let parts = self.samples.chunks_exact(self.samples.len() / PARTS);
        let means =
            parts.map(|part| part.iter().map(|sample| sample.kinetic + sample.potential).sum::<f64>() / part.len() as f64 / scale);
        let points: Vec<(f64, f64)> = means.enumerate().map(|(k, energy)| ((k as f64 + 0.5) / PARTS as f64, energy)).collect();
        let line = fit::line_by_scatter(&points)?;
        Some(line.slope.check(
            "drift of the energy over the run, relative",
            0.0,
            "a symplectic integrator keeps a shadow energy for ever",
        ))
    }
}

/// At most [`CHART`] of the samples, evenly.
fn thin(samples: &[Sample]) -> impl Iterator<Item = &Sample> {
    samples.iter().step_by(samples.len().div_ceil(CHART).max(1))
}

fn degrees_of_freedom<const D: usize>(engine: &AnyEngine<D>, count: usize) -> usize {
    if engine.boundary().conserves_momentum() && count > 1 { D * (count - 1) } else { D * count }
}

impl<const D: usize> Simulation for Free<D> {
    fn time(&self) -> f64 {
        self.engine.time()
    }

    fn end(&self) -> f64 {
        self.duration
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            self.engine.advance(time, &mut (&mut self.wall_pressure, &mut self.virial_pressure))?;
            self.sample();
        }
        self.engine.advance(to, &mut (&mut self.wall_pressure, &mut self.virial_pressure))
    }

    fn draw(&self, scene: &mut Scene) {
        scene.clear();
        let speeds = self.names.len() < 2 && self.start.len() > 20;
        match &self.engine {
            AnyEngine::Event(engine) => {
                let species = &self.start_particles.species;
                drawing::add_event_driven(scene, engine, 0.0, |i| f64::from(species[i]));
            }
            AnyEngine::Time(engine) => {
                let particles = engine.particles();
                scene.time = engine.time();
                scene.field = [0.0; 3];
                let size = engine.boundary().extent().norm();
                // A point mass has no size; it is drawn as a dot, half of which is the picture's two-hundredth.
                let radius = |i: usize| if particles.radius[i] > 0.0 { particles.radius[i] } else { 0.005 * size };
                drawing::add_particles(scene, engine.time(), particles, radius, |i| f64::from(particles.species[i]));
                drawing::add_boundary(scene, engine.boundary());
                for &[first, second] in &self.springs {
                    let from = particles.position[first];
                    let to = from + engine.boundary().displacement(from, particles.position[second]);
                    scene.lines.push(Line { from: from.to_three(), to: to.to_three(), width: 1.5, colour: Colour::Faint });
                }
            }
        }
        scene.colouring = if speeds {
            let temperature = self.samples.last().map_or(1.0, |sample| sample.temperature);
            Colouring::Speed {
                most: 3.0 * (temperature / self.start_particles.mass[0].max(f64::MIN_POSITIVE)).sqrt(),
                unit: String::new(),
            }
        } else {
            Colouring::Species(self.names.clone())
        };
        for (i, points) in &self.trails {
            let trail = scene.trail(*i as u32, TRAIL, Colour::Accent(self.start_particles.species[*i] as u8));
            let seen = trail.total() as usize;
            for &point in points.iter().skip(seen) {
                trail.push(point);
            }
        }
        scene.title.clone_from(&self.title);
        let (kinetic, potential) = self.engine.energies();
        scene.caption = format!("t = {:.2}   {} particles   E = {:.6}", self.engine.time(), self.start.len(), kinetic + potential);
    }

    fn charts(&self) -> Vec<Chart> {
        let mut charts = vec![self.energy_chart()];
        if self.observe.contains(&Observable::Temperature) {
            charts.push(self.temperature_chart());
        }
        charts.extend(self.speed_chart());
        charts.extend(self.structure_chart());
        charts.extend(self.displacement_chart());
        charts
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let done = self.engine.time() >= self.duration;
        match &self.engine {
            AnyEngine::Event(engine) if self.elastic => {
                if let Some(drift) = self.energy.largest() {
                    checks.push(Check::at_most(
                        "largest energy drift, relative",
                        drift,
                        1e-10,
                        "elastic collisions, double precision",
                    ));
                }
                if engine.boundary().conserves_momentum()
                    && engine.rules().field == Vector::ZERO
                    && let Some(drift) = self.conservation.momentum.largest()
                {
                    checks.push(Check::at_most("largest momentum drift, relative", drift, 1e-10, "no walls, double precision"));
                }
            }
            AnyEngine::Time(engine) if done && self.conservative && engine.integrator().is_symplectic() => {
                checks.extend(self.energy_slope());
            }
            _ => {}
        }
        if let Some(radius) = self.uniform_hard_spheres().filter(|_| done) {
            let particles = &self.start_particles;
            let packing = particles.len() as f64 * ball_volume::<D>(radius) / self.engine.boundary().volume();
            let z = self.virial_pressure.compressibility();
            let expected = theory::compressibility::<D>(packing);
            let source = if D == 2 { "Henderson 1975, hard disks" } else { "Carnahan and Starling 1969, hard spheres" };
            if packing < 0.45 {
                // The pair sum of N particles has N - 1 partners each.
                let finite = 1.0 + (expected - 1.0) * (1.0 - 1.0 / particles.len() as f64);
                checks.push(z.check("compressibility factor Z", finite, source));
            }
        }
        checks
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
            energy_drift: self.energy.largest(),
            momentum_drift: self.engine.boundary().conserves_momentum().then(|| self.conservation.momentum.largest()).flatten(),
            ..Honesty::default()
        }
    }

    fn tables(&self) -> Vec<Table> {
        let mut tables = vec![];
        if self.observe.contains(&Observable::Pressure) {
            let rows = self.pressures().iter().map(|(_, estimate)| vec![estimate.mean, estimate.standard_error]).collect();
            tables.push(Table { name: "pressure".into(), columns: vec!["pressure".into(), "standard_error".into()], rows });
        }
        tables
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.0, 0.5 * self.duration]
    }

    fn act(&mut self, action: Action) -> Result<(), Invalid> {
        let Action::Reverse = action;
        match &mut self.engine {
            AnyEngine::Event(engine) => engine.reverse_velocities(),
            AnyEngine::Time(engine) => engine.edit(|particles| particles.velocity.iter_mut().for_each(|v| *v = -*v))?,
        }
        Ok(())
    }
}
