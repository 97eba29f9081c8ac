//! Loschmidt's echo: at every turning time `t` the velocities are reversed, as they are and disturbed by `eps`, and how far each
//! particle misses its start is measured.
//!
//! Two gases mix, which mechanically are one gas in equilibrium. A difference of two paths grows as `exp(lambda t)`, so that the
//! return error is `eps G(t)` with the growth `G(t)` of an infinitesimal displacement. Equilibrium looks the same in either
//! direction of time: `G` on the way out, computed from the collisions in tangent space ([`Tangent`]), has the same distribution
//! as on the way back, and both must give the same exponent.
//!
//! Doubles round by `u = 2^-53` of themselves. Each contact leaves errors of about `u L` in the places of its particles, `L` being
//! the length of the box, so that nothing returns from beyond the horizon `ln(R/(u L))/lambda`, at most `ln(1/u)/lambda`.

use std::f64::consts::{LN_2, LN_10};

use corpuscle_checkpoint::resume;
use corpuscle_core::{Engine, Failure, Invalid, Observer, Random, Vector};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate, Tangent, fit};
use corpuscle_scene::{Colouring, Scene};

use super::Set;
use super::room::{Process, Room};
use crate::replicas::{Member, Replicas};
use crate::study::{Running, Specimen, Study, Vessel};
use crate::{Settings, ensemble};

/// Turning times in the whole duration.
const TURNS: usize = 32;
/// Collisions per particle after which a displacement grows exponentially: some tens of collisions of the gas.
const ALIGNED: f64 = 0.3;
/// A return error of this part of a radius is still infinitesimal.
const SMALL: f64 = 0.01;
/// Binary digits of a double.
const DIGITS: f64 = 53.0;
/// Streams of the disturbances of velocities, and of the displacements in tangent space.
const DISTURBANCE: u64 = 1 << 34;
const DISPLACEMENT: u64 = 1 << 35;

/// The echo of the two gases of a room.
pub(super) fn start<const D: usize>(set: Set<D>, settings: &Settings) -> Result<Running<D, Echo<D>>, Invalid> {
    let perturbations: Vec<f64> = std::iter::once(0.0).chain(settings.list("perturbations").iter().copied()).collect();
    // Krylov's exponent of one particle among others; the fastest growth in the whole gas is two to three times as fast.
    let rate = 0.5 * set.collision_rate;
    let exponent = rate * libm::log(1.0 + 2.0 * set.thermal_speed() / (rate * 2.0 * set.radius));
    let duration = Set::<D>::duration(settings, 0.6 * DIGITS * LN_2 / exponent);
    let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
    let paths = ensemble::build(&streams, |&stream| Path::new(&set, &perturbations, stream))?;
    Ok(Running::new(Echo { set, perturbations, duration }, duration, TURNS, paths))
}

/// What is asked.
pub(super) struct Echo<const D: usize> {
    set: Set<D>,
    /// Of velocities, in thermal speeds; the first is none.
    perturbations: Vec<f64>,
    duration: f64,
}

/// A return from one turning time.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Return {
    /// Logarithm of the root mean square distance of the particles from where they started.
    error: f64,
    /// Entropy of mixing that is left over.
    entropy: f64,
}

/// A way out, and the ways back from each turning time.
pub(super) struct Path<const D: usize> {
    room: Room<D>,
    start: Vec<Vector<D>>,
    tangent: Tangent<D>,
    /// At each turning time, logarithm of the root mean square displacement in tangent space, of velocities that differed by one
    /// thermal speed.
    growth: Vec<f64>,
    /// At each turning time, for each perturbation.
    returns: Vec<Vec<Return>>,
    /// Distance of each particle from its start, from the last turning time without disturbance.
    misses: Vec<f64>,
    /// In units of velocity.
    perturbations: Vec<f64>,
    seed: u64,
    stream: u64,
}

resume!(Path<const D> {
    values: [tangent, growth, returns, misses],
    parts: [room],
    set_up: [start, perturbations, seed, stream],
});

