//! How the paths of neighbouring grains part.

use corpuscle_checkpoint::resume;
use corpuscle_core::Vector;
use corpuscle_observe::{Estimate, fit};

use super::start::{OFFSETS, Start};

/// Growth counts as linear while twins are closer than this share of the distance between unrelated grains.
const LINEAR: f64 = 1e-3;

/// `ln` of separations, averaged over the grains, at every sampling time; and each grain's own for the closest twins.
pub(crate) struct Parting {
    grains: usize,
    spacing: f64,
    pub(crate) time: Vec<f64>,
    /// Of grains that started `grain_spacing` apart.
    pub(crate) neighbours: Vec<f64>,
    /// Of a grain and its twin, for each offset.
    pub(crate) twins: [Vec<f64>; 2],
    /// Of grains half the row apart: what separations saturate at.
    pub(crate) unrelated: Vec<f64>,
    /// Of one grain in two integrators; of the stars where there is no dust.
    pub(crate) integrators: Vec<f64>,
    /// `ln` separation of each grain from its closest twin, one row a sampling time.
    closest: Vec<Vec<f64>>,
    /// Difference of `ln(separation / offset)` between both twins of each grain, and the larger separation of the pair.
    proportion: Vec<Vec<(f64, f64)>>,
}

/// The growth rate of separations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Growth {
    /// Rate `lambda`, mean and standard error over the grains.
    pub(crate) rate: Estimate,
    /// Mean `ln` separation at time zero on the fitted line.
    pub(crate) intercept: f64,
    /// Time until which separations were fitted.
    pub(crate) until: f64,
}

resume!(Parting { values: [time, neighbours, twins, unrelated, integrators, closest, proportion], set_up: [grains, spacing] });

impl Parting {
    pub(crate) fn new(start: &Start) -> Self {
        Self {
            grains: start.grains,
            spacing: start.spacing,
            time: vec![],
            neighbours: vec![],
            twins: [vec![], vec![]],
            unrelated: vec![],
            integrators: vec![],
            closest: vec![],
            proportion: vec![],
        }
    }

    /// Sees all positions in this integrator and in another.
    pub(crate) fn see(&mut self, time: f64, position: &[Vector<2>], other: &[Vector<2>]) {
        let n = self.grains;
        let grain = |copy: usize, k: usize| position[3 + copy * n + k];
        let distance = |a: Vector<2>, b: Vector<2>| libm::log((a - b).norm());
        self.time.push(time);
        let bodies = if n > 0 { 3..3 + n } else { 0..3 };
        self.integrators.push(0.5 * mean(bodies.map(|i| libm::log((position[i] - other[i]).norm_squared()))));
        if n == 0 {
            return;
        }
        self.neighbours.push(mean((1..n).map(|k| distance(grain(0, k - 1), grain(0, k)))));
        self.unrelated.push(mean((0..n / 2).map(|k| distance(grain(0, k), grain(0, k + n / 2)))));
        let apart: [Vec<f64>; 2] = std::array::from_fn(|copy| (0..n).map(|k| distance(grain(0, k), grain(copy + 1, k))).collect());
        for (series, of_each) in self.twins.iter_mut().zip(&apart) {
            series.push(mean(of_each.iter().copied()));
        }
        let logarithms = OFFSETS.map(libm::log);
        self.proportion.push(
            apart[0].iter().zip(&apart[1]).map(|(wide, close)| ((wide - logarithms[0]) - (close - logarithms[1]), *wide)).collect(),
        );
        let [_, closest] = apart;
        self.closest.push(closest);
    }

    /// Initial separations, neighbours first.
    pub(crate) fn offsets(&self) -> [f64; 3] {
        [self.spacing, OFFSETS[0], OFFSETS[1]]
    }

    /// The rate at which the closest twins part while they are close, from the line of least squares through each
    /// grain's `ln` separation.
    pub(crate) fn growth(&self) -> Option<Growth> {
        let limit = |k: usize| self.unrelated[k] + libm::log(LINEAR);
        let last = (0..self.closest.len()).find(|&k| self.twins[1][k] >= limit(k)).unwrap_or(self.closest.len());
        if last < 100 || self.grains < 3 {
            return None;
        }
        let lines: Vec<(f64, f64)> = (0..self.grains)
            .filter_map(|grain| {
                let points: Vec<(f64, f64)> = (0..last).map(|k| (self.time[k], self.closest[k][grain])).collect();
                fit::line_by_scatter(&points).map(|line| (line.slope.mean, line.intercept.mean))
            })
            .collect();
        let rates: Vec<f64> = lines.iter().map(|line| line.0).collect();
        let intercept = mean(lines.iter().map(|line| line.1));
        Some(Growth { rate: Estimate::from_replicas(&rates), intercept, until: self.time[last - 1] })
    }

    /// Mean over the grains of how much faster, as a logarithm, the wide twin parted than the close one, at the last time
    /// at which every wide pair was still closer than a hundredth of the distance between unrelated grains: zero, while
    /// separations obey a linear equation. Second order is as often for as against.
    pub(crate) fn proportionality(&self) -> Option<(f64, Estimate)> {
        let small = |k: usize| self.proportion[k].iter().all(|pair| pair.1 < self.unrelated[k] + libm::log(10.0 * LINEAR));
        let last = (0..self.proportion.len()).take_while(|&k| small(k)).last()?;
        let grown = mean(self.proportion[last].iter().map(|pair| pair.1)) - libm::log(OFFSETS[0]);
        let differences: Vec<f64> = self.proportion[last].iter().map(|pair| pair.0).collect();
        (grown > 1.0 && self.grains >= 3).then(|| (self.time[last], Estimate::from_replicas(&differences)))
    }

    /// First time at which two integrators put the same grain (or star) a hundredth of the size of the system apart.
    pub(crate) fn horizon(&self, size: f64) -> Option<f64> {
        self.integrators.iter().position(|&apart| apart > libm::log(0.01 * size)).map(|k| self.time[k])
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}
