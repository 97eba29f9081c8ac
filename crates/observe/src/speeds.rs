//! The distribution of speeds, and Boltzmann's H.

use std::f64::consts::PI;

use corpuscle_core::particles::ball_volume;

use crate::Estimate;
use crate::distribution::{incomplete_beta, ln_gamma};

/// The equilibrium distribution of the speed of one particle in two or three dimensions.
///
/// In contact with a bath it is Maxwell's: `(m v/kT) exp(-m v^2/2kT)` in 2-D, `sqrt(2/pi) (m/kT)^(3/2) v^2 exp(-m v^2/2kT)`
/// in 3-D. `N` particles alone share a fixed energy: their velocities are uniform on a sphere in `f` dimensions, so that
/// `v^2 / v_max^2` has the beta distribution `(d/2, (f - d)/2)`, exactly and for any `N`; it tends to Maxwell's as `1/N`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedDistribution {
    dimension: usize,
    /// `kT/m`.
    variance: f64,
    /// `(v_max^2, (f - d)/2)` of a closed system.
    closed: Option<(f64, f64)>,
}

impl SpeedDistribution {
    /// Maxwell's distribution for particles of this mass in a bath of this temperature.
    pub fn maxwell(dimension: usize, temperature: f64, mass: f64) -> Self {
        Self { dimension, variance: temperature / mass, closed: None }
    }

    /// The distribution in a closed system of `particles` equal particles, whose temperature is `2 E/f` with
    /// `f = d (N - 1)` degrees of freedom where total momentum is zero and conserved, `d N` between walls.
    pub fn closed(dimension: usize, particles: usize, momentum_conserved: bool, temperature: f64, mass: f64) -> Self {
        let (d, n) = (dimension as f64, particles as f64);
        let freedom = if momentum_conserved { d * (n - 1.0) } else { d * n };
        // With the others moving the other way, one particle can have all energy but its share of the centre of mass's.
        let share = if momentum_conserved { (n - 1.0) / n } else { 1.0 };
        let variance = temperature / mass;
        Self { dimension, variance, closed: Some((freedom * variance * share, 0.5 * (freedom - d))) }
    }

    /// Probability that the speed is at most `speed`.
    pub fn cumulative(&self, speed: f64) -> f64 {
        let square = speed * speed;
        if speed <= 0.0 {
            return 0.0;
        }
        if let Some((most, b)) = self.closed {
            return incomplete_beta((square / most).min(1.0), 0.5 * self.dimension as f64, b);
        }
        let x = 0.5 * square / self.variance;
        match self.dimension {
            2 => -libm::expm1(-x),
            _ => libm::erf(x.sqrt()) - 2.0 * (x / PI).sqrt() * libm::exp(-x),
        }
    }

    /// Probability density of the speed.
    pub fn density(&self, speed: f64) -> f64 {
        if speed <= 0.0 {
            return 0.0;
        }
        let half = 0.5 * self.dimension as f64;
        if let Some((most, b)) = self.closed {
            let x = speed * speed / most;
            if x >= 1.0 {
                return 0.0;
            }
            let ln_beta = ln_gamma(half) + ln_gamma(b) - ln_gamma(half + b);
            return 2.0 / speed * libm::exp(half * libm::log(x) + (b - 1.0) * libm::log1p(-x) - ln_beta);
        }
        let x = 0.5 * speed * speed / self.variance;
        2.0 / speed * libm::exp(half * libm::log(x) - x - ln_gamma(half))
    }

    /// Probabilities of the bins between these edges.
    pub fn probabilities(&self, edges: &[f64]) -> Vec<f64> {
        edges.windows(2).map(|w| self.cumulative(w[1]) - self.cumulative(w[0])).collect()
    }
}

/// Boltzmann's `H = int f ln f d^dv` of independent velocities, from the counts of their speeds between `edges`, where `f` is
/// taken as constant in each shell. Speeds beyond the last edge are left out: choose it high enough.
///
/// The plug-in form is too high by `(K - 1)/(2N)` for `K` occupied bins (Miller 1955); that is taken off.
pub fn boltzmann_h(counts: &[u64], edges: &[f64], dimension: usize) -> Estimate {
    let total = counts.iter().sum::<u64>() as f64;
    let terms: Vec<(f64, f64)> = counts
        .iter()
        .zip(edges.windows(2))
        .filter(|&(&n, _)| n > 0)
        .map(|(&n, w)| {
            let p = n as f64 / total;
            (p, libm::log(p / shell(dimension, w[0], w[1])))
        })
        .collect();
    let plug_in: f64 = terms.iter().map(|(p, ln)| p * ln).sum();
    let variance: f64 = terms.iter().map(|(p, ln)| p * (ln - plug_in) * (ln - plug_in)).sum();
    Estimate::new(plug_in - 0.5 * (terms.len() as f64 - 1.0) / total, (variance / total).sqrt())
}

/// What [`boltzmann_h`] is in the mean for a known distribution seen through the same bins.
pub fn binned_h(distribution: &SpeedDistribution, edges: &[f64]) -> f64 {
    let probabilities = distribution.probabilities(edges);
    let total: f64 = probabilities.iter().sum();
    let term = |(p, w): (&f64, &[f64])| p / total * libm::log(p / total / shell(distribution.dimension, w[0], w[1]));
    probabilities.iter().zip(edges.windows(2)).filter(|(p, _)| **p > 0.0).map(term).sum()
}

