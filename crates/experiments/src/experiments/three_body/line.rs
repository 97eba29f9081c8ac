//! Euler's line: how fast it falls apart.

use corpuscle_core::{Engine, Failure, Random, Vector};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Estimate, Scale, Series, Style, fit};

use super::failure;
use super::orbits::growth_of_line;
use super::start::{PRECISE, Start};
use crate::ensemble;

/// Stream of the random displacements.
const STREAM: u64 = 0x7a1a;
/// Replicas, each displaced at random by so much.
const REPLICAS: usize = 12;
const DISPLACEMENT: f64 = 1e-13;
/// Displacements are fitted while they have grown by these powers of `e`: late enough for the growing mode to have won by
/// `e^10`, early enough to be small.
const WINDOW: (f64, f64) = (10.0, 20.0);
const LOOKS: usize = 60;

/// Lines of the given masses, each displaced at random a little, and followed while the displacement stays small.
pub(crate) struct Line {
    masses: [f64; 3],
    replicas: Vec<Replica>,
}

#[derive(Clone)]
struct Replica {
    start: Start,
    rate: f64,
    random: Random,
    /// Angle turned by and deviation from the undisturbed line over the displacement.
    deviation: Vec<(f64, f64)>,
}

impl Line {
    pub(crate) fn measure(masses: [f64; 3], seed: u64) -> Result<Self, Failure> {
        let start = Start::euler(masses, 1.0, 0.0);
        let rate = growth_of_line(masses);
        let mut replicas: Vec<Replica> = (0..REPLICAS as u64)
            .map(|k| Replica { start: start.clone(), rate, random: Random::at(seed, STREAM, 0, k), deviation: vec![] })
            .collect();
        ensemble::for_each(&mut replicas, Replica::measure)?;
        Ok(Self { masses, replicas })
    }

    pub(crate) fn check(&self) -> Check {
        let [a, b, c] = self.masses;
        let slope = |replica: &Replica| {
            let late = replica.deviation.iter().filter(|(angle, _)| angle * replica.rate >= WINDOW.0);
            let points: Vec<(f64, f64)> = late.map(|&(angle, deviation)| (angle, libm::log(deviation))).collect();
            fit::line_by_scatter(&points).map(|line| line.slope.mean)
        };
        let rates: Vec<f64> = self.replicas.iter().filter_map(slope).collect();
        Estimate::from_replicas(&rates).check(
            format!("growth rate λ/ω of a displaced line of masses {a}, {b}, {c}"),
            growth_of_line(self.masses),
            "Euler 1767: always unstable; λ⁴ + (2 − c) λ² + (1 + 2c)(1 − c) = 0, c ω² + ω² = Σ G (mᵢ + mⱼ)/r³",
        )
    }

    /// Deviation against angle, beside the exponential of theory.
    pub(crate) fn chart(&self) -> Chart {
        let count = self.replicas.first().map_or(0, |replica| replica.deviation.len());
        let points: Vec<(f64, f64, f64)> = (0..count)
            .map(|k| {
                let of_each: Vec<f64> = self.replicas.iter().map(|replica| libm::log(replica.deviation[k].1)).collect();
                let mean = Estimate::from_replicas(&of_each);
                (self.replicas[0].deviation[k].0, libm::exp(mean.mean), libm::exp(mean.mean) * mean.standard_error)
            })
            .collect();
        let rate = growth_of_line(self.masses);
        let mut chart = Chart::new(
            "line",
            "How a displacement of Euler's line grows",
            Axis::linear("angle turned by ω t", "rad"),
            Axis::logarithmic("deviation over displacement", ""),
        );
        if let Some(&(end, value, _)) = points.last() {
            let curve = |angle: f64| value * libm::exp(rate * (angle - end));
            chart = chart.with(Series::theory("theory exp(λ t)", 0.0, end, 2, Scale::Linear, curve));
        }
        let [a, b, c] = self.masses;
        chart
            .with(Series::with_errors(format!("masses {a}, {b}, {c}"), Style::Points, points))
            .noting("Stars in a row turn rigidly, but no masses make that stable: the least push grows exponentially.")
    }
}

impl Replica {
    fn measure(&mut self) -> Result<(), Failure> {
        let exact = self.start.particles.position.clone();
        let star = self.random.below(3) as usize;
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * self.random.uniform());
        self.start.particles.position[star] += Vector([cosine, sine]) * DISPLACEMENT;
        let mut engine = self.start.engine(PRECISE).map_err(failure)?;
        let turning = self.start.period.map_or(1.0, |period| std::f64::consts::TAU / period);
        for look in 1..=LOOKS {
            let angle = look as f64 / LOOKS as f64 * WINDOW.1 / self.rate;
            engine.advance(angle / turning, &mut ())?;
            let (sine, cosine) = libm::sincos(angle);
            let turn = |r: Vector<2>| Vector([cosine * r[0] - sine * r[1], sine * r[0] + cosine * r[1]]);
            let squares = engine.particles().position.iter().zip(&exact).map(|(r, &e)| (*r - turn(e)).norm_squared());
            self.deviation.push((angle, squares.sum::<f64>().sqrt() / DISPLACEMENT));
        }
        Ok(())
    }
}
