//! Energy, momentum and angular momentum of the stars, their errors, and how large these may be.
//!
//! **Rounding.** Positions are known to `u |r|`, `u = 2^-53`, so the force between two stars at the distance `d` has the
//! relative error `u R/d`, `R` the larger `|r|`. Over a step, which takes no longer than the motion lasts, it changes the
//! energy by at most `u |U| R/d`, and rounding a velocity changes it by `u m v^2`. Steps add up like a random walk
//! (Rein and Spiegel 2015, doi:10.1093/mnras/stu2164): after `n` of them the error is at most `4 u sqrt(n) X`, four
//! standard deviations, with the largest `X = sum |U| (1 + R/d) + 2 K` seen. Momentum and angular momentum likewise, with
//! `sum m |v|` and `sum m |r| |v|` in the place of `X`.
//!
//! **Truncation.** With a step `dt` of a method of order `p` the error is `A dt^p (1 + B dt + ...)`. Where that series is
//! of use, say `|B| dt <= 1/3`, an error at `dt` is at most `2^(1 - p)` times the error of the same run at `2 dt`, which
//! is measured beside.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Vector};
use corpuscle_time::{Integrator, TimeDriven};

use super::start::Start;

/// Unit roundoff of double precision.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// A monitor looks this often while two stars pass each other.
const LOOKS: f64 = 8.0;

/// Something conserved: its value at the start, its largest error, and the largest scale seen of its rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Watched<const D: usize> {
    start: Option<Vector<D>>,
    /// Largest `|x - x_0|` seen.
    pub(crate) error: f64,
    scale: f64,
}

impl<const D: usize> Watched<D> {
    fn see(&mut self, value: Vector<D>, scale: f64) {
        let error = (value - *self.start.get_or_insert(value)).norm();
        self.error = self.error.max(if error.is_nan() { f64::INFINITY } else { error });
        self.scale = self.scale.max(scale);
    }

    /// What rounding may amount to after so many random contributions.
    fn rounding(&self, contributions: f64) -> f64 {
        4.0 * UNIT * contributions.sqrt() * self.scale
    }
}

/// An engine of three stars and dust with a watch on what should be conserved.
pub(crate) struct Run {
    pub(crate) engine: TimeDriven<2>,
    pub(crate) energy: Watched<1>,
    pub(crate) momentum: Watched<2>,
    pub(crate) angular_momentum: Watched<1>,
    /// Greatest speed over distance seen between two stars: the highest frequency an integrator has to follow.
    pub(crate) fastest: f64,
    constant: f64,
    softening: f64,
    /// Energy at the start.
    pub(crate) energy_at_start: f64,
    /// Positions and velocities at each sampling time reached in the current call, oldest first.
    pub(crate) frames: Vec<Frame>,
}

/// Everything at one sampling time.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Frame {
    pub(crate) time: f64,
    pub(crate) position: Vec<Vector<2>>,
    pub(crate) velocity: Vec<Vector<2>>,
    /// Largest relative energy error so far.
    pub(crate) energy_error: f64,
}

resume!(Run {
    values: [energy, momentum, angular_momentum, fastest, energy_at_start, frames],
    parts: [engine],
    set_up: [constant, softening],
});

impl Run {
    pub(crate) fn new(start: &Start, integrator: Integrator) -> Result<Self, corpuscle_core::Invalid> {
        let mut run = Self {
            engine: start.engine(integrator)?,
            energy: Watched::default(),
            momentum: Watched::default(),
            angular_momentum: Watched::default(),
            fastest: 0.0,
            constant: start.constant,
            softening: start.softening,
            energy_at_start: 0.0,
            frames: vec![],
        };
        run.look();
        run.energy_at_start = run.energy.start.map_or(0.0, |energy| energy[0]);
        Ok(run)
    }

