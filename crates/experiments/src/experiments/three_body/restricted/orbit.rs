//! A grain among two stars on circles, with a twin and a deviation beside it.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Axis, Boundary, Engine, Failure, Invalid, Particles, Vector};
use corpuscle_time::{Integrator, TimeDriven};

use super::super::quintic::{quintic, slope, value};
use super::super::tangent::{Places, Tangent};
use super::frame::Turning;

/// Truncation is far below rounding still, and the step is chosen safely above what rounding makes of its measure: the tides near
/// a star amplify rounding more than gravity does.
const ALMOST_PRECISE: Integrator = Integrator::GaussRadau15 { tolerance: 1e-8, first_step: None };
/// Unit roundoff of double precision.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Distance of the twin after each renormalisation: its square root of rounding, where the error of a finite distance and
/// that of rounding are alike.
const APART: f64 = 1e-8;
/// Closer to a star a grain has hit it.
const HIT: f64 = 4e-3;
const PLACES: Places = Places { grain: 2, twin: 3, deviation: 4 };

/// State in the turning frame.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct State {
    pub(super) time: f64,
    pub(super) r: Vector<2>,
    pub(super) v: Vector<2>,
}

/// One grain.
pub(super) struct Orbit {
    frame: Turning,
    engine: TimeDriven<2>,
    /// Its states at the samples, newest last; so many are kept.
    pub(super) path: std::collections::VecDeque<State>,
    /// `(x, x')` where it went through `y = 0` upwards.
    pub(super) section: Vec<(f64, f64)>,
    /// `ln` of all that the deviation, and the twin's distance, have grown by at each unit of time.
    pub(super) growth: Vec<(f64, f64)>,
    grown: (f64, f64),
    jacobi: f64,
    /// Largest error of the Jacobi constant, and the largest scale of its rounding.
    pub(super) error: f64,
    scale: f64,
    /// Whether it has hit a star.
    pub(super) ended: bool,
}

resume!(Orbit { values: [path, section, growth, grown, error, scale, ended], parts: [engine], set_up: [frame, jacobi] });

impl Orbit {
    /// A grain that starts at `(x, 0)`, moving along `y` as the Jacobi constant says.
    pub(super) fn new(frame: Turning, x: f64, speed: f64, jacobi: f64) -> Result<Self, Invalid> {
        let mut particles = Particles::<2>::new();
        for (mass, r) in frame.stars() {
            particles.push(r, Vector([0.0, r[0]]), mass, 0.0, 0);
        }
        let start = Vector([x, 0.0]);
        let v = Vector([0.0, speed + x]);
        let aside = Vector([1.0, 0.0]);
        particles.push(start, v, 0.0, 0.0, 1);
        particles.push(start + aside * APART, v, 0.0, 0.0, 1);
        particles.push(aside, Vector::ZERO, 0.0, 0.0, 2);
        let space = Boundary::new([-4.0; 2], [4.0; 2], Axis::Open);
        let force = Tangent { constant: 1.0, stars: 2, places: PLACES };
        let engine = TimeDriven::new(space, particles, vec![Box::new(force)], ALMOST_PRECISE)?;
        let mut orbit = Self {
            frame,
            engine,
            path: std::collections::VecDeque::new(),
            section: vec![],
            growth: vec![],
            grown: (0.0, 0.0),
            jacobi,
            error: 0.0,
            scale: 0.0,
            ended: false,
        };
        let state = orbit.state(0.0);
        orbit.watch(&state);
        orbit.path.push_back(state);
        Ok(orbit)
    }

    pub(super) fn steps(&self) -> u64 {
        self.engine.steps()
    }

    /// The grain as seen from the frame that has turned by the angle `time`.
    fn state(&self, time: f64) -> State {
        let (sine, cosine) = libm::sincos(time);
        let back = |r: Vector<2>| Vector([cosine * r[0] + sine * r[1], cosine * r[1] - sine * r[0]]);
        let all = self.engine.particles();
        let (r, v) = (back(all.position[PLACES.grain]), back(all.velocity[PLACES.grain]));
        State { time, r, v: v - Vector([-r[1], r[0]]) }
    }

