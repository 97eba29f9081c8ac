//! Where everything starts: the presets, the dust and its twins.

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};
use corpuscle_time::{Gravity, Integrator, TimeDriven};

use super::orbits::{Orbit, line_of_euler};
use crate::Settings;

/// Period of the figure-eight for `G = m = 1` (Chenciner and Montgomery 2000, doi:10.2307/2661357; numbers by Simó).
pub(crate) const PERIOD_OF_EIGHT: f64 = 6.325_913_98;
/// Offsets of the twins of every grain, along `x`.
pub(crate) const OFFSETS: [f64; 2] = [1e-4, 1e-8];

/// The Moon's mean distance in astronomical units.
pub(crate) const MOON: f64 = 0.002_569_555;

/// A system of three stars with dust, and how long and how finely to watch it.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    /// Name of the preset.
    pub(crate) preset: String,
    /// Three stars, the grains, then the grains once more for each of [`OFFSETS`].
    pub(crate) particles: Particles<2>,
    /// Number of grains, twins not counted.
    pub(crate) grains: usize,
    /// Difference in `x` between neighbouring grains.
    pub(crate) spacing: f64,
    /// Constant of gravity `G`.
    pub(crate) constant: f64,
    /// Plummer's softening length.
    pub(crate) softening: f64,
    /// Time between samples.
    pub(crate) interval: f64,
    /// Time after which the experiment has shown what it set out to show.
    pub(crate) duration: f64,
    /// Time after which all stars should be back at their start, where there is one.
    pub(crate) period: Option<f64>,
    /// Number of samples drawn behind a star: less than a third of a closed orbit that three stars share.
    pub(crate) trail: usize,
    /// Half the width of the picture.
    pub(crate) view: f64,
    /// How many times farther than it is from the second star the third one is drawn.
    pub(crate) magnified: Option<f64>,
}

