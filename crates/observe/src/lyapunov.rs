//! Growth of a small separation, and the Lyapunov exponent.

use crate::Estimate;
use crate::blocking::blocking;
use crate::fit::{self, Line};

/// Logarithm of the separation of two paths against time, sampled at equal intervals.
///
/// It grows like `lambda t` from when the fastest direction has taken over until the separation is no longer small against
/// the system, where it saturates. The exponent is read between the two.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Separation {
    limit: f64,
    times: Vec<f64>,
    logarithms: Vec<f64>,
}

impl Separation {
    /// Separations above `limit`, some hundredth of the system's size, count as saturated.
    pub fn new(limit: f64) -> Self {
        Self { limit, times: vec![], logarithms: vec![] }
    }

    /// The next sample. A separation of zero has no logarithm and is passed over.
    pub fn push(&mut self, time: f64, separation: f64) {
        if separation > 0.0 {
            self.times.push(time);
            self.logarithms.push(libm::log(separation));
        }
    }

    /// `(time, ln separation)`.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.times.iter().copied().zip(self.logarithms.iter().copied())
    }

    /// When the separation first exceeded the limit: from there on it says nothing about the exponent.
    pub fn saturation(&self) -> Option<f64> {
        let limit = libm::log(self.limit);
        self.points().find(|point| point.1 > limit).map(|point| point.0)
    }

    /// The exponent from `from` up to saturation: the mean growth of the logarithm per time, its error from blocking the
    /// growth between samples.
    ///
    /// Growth rates of successive stretches of a chaotic path are independent, so that the logarithm is a random walk about
    /// its line, and neighbouring points of it are strongly correlated: the error of a straight-line fit would be far too
    /// small. Fewer than three samples in the window have no error.
    pub fn exponent(&self, from: f64) -> Estimate {
        let window = self.window(from);
        let growth: Vec<f64> = window.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect();
        blocking(&growth).estimate
    }

    /// The straight line through the same window, to be drawn; its errors take no account of the walk.
    pub fn line(&self, from: f64) -> Option<Line> {
        fit::line_by_scatter(&self.window(from))
    }

    fn window(&self, from: f64) -> Vec<(f64, f64)> {
        let until = self.saturation().unwrap_or(f64::INFINITY);
        self.points().filter(|&(time, _)| from <= time && time < until).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use corpuscle_core::Random;

    /// The tent-like map that stretches by `1/p` with probability `p` and by `1/(1-p)` otherwise has the exponent
    /// `-p ln p - (1-p) ln(1-p)`. A fixed window, as saturation comes sooner to paths that grow fast.
    #[test]
    fn random_stretching_has_its_entropy_as_exponent() {
        let p = 0.2;
        let expected = -p * libm::log(p) - (1.0 - p) * libm::log(1.0 - p);
        let scores: Vec<f64> = (0..600)
            .map(|seed| {
                let mut random = Random::new(seed, 95);
                let mut separation = Separation::new(f64::INFINITY);
                let mut distance = 1e-280;
                for k in 0..800 {
                    separation.push(f64::from(k), distance);
                    distance *= if random.uniform() < p { 1.0 / p } else { 1.0 / (1.0 - p) };
                }
                separation.exponent(10.0).score(expected)
            })
            .collect();
        assert_standard_normal("Lyapunov exponent", &scores);
    }

    #[test]
    fn saturation_ends_the_window() {
        let mut separation = Separation::new(1e-2);
        for k in 0..100 {
            let t = f64::from(k) * 0.5;
            separation.push(t, (1e-10 * libm::exp(0.7 * t)).min(1.0));
        }
        let mark = separation.saturation().unwrap();
        assert!((mark - 8.0 * std::f64::consts::LN_10 / 0.7).abs() < 0.5);
        assert!((separation.exponent(1.0).mean - 0.7).abs() < 1e-12);
        assert!((separation.line(1.0).unwrap().slope.mean - 0.7).abs() < 1e-12);
    }
}
