//! Lagrange's triangle: how long it holds together.

use corpuscle_core::{Failure, Random};
use corpuscle_observe::chart::Axis;
use corpuscle_observe::{Chart, Check, Estimate, Series, Style, fit};

use super::displaced::Displaced;
use super::start::{Start, rate_of_triangle};

/// Stream of the random displacements.
const STREAM: u64 = 0x7a19;
/// Revolutions followed, and the number of looks in each.
const REVOLUTIONS: usize = 5;
const LOOKS: usize = 24;
/// A growth rate above which the growing mode has won after three revolutions, by `exp(0.4 x 6 pi) = 1900`.
const WINS: f64 = 0.4;

/// Routh's number `(m_1 m_2 + m_2 m_3 + m_3 m_1)/M^2`: the triangle is linearly stable if and only if it is below 1/27
/// (Routh 1875, doi:10.1112/plms/s1-6.1.86; Gascheau 1843).
pub(crate) fn routh([a, b, c]: [f64; 3]) -> f64 {
    (a * b + b * c + c * a) / ((a + b + c) * (a + b + c))
}

/// Rate at which a displacement of an unsoftened triangle grows, in units of its angular velocity: zero where stable, otherwise
/// `sqrt(sqrt(27 mu) - 1)/2` with Routh's number `mu`, the real part of `lambda^2 = (-1 ± sqrt(1 - 27 mu))/2`.
pub(crate) fn growth_rate(masses: [f64; 3]) -> f64 {
    0.5 * ((27.0 * routh(masses)).sqrt() - 1.0).max(0.0).sqrt()
}

/// Triangles of the given masses, each displaced at random a little, followed for some revolutions.
pub(crate) struct Triangle {
    masses: [f64; 3],
    replicas: Vec<Displaced>,
}

impl Triangle {
    pub(crate) fn measure(masses: [f64; 3], seed: u64) -> Result<Self, Failure> {
        let start = Start::lagrange(masses, 1.0, 0.0);
        let rate = rate_of_triangle(masses, 1.0, 0.0);
        let angles: Vec<f64> = (1..=REVOLUTIONS * LOOKS).map(|look| look as f64 / LOOKS as f64 * std::f64::consts::TAU).collect();
        let replicas = Displaced::follow(&start, rate, &angles, |k| Random::at(seed, STREAM, 0, k))?;
        Ok(Self { masses, replicas })
    }

    /// Rate of growth over the angular velocity, from the last two revolutions, when the fastest mode has won. Its deviation
    /// oscillates with twice the imaginary part of `lambda`, `sqrt(sqrt(27 mu) + 1)/2`; only whole oscillations are fitted.
    fn rate(&self) -> Estimate {
        use std::f64::consts::{PI, TAU};
        let oscillation = 2.0 * PI / ((27.0 * routh(self.masses)).sqrt() + 1.0).sqrt();
        let window = (2.0 * TAU / oscillation).floor() * oscillation;
        let looks = (window / TAU * LOOKS as f64).round() as usize;
        let rates: Vec<f64> = self
            .replicas
            .iter()
            .filter_map(|replica| {
                let late = &replica.deviation[REVOLUTIONS * LOOKS - looks..];
                let points: Vec<(f64, f64)> = late.iter().map(|&(angle, deviation)| (angle, libm::log(deviation))).collect();
                fit::line_by_scatter(&points).map(|line| line.slope.mean)
            })
            .collect();
        Estimate::from_replicas(&rates)
    }

    pub(crate) fn check(&self) -> Check {
        let [a, b, c] = self.masses;
        let (mu, theory) = (routh(self.masses), growth_rate(self.masses));
        let reference = format!("Routh 1875: (m1m2 + m2m3 + m3m1)/M² = {mu:.4}, the triangle holds below 1/27 = 0.0370");
        if theory > WINS {
            let quantity = format!("growth rate λ/ω of a displaced triangle of masses {a}, {b}, {c}");
            return self.rate().check(quantity, theory, format!("{reference}; λ/ω = √(√(27 μ) − 1)/2"));
        }
        let most = self.replicas.iter().flat_map(|replica| &replica.deviation).map(|pair| pair.1).fold(0.0, f64::max);
        let quantity = format!("growth of a displaced triangle of masses {a}, {b}, {c} in {REVOLUTIONS} revolutions");
        Check::at_most(
            quantity,
            most,
            drift_bound(theory, REVOLUTIONS as f64),
            format!("{reference}; displaced orbits shear by at most 6π a revolution"),
        )
    }

    /// Deviation against angle, beside the exponential of theory.
    pub(crate) fn chart(&self, other: Option<&Self>) -> Chart {
        let mut chart = Chart::new(
            "triangle",
            "How a displacement of Lagrange's triangle grows",
            Axis::linear("angle turned by ω t", "rad"),
            Axis::logarithmic("deviation over displacement", ""),
        )
        .noting("Stable if and only if (m1m2 + m2m3 + m3m1)/M² < 1/27: a stable one drifts, an unstable one grows exponentially.");
        for triangle in std::iter::once(self).chain(other) {
            let [a, b, c] = triangle.masses;
            let points = Displaced::mean(&triangle.replicas);
            let theory = growth_rate(triangle.masses);
            if let (Some(&(end, value, _)), true) = (points.last(), theory > WINS) {
                let curve = points.iter().map(|p| (p.0, value * libm::exp(theory * (p.0 - end))));
                chart = chart.with(Series::new("theory exp(λ t)", Style::Theory, curve.collect::<Vec<_>>()));
            }
            chart = chart.with(Series::with_errors(format!("masses {a}, {b}, {c}"), Style::Points, points));
        }
        chart
    }
}

/// Bound of the deviation over the displacement where no mode grows fast.
///
/// At an unchanged velocity, `dr` more distance from the centre of mass makes a larger orbit, `da = 2 dr` (vis viva), whose
/// phase falls behind by `3 pi da` a revolution (Kepler's third law), besides an epicycle of an amplitude of less than
/// `6 dr`. All three stars may do so; what they do to each other brings them back, or grows with the rate of theory.
pub(crate) fn drift_bound(rate: f64, revolutions: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    3f64.sqrt() * (6.0 * PI * revolutions + 6.0) * libm::exp(rate * TAU * revolutions)
}