impl Start {
    pub(crate) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let preset = settings.word("preset");
        let &[a, b, c] = settings.list("masses") else {
            return Err(settings.invalid("masses", "three of them, or none for the preset's own"));
        };
        let masses = [a, b, c];
        let constant = settings.real("gravity_constant");
        let softening = settings.real("softening");
        let mut start = match preset {
            "figure-eight" => Self::figure_eight(masses, constant, softening),
            "lagrange" => Self::lagrange(masses, constant, softening),
            "pythagorean" => Self::pythagorean(masses, constant, softening),
            "euler" => Self::euler(masses, constant, softening),
            "sun-earth-moon" => Self::sun_earth_moon(masses, constant, softening),
            "paper" => Self::paper(masses, constant, softening),
            name => match Orbit::find(name) {
                Some(orbit) => orbit.start(masses, constant, softening),
                None => return Err(settings.invalid("preset", "a start that this view knows")),
            },
        };
        start.add_dust(settings.whole("grains"), settings.real("grain_spacing"));
        if settings.real("duration") > 0.0 {
            start.duration = settings.real("duration");
        }
        start.particles.validate()?;
        Ok(start)
    }

    /// Three equal masses chase each other along one curve; with other masses, what becomes of that start.
    pub(crate) fn figure_eight(masses: [f64; 3], constant: f64, softening: f64) -> Self {
        let mean = masses.iter().sum::<f64>() / 3.0;
        // Lengths stay, velocities scale with sqrt(G m) and times with its inverse.
        let pace = (constant * mean).sqrt();
        let first = Vector([0.970_004_36, -0.243_087_53]);
        let third = Vector([-0.932_407_37, -0.864_731_46]) * pace;
        let stars = [(first, third * -0.5), (-first, third * -0.5), (Vector::ZERO, third)];
        let period = PERIOD_OF_EIGHT / pace;
        let closes = masses == [mean; 3] && softening == 0.0;
        let mut start = Self::with_stars("figure-eight", masses, stars, constant, softening);
        (start.interval, start.duration, start.view, start.trail) = (period / 320.0, 3.0 * period, 1.25, 100);
        start.period = closes.then_some(period);
        start
    }

    /// An equilateral triangle of side 1 that turns rigidly about its centre of mass, for any three masses.
    pub(crate) fn lagrange(masses: [f64; 3], constant: f64, softening: f64) -> Self {
        let total: f64 = masses.iter().sum();
        let corners = [Vector([0.0, 0.0]), Vector([1.0, 0.0]), Vector([0.5, 0.75f64.sqrt()])];
        let centre = (0..3).fold(Vector::ZERO, |sum, i| sum + corners[i] * (masses[i] / total));
        let rate = rate_of_triangle(masses, constant, softening);
        let stars = corners.map(|corner| {
            let r = corner - centre;
            (r, Vector([-r[1], r[0]]) * rate)
        });
        let period = std::f64::consts::TAU / rate;
        let mut start = Self::with_stars("lagrange", masses, stars, constant, softening);
        (start.interval, start.duration, start.view, start.trail) = (period / 320.0, 10.0 * period, 1.25, 100);
        start.period = Some(period);
        start
    }

    /// Three stars in a row that turns rigidly, for any three masses.
    pub(crate) fn euler(masses: [f64; 3], constant: f64, softening: f64) -> Self {
        let total: f64 = masses.iter().sum();
        let (x, square) = line_of_euler(masses, constant, softening);
        let (places, rate) = ([0.0, 1.0, 1.0 + x], square.sqrt());
        let centre = (0..3).map(|i| places[i] * masses[i] / total).sum::<f64>();
        let stars = places.map(|place| (Vector([place - centre, 0.0]), Vector([0.0, rate * (place - centre)])));
        let period = std::f64::consts::TAU / rate;
        let mut start = Self::with_stars("euler", masses, stars, constant, softening);
        let reach = centre.max(1.0 + x - centre);
        (start.interval, start.duration, start.view, start.trail) = (period / 320.0, 4.0 * period, 1.2 * reach, 100);
        start.period = Some(period);
        start
    }

    /// Sun, Earth and Moon in astronomical units, with the time unit in which a year lasts `2 pi`: the pair on a circle about the
    /// Sun, the Moon on a circle about the Earth; eccentricities and inclination are left out.
    pub(crate) fn sun_earth_moon(masses: [f64; 3], constant: f64, softening: f64) -> Self {
        let [sun, earth, moon] = masses;
        let pair = earth + moon;
        let circular = |mass: f64, r: f64| (constant * mass * r * r / (r * r + softening * softening).powi(3).sqrt()).sqrt();
        let (year, month) = (circular(sun + pair, 1.0), circular(pair, MOON));
        let along = |x: f64, v: f64| (Vector([x, 0.0]), Vector([0.0, v]));
        let (outward, share) = (sun / (sun + pair), pair / (sun + pair));
        let stars = [
            along(-share, -share * year),
            along(outward - MOON * moon / pair, outward * year - month * moon / pair),
            along(outward + MOON * earth / pair, outward * year + month * earth / pair),
        ];
        let mut start = Self::with_stars("sun-earth-moon", masses, stars, constant, softening);
        let period = std::f64::consts::TAU / year;
        (start.interval, start.duration, start.view, start.trail) = (period / 1200.0, period, 1.25, 1200);
        start.magnified = Some(30.0);
        start
    }

    /// Burrau's problem: three stars at rest at the corners of a right-angled triangle with sides 3, 4, 5.
    pub(crate) fn pythagorean(masses: [f64; 3], constant: f64, softening: f64) -> Self {
        let stars = [[1.0, 3.0], [-2.0, -1.0], [1.0, -1.0]].map(|r| (Vector(r), Vector::ZERO));
        let mut start = Self::with_stars("pythagorean", masses, stars, constant, softening);
        let unit = (12.0 / (constant * masses.iter().sum::<f64>())).sqrt();
        (start.interval, start.duration, start.view) = (0.01 * unit, 65.0 * unit, 4.5);
        start
    }

    /// A bright star with two companions on nearly circular orbits. Softened, since a grain that meets a point mass
    /// head-on is thrown out for good after a single encounter, and shows nothing more.
    pub(crate) fn paper(masses: [f64; 3], constant: f64, softening: f64) -> Self {
        let [a, b, c] = masses;
        let total = a + b + c;
        let circular = |mass: f64, r: f64| (constant * mass * r * r / (r * r + softening * softening).powi(3).sqrt()).sqrt();
        let (inner, outer) = (0.7, 2.5);
        let pair = circular(a + b, inner);
        let third = circular(total, outer);
        let mut stars = [
            (Vector([inner * b / (a + b), 0.0]), Vector([0.0, pair * b / (a + b)])),
            (Vector([-inner * a / (a + b), 0.0]), Vector([0.0, -pair * a / (a + b)])),
            (Vector([-0.6 * outer, -0.8 * outer]), Vector([0.8 * third, -0.6 * third])),
        ];
        let mean = |f: &dyn Fn(usize) -> Vector<2>| (0..3).fold(Vector::ZERO, |sum, i| sum + f(i) * (masses[i] / total));
        let (centre, drift) = (mean(&|i| stars[i].0), mean(&|i| stars[i].1));
        for (r, v) in &mut stars {
            *r -= centre;
            *v -= drift;
        }
        let mut start = Self::with_stars("paper", masses, stars, constant, softening);
        let unit = (1.25 / (constant * total)).sqrt();
        (start.interval, start.duration, start.view) = (0.02 * unit, 60.0 * unit, 3.4);
        start
    }

    pub(super) fn with_stars(
        preset: &str,
        masses: [f64; 3],
        stars: [(Vector<2>, Vector<2>); 3],
        constant: f64,
        softening: f64,
    ) -> Self {
        let mut particles = Particles::new();
        for (star, ((position, velocity), mass)) in (0u16..).zip(stars.into_iter().zip(masses)) {
            particles.push(position, velocity, mass, 0.0, star);
        }
        Self {
            preset: preset.into(),
            particles,
            grains: 0,
            spacing: 0.0,
            constant,
            softening,
            interval: 0.01,
            duration: 1.0,
            period: None,
            trail: 1000,
            view: 1.0,
            magnified: None,
        }
    }

    /// A row of grains along `x` above the stars, all with the same velocity, that of a circular orbit in its middle;
    /// and their twins.
    fn add_dust(&mut self, grains: usize, spacing: f64) {
        let total = self.total_mass();
        let height = match self.preset.as_str() {
            "lagrange" => 0.55,
            "pythagorean" => 4.0,
            _ => 1.5,
        };
        let velocity = Vector([-(self.constant * total / height).sqrt(), 0.0]) * if self.preset == "paper" { 0.876 } else { 1.0 };
        (self.grains, self.spacing) = (grains, spacing);
        for offset in std::iter::once(0.0).chain(OFFSETS) {
            for grain in 0..grains {
                let place = (grain as f64 - 0.5 * (grains as f64 - 1.0)) * spacing;
                self.particles.push(Vector([place + offset, height]), velocity, 0.0, 0.0, 3);
            }
        }
    }

    pub(crate) fn masses(&self) -> [f64; 3] {
        std::array::from_fn(|star| self.particles.mass[star])
    }

    pub(crate) fn total_mass(&self) -> f64 {
        self.masses().iter().sum()
    }

    /// The same stars without dust.
    pub(crate) fn without_dust(&self) -> Self {
        let mut start = self.clone();
        start.grains = 0;
        start.particles.position.truncate(3);
        start.particles.velocity.truncate(3);
        start.particles.mass.truncate(3);
        start.particles.radius.truncate(3);
        start.particles.species.truncate(3);
        start
    }

    /// An engine at the start.
    pub(crate) fn engine(&self, integrator: Integrator) -> Result<TimeDriven<2>, Invalid> {
        let space = Boundary::new([-self.view; 2], [self.view; 2], Axis::Open);
        TimeDriven::new(space, self.particles.clone(), vec![Box::new(Gravity::new(self.constant, self.softening))], integrator)
    }

    /// The longest step not above `dt` of which a whole number makes a sampling interval, so that every integrator has a
    /// state at every sampling time.
    pub(crate) fn fitting_step(&self, dt: f64) -> f64 {
        self.interval / (self.interval / dt * (1.0 - 1e-12)).ceil().max(1.0)
    }
}

/// Angular velocity of Lagrange's triangle of side 1, `omega^2 = G M / (1 + s^2)^(3/2)` with softening `s`.
pub(crate) fn rate_of_triangle(masses: [f64; 3], constant: f64, softening: f64) -> f64 {
    (constant * masses.iter().sum::<f64>() / (1.0 + softening * softening).powi(3).sqrt()).sqrt()
}

/// The adaptive integrator as this experiment uses it: to rounding error.
pub(crate) const PRECISE: Integrator = Integrator::GaussRadau15 { tolerance: 1e-9, first_step: None };