impl<const D: usize> Path<D> {
    fn new(set: &Set<D>, perturbations: &[f64], stream: u64) -> Result<Self, Invalid> {
        let mut room = Room::new(set, Process::Mixing, None, &[set.cells_along], stream)?;
        room.sample();
        let (count, unit) = (set.particles, set.thermal_speed());
        let mut random = Random::new(set.seed, DISPLACEMENT + stream);
        let scale = unit / (count as f64).sqrt();
        let velocities = (0..count).map(|_| Vector::from_fn(|_| scale * random.normal()));
        Ok(Self {
            tangent: Tangent::of_velocities(room.vessel.engine.time(), velocities),
            start: room.places(),
            room,
            growth: vec![],
            returns: vec![],
            misses: vec![0.0; count],
            perturbations: perturbations.iter().map(|eps| eps * unit).collect(),
            seed: set.seed,
            stream,
        })
    }

    /// Turns a copy round, disturbed by the perturbation of this index, and lets it go back to the start.
    fn back(&self, index: usize) -> Result<(Return, Vec<f64>), Failure> {
        let time = self.room.vessel.time();
        let mut copy = self.room.vessel.engine.clone();
        let (eps, turn) = (self.perturbations[index], self.returns.len() as u64);
        copy.set_velocities(|i, velocity| {
            let mut random = Random::at(self.seed, DISTURBANCE + self.stream, turn, (index * self.start.len() + i) as u64);
            let disturbance = if eps > 0.0 { Vector::from_fn(|_| eps * random.normal()) } else { Vector::ZERO };
            *velocity = -*velocity + disturbance;
        });
        let from = copy.time();
        copy.advance(from + time, &mut ())?;
        let places: Vec<Vector<D>> = (0..self.start.len()).map(|i| copy.position(i)).collect();
        let misses: Vec<f64> = places.iter().zip(&self.start).map(|(a, b)| (*a - *b).norm()).collect();
        let square = misses.iter().map(|miss| miss * miss).sum::<f64>() / misses.len() as f64;
        let entropy = self.room.entropy_of(&places) - self.room.samples[0].entropy();
        Ok((Return { error: 0.5 * libm::log(square), entropy }, misses))
    }
}

impl<const D: usize> Member for Path<D> {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        let Self { room, tangent, .. } = self;
        room.vessel.advance(time, &mut |contact| tangent.contact(contact))
    }

    fn sample(&mut self) {
        let now = self.room.vessel.engine.time();
        if self.room.vessel.time() == 0.0 {
            return;
        }
        self.room.sample();
        self.growth.push(self.tangent.logarithm(now));
        self.tangent.rescale(now);
        // A way back that breaks down has no return: its errors are not numbers.
        let lost = || (Return { error: f64::NAN, entropy: f64::NAN }, self.misses.clone());
        let ways: Vec<_> = (0..self.perturbations.len()).map(|index| self.back(index).unwrap_or_else(|_| lost())).collect();
        self.misses.clone_from(&ways[0].1);
        self.returns.push(ways.into_iter().map(|way| way.0).collect());
    }

    fn time(&self) -> f64 {
        self.room.vessel.time()
    }
}

impl<const D: usize> Specimen<D> for Path<D> {
    fn vessel(&self) -> &Vessel<D> {
        &self.room.vessel
    }

    fn vessel_mut(&mut self) -> &mut Vessel<D> {
        &mut self.room.vessel
    }
}

type Paths<const D: usize> = Replicas<Path<D>>;

impl<const D: usize> Echo<D> {
    /// Turning times so far.
    fn turns(paths: &Paths<D>) -> &[f64] {
        &paths.times[1..]
    }

    /// Mean over the paths of a logarithm, at each turning time where all of them have one.
    fn mean(paths: &Paths<D>, value: impl Fn(&Path<D>, usize) -> f64) -> Vec<(f64, Estimate)> {
        let at = |turn: usize| Estimate::from_replicas(&paths.values(|path| value(path, turn)));
        let all = Self::turns(paths).iter().enumerate().map(|(turn, &time)| (time, at(turn)));
        all.filter(|(_, estimate)| estimate.mean.is_finite()).collect()
    }