    /// Advances to `to`, looking more often while two stars are close. Where it looks depends on the state alone.
    pub(crate) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        let mut time = self.engine.time();
        let shortest = (to - time) / 4096.0;
        while time < to {
            let pause = (1.0 / (LOOKS * self.frequency())).max(shortest);
            time = if time + 1.5 * pause < to { time + pause } else { to };
            self.engine.advance(time, &mut ())?;
            self.look();
        }
        Ok(())
    }

    /// Advances to `to` and keeps what is there.
    pub(crate) fn sample(&mut self, to: f64) -> Result<(), Failure> {
        self.advance(to)?;
        let particles = self.engine.particles();
        let (position, velocity) = (particles.position.clone(), particles.velocity.clone());
        self.frames.push(Frame { time: to, position, velocity, energy_error: self.relative_energy_error() });
        Ok(())
    }

    pub(crate) fn relative_energy_error(&self) -> f64 {
        self.energy.error / self.energy_at_start.abs()
    }

    /// Largest momentum error over the largest `sum m |v|`.
    pub(crate) fn relative_momentum_error(&self) -> f64 {
        self.momentum.error / self.momentum.scale
    }

    /// Largest error of the angular momentum over the largest `sum m |r| |v|`.
    pub(crate) fn relative_angular_momentum_error(&self) -> f64 {
        self.angular_momentum.error / self.angular_momentum.scale
    }

    /// Bounds of the three relative errors; `coarse` is the same run with twice the step, for an integrator with a fixed one.
    pub(crate) fn bounds(&self, coarse: Option<&Self>) -> [f64; 3] {
        let integrator = self.engine.integrator();
        // Stages of a step round on their own; seven nodes of Gauss-Radau, at most five of the others.
        let contributions = 1.0 + 7.0 * self.engine.steps() as f64;
        let [energy, momentum, angular] = [
            self.energy.rounding(contributions),
            self.momentum.rounding(contributions),
            self.angular_momentum.rounding(contributions),
        ];
        let truncation = |error: fn(&Self) -> f64| coarse.map_or(0.0, |c| error(c) * 2f64.powi(1 - integrator.order() as i32));
        // Kicks along the lines between stars and free drifts change neither momentum nor angular momentum.
        let of_angular = if integrator.is_symplectic() { 0.0 } else { truncation(|c| c.angular_momentum.error) };
        [
            (energy + truncation(|c| c.energy.error)) / self.energy_at_start.abs(),
            momentum / self.momentum.scale,
            (angular + of_angular) / self.angular_momentum.scale,
        ]
    }

    /// Highest of the frequencies `v/d` and `sqrt(G M/d^3)` over the pairs of stars.
    fn frequency(&self) -> f64 {
        let particles = self.engine.particles();
        let mut frequency: f64 = 0.0;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let d2 = (particles.position[j] - particles.position[i]).norm_squared() + self.softening * self.softening;
            let v2 = (particles.velocity[j] - particles.velocity[i]).norm_squared();
            let fall = self.constant * (particles.mass[i] + particles.mass[j]) / (d2 * d2.sqrt());
            frequency = frequency.max((v2 / d2).max(fall).sqrt());
        }
        frequency
    }

    fn look(&mut self) {
        let particles = self.engine.particles();
        let (m, r, v) = (&particles.mass, &particles.position, &particles.velocity);
        let mut kinetic = 0.0;
        let mut momentum = Vector::ZERO;
        let (mut angular, mut speeds, mut arms) = (0.0, 0.0, 0.0);
        for i in 0..3 {
            kinetic += 0.5 * m[i] * v[i].norm_squared();
            momentum += v[i] * m[i];
            angular += m[i] * (r[i][0] * v[i][1] - r[i][1] * v[i][0]);
            speeds += m[i] * v[i].norm();
            arms += m[i] * r[i].norm() * v[i].norm();
        }
        let (mut potential, mut sensitive) = (0.0, 0.0);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let d = ((r[j] - r[i]).norm_squared() + self.softening * self.softening).sqrt();
            let depth = self.constant * m[i] * m[j] / d;
            potential -= depth;
            sensitive += depth * (1.0 + r[i].norm().max(r[j].norm()) / d);
        }
        self.energy.see(Vector([kinetic + potential]), sensitive + 2.0 * kinetic);
        self.momentum.see(momentum, speeds);
        self.angular_momentum.see(Vector([angular]), arms);
        self.fastest = self.fastest.max(self.frequency());
    }
}
