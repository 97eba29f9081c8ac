//! What chance makes of deflections: the walk that forgets, and the one that remembers the last step.

use corpuscle_observe::distribution::ln_factorial;

/// Deflections that are told apart: leaps farther than over one peg count as such.
const KINDS: [i32; 4] = [-3, -1, 1, 3];

/// Probability that `rows` fair and independent deflections end at `gap`, by halves from the middle:
/// `binomial(n, k)/2^n` with `gap = 2 k - n`.
pub(super) fn binomial(rows: usize, gap: i32) -> f64 {
    let (n, reach) = (rows as i32, gap.abs());
    if reach > n || (n - gap) % 2 != 0 {
        return 0.0;
    }
    let right = i32::midpoint(n, gap) as u64;
    let n = rows as u64;
    libm::exp(ln_factorial(n) - ln_factorial(right) - ln_factorial(n - right) - rows as f64 * std::f64::consts::LN_2)
}

/// A walk whose step depends on the last one, with the probabilities counted on a board and made symmetric.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Walk {
    /// Probabilities of the first step, and in each further row of each step behind each.
    first: [f64; 4],
    then: Vec<[[f64; 4]; 4]>,
}

/// The place of a deflection in [`KINDS`].
fn kind(deflection: i32) -> usize {
    i32::midpoint(deflection.clamp(-3, 3), 3) as usize
}

impl Walk {
    /// Counts deflections, row after row, of many balls; none when there is nothing to count.
    pub(super) fn counted<'a>(balls: impl Iterator<Item = &'a [i32]>) -> Option<Self> {
        let (mut first, mut then) = ([0.0; 4], vec![]);
        for deflections in balls {
            // Left and right are the same board in a mirror: each path counts twice.
            for side in [1, -1] {
                let kinds: Vec<usize> = deflections.iter().map(|&deflection| kind(side * deflection)).collect();
                first[*kinds.first()?] += 1.0;
                then.resize(kinds.len() - 1, [[0.0; 4]; 4]);
                for (row, pair) in then.iter_mut().zip(kinds.windows(2)) {
                    row[pair[0]][pair[1]] += 1.0;
                }
            }
        }
        let normal = |counts: [f64; 4]| {
            let sum: f64 = counts.iter().sum();
            counts.map(|count| if sum > 0.0 { count / sum } else { 0.25 })
        };
        (first.iter().sum::<f64>() > 0.0)
            .then(|| Self { first: normal(first), then: then.into_iter().map(|row| row.map(normal)).collect() })
    }

    /// Probabilities of the gaps behind the last row, from `-reach` to `reach` in steps of 2; `reach` is three times the rows.
    pub(super) fn ends(&self) -> Vec<f64> {
        let reach = 3 * (self.then.len() + 1);
        // By last step and place, places counted from -reach.
        let mut now = vec![[0.0; 4]; 2 * reach + 1];
        for (k, &probability) in self.first.iter().enumerate() {
            now[(reach as i32 + KINDS[k]) as usize][k] = probability;
        }
        for (row, then) in self.then.iter().enumerate() {
            let mut next = vec![[0.0; 4]; 2 * reach + 1];
            // A place that a walk of fewer rows can have reached stays within bounds.
            for place in reach - 3 * (row + 1)..=reach + 3 * (row + 1) {
                for (last, &probability) in now[place].iter().enumerate() {
                    for (k, &step) in KINDS.iter().enumerate() {
                        next[(place as i32 + step) as usize][k] += probability * then[last][k];
                    }
                }
            }
            now = next;
        }
        now.iter().step_by(2).map(|kinds| kinds.iter().sum()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binomial_probabilities_add_up() {
        for rows in [1, 2, 7, 30] {
            let sum: f64 = (-40..=40).map(|gap| binomial(rows, gap)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{rows}: {sum}");
        }
        assert!((binomial(4, 0) - 6.0 / 16.0).abs() < 1e-14);
        assert_eq!((binomial(4, 1), binomial(4, 6)), (0.0, 0.0));
    }

    fn every_path(rows: usize, repeats: usize) -> Vec<Vec<i32>> {
        // Each step repeats the last one `repeats` times as often as it turns.
        let mut paths = vec![vec![1]];
        for _ in 1..rows {
            let longer = |path: &Vec<i32>| {
                let last = path[path.len() - 1];
                let next = (0..repeats).map(|_| last).chain([-last]);
                next.map(|step| [path.as_slice(), &[step]].concat()).collect::<Vec<_>>()
            };
            paths = paths.iter().flat_map(longer).collect();
        }
        paths
    }

    /// Steps that repeat the last with probability `p` have the correlation `rho = 2 p - 1`, and `n` of them the variance
    /// `n (1 + rho)/(1 - rho) - 2 rho (1 - rho^n)/(1 - rho)^2`.
    #[test]
    fn a_walk_that_remembers_spreads_as_its_correlations_say() {
        let (rho, n) = (0.5f64, 6usize);
        let paths = every_path(n, 3);
        let ends = Walk::counted(paths.iter().map(Vec::as_slice)).unwrap().ends();
        let gap = |place: usize| 2.0 * place as f64 - 3.0 * n as f64;
        let moment = |power: i32| ends.iter().enumerate().map(|(place, p)| p * gap(place).powi(power)).sum::<f64>();
        let variance = n as f64 * (1.0 + rho) / (1.0 - rho) - 2.0 * rho * (1.0 - rho.powi(n as i32)) / (1.0 - rho).powi(2);
        assert!((moment(0) - 1.0).abs() < 1e-13 && moment(1).abs() < 1e-13);
        assert!((moment(2) - variance).abs() < 1e-12, "{} {variance}", moment(2));
    }

    #[test]
    fn a_walk_that_forgets_is_the_binomial() {
        let paths = every_path(6, 1);
        for (place, p) in Walk::counted(paths.iter().map(Vec::as_slice)).unwrap().ends().into_iter().enumerate() {
            assert!((p - binomial(6, 2 * place as i32 - 18)).abs() < 1e-14);
        }
        assert_eq!(Walk::counted(std::iter::empty()), None);
    }
}
