//! How fast neighbouring systems part: the Lyapunov exponent by the variational equations and by twins, and of a periodic orbit
//! by Floquet's multipliers.
//!
//! A deviation obeys the linearised equations along the path, `delta_i'' = sum_j G m_j (D - 3 d (d.D)/s^2)/s^3` with
//! `d = r_j - r_i`, `D = delta_j - delta_i` and the softened distance `s`; a twin starts near the system and obeys the full ones. Both are
//! taken back to their first size now and then (Benettin, Galgani, Giorgilli and Strelcyn 1980, doi:10.1007/BF02128236), and what
//! they had grown by is noted: they should agree, whatever the path does.
//!
//! After the period of a periodic orbit every deviation has been multiplied by the monodromy matrix `M`. Of its twelve eigenvalues
//! (planar motion) eight are one: by the place and the momentum of the whole, and by time and energy, rotation and angular momentum. The other
//! four are `mu, 1/mu, nu, 1/nu`, for motion is symplectic; so `tr M = 8 + 2a + 2b` and `tr M^2 = 8 + 2(2a^2 - 1) + 2(2b^2 - 1)` with
//! `2a = mu + 1/mu` and `2b = nu + 1/nu` say all. The orbit is stable in the linear sense where `a` and `b` are real and within `[-1, 1]`.

use std::fmt::Write;

use corpuscle_core::{Axis as Sides, Boundary, Engine, Failure, Invalid, Particles, Random, Vector};
use corpuscle_observe::chart::{Axis, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_time::{Force, Integrator, TimeDriven};

use super::failure;
use super::orbits::Orbit;
use super::start::Start;
use super::tangent::{pull, tide};
use crate::ensemble;

/// As for dust among two stars: the tides near a star amplify the rounding that steps are chosen by.
const ALMOST_PRECISE: Integrator = Integrator::GaussRadau15 { tolerance: 1e-8, first_step: None };
/// Systems deviated at random; where there is dust, grains.
const REPLICAS: usize = 12;
/// Size of a twin's deviation after each renormalisation, over the length of the system.
const APART: f64 = 1e-8;
/// Renormalisations in the whole time.
const TIMES: usize = 200;
/// Periods of a stable orbit that are followed.
const PERIODS: f64 = 40.0;
const STREAM: u64 = 0x6c79;

/// Gravity among bodies, among each set of twins of them, and its linearisation on each set of deviations, in this order.
#[derive(Clone, Copy, Debug)]
struct Tides {
    constant: f64,
    softening: f64,
    bodies: usize,
    twins: usize,
    deviations: usize,
}

impl Tides {
    fn size(&self) -> usize {
        self.bodies * (1 + self.twins + self.deviations)
    }
}

impl Force<2> for Tides {
    fn name(&self) -> &'static str {
        "gravity with its tides"
    }

    fn accelerate(&mut self, time: f64, boundary: &Boundary<2>, particles: &Particles<2>, acceleration: &mut [Vector<2>]) {
        self.accelerate_precisely(time, boundary, particles, &[], acceleration);
    }

    fn accelerate_precisely(
        &mut self,
        _: f64,
        _: &Boundary<2>,
        particles: &Particles<2>,
        remainder: &[Vector<2>],
        acceleration: &mut [Vector<2>],
    ) {
        let r = &particles.position;
        let lost = |i: usize| remainder.get(i).copied().unwrap_or(Vector::ZERO);
        let arrow = |from: usize, to: usize| (r[to] - r[from]) + (lost(to) - lost(from));
        let pairs = || (0..self.bodies).flat_map(|i| (0..self.bodies).map(move |j| (i, j))).filter(|(i, j)| i != j);
        for (i, j) in pairs() {
            let strength = self.constant * particles.mass[j];
            if strength == 0.0 {
                continue;
            }
            for set in 0..=self.twins {
                let first = set * self.bodies;
                acceleration[first + i] += pull(strength, arrow(first + i, first + j), self.softening);
            }
            for set in 0..self.deviations {
                let first = (1 + self.twins + set) * self.bodies;
                acceleration[first + i] += tide(strength, arrow(i, j), arrow(first + i, first + j), self.softening);
            }
        }
    }

    fn energy(&self, _: f64, _: &Boundary<2>, _: &Particles<2>) -> f64 {
        0.0 // that of deviations is none that anybody would ask for
    }

    fn virial(&self, _: f64, _: &Boundary<2>, _: &Particles<2>) -> f64 {
        0.0
    }

    fn validate(&self, _: &Boundary<2>, particles: &Particles<2>) -> Result<(), Invalid> {
        if particles.len() == self.size() {
            Ok(())
        } else {
            Err(Invalid::new("particles", particles.len(), format!("{}: bodies, twins and deviations", self.size())))
        }
    }
}

