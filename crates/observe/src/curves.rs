//! Curves measured in several replicas on the same abscissae.

use crate::{Estimate, fit};

/// One curve a replica, `y[replica][k]` at `x[k]`. Replicas are what errors come from: points of one curve at different
/// abscissae are strongly correlated, so a fitted slope takes its error from the spread of the replicas' own slopes.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Curves {
    /// Abscissae, ascending.
    pub x: Vec<f64>,
    /// Ordinates of each replica, as many as there are abscissae.
    pub y: Vec<Vec<f64>>,
}

impl Curves {
    /// The replicas of all together, on the abscissae that the shortest reaches. All must share their first abscissae, as
    /// measurements with the same sampling interval do.
    pub fn join(all: impl IntoIterator<Item = Self>) -> Self {
        let mut all = all.into_iter();
        let mut joined = all.next().unwrap_or_default();
        for curves in all {
            joined.x.truncate(curves.x.len());
            joined.y.extend(curves.y);
        }
        let length = joined.x.len();
        joined.y.iter_mut().for_each(|y| y.truncate(length));
        joined
    }

    /// Number of replicas.
    pub fn replicas(&self) -> usize {
        self.y.len()
    }

    /// Mean over the replicas at each abscissa, with its standard error.
    pub fn points(&self) -> Vec<(f64, Estimate)> {
        let at = |k: usize| Estimate::from_replicas(&self.y.iter().map(|y| y[k]).collect::<Vec<_>>());
        self.x.iter().enumerate().map(|(k, &x)| (x, at(k))).collect()
    }

    /// The mean over the replicas of a number made from each replica's curve `(x, y)`, with its standard error.
    pub fn estimate(&self, number: impl Fn(&[f64], &[f64]) -> f64) -> Estimate {
        Estimate::from_replicas(&self.y.iter().map(|y| number(&self.x, y)).collect::<Vec<_>>())
    }

    /// Slope of the line fitted to each replica's curve for `from <= x <= to`, every point weighted by `1/x^2`, as befits
    /// ordinates whose spread grows like `x`. Not a number with fewer than two points in the window.
    pub fn slope(&self, from: f64, to: f64) -> Estimate {
        self.estimate(|x, y| {
            let window = x.iter().zip(y).filter(|&(&x, _)| x > 0.0 && from <= x && x <= to);
            let points: Vec<_> = window.map(|(&x, &y)| (x, y, x)).collect();
            fit::line(&points).map_or(f64::NAN, |line| line.slope.mean)
        })
    }
}