/// Equilibrium value of `H` in Maxwell's distribution: `-(d/2) (1 + ln(2 pi kT/m))`.
pub fn equilibrium_h(dimension: usize, temperature: f64, mass: f64) -> f64 {
    -0.5 * dimension as f64 * (1.0 + libm::log(2.0 * PI * temperature / mass))
}

/// Volume of a shell in velocity space.
pub fn shell(dimension: usize, inner: f64, outer: f64) -> f64 {
    match dimension {
        2 => ball_volume::<2>(outer) - ball_volume::<2>(inner),
        _ => ball_volume::<3>(outer) - ball_volume::<3>(inner),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Histogram;
    use crate::estimate::tests::assert_standard_normal;
    use crate::theory::mean_speed;
    use corpuscle_core::{Particles, Random, Vector, placement};

    #[test]
    fn densities_are_derivatives_and_have_the_known_mean() {
        for distribution in [
            SpeedDistribution::maxwell(2, 1.3, 0.7),
            SpeedDistribution::maxwell(3, 1.3, 0.7),
            SpeedDistribution::closed(2, 7, true, 1.3, 0.7),
            SpeedDistribution::closed(3, 5, false, 1.3, 0.7),
        ] {
            let h = 1e-4;
            for v in [0.3, 1.0, 2.0] {
                let slope = (distribution.cumulative(v + h) - distribution.cumulative(v - h)) / (2.0 * h);
                assert!((slope / distribution.density(v) - 1.0).abs() < 1e-6);
            }
        }
        // Mean speed as the integral of 1 - F, by Simpson's rule.
        for (d, expected) in [(2, mean_speed::<2>(1.3, 0.7)), (3, mean_speed::<3>(1.3, 0.7))] {
            let distribution = SpeedDistribution::maxwell(d, 1.3, 0.7);
            let h = 0.005;
            let weight = |k: u32| if k == 0 { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
            let mean: f64 = (0..4000u32).map(|k| weight(k) * (1.0 - distribution.cumulative(f64::from(k) * h)) * h / 3.0).sum();
            assert!((mean / expected - 1.0).abs() < 1e-9);
        }
    }

    /// Ten particles with exactly the energy of the temperature: Maxwell's law is wrong, the closed one right.
    #[test]
    fn a_small_closed_system_follows_its_own_law() {
        let speeds = |seed: u64, histogram: &mut Histogram| {
            let mut random = Random::new(seed, 60);
            let mut particles = Particles::<2>::new();
            (0..10).for_each(|_| {
                particles.push(Vector::ZERO, Vector::ZERO, 2.0, 0.1, 0);
            });
            placement::maxwell(&mut particles, 1.5, true, &mut random);
            histogram.add(particles.velocity[0].norm());
        };
        let mut histogram = Histogram::new(0.0, 2.5, 25);
        (0..40_000).for_each(|seed| speeds(seed, &mut histogram));
        let against = |law: SpeedDistribution| histogram.chi_squared(|v| law.cumulative(v), 1.0, 0).unwrap().score();
        let (closed, maxwell) =
            (against(SpeedDistribution::closed(2, 10, true, 1.5, 2.0)), against(SpeedDistribution::maxwell(2, 1.5, 2.0)));
        println!("closed {closed:.2}, Maxwell {maxwell:.2}");
        assert!(closed.abs() < 4.0 && maxwell > 4.0);
    }

    /// All speeds of systems with fixed energy: one constraint takes one degree of freedom (a little less with finite bins).
    #[test]
    fn fixed_energy_costs_a_degree_of_freedom() {
        let law = SpeedDistribution::closed(3, 500, true, 1.0, 1.0);
        let scores: Vec<f64> = (0..600)
            .map(|seed| {
                let mut random = Random::new(seed, 61);
                let mut particles = Particles::<3>::new();
                (0..500).for_each(|_| {
                    particles.push(Vector::ZERO, Vector::ZERO, 1.0, 0.1, 0);
                });
                placement::maxwell(&mut particles, 1.0, true, &mut random);
                let mut histogram = Histogram::new(0.0, 4.5, 30);
                particles.velocity.iter().for_each(|v| histogram.add(v.norm()));
                histogram.chi_squared(|v| law.cumulative(v), 1.0, 1).unwrap().score()
            })
            .collect();
        assert_standard_normal("speeds of a closed gas", &scores);
    }

    #[test]
    fn boltzmanns_h_of_maxwellian_speeds_is_standard_normal() {
        let law = SpeedDistribution::maxwell(3, 2.0, 1.0);
        let edges: Vec<f64> = (0..=40).map(|k| 0.25 * f64::from(k)).collect();
        let expected = binned_h(&law, &edges);
        assert!((expected - equilibrium_h(3, 2.0, 1.0)).abs() < 0.01, "{expected}");
        let scores: Vec<f64> = (0..600)
            .map(|seed| {
                let mut random = Random::new(seed, 62);
                let mut histogram = Histogram::new(0.0, 10.0, 40);
                for _ in 0..3000 {
                    histogram.add(2f64.sqrt() * Vector::<3>::from_fn(|_| random.normal()).norm());
                }
                boltzmann_h(histogram.counts(), &edges, 3).score(expected)
            })
            .collect();
        assert_standard_normal("H", &scores);
    }
}