/// A deviation of each body: of place and velocity.
type Deviation = Vec<(Vector<2>, Vector<2>)>;

fn norm(deviation: &[(Vector<2>, Vector<2>)]) -> f64 {
    deviation.iter().map(|(r, v)| r.norm_squared() + v.norm_squared()).sum::<f64>().sqrt()
}

/// Bodies on their way, with twins and deviations.
fn engine(start: &Start, bodies: &[usize], twins: &[Deviation], deviations: &[Deviation]) -> Result<TimeDriven<2>, Invalid> {
    let all = &start.particles;
    let mut particles = Particles::<2>::new();
    for &i in bodies {
        particles.push(all.position[i], all.velocity[i], all.mass[i], 0.0, 0);
    }
    for (r, (&i, (dr, dv))) in twins.iter().flat_map(|twin| bodies.iter().zip(twin)).map(|(i, d)| (all.position[*i], (i, *d))) {
        particles.push(r + dr, all.velocity[i] + dv, all.mass[i], 0.0, 1);
    }
    for (&i, &(dr, dv)) in deviations.iter().flat_map(|deviation| bodies.iter().zip(deviation)) {
        particles.push(dr, dv, all.mass[i], 0.0, 2);
    }
    let tides = Tides {
        constant: start.constant,
        softening: start.softening,
        bodies: bodies.len(),
        twins: twins.len(),
        deviations: deviations.len(),
    };
    let space = Boundary::new([-start.view; 2], [start.view; 2], Sides::Open);
    TimeDriven::new(space, particles, vec![Box::new(tides)], ALMOST_PRECISE)
}

/// What a deviation has grown by: `ln`, by the variational equations and by a twin, at each renormalisation.
struct Replica {
    engine: TimeDriven<2>,
    bodies: usize,
    grown: (f64, f64),
    growth: Vec<(f64, f64)>,
}

impl Replica {
    /// A deviation in a random direction of phase space, of one grain or of all stars.
    fn new(start: &Start, grain: Option<usize>, random: &mut Random) -> Result<Self, Invalid> {
        let bodies: Vec<usize> = (0..3).chain(grain).collect();
        let mut direction: Deviation = bodies
            .iter()
            .map(|&i| {
                let moved = grain.is_none_or(|grain| grain == i);
                let mut draw = || if moved { random.normal() } else { 0.0 };
                (Vector([draw(), draw()]), Vector([draw(), draw()]))
            })
            .collect();
        let size = norm(&direction);
        for (r, v) in &mut direction {
            (*r, *v) = (*r * (1.0 / size), *v * (1.0 / size));
        }
        let twin = direction.iter().map(|&(r, v)| (r * APART, v * APART)).collect();
        let engine = engine(start, &bodies, &[twin], &[direction])?;
        Ok(Self { engine, bodies: bodies.len(), grown: (0.0, 0.0), growth: vec![] })
    }

    fn follow(&mut self, duration: f64) -> Result<(), Failure> {
        for k in 1..=TIMES {
            self.engine.advance(duration * k as f64 / TIMES as f64, &mut ())?;
            self.renormalise().map_err(failure)?;
        }
        Ok(())
    }

    fn renormalise(&mut self) -> Result<(), Invalid> {
        let (n, all) = (self.bodies, self.engine.particles());
        let twin: Deviation =
            (0..n).map(|i| (all.position[n + i] - all.position[i], all.velocity[n + i] - all.velocity[i])).collect();
        let tangent: Deviation = (2 * n..3 * n).map(|i| (all.position[i], all.velocity[i])).collect();
        let (apart, size) = (norm(&twin), norm(&tangent));
        self.grown.0 += libm::log(size);
        self.grown.1 += libm::log(apart / APART);
        self.growth.push(self.grown);
        self.engine.edit(|all| {
            for i in 0..n {
                all.position[n + i] = all.position[i] + twin[i].0 * (APART / apart);
                all.velocity[n + i] = all.velocity[i] + twin[i].1 * (APART / apart);
                all.position[2 * n + i] = tangent[i].0 * (1.0 / size);
                all.velocity[2 * n + i] = tangent[i].1 * (1.0 / size);
            }
        })
    }
}

/// `a` and `b` of a periodic orbit: real and imaginary parts.
#[derive(Clone, Copy, Debug)]
struct Floquet {
    cosines: [(f64, f64); 2],
    period: f64,
}

