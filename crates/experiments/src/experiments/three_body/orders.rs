//! The order of each integrator, measured on the figure-eight.

use corpuscle_core::{Engine, Failure, Particles, Random};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Estimate, Scale, Series, Style, fit};
use corpuscle_time::Integrator;

use super::failure;
use super::start::{PERIOD_OF_EIGHT, PRECISE, Start};
use crate::ensemble;

/// Stream of the random starting phases.
const STREAM: u64 = 0x0eed;
/// Replicas, each from another place of the orbit.
const REPLICAS: usize = 12;
/// Number of different steps, each half as long as the one before.
const HALVINGS: usize = 5;
/// Time integrated, as a share of the period.
const SHARE: f64 = 0.125;

/// Name and longest step of each fixed-step integrator, as a number of steps in the time integrated: the largest for
/// which the next term of the error is a small correction, by the size of the error itself.
const METHODS: [(&str, u32); 5] =
    [("explicit-euler", 256), ("symplectic-euler", 256), ("velocity-verlet", 64), ("runge-kutta-4", 32), ("yoshida-4", 64)];
/// Tolerances of the adaptive integrator, which chooses its steps.
const TOLERANCES: [f64; 6] = [1e2, 1e1, 1e0, 1e-1, 1e-3, 1e-9];

/// Errors of all integrators from one starting phase.
#[derive(Clone, Debug, Default)]
struct Replica {
    phase: f64,
    /// For each method, `(dt, |error|)`.
    errors: Vec<Vec<(f64, f64)>>,
    /// Mean step and error of the adaptive integrator for each tolerance.
    adaptive: Vec<(f64, f64)>,
}

/// The measured orders.
pub(crate) struct Orders {
    replicas: Vec<Replica>,
}

impl Orders {
    /// Integrates an eighth of a period with every method and step, from random places on the orbit.
    pub(crate) fn measure(seed: u64) -> Result<Self, Failure> {
        let mut random = Random::new(seed, STREAM);
        let mut replicas: Vec<Replica> =
            (0..REPLICAS).map(|_| Replica { phase: random.uniform() * PERIOD_OF_EIGHT, ..Replica::default() }).collect();
        ensemble::for_each(&mut replicas, Replica::measure)?;
        Ok(Self { replicas })
    }

    /// The order of a method: in each replica the local slopes of `ln |error|` against `ln dt` are continued to `dt = 0`
    /// along a line in `dt` (in `dt^2` for a reversible method, whose error has even powers only).
    ///
    /// The error has two parts: the scatter over the starting phases, and that of the slopes about their lines. The latter
    /// comes from terms of higher order, alike in all replicas, and so does not shrink with their number.
    fn order(&self, method: usize) -> Estimate {
        let orders: Vec<Estimate> = self.replicas.iter().filter_map(|replica| replica.order(method)).collect();
        let values: Vec<f64> = orders.iter().map(|order| order.mean).collect();
        let phases = Estimate::from_replicas(&values);
        let lines = orders.iter().map(|order| order.standard_error).sum::<f64>() / orders.len() as f64;
        let standard_error = (phases.standard_error * phases.standard_error + lines * lines).sqrt();
        Estimate::new(phases.mean, standard_error).with_degrees_of_freedom(HALVINGS as f64 - 3.0)
    }

    pub(crate) fn checks(&self) -> Vec<Check> {
        let reference = "error of order p falls as dt^p (Hairer, Nørsett and Wanner 1993, II.3); slopes continued to dt = 0; \
                         bound: four times the error of that, from starting phases of the figure-eight and from the fit";
        let orders = METHODS.iter().enumerate().filter_map(|(method, (name, _))| {
            let order = f64::from(Integrator::from_name(name, 1.0).ok()?.order());
            let found = self.order(method);
            // What is left of higher orders is alike in every run: no score of chance, but a bound.
            let bound = Check::Z_LIMIT * found.standard_error;
            Some(Check::at_most(format!("order p of {name}: distance from {order}"), (found.mean - order).abs(), bound, reference))
        });
        orders.collect()
    }