    /// Goes on to the next sample, `interval` later, and keeps so many states.
    pub(super) fn sample(&mut self, time: f64, kept: usize) -> Result<(), Failure> {
        if self.ended {
            return Ok(());
        }
        self.engine.advance(time, &mut ())?;
        let now = self.state(time);
        self.watch(&now);
        if let Some(&before) = self.path.back() {
            self.cross(&before, &now);
        }
        if self.path.len() == kept {
            self.path.pop_front();
        }
        self.path.push_back(now);
        Ok(())
    }

    /// Errors of the Jacobi constant. As with the energy (`conservation`), rounding is `u` of each of its terms a step, and more of
    /// the pull of a star that is near: coordinates are rounded, not distances.
    fn watch(&mut self, now: &State) {
        self.error = self.error.max((self.frame.jacobi(now.r, now.v) - self.jacobi).abs());
        let mut scale = now.r.norm_squared() + now.v.norm_squared();
        for (mass, star) in self.frame.stars() {
            let d = (now.r - star).norm();
            scale += 2.0 * mass / d * (1.0 + now.r.norm().max(1.0) / d);
            self.ended |= d < HIT;
        }
        self.scale = self.scale.max(scale);
    }

    /// What rounding may amount to: `4 u sqrt(n) X`, as for the energy.
    pub(super) fn bound(&self) -> f64 {
        4.0 * UNIT * (1.0 + 7.0 * self.engine.steps() as f64).sqrt() * self.scale
    }

    /// Finds where `y` went through zero upwards between two samples, on the quintic through both.
    fn cross(&mut self, before: &State, now: &State) {
        if !(before.r[1] < 0.0 && now.r[1] >= 0.0) {
            return;
        }
        let h = now.time - before.time;
        let scaled = |state: &State, axis: usize| {
            let a = self.frame.acceleration(state.r, state.v);
            [state.r[axis], h * state.v[axis], h * h * a[axis]]
        };
        let [x, y] = [0, 1].map(|axis| quintic(scaled(before, axis), scaled(now, axis)));
        let (mut lower, mut upper) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (lower + upper);
            if value(&y, middle) < 0.0 { lower = middle } else { upper = middle }
        }
        self.section.push((value(&x, upper), slope(&x, upper) / h));
    }

    /// Takes down by how much deviation and twin have parted from the grain, and brings both near again (Benettin, Galgani,
    /// Giorgilli and Strelcyn 1980, doi:10.1007/BF02128236).
    pub(super) fn renormalise(&mut self, time: f64) -> Result<(), Invalid> {
        if self.ended {
            return Ok(());
        }
        let all = self.engine.particles();
        let size = |r: Vector<2>, v: Vector<2>| (r.norm_squared() + v.norm_squared()).sqrt();
        let Places { grain, twin, deviation } = PLACES;
        let (dr, dv) = (all.position[twin] - all.position[grain], all.velocity[twin] - all.velocity[grain]);
        let (tangent, apart) = (size(all.position[deviation], all.velocity[deviation]), size(dr, dv));
        self.grown.0 += libm::log(tangent);
        self.grown.1 += libm::log(apart / APART);
        self.growth.push((self.grown.0 / time, self.grown.1 / time));
        self.engine.edit(|all| {
            all.position[deviation] = all.position[deviation] * (1.0 / tangent);
            all.velocity[deviation] = all.velocity[deviation] * (1.0 / tangent);
            all.position[twin] = all.position[grain] + dr * (APART / apart);
            all.velocity[twin] = all.velocity[grain] + dv * (APART / apart);
        })
    }

    /// The Lyapunov exponent over the whole time, by the variational equations and by the twin.
    pub(super) fn exponents(&self) -> Option<(f64, f64)> {
        self.growth.last().copied()
    }
}