impl Floquet {
    fn measure(start: &Start, period: f64) -> Result<Self, Failure> {
        let unit = |k: usize| -> Deviation {
            let component = |body: usize, part: usize| if k == 4 * body + part { 1.0 } else { 0.0 };
            (0..3).map(|b| (Vector([component(b, 0), component(b, 1)]), Vector([component(b, 2), component(b, 3)]))).collect()
        };
        let deviations: Vec<Deviation> = (0..12).map(unit).collect();
        let mut engine = engine(start, &[0, 1, 2], &[], &deviations).map_err(failure)?;
        engine.advance(period, &mut ())?;
        let all = engine.particles();
        // Column by column.
        let matrix: Vec<[f64; 12]> = (0..12)
            .map(|k| {
                std::array::from_fn(|row| {
                    let (body, part) = (3 * (k + 1) + row / 4, row % 4);
                    if part < 2 { all.position[body][part] } else { all.velocity[body][part - 2] }
                })
            })
            .collect();
        let trace: f64 = (0..12).map(|k| matrix[k][k]).sum();
        let of_square: f64 = (0..12).flat_map(|i| (0..12).map(move |j| (i, j))).map(|(i, j)| matrix[i][j] * matrix[j][i]).sum();
        // The sum of a and b, and that of their squares.
        let (sum, squares) = (0.5 * (trace - 8.0), 0.25 * (of_square - 4.0));
        let discriminant = 0.5 * squares - 0.25 * sum * sum;
        let root = discriminant.abs().sqrt();
        let cosines = if discriminant >= 0.0 {
            [(0.5 * sum + root, 0.0), (0.5 * sum - root, 0.0)]
        } else {
            [(0.5 * sum, root), (0.5 * sum, -root)]
        };
        Ok(Self { cosines, period })
    }

    /// What the last decimals of the figure-eight's start, and of its period, may do to the turns: half a unit of the eighth of each.
    fn doubt(start: &Start, period: f64, turns: [f64; 2]) -> Result<[f64; 2], Failure> {
        const HALF: f64 = 5e-9;
        let pace = start.particles.velocity[2].norm() / Vector([-0.932_407_37, -0.864_731_46]).norm();
        let mut doubt = [0.0; 2];
        for number in 0..5 {
            let mut shifted = start.clone();
            let (position, velocity) = (&mut shifted.particles.position, &mut shifted.particles.velocity);
            let axis = number % 2;
            let mut long = period;
            match number {
                0 | 1 => (position[0][axis], position[1][axis]) = (position[0][axis] + HALF, position[1][axis] - HALF),
                2 | 3 => {
                    velocity[2][axis] += HALF * pace;
                    (0..2).for_each(|star| velocity[star][axis] -= 0.5 * HALF * pace);
                }
                _ => long += HALF / pace,
            }
            let Some(other) = Self::measure(&shifted, long)?.turns() else { return Ok([f64::INFINITY; 2]) };
            (0..2).for_each(|k| doubt[k] += (other[k] - turns[k]).abs());
        }
        Ok(doubt)
    }

    /// Whether all multipliers lie on the unit circle.
    fn is_stable(&self) -> bool {
        self.cosines.iter().all(|&(re, im)| im == 0.0 && re.abs() <= 1.0)
    }

    /// `ln` of the largest multiplier over the period: `cosh(x + iy) = a` has `(|a + 1| + |a - 1|)/2 = cosh x`.
    fn exponent(&self) -> f64 {
        let of = |&(re, im): &(f64, f64)| libm::acosh((0.5 * ((re + 1.0).hypot(im) + (re - 1.0).hypot(im))).max(1.0));
        self.cosines.iter().map(of).fold(0.0, f64::max) / self.period
    }

    /// Turns of the two pairs in a period, the slower first; none of an orbit that is not stable.
    fn turns(&self) -> Option<[f64; 2]> {
        self.is_stable().then(|| self.cosines.map(|(re, _)| libm::acos(re) / std::f64::consts::TAU))
    }
}

/// What was measured of a start.
pub(super) struct Lyapunov {
    dust: bool,
    times: Vec<f64>,
    /// `ln` of the growth of each replica at these times.
    growth: Vec<Vec<(f64, f64)>>,
    floquet: Option<Floquet>,
    /// Turns of the figure-eight's deviations in a period, and how well they are known.
    turns: Option<([f64; 2], [f64; 2])>,
}

impl Lyapunov {
    /// Stars, or where there is dust grains, deviated at random. Stars of a periodic orbit are followed for a period's multipliers, too.
    pub(super) fn measure(start: &Start, seed: u64) -> Result<Self, Failure> {
        let known = start.preset == "figure-eight" || Orbit::find(&start.preset).is_some();
        let floquet = match start.period.filter(|_| known) {
            Some(period) => Some(Floquet::measure(start, period)?),
            None => None,
        };
        let turns = match (floquet.and_then(|floquet| Some((floquet.turns()?, floquet.period))), start.preset.as_str()) {
            (Some((turns, period)), "figure-eight") => Some((turns, Floquet::doubt(start, period, turns)?)),
            _ => None,
        };
        let stable = floquet.filter(Floquet::is_stable).map_or(0.0, |floquet| PERIODS * floquet.period);
        let duration = start.duration.max(stable);
        let dust = start.grains > 0;
        let count = if dust { start.grains.min(REPLICAS) } else { REPLICAS };
        let places: Vec<(u64, Option<usize>)> =
            (0..count).map(|k| (k as u64, dust.then(|| 3 + k * start.grains / count))).collect();
        let replica = |&(k, grain): &(u64, Option<usize>)| Replica::new(start, grain, &mut Random::new(seed, STREAM << 16 | k));
        let mut replicas = ensemble::build(&places, replica).map_err(failure)?;
        ensemble::for_each(&mut replicas, |replica| replica.follow(duration))?;
        Ok(Self {
            dust,
            times: (1..=TIMES).map(|k| duration * k as f64 / TIMES as f64).collect(),
            growth: replicas.into_iter().map(|replica| replica.growth).collect(),
            floquet,
            turns,
        })
    }