    /// Turning times between which the error of a perturbation grows as a displacement in tangent space does: after the
    /// displacement has found its direction, and before any error is a sizeable part of a radius. It is read off tangent space.
    fn window(&self, paths: &Paths<D>, eps: f64) -> Vec<usize> {
        let from = ALIGNED / (0.5 * self.set.collision_rate);
        let most = libm::log(SMALL * self.set.radius / eps);
        let largest = |turn: usize| paths.values(|path| path.growth[turn]).into_iter().fold(f64::NEG_INFINITY, f64::max);
        let turns = Self::turns(paths);
        (0..turns.len()).filter(|&turn| turns[turn] >= from && largest(turn) < most).collect()
    }

    /// Growth per time in the window: of the return errors, and in tangent space along the same paths.
    fn exponents(&self, paths: &Paths<D>) -> Option<[Vec<f64>; 2]> {
        let (index, eps) = self.smallest()?;
        let (turns, window) = (Self::turns(paths), self.window(paths, eps));
        let slope = |value: &dyn Fn(usize) -> f64| {
            let points: Vec<_> = window.iter().map(|&turn| (turns[turn], value(turn))).collect();
            fit::line_by_scatter(&points).map(|line| line.slope.mean)
        };
        let echo: Option<Vec<f64>> = paths.members.iter().map(|path| slope(&|turn| path.returns[turn][index].error)).collect();
        let tangent: Option<Vec<f64>> = paths.members.iter().map(|path| slope(&|turn| path.growth[turn])).collect();
        (window.len() >= 4).then_some([echo?, tangent?])
    }

    /// The smallest perturbation there is, and its index.
    fn smallest(&self) -> Option<(usize, f64)> {
        let positive = self.perturbations.iter().copied().enumerate().filter(|&(_, eps)| eps > 0.0);
        positive.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Turning time beyond which each path misses its start by more than a radius; none while one of them still returns.
    fn horizons(&self, paths: &Paths<D>, index: usize) -> Option<Vec<f64>> {
        let (turns, limit) = (Self::turns(paths), libm::log(self.set.radius));
        let of_path = |path: &Path<D>| {
            let errors: Vec<f64> = path.returns.iter().map(|returns| returns[index].error).collect();
            let after = errors.iter().position(|&error| error > limit)?;
            let before = after.checked_sub(1).filter(|&before| errors[before].is_finite())?;
            let part = (limit - errors[before]) / (errors[after] - errors[before]);
            Some(turns[before] + part * (turns[after] - turns[before]))
        };
        paths.members.iter().map(of_path).collect()
    }

    fn error_chart(&self, paths: &Paths<D>) -> Chart {
        let growth = Self::mean(paths, |path, turn| path.growth[turn]);
        let limit = libm::log(self.set.boundary.upper[0]);
        let mut chart = Chart::new(
            "echo",
            "Loschmidt's echo: how far the return misses",
            Axis::linear("time t of the reversal", ""),
            Axis::logarithmic("distance from the start", ""),
        )
        .with(Series::theory("radius of a particle", 0.0, self.duration, 2, Scale::Linear, |_| self.set.radius));
        for (index, &eps) in self.perturbations.iter().enumerate() {
            if eps > 0.0 {
                let line = growth.iter().map(|(t, g)| (*t, libm::log(eps) + g.mean)).filter(|(_, ln)| *ln < limit);
                let theory =
                    Series::new(format!("ε = {eps:e}: tangent space"), Style::Theory, line.map(|(t, ln)| (t, libm::exp(ln))));
                chart = chart.with(theory);
            }
            let name = if eps > 0.0 { format!("ε = {eps:e}: measured") } else { "reversed as it is".into() };
            let points = Self::mean(paths, |path, turn| path.returns[turn][index].error);
            let points = points.iter().map(|(t, e)| (*t, libm::exp(e.mean), libm::exp(e.mean) * e.standard_error));
            chart = chart.with(Series::with_errors(name, Style::Points, points));
        }
        chart.noting(
            "Whatever is disturbed, even by the last bit, grows e-fold in the same time; beyond a radius nobody comes home.",
        )
    }

    fn entropy_chart(&self, paths: &Paths<D>) -> Chart {
        let count = self.set.particles as f64;
        let mut chart = Chart::new(
            "entropy-returned",
            "Entropy of mixing that is left over after the return",
            Axis::linear("time t of the reversal", ""),
            Axis::linear("entropy left over (S − S₀)/N", "k_B"),
        )
        .with(Series::new(
            "on the way out",
            Style::Theory,
            Self::mean(paths, |path, turn| path.room.rise(&path.room.samples[turn + 1]) / count).iter().map(|(t, s)| (*t, s.mean)),
        ));
        for (index, &eps) in self.perturbations.iter().enumerate() {
            let name = if eps > 0.0 { format!("ε = {eps:e}") } else { "reversed as it is".into() };
            let points = Self::mean(paths, |path, turn| path.returns[turn][index].entropy / count);
            let points = points.iter().map(|(t, s)| (*t, s.mean, s.standard_error));
            chart = chart.with(Series::with_errors(name, Style::Line, points));
        }
        chart.noting(
            "Before its horizon each reversal takes the entropy back to where it was; beyond it entropy rises backwards, too.",
        )
    }
}

impl<const D: usize> Study<D> for Echo<D> {
    type Specimen = Path<D>;

