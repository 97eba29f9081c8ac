//! Averages over time origins of a function of two vectors some lag apart, on the fly.

use std::collections::VecDeque;

use corpuscle_checkpoint::resume;
use corpuscle_core::Vector;

use crate::Curves;

/// Keeps the newest samples at strides 1, 2, 4, ... and accumulates a kernel over pairs of them, one sum a tracer:
/// memory and cost grow with the logarithm of the longest lag (Frenkel and Smit, Understanding Molecular Simulation,
/// section 4.4.2; Ramirez, Sukumaran, Vorselaars and Likhtman 2010, doi:10.1063/1.3491098). Samples are picked, not averaged:
/// every lag's value is exact.
#[derive(Clone, Debug)]
pub(crate) struct Correlator<const D: usize> {
    interval: f64,
    kernel: fn(Vector<D>, Vector<D>) -> f64,
    /// Longest lag of a level in units of its stride.
    reach: usize,
    most_levels: usize,
    levels: Vec<Level<D>>,
    /// The very first sample belongs to every level, but a level is not made before its second.
    first: Vec<Vector<D>>,
    pushed: u64,
}

#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Level<const D: usize> {
    /// Newest last.
    samples: VecDeque<Vec<Vector<D>>>,
    /// `[lag][tracer]`.
    sums: Vec<Vec<f64>>,
    counts: Vec<u64>,
}

resume!(Correlator<const D> { values: [levels, first, pushed], set_up: [interval, kernel, reach, most_levels] });

impl<const D: usize> Correlator<D> {
    /// Lags 0, 1, ... `reach` times the interval, then the upper half of that range doubled, again and again.
    pub(crate) fn new(interval: f64, reach: usize, most_levels: usize, kernel: fn(Vector<D>, Vector<D>) -> f64) -> Self {
        Self { interval, kernel, reach: reach.max(2), most_levels, levels: vec![], first: vec![], pushed: 0 }
    }

    /// The next sample of all tracers.
    pub(crate) fn push(&mut self, values: &[Vector<D>]) {
        if self.pushed == 0 {
            self.first = values.to_vec();
        }
        let mut level = 0;
        while level < self.most_levels && self.pushed.is_multiple_of(1 << level) && (level == 0 || self.pushed > 0) {
            if level == self.levels.len() {
                let slots = self.reach + 1;
                let samples = if level == 0 { VecDeque::new() } else { VecDeque::from([self.first.clone()]) };
                self.levels.push(Level { samples, sums: vec![vec![0.0; values.len()]; slots], counts: vec![0; slots] });
            }
            let from = self.first_lag(level);
            self.levels[level].accumulate(values, from, self.reach, self.kernel);
            level += 1;
        }
        self.pushed += 1;
    }

    /// The average over time origins at each lag reached, one curve a tracer.
    pub(crate) fn curves(&self) -> Curves {
        let mut curves = Curves::default();
        let tracers = self.levels.first().map_or(0, |level| level.sums[0].len());
        curves.y.resize(tracers, vec![]);
        for (index, level) in self.levels.iter().enumerate() {
            for lag in self.first_lag(index)..=self.reach {
                if level.counts[lag] > 0 {
                    curves.x.push((lag << index) as f64 * self.interval);
                    for (y, sum) in curves.y.iter_mut().zip(&level.sums[lag]) {
                        y.push(sum / level.counts[lag] as f64);
                    }
                }
            }
        }
        curves
    }

    /// Shorter lags are the business of the level below.
    fn first_lag(&self, level: usize) -> usize {
        if level == 0 { 0 } else { self.reach / 2 + 1 }
    }
}

impl<const D: usize> Level<D> {
    fn accumulate(&mut self, values: &[Vector<D>], from: usize, reach: usize, kernel: fn(Vector<D>, Vector<D>) -> f64) {
        self.samples.push_back(values.to_vec());
        if self.samples.len() > reach + 1 {
            self.samples.pop_front();
        }
        let newest = self.samples.len() - 1;
        for lag in from..=reach.min(newest) {
            self.counts[lag] += 1;
            for ((sum, &now), &then) in self.sums[lag].iter_mut().zip(values).zip(&self.samples[newest - lag]) {
                *sum += kernel(then, now);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    /// Against the plain double loop over all origins that are multiples of the lag's stride.
    #[test]
    fn every_lag_is_the_plain_average_over_its_origins() {
        let mut random = Random::new(1, 30);
        let samples: Vec<[Vector<2>; 2]> =
            (0..203).map(|_| std::array::from_fn(|_| Vector([random.normal(), random.normal()]))).collect();
        let mut correlator = Correlator::new(0.5, 6, 20, Vector::dot);
        for values in &samples {
            correlator.push(values);
        }
        let curves = correlator.curves();
        let lags: Vec<usize> = curves.x.iter().map(|x| (2.0 * x) as usize).collect();
        assert_eq!(lags, [0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 96, 128, 160, 192]);
        for (k, &lag) in lags.iter().enumerate() {
            // The coarsest level whose upper half, 4 to 6 strides, ends before this lag, plus one.
            let stride = (0..10).map(|level| 1 << level).find(|stride| lag <= 6 * stride).unwrap();
            for tracer in 0..2 {
                let origins: Vec<f64> = (0..samples.len() - lag)
                    .step_by(stride)
                    .map(|origin| samples[origin][tracer].dot(samples[origin + lag][tracer]))
                    .collect();
                let plain = origins.iter().sum::<f64>() / origins.len() as f64;
                assert!((curves.y[tracer][k] - plain).abs() < 1e-13, "lag {lag}");
            }
        }
    }
}