    fn mean(&self, k: usize, value: fn((f64, f64)) -> f64) -> Estimate {
        Estimate::from_replicas(&self.growth.iter().map(|growth| value(growth[k]) / self.times[k]).collect::<Vec<_>>())
    }

    /// The exponent over the whole time, by the variational equations.
    fn exponent(&self) -> Estimate {
        self.mean(TIMES - 1, |growth| growth.0)
    }

    pub(super) fn checks(&self) -> Vec<Check> {
        // Both follow the same orbits, so that the error is that of their difference.
        let mut agreement = self.mean(TIMES - 1, |(tangent, twin)| tangent - twin).check(
            "Lyapunov exponent by the variational equations, against that by twins",
            0.0,
            "Benettin et al. 1980 (doi:10.1007/BF02128236): both brought back to their first size two hundred times; \
             standard error of the difference",
        );
        (agreement.measured, agreement.expected) = (self.exponent().mean, self.mean(TIMES - 1, |growth| growth.1).mean);
        let mut checks = vec![agreement];
        if let Some((turns, doubt)) = self.turns {
            for ((turns, doubt), published) in turns.into_iter().zip(doubt).zip([0.008_422_72, 0.298_092_53]) {
                checks.push(Check::at_most(
                    format!("figure-eight: deviations turn {turns:.8} times a period, off {published} by"),
                    (turns - published).abs(),
                    doubt + 5e-9,
                    "Simó 2002 (Contemporary Mathematics 292, 209): all multipliers on the unit circle, exponent 0; bound: half a unit of \
                     the eighth decimal of each number of the start, and of his",
                ));
            }
        }
        checks
    }

    pub(super) fn chart(&self) -> Chart {
        let last = self.times[TIMES - 1];
        let series = |value: fn((f64, f64)) -> f64| {
            (0..TIMES).map(move |k| (k, value)).map(|(k, value)| (self.times[k], self.mean(k, value)))
        };
        let with_errors = |name: &str, style: Style, value: fn((f64, f64)) -> f64, step: usize| {
            let points = series(value).skip(step / 2).step_by(step).map(|(t, e)| (t, e.mean, e.standard_error));
            Series::with_errors(name, style, points)
        };
        let mut chart = Chart::new(
            "lyapunov",
            "Lyapunov exponent, by variational equations and by twins",
            Axis::linear("time t", ""),
            Axis::linear("ln(growth)/t", ""),
        )
        .with(with_errors("variational equations", Style::Line, |growth| growth.0, 1))
        .with(with_errors("twins", Style::Points, |growth| growth.1, 10));
        let exponent = self.exponent();
        let of = if self.dust { "grains" } else { "stars, deviated at random" };
        let mut note = format!("Mean over {} {of}; bands and bars are one standard error.", self.growth.len());
        match self.floquet {
            Some(floquet) if floquet.is_stable() => {
                // Linear growth from the first tenth on.
                let from = self.times[TIMES / 10];
                let size = self.mean(TIMES / 10, |growth| growth.0).mean * from;
                let curve = |t: f64| (size + libm::log(t / from)) / t;
                chart = chart.with(Series::theory(
                    "growth in proportion to time",
                    from,
                    last,
                    200,
                    corpuscle_observe::Scale::Linear,
                    curve,
                ));
                note += " The orbit is stable: deviations grow with time, not exponentially, and the exponent falls to zero.";
            }
            Some(floquet) => {
                let rate = floquet.exponent();
                chart =
                    chart.with(Series::theory("Floquet's multipliers", 0.0, last, 2, corpuscle_observe::Scale::Linear, |_| rate));
                let grown = libm::exp(rate * floquet.period);
                let _ = write!(note, " The orbit is unstable: a deviation grows {grown:.3e}fold in a period.");
            }
            None => {
                let _ = write!(note, " Over this time λ = {:.4} ± {:.4}.", exponent.mean, exponent.standard_error);
            }
        }
        chart.noting(note)
    }
}
