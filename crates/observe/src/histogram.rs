//! Histograms, and Pearson's chi^2 against a distribution.

use crate::distribution::normal_score_of_chi_squared;
use crate::{Check, Estimate};

/// Counts in equal bins from `lower` to `upper`, and of what lies outside.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Histogram {
    lower: f64,
    width: f64,
    /// Below, the bins, at or above.
    counts: Vec<u64>,
}

impl Histogram {
    /// Empty bins; at least one.
    pub fn new(lower: f64, upper: f64, bins: usize) -> Self {
        let bins = bins.max(1);
        Self { lower, width: (upper - lower) / bins as f64, counts: vec![0; bins + 2] }
    }

    /// Counts a value. What is not a number is not counted.
    pub fn add(&mut self, value: f64) {
        let place = (value - self.lower) / self.width;
        if !place.is_nan() {
            let last = self.counts.len() - 1;
            // Casting saturates: infinities and far values end in the outer bins.
            let bin = if place < 0.0 { 0 } else { (place as usize).saturating_add(1).min(last) };
            self.counts[bin] += 1;
        }
    }

    /// Number of values counted, outside ones included.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Counts in the bins proper.
    pub fn counts(&self) -> &[u64] {
        &self.counts[1..self.counts.len() - 1]
    }

    /// Edges of the bins proper, one more than there are bins.
    pub fn edges(&self) -> Vec<f64> {
        (0..self.counts.len() - 1).map(|k| self.lower + self.width * k as f64).collect()
    }

    /// Middle of each bin and the probability density there, with the binomial standard error of independent values.
    pub fn densities(&self) -> Vec<(f64, Estimate)> {
        let total = self.total() as f64;
        let density = |&n: &u64| {
            let p = n as f64 / total;
            Estimate::new(p, (p * (1.0 - p) / total).sqrt()) / self.width
        };
        let middle = |k: usize| self.lower + self.width * (k as f64 + 0.5);
        self.counts().iter().enumerate().map(|(k, n)| (middle(k), density(n))).collect()
    }

    /// Pearson's chi^2 against a cumulative distribution, what lies outside the bins included. See [`chi_squared`].
    pub fn chi_squared(&self, cumulative: impl Fn(f64) -> f64, inefficiency: f64, constraints: usize) -> Option<GoodnessOfFit> {
        let edges = self.edges();
        let below = std::iter::once(0.0).chain(edges.iter().map(|&x| cumulative(x)));
        let steps: Vec<f64> = below.chain(std::iter::once(1.0)).collect();
        let probabilities: Vec<f64> = steps.windows(2).map(|w| w[1] - w[0]).collect();
        chi_squared(&self.counts, &probabilities, inefficiency, constraints)
    }
}

/// Pearson's chi^2 and its degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// `sum (n - N p)^2 / (N p)`, over the statistical inefficiency.
    pub chi_squared: f64,
    /// Bins after pooling, less one, less the constraints.
    pub degrees_of_freedom: f64,
}

impl GoodnessOfFit {
    /// Its standard normal score.
    pub fn score(self) -> f64 {
        normal_score_of_chi_squared(self.chi_squared, self.degrees_of_freedom)
    }

    /// The check of chi^2 per degree of freedom against 1.
    pub fn check(self, quantity: impl Into<String>, reference: impl Into<String>) -> Check {
        let nu = self.degrees_of_freedom;
        Check::scored(quantity, self.chi_squared / nu, (2.0 / nu).sqrt(), 1.0, self.score(), reference)
    }
}