    /// Error against step, both logarithmic.
    pub(crate) fn chart(&self) -> Chart {
        let mut chart = Chart::new(
            "orders",
            "Error of each integrator against its step",
            Axis::logarithmic("time step dt", ""),
            Axis::logarithmic("error of the positions after T/8", ""),
        )
        .noting("Halving dt divides the error by 2^p: the slope is the order p. Gauss-Radau chooses its steps (mean shown).");
        for (method, (name, _)) in METHODS.iter().enumerate() {
            let points = (0..HALVINGS).map(|k| average(self.replicas.iter().map(|replica| replica.errors[method][k])));
            chart = chart.with(Series::with_errors(*name, Style::Points, points));
        }
        let adaptive = (0..TOLERANCES.len()).map(|k| average(self.replicas.iter().map(|replica| replica.adaptive[k])));
        chart = chart.with(Series::with_errors("gauss-radau-15", Style::Points, adaptive));
        for (label, method) in [("slope 1", 0), ("slope 2", 2), ("slope 4", 4)] {
            let Some(&(dt, error, _)) = chart.series[method].first_point().as_ref() else { continue };
            let order = label.as_bytes()[6] - b'0';
            let shortest = dt * 0.5f64.powi(HALVINGS as i32 - 1);
            let line = Series::theory(label, shortest, dt, 2, Scale::Logarithmic, |x| error * (x / dt).powi(i32::from(order)));
            chart = chart.with(line);
        }
        chart
    }
}

/// Reads the first point of a series.
trait FirstPoint {
    fn first_point(&self) -> Option<(f64, f64, f64)>;
}

impl FirstPoint for Series {
    fn first_point(&self) -> Option<(f64, f64, f64)> {
        Some((*self.x.first()?, *self.y.first()?, *self.standard_error.first()?))
    }
}

/// Geometric means of steps and errors, with the standard error of the latter.
fn average(points: impl Iterator<Item = (f64, f64)>) -> (f64, f64, f64) {
    let (steps, errors): (Vec<f64>, Vec<f64>) = points.map(|(dt, error)| (libm::log(dt), libm::log(error.max(1e-17)))).unzip();
    let (step, error) = (Estimate::from_replicas(&steps), Estimate::from_replicas(&errors));
    let mean = libm::exp(error.mean);
    (libm::exp(step.mean), mean, mean * error.standard_error)
}

impl Replica {
    fn measure(&mut self) -> Result<(), Failure> {
        let mut start = Start::figure_eight([1.0; 3], 1.0, 0.0);
        let mut orbit = start.engine(PRECISE).map_err(failure)?;
        orbit.advance(self.phase, &mut ())?;
        start.particles = orbit.snapshot();
        let time = SHARE * PERIOD_OF_EIGHT;
        let run = |integrator: Integrator| -> Result<(Particles<2>, u64), Failure> {
            let mut engine = start.engine(integrator).map_err(failure)?;
            engine.advance(time, &mut ())?;
            Ok((engine.snapshot(), engine.steps()))
        };
        let (exact, _) = run(PRECISE)?;
        for (name, fewest) in METHODS {
            let mut errors = vec![];
            for halving in 0..HALVINGS {
                let dt = time / f64::from(fewest << halving);
                let integrator = Integrator::from_name(name, dt).map_err(failure)?;
                errors.push((dt, distance(&run(integrator)?.0, &exact)));
            }
            self.errors.push(errors);
        }
        for tolerance in TOLERANCES {
            let (end, steps) = run(Integrator::GaussRadau15 { tolerance, first_step: None })?;
            self.adaptive.push((time / steps as f64, distance(&end, &exact)));
        }
        Ok(())
    }

    fn order(&self, method: usize) -> Option<Estimate> {
        let reversible = matches!(METHODS[method].0, "velocity-verlet" | "yoshida-4");
        let slopes: Vec<(f64, f64)> = self.errors[method]
            .windows(2)
            .map(|pair| {
                let ((coarse, error), (fine, less)) = (pair[0], pair[1]);
                let slope = libm::log(error / less) / libm::log(coarse / fine);
                (if reversible { coarse * coarse } else { coarse }, slope)
            })
            .collect();
        fit::line_by_scatter(&slopes).map(|line| line.intercept)
    }
}

/// Distance of two states of three stars: root of the sum of squared distances.
fn distance(a: &Particles<2>, b: &Particles<2>) -> f64 {
    a.position.iter().zip(&b.position).map(|(a, b)| (*a - *b).norm_squared()).sum::<f64>().sqrt()
}
