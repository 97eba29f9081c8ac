//! A table with its scatterers and points, and the rays that are followed on it.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Meeting, Obstacle, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Rules};
use corpuscle_observe::{Histogram, Schedule};

use super::{TRAILS, theory};
use crate::Settings;
use crate::replicas::{Member, Watch};

/// Flights up to so many mean free paths have a place in the histogram.
pub(super) const LONGEST: f64 = 6.0;
const BINS: usize = 30;
/// Radius of a scatterer.
const RADIUS: f64 = 1.0;
/// Cells of the lattice along the box: enough for a picture.
const CELLS: usize = 3;
/// Distance of twins at the start: rounding is a millionth of it, and it has far to grow.
const TWIN: f64 = 1e-9;
/// Distance up to which twins are compared with the front.
const CLOSE: f64 = 1e-6;
/// Rays of the bundle and the angle between the outermost.
const RAYS: usize = 48;
const FAN: f64 = 0.02;

/// What all tables have in common.
pub(super) struct Layout {
    seed: u64,
    random: bool,
    square: bool,
    pub(super) coverage: f64,
    scatterers: usize,
    particles: usize,
    extent: [f64; 2],
}

impl Layout {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (coverage, word) = (settings.real("coverage"), settings.word("layout"));
        let area = std::f64::consts::PI * RADIUS * RADIUS / coverage;
        let (random, square) = (word == "random", word == "square");
        // Random sequential placement jams near 0.547; a square lattice closes at pi/4, a triangular one at pi/(2 sqrt 3) = 0.907.
        let most = if random {
            0.4
        } else if square {
            0.78
        } else {
            0.85
        };
        if coverage > most {
            return Err(settings.invalid("coverage", format!("at most {most} in this layout")));
        }
        let scatterers = if random {
            settings.whole("scatterers")
        } else if square {
            CELLS * CELLS
        } else {
            2 * CELLS * 2
        };
        let extent = if random {
            [(area * scatterers as f64).sqrt(); 2]
        } else if square {
            [area.sqrt() * CELLS as f64; 2]
        } else {
            // Rectangles of two discs, sqrt(3) times as high as wide: three beside, two above each other.
            let side = (2.0 * area / 3f64.sqrt()).sqrt();
            [side * CELLS as f64, side * 3f64.sqrt() * 2.0]
        };
        Ok(Self { seed: settings.seed, random, square, coverage, scatterers, particles: settings.whole("particles"), extent })
    }

    pub(super) fn is_random(&self) -> bool {
        self.random
    }

    /// Mean free path `pi A / P`.
    pub(super) fn free_path(&self) -> f64 {
        0.5 * std::f64::consts::PI * RADIUS * (1.0 - self.coverage) / self.coverage
    }

    /// Lyapunov exponent of the thin random layout, at unit speed.
    pub(super) fn exponent(&self) -> f64 {
        theory::exponent_per_flight(RADIUS, self.free_path()) / self.free_path()
    }

    fn centres(&self, boundary: &Boundary<2>, random: &mut Random) -> Result<Vec<Vector<2>>, Invalid> {
        let [width, height] = self.extent;
        if self.square {
            let side = width / CELLS as f64;
            let place = |k: usize| Vector([side * ((k % CELLS) as f64 + 0.5), side * ((k / CELLS) as f64 + 0.5)]);
            return Ok((0..CELLS * CELLS).map(place).collect());
        }
        if !self.random {
            let (side, step) = (width / CELLS as f64, height / 4.0);
            // Rows half a side apart in turn, off the faces of the box.
            let place = |k: usize| {
                let (row, column) = (k / CELLS, k % CELLS);
                Vector([side * (column as f64 + 0.25 + 0.5 * (row % 2) as f64), step * (row as f64 + 0.5)])
            };
            return Ok((0..4 * CELLS).map(place).collect());
        }
        let mut centres: Vec<Vector<2>> = vec![];
        for _ in 0..self.scatterers {
            let clear = |at: &Vector<2>| centres.iter().all(|&other| boundary.displacement(*at, other).norm() > 2.0 * RADIUS);
            let found = (0..100_000).map(|_| Vector([width * random.uniform(), height * random.uniform()])).find(clear);
            centres.push(found.ok_or_else(|| Invalid::new("coverage", self.coverage, "less: no free place was found"))?);
        }
        Ok(centres)
    }
}

