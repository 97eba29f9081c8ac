//! Coarse-grained configurational entropy, in units of Boltzmann's constant.

use std::f64::consts::PI;

use corpuscle_core::{Axis, Boundary, Vector};

use crate::distribution::{ln_factorial, ln_gamma};

/// Equal cells that divide a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells<const D: usize> {
    lower: Vector<D>,
    extent: Vector<D>,
    sides: [usize; D],
}

impl<const D: usize> Cells<D> {
    /// Divides the room open to centres of particles of this radius into so many cells along each axis (at least one).
    pub fn new(boundary: &Boundary<D>, radius: f64, sides: [usize; D]) -> Self {
        let margin = Vector::from_fn(|k| if boundary.axes[k] == Axis::Walls { radius } else { 0.0 });
        Self { lower: boundary.lower + margin, extent: boundary.extent() - margin * 2.0, sides: sides.map(|n| n.max(1)) }
    }

    /// Number of cells `K`.
    pub fn len(&self) -> usize {
        self.sides.iter().product()
    }

    /// Never: there is at least one cell.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Cell of a point; points outside belong to the nearest. The first axis varies fastest.
    pub fn index(&self, point: Vector<D>) -> usize {
        let mut index = 0;
        for k in (0..D).rev() {
            let place = (point[k] - self.lower[k]) / self.extent[k] * self.sides[k] as f64;
            index = index * self.sides[k] + (place.max(0.0) as usize).min(self.sides[k] - 1);
        }
        index
    }

    /// Number of points in each cell.
    pub fn occupation<'a>(&self, points: impl IntoIterator<Item = &'a Vector<D>>) -> Vec<u64> {
        let mut counts = vec![0; self.len()];
        for &point in points {
            counts[self.index(point)] += 1;
        }
        counts
    }
}

/// Boltzmann's `S/k = ln(N! / prod n_i!)`: the logarithm of the number of ways to distribute `N` labelled particles over the
/// cells with these occupation numbers.
pub fn configurational_entropy(occupation: &[u64]) -> f64 {
    // Most cells of a fine grid hold none or one, and ln 0! = ln 1! = 0.
    ln_factorial(occupation.iter().sum()) - occupation.iter().filter(|&&n| n > 1).map(|&n| ln_factorial(n)).sum::<f64>()
}

/// The plug-in form `-N sum p_i ln p_i` with `p_i = n_i/N`, Stirling's approximation of the former. In equilibrium it is
/// on average [`plug_in_bias`] below `N ln K`.
pub fn plug_in_entropy(occupation: &[u64]) -> f64 {
    let total = occupation.iter().sum::<u64>() as f64;
    -occupation.iter().filter(|&&n| n > 0).map(|&n| n as f64 * libm::log(n as f64 / total)).sum::<f64>()
}

/// Bias of the plug-in form over `cells` cells, `-(K - 1)/2`, to leading order in `K/N` (Miller 1955).
pub fn plug_in_bias(cells: usize) -> f64 {
    -0.5 * (cells as f64 - 1.0)
}

/// Mean and variance of [`configurational_entropy`] in equilibrium, where each of `particles` independent particles is in
/// each of `cells` cells with equal probability.
///
/// Exact, from the multinomial distribution's marginals: one cell's number is binomial `(N, 1/K)`, and given that, another's is
/// `(N - n, 1/(K - 1))`. Hard cores of packing fraction `eta` suppress fluctuations: the measured mean is then a little
/// higher, by half the missing variance a cell. For many particles a cell the variance is `(K - 1)/2`.
pub fn equilibrium_entropy(particles: u64, cells: usize) -> (f64, f64) {
    let k = cells as f64;
    if cells < 2 || particles == 0 {
        return (0.0, 0.0);
    }
    let share = 1.0 / k;
    let single = binomial(particles, share);
    let expectation = |f: &dyn Fn(u64) -> f64| single.iter().map(|&(n, p)| p * f(n)).sum::<f64>();
    let mean_ln = expectation(&ln_factorial);
    // The numbers' sum is fixed: a line may be taken off ln n! without changing the variance of its sum over the cells. With
    // the slope ln(N/K) little is left that would cancel.
    let middle = particles as f64 * share;
    let slope = libm::log(middle.max(1.0));
    let line = mean_ln - slope * middle;
    let f = |n: u64| ln_factorial(n) - line - slope * n as f64;
    let variance = expectation(&|n| f(n) * f(n));
    let covariance = expectation(&|n| {
        let given: f64 = binomial(particles - n, 1.0 / (k - 1.0)).iter().map(|&(m, p)| p * f(m)).sum();
        f(n) * given
    });
    (ln_factorial(particles) - k * mean_ln, k * (variance + (k - 1.0) * covariance))
}

