//! Euler's line: how fast it falls apart.

use corpuscle_core::{Failure, Random};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Estimate, Scale, Series, Style, fit};

use super::displaced::Displaced;
use super::orbits::growth_of_line;
use super::start::Start;

/// Stream of the random displacements.
const STREAM: u64 = 0x7a1a;
/// Displacements are fitted while they have grown by these powers of `e`: late enough for the growing mode to have won by
/// `e^10`, early enough to be small.
const WINDOW: (f64, f64) = (10.0, 20.0);
const LOOKS: usize = 60;

/// Lines of the given masses, each displaced at random a little, and followed while the displacement stays small.
pub(crate) struct Line {
    masses: [f64; 3],
    replicas: Vec<Displaced>,
}

impl Line {
    pub(crate) fn measure(masses: [f64; 3], seed: u64) -> Result<Self, Failure> {
        let start = Start::euler(masses, 1.0, 0.0);
        let rate = growth_of_line(masses);
        let turning = start.period.map_or(1.0, |period| std::f64::consts::TAU / period);
        let angles: Vec<f64> = (1..=LOOKS).map(|look| look as f64 / LOOKS as f64 * WINDOW.1 / rate).collect();
        let replicas = Displaced::follow(&start, turning, &angles, |k| Random::at(seed, STREAM, 0, k))?;
        Ok(Self { masses, replicas })
    }

    pub(crate) fn check(&self) -> Check {
        let [a, b, c] = self.masses;
        let rate = growth_of_line(self.masses);
        let slope = |replica: &Displaced| {
            let late = replica.deviation.iter().filter(|(angle, _)| angle * rate >= WINDOW.0);
            let points: Vec<(f64, f64)> = late.map(|&(angle, deviation)| (angle, libm::log(deviation))).collect();
            fit::line_by_scatter(&points).map(|line| line.slope.mean)
        };
        let rates: Vec<f64> = self.replicas.iter().filter_map(slope).collect();
        Estimate::from_replicas(&rates).check(
            format!("growth rate λ/ω of a displaced line of masses {a}, {b}, {c}"),
            rate,
            "Euler 1767: always unstable; λ⁴ + (2 − c) λ² + (1 + 2c)(1 − c) = 0, c ω² + ω² = Σ G (mᵢ + mⱼ)/r³",
        )
    }

    /// Deviation against angle, beside the exponential of theory.
    pub(crate) fn chart(&self) -> Chart {
        let points = Displaced::mean(&self.replicas);
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