/// One point's front of rays, and what it has met.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Ray {
    /// Time of the last contact, and the curvature of the front behind it.
    since: f64,
    curvature: f64,
    /// Logarithm of all spreading up to the last contact.
    stretch: f64,
    hits: u64,
    squares: f64,
}

/// The rays of all points of a table.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Rays(Vec<Ray>);

impl Rays {
    fn new(count: usize) -> Self {
        Self(vec![Ray { since: 0.0, curvature: 0.0, stretch: 0.0, hits: 0, squares: 0.0 }; count])
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Contacts of all points.
    pub(super) fn hits(&self) -> u64 {
        self.0.iter().map(|ray| ray.hits).sum()
    }

    /// Sum of the squared impact parameters over the radius.
    pub(super) fn squares(&self) -> f64 {
        self.0.iter().map(|ray| ray.squares).sum()
    }

    /// A point meets a scatterer; its flight is counted in mean free paths.
    fn meet(&mut self, contact: &Contact<2>, flights: &mut Histogram, free_path: f64) {
        let Meeting::Obstacle { .. } = contact.with else { return };
        let ray = &mut self.0[contact.first.index];
        let flight = contact.time - ray.since;
        if ray.hits > 0 {
            flights.add(flight / free_path);
        }
        let cosine = contact.first.before.dot(contact.normal) / contact.first.before.norm();
        let spread = 1.0 + ray.curvature * flight;
        ray.stretch += libm::log(spread);
        ray.curvature = ray.curvature / spread + 2.0 / (RADIUS * cosine);
        ray.since = contact.time;
        ray.hits += 1;
        ray.squares += 1.0 - cosine * cosine;
    }

    /// `ln(separation/separation at the start)` of the front of one point, at unit speed.
    fn stretch(&self, i: usize, time: f64) -> f64 {
        let ray = &self.0[i];
        ray.stretch + libm::log1p(ray.curvature * (time - ray.since))
    }
}

/// A table under way. Speeds are 1.
pub(super) struct Table {
    pub(super) engine: EventDriven<2>,
    pub(super) rays: Rays,
    pub(super) flights: Histogram,
    /// At each sample: the mean logarithm of the spread, and the mean squared displacement.
    pub(super) stretch: Vec<f64>,
    pub(super) displacement: Vec<f64>,
    origin: Vec<Vector<2>>,
    free_path: f64,
}

resume!(Table { values: [engine, rays, flights, stretch, displacement], set_up: [origin, free_path] });

impl Table {
    /// Scatterers, and points anywhere between them that fly anywhere: the invariant measure.
    ///
    /// # Errors
    /// [`Invalid`] when the scatterers do not fit.
    pub(super) fn new(layout: &Layout, stream: u64) -> Result<Self, Invalid> {
        let mut random = Random::new(layout.seed, stream);
        let mut boundary = Boundary::new([0.0; 2], layout.extent, Axis::Periodic);
        let centres = layout.centres(&boundary, &mut random)?;
        boundary.obstacles = centres.iter().map(|&centre| Obstacle { centre, radius: RADIUS }).collect();
        let mut particles = Particles::new();
        while particles.len() < layout.particles {
            let place = Vector(layout.extent.map(|side| side * random.uniform()));
            if centres.iter().all(|&centre| boundary.displacement(place, centre).norm() > RADIUS * (1.0 + 1e-9)) {
                let (sine, cosine) = libm::sincos(std::f64::consts::TAU * random.uniform());
                particles.push(place, Vector([cosine, sine]), 1.0, 0.0, 0);
            }
        }
        let origin = particles.position.clone();
        let engine = EventDriven::new(boundary, particles, Rules::default())?;
        Ok(Self {
            rays: Rays::new(layout.particles),
            engine,
            flights: Histogram::new(0.0, LONGEST, BINS),
            stretch: vec![],
            displacement: vec![],
            origin,
            free_path: layout.free_path(),
        })
    }
}

impl Member for Table {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let Self { engine, rays, flights, free_path, .. } = self;
        engine.advance(time, &mut Watch(&mut |contact| rays.meet(contact, flights, *free_path)))
    }

    fn sample(&mut self) {
        let (count, time) = (self.rays.len(), self.engine.time());
        self.stretch.push((0..count).map(|i| self.rays.stretch(i, time)).sum::<f64>() / count as f64);
        let square = |i: usize| (self.engine.unwrapped(i) - self.origin[i]).norm_squared();
        self.displacement.push((0..count).map(square).sum::<f64>() / count as f64);
    }

    fn time(&self) -> f64 {
        self.engine.time()
    }
}

