//! Whether the scores of many runs are standard normal deviates, as they must be where theory and error bars are both right.

use crate::Estimate;
use crate::distribution::normal_score_of_chi_squared;

/// Scores of one check over independent runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scores(Vec<f64>);

impl Scores {
    /// No scores yet.
    pub const fn new() -> Self {
        Self(vec![])
    }

    /// One more run's score.
    pub fn push(&mut self, score: f64) {
        self.0.push(score);
    }

    /// Number of runs.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Mean score: 0 but for `1/sqrt(n)`.
    pub fn mean(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.count() as f64
    }

    /// Mean square: 1 but for `sqrt(2/n)`.
    pub fn mean_square(&self) -> f64 {
        self.0.iter().map(|z| z * z).sum::<f64>() / self.count() as f64
    }

    /// Normal score of the mean, `mean sqrt(n)`: far from zero where theory or measurement is off.
    pub fn score_of_mean(&self) -> f64 {
        self.mean() * (self.count() as f64).sqrt()
    }

    /// Normal score of `sum z^2`, which follows `chi^2` with `n` degrees of freedom: far above zero where error bars are too
    /// small, far below where they are too large.
    pub fn score_of_spread(&self) -> f64 {
        let count = self.count() as f64;
        normal_score_of_chi_squared(self.mean_square() * count, count)
    }
}

/// The mean square of the scores of all checks of one run, averaged over runs, with its standard error: checks of one run need
/// not be independent, runs are.
pub fn mean_square_over_runs(runs: &[Vec<f64>]) -> Estimate {
    let squares = runs.iter().filter(|run| !run.is_empty());
    let squares: Vec<f64> = squares.map(|run| run.iter().map(|z| z * z).sum::<f64>() / run.len() as f64).collect();
    Estimate::from_replicas(&squares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;

    fn scores(width: f64, shift: f64) -> Scores {
        let mut random = Random::new(4, 9);
        let mut scores = Scores::new();
        (0..400).for_each(|_| scores.push(shift + width * random.normal()));
        scores
    }

    #[test]
    fn standard_normal_scores_pass_and_others_do_not() {
        let right = scores(1.0, 0.0);
        assert!(right.score_of_mean().abs() < 4.0 && right.score_of_spread().abs() < 4.0);
        assert!(scores(1.0, 0.3).score_of_mean() > 4.0);
        assert!(scores(1.3, 0.0).score_of_spread() > 4.0);
        assert!(scores(0.7, 0.0).score_of_spread() < -4.0);
    }

    #[test]
    fn scores_that_go_together_count_once() {
        let mut random = Random::new(5, 9);
        let runs: Vec<Vec<f64>> = (0..300).map(|_| vec![random.normal(); 7]).collect();
        let together = mean_square_over_runs(&runs);
        assert!((together.mean - 1.0).abs() < 4.0 * together.standard_error);
        assert!((together.standard_error / (2.0f64 / 300.0).sqrt() - 1.0).abs() < 0.3);
    }
}