    fn draw(&self, paths: &Paths<D>, scene: &mut Scene) {
        scene.title = super::EXPERIMENT.title.into();
        let name = "digits of the way back".to_string();
        scene.colouring = Colouring::Value { name, unit: String::new(), least: 0.0, most: 16.0 };
        let path = &paths.members[0];
        scene.caption = match path.returns.last() {
            Some(returns) => format!(
                "reversed at t = {:.0}, the particles miss their start by {:.1e}",
                paths.sampled(),
                libm::exp(returns[0].error)
            ),
            None => "two gases, on their way out".into(),
        };
    }

    fn shade(&self, path: &Path<D>, particle: usize) -> f64 {
        let digits = -libm::log(path.misses[particle] / self.set.radius) / LN_10;
        digits.clamp(0.0, 16.0)
    }

    fn charts(&self, paths: &Paths<D>) -> Vec<Chart> {
        vec![self.error_chart(paths), self.entropy_chart(paths)]
    }

    fn checks(&self, paths: &Paths<D>) -> Vec<Check> {
        let Some([echo, tangent]) = self.exponents(paths).filter(|_| Self::turns(paths).len() >= TURNS) else { return vec![] };
        let difference: Vec<f64> = echo.iter().zip(&tangent).map(|(a, b)| a - b).collect();
        let (echo, tangent) = (Estimate::from_replicas(&echo), Estimate::from_replicas(&tangent));
        let mut exponent = Estimate::from_replicas(&difference).check(
            "Lyapunov exponent λ from the echo",
            0.0,
            "growth in tangent space along the way out (Dellago, Posch and Hoover 1996); z is that of the paths' differences",
        );
        (exponent.measured, exponent.expected) = (echo.mean, tangent.mean);
        let mut checks = vec![exponent];
        if let Some(horizons) = self.horizons(paths, 0) {
            let (horizon, rounding) = (Estimate::from_replicas(&horizons).mean, DIGITS * LN_2);
            // Every contact on the way out and back rounds position, velocity and time of two particles in each coordinate.
            let counts = paths.members[0].room.vessel.engine.counts();
            let contacts = 2.0 * (counts.collisions + counts.wall_collisions) as f64;
            let parts = libm::log(contacts * 6.0 * D as f64 * self.set.boundary.upper[0] / self.set.radius);
            checks.push(Check::at_most(
                "horizon of double precision, times λ",
                horizon * tangent.mean,
                rounding,
                "ln(1/2^-53): an error of the last bit has grown to all there is",
            ));
            checks.push(Check::at_least(
                "horizon of double precision, times λ, at least",
                horizon * tangent.mean,
                rounding - parts,
                "no more than a rounding of every number at every contact, all adding up",
            ));
        }
        checks
    }

    fn moments(&self, end: f64) -> Vec<f64> {
        vec![0.0, 0.3 * end, 0.6 * end]
    }
}