/// On one table: points with a twin beside each, and a bundle of rays for the eye.
pub(super) struct Twins {
    engine: EventDriven<2>,
    bundle: EventDriven<2>,
    boundary: Boundary<2>,
    rays: Rays,
    /// Not told: flights are counted on the tables.
    flights: Histogram,
    schedule: Schedule,
    /// Time, mean logarithm of the separation of twins over that at the start, and its largest difference from the front's.
    pub(super) separations: Vec<(f64, f64, f64)>,
    /// Times and places of the first rays of the bundle.
    pub(super) paths: Vec<Vec<(f64, Vector<2>)>>,
}

resume!(Twins { values: [engine, bundle, rays, flights, schedule, separations, paths], set_up: [boundary] });

impl Twins {
    /// # Errors
    /// [`Invalid`] of the engine.
    pub(super) fn new(table: &Table, interval: f64) -> Result<Self, Invalid> {
        let boundary = table.engine.boundary().clone();
        let start = table.engine.snapshot();
        let mut pairs = Particles::new();
        for (&position, &velocity) in start.position.iter().zip(&start.velocity) {
            let across = Vector([-velocity[1], velocity[0]]);
            pairs.push(position, velocity, 1.0, 0.0, 0);
            pairs.push(position + across * TWIN, velocity, 1.0, 0.0, 1);
        }
        let mut rays = Particles::new();
        let heading = libm::atan2(start.velocity[0][1], start.velocity[0][0]);
        for ray in 0..RAYS {
            // The first rays, which leave trails, are spread over the whole bundle.
            let place = (ray * 7) % RAYS;
            let (sine, cosine) = libm::sincos(heading + FAN * (place as f64 / (RAYS - 1) as f64 - 0.5));
            rays.push(start.position[0], Vector([cosine, sine]), 1.0, 0.0, 0);
        }
        let count = pairs.len();
        Ok(Self {
            engine: EventDriven::new(boundary.clone(), pairs, Rules::default())?,
            bundle: EventDriven::new(boundary.clone(), rays, Rules::default())?,
            boundary,
            rays: Rays::new(count),
            flights: Histogram::new(0.0, LONGEST, 1),
            schedule: Schedule::new(0.25 * interval),
            separations: vec![],
            paths: vec![vec![]; TRAILS],
        })
    }

    /// The bundle of rays on show.
    pub(super) fn bundle(&self) -> &EventDriven<2> {
        &self.bundle
    }

    /// # Errors
    /// [`Failure`] of the engine.
    pub(super) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            let Self { engine, rays, flights, .. } = self;
            engine.advance(time, &mut Watch(&mut |contact| rays.meet(contact, flights, 1.0)))?;
            self.advance_bundle(time)?;
            for (ray, path) in self.paths.iter_mut().enumerate() {
                path.push((time, self.bundle.unwrapped(ray)));
            }
            self.compare(time);
        }
        self.advance_bundle(to)
    }

    /// Notes where the first rays are mirrored: their paths turn there.
    fn advance_bundle(&mut self, to: f64) -> Result<(), Failure> {
        let Self { bundle, boundary, paths, .. } = self;
        let mut corner = |contact: &Contact<2>| {
            if let Some(path) = paths.get_mut(contact.first.index)
                && let Some(&(_, last)) = path.last()
            {
                // Less than half a box since the last point: samples are that close.
                path.push((contact.time, last + boundary.displacement(last, contact.first.position)));
            }
        };
        bundle.advance(to, &mut Watch(&mut corner))
    }

    fn compare(&mut self, time: f64) {
        let pairs = self.rays.len() / 2;
        let (mut sum, mut worst, mut close) = (0.0, 0.0f64, true);
        for pair in 0..pairs {
            let separation = (self.engine.unwrapped(2 * pair + 1) - self.engine.unwrapped(2 * pair)).norm();
            let logarithm = libm::log(separation / TWIN);
            sum += logarithm;
            close &= separation < CLOSE;
            worst = worst.max((logarithm - self.rays.stretch(2 * pair, time)).abs());
        }
        let worst = if close { worst } else { f64::NAN };
        self.separations.push((time, sum / pairs as f64, worst));
    }

    /// Largest difference between twins and front at the last sample at which all twins were close; none before they have
    /// had the time to spread.
    pub(super) fn disagreement(&self) -> Option<f64> {
        let far = self.separations.iter().position(|sample| sample.2.is_nan())?;
        self.separations[..far].last().map(|sample| sample.2)
    }
}