/// The binomial distribution as `(n, probability)`, without its tails beyond 12 standard deviations and 12 counts.
fn binomial(trials: u64, p: f64) -> Vec<(u64, f64)> {
    if p >= 1.0 {
        return vec![(trials, 1.0)];
    }
    let mean = trials as f64 * p;
    let reach = 12.0 * (mean * (1.0 - p)).sqrt() + 12.0;
    let (from, to) = ((mean - reach).max(0.0) as u64, ((mean + reach) as u64).min(trials));
    let (ln_p, ln_q, ln_trials) = (libm::log(p), libm::log1p(-p), ln_factorial(trials));
    let ln_weight = |n: u64| {
        let rest = (trials - n) as f64;
        ln_trials - ln_factorial(n) - ln_gamma(rest + 1.0) + n as f64 * ln_p + rest * ln_q
    };
    (from..=to).map(|n| (n, libm::exp(ln_weight(n)))).collect()
}

/// Entropy gained by `particles` ideal particles in a free expansion: `N ln(V2/V1)`, accessible volumes.
pub fn free_expansion(particles: u64, from_volume: f64, to_volume: f64) -> f64 {
    particles as f64 * libm::log(to_volume / from_volume)
}

/// Entropy gained when ideal gases mix, each `(N_i, V_i)` spreading over the whole `volume`: `sum N_i ln(V/V_i)`.
pub fn mixing(gases: &[(u64, f64)], volume: f64) -> f64 {
    gases.iter().map(|&(particles, own)| free_expansion(particles, own, volume)).sum()
}

/// Mean and standard deviation of the number of independent particles in a part of the volume: `N p`, `sqrt(N p (1 - p))`.
/// All of them are there with probability `p^N`.
pub fn occupation_of_part(particles: u64, part: f64) -> (f64, f64) {
    let n = particles as f64;
    (n * part, (n * part * (1.0 - part)).sqrt())
}