/// Pearson's chi^2 of counts against the bins' probabilities (Pearson 1900, doi:10.1080/14786440009463897).
///
/// `inefficiency` is how many of the values are worth one independent value, 1 if all are
/// ([`Blocked::correlation`](crate::Blocked) of a related series): counts from one path are correlated and would fluctuate by
/// so much more. `constraints` is how many numbers the sample shares with the distribution beyond the total: 1 when all
/// samples have exactly the energy that fixes the temperature. Neighbouring bins that expect fewer than five independent
/// counts are pooled. None when fewer than one degree of freedom is left.
pub fn chi_squared(counts: &[u64], probabilities: &[f64], inefficiency: f64, constraints: usize) -> Option<GoodnessOfFit> {
    let total = counts.iter().sum::<u64>() as f64;
    let mut pools: Vec<(f64, f64)> = vec![];
    let mut open = (0.0, 0.0);
    for (&n, p) in counts.iter().zip(probabilities) {
        open = (open.0 + n as f64, open.1 + total * p);
        if open.1 >= 5.0 * inefficiency {
            pools.push(std::mem::take(&mut open));
        }
    }
    // What is left at the end joins its neighbour.
    if let Some(last) = pools.last_mut() {
        *last = (last.0 + open.0, last.1 + open.1);
    }
    let degrees_of_freedom = pools.len() as f64 - 1.0 - constraints as f64;
    let chi_squared = pools.iter().map(|&(n, e)| (n - e) * (n - e) / e).sum::<f64>() / inefficiency;
    (degrees_of_freedom >= 1.0).then_some(GoodnessOfFit { chi_squared, degrees_of_freedom })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distribution::normal_cdf;
    use crate::estimate::mean_and_variance;
    use crate::estimate::tests::assert_standard_normal;
    use corpuscle_core::Random;

    #[test]
    fn values_find_their_bins() {
        let mut histogram = Histogram::new(1.0, 3.0, 4);
        for x in [1.0, 1.2, 2.99, 3.0, 0.99, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            histogram.add(x);
        }
        assert_eq!(histogram.counts(), [2, 0, 0, 1]);
        assert_eq!(histogram.total(), 7);
        assert_eq!(histogram.edges(), [1.0, 1.5, 2.0, 2.5, 3.0]);
    }

    /// Chi^2 itself has mean nu and variance `2 nu` (with multinomial corrections of order 1/N); its Wilson-Hilferty score
    /// is near-normal, which is tested against the exact distribution elsewhere.
    #[test]
    fn chi_squared_of_a_normal_sample_has_its_moments() {
        let fits: Vec<GoodnessOfFit> = (0..2000)
            .map(|seed| {
                let mut random = Random::new(seed, 50);
                let mut histogram = Histogram::new(-3.0, 3.0, 24);
                (0..2000).for_each(|_| histogram.add(random.normal()));
                histogram.chi_squared(normal_cdf, 1.0, 0).unwrap()
            })
            .collect();
        let nu = fits[0].degrees_of_freedom;
        assert_standard_normal("score of chi^2", &fits.iter().map(|f| f.score()).collect::<Vec<_>>());
        let (mean, variance) = mean_and_variance(&fits.iter().map(|f| f.chi_squared).collect::<Vec<_>>());
        assert!(((mean - nu) / (2.0 * nu / 2000.0).sqrt()).abs() < 4.0, "{mean} of {nu}, variance {variance}");
    }

    #[test]
    fn a_wrong_distribution_is_noticed() {
        let mut random = Random::new(1, 51);
        let mut histogram = Histogram::new(-3.0, 3.0, 24);
        (0..20_000).for_each(|_| histogram.add(1.1 * random.normal()));
        assert!(!histogram.chi_squared(normal_cdf, 1.0, 0).unwrap().check("x", "").passed);
    }

    #[test]
    fn densities_are_within_their_errors() {
        let scores: Vec<f64> = (0..1000)
            .map(|seed| {
                let mut random = Random::new(seed, 52);
                let mut histogram = Histogram::new(0.0, 1.0, 5);
                (0..1000).for_each(|_| histogram.add(random.uniform() * 1.25));
                histogram.densities()[2].1.score(0.8)
            })
            .collect();
        assert_standard_normal("density", &scores);
    }

    #[test]
    fn thin_bins_are_pooled_and_correlated_ones_more() {
        let pooled = |inefficiency| chi_squared(&[10; 10], &[0.1; 10], inefficiency, 0).map(|f| f.degrees_of_freedom);
        assert_eq!((pooled(1.0), pooled(3.0), pooled(100.0)), (Some(9.0), Some(4.0), None));
    }
}