/// Entropy of momenta and places of an ideal gas in `dimension` dimensions, Sackur and Tetrode without Planck's constant:
/// `N (ln(V/N) + (d/2) ln(2 pi m kT) + d/2 + 1)`, up to a constant a particle. Differences are what it is for.
pub fn ideal_gas(particles: u64, dimension: usize, volume: f64, temperature: f64, mass: f64) -> f64 {
    let (n, half) = (particles as f64, 0.5 * dimension as f64);
    n * (libm::log(volume / n) + half * libm::log(2.0 * PI * mass * temperature) + half + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Estimate;
    use corpuscle_core::Random;

    #[test]
    fn cells_tile_the_accessible_room() {
        let room = Boundary::new([0.0, 0.0], [10.0, 4.0], Axis::Walls);
        let cells = Cells::new(&room, 0.5, [3, 2]);
        assert_eq!(cells.len(), 6);
        for (point, index) in [([0.5, 0.5], 0), ([3.6, 0.6], 1), ([9.5, 0.5], 2), ([0.5, 2.1], 3), ([9.5, 3.5], 5)] {
            assert_eq!(cells.index(Vector(point)), index);
        }
        assert_eq!(cells.occupation(&[Vector([0.6, 0.6]), Vector([9.0, 3.0])]), [1, 0, 0, 0, 0, 1]);
    }

    /// Three particles over two cells, counted by hand: W = 1, 3, 3, 1 with probabilities 1/8, 3/8, 3/8, 1/8.
    #[test]
    fn three_particles_in_two_cells() {
        let (mean, variance) = equilibrium_entropy(3, 2);
        let ln3 = libm::log(3.0);
        assert!((mean - 0.75 * ln3).abs() < 1e-14);
        assert!((variance - 0.75 * 0.25 * ln3 * ln3).abs() < 1e-14);
        assert!((configurational_entropy(&[1, 2]) - ln3).abs() < 1e-14);
        assert_eq!(plug_in_entropy(&[4, 0]), 0.0);
    }

    #[test]
    fn independent_particles_have_the_equilibrium_mean_and_variance() {
        for (particles, cells) in [(30, 16), (200, 4), (1000, 20)] {
            let mut random = Random::new(particles, 40);
            let entropies: Vec<f64> = (0..20_000)
                .map(|_| {
                    let mut counts = vec![0; cells];
                    (0..particles).for_each(|_| counts[random.below(cells as u32) as usize] += 1);
                    configurational_entropy(&counts)
                })
                .collect();
            let (mean, variance) = equilibrium_entropy(particles, cells);
            let measured = Estimate::from_replicas(&entropies);
            let squares = Estimate::from_replicas(&entropies.iter().map(|s| (s - mean) * (s - mean)).collect::<Vec<_>>());
            println!("{particles} in {cells}: {mean:.4} {variance:.4}: {measured:?} {squares:?}");
            assert!(measured.score(mean).abs() < 4.0 && squares.score(variance).abs() < 4.0);
        }
    }

    /// Many particles a cell: `S = S_max - chi^2/2`, so the variance is `(K - 1)/2`, corrections being of order `K/N`.
    #[test]
    fn large_cells_have_gaussian_fluctuations() {
        let (particles, cells) = (1_000_000, 8);
        let (_, variance) = equilibrium_entropy(particles, cells);
        assert!((variance / 3.5 - 1.0).abs() < 1e-4, "{variance}");
    }

    #[test]
    fn the_plug_in_form_has_its_bias() {
        let (particles, cells) = (2000u64, 20usize);
        let mut random = Random::new(2, 41);
        let entropies: Vec<f64> = (0..20_000)
            .map(|_| {
                let mut counts = vec![0; cells];
                (0..particles).for_each(|_| counts[random.below(cells as u32) as usize] += 1);
                plug_in_entropy(&counts) - particles as f64 * libm::log(cells as f64)
            })
            .collect();
        let measured = Estimate::from_replicas(&entropies);
        // The next order of the bias is -(K^2 - 1)/(12 N) for equal cells (Harris 1975): 0.0166 here, half a standard error.
        let next = -((cells * cells) as f64 - 1.0) / (12.0 * particles as f64);
        assert!(measured.score(plug_in_bias(cells) + next).abs() < 4.0, "{measured:?}");
    }

    /// The cells' entropy grows by `N ln(V2/V1)` to leading order: here over 2 of 4 to 4 of 4 equal cells.
    #[test]
    fn free_expansion_is_the_ideal_gas_difference() {
        let gain = ideal_gas(100, 2, 8.0, 1.0, 1.0) - ideal_gas(100, 2, 4.0, 1.0, 1.0);
        assert!((gain - free_expansion(100, 4.0, 8.0)).abs() < 1e-11);
        assert!((mixing(&[(100, 4.0), (50, 4.0)], 8.0) - 150.0 * libm::log(2.0)).abs() < 1e-11);
        let cells = equilibrium_entropy(1_000_000, 4).0 - equilibrium_entropy(1_000_000, 2).0;
        assert!((cells / free_expansion(1_000_000, 1.0, 2.0) - 1.0).abs() < 1e-4);
    }
}
