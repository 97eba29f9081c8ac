//! Velocity autocorrelation, initial friction and the Green-Kubo integral.

use corpuscle_checkpoint::resume;
use corpuscle_core::Vector;

use crate::correlator::Correlator;
use crate::{Curves, Estimate};

/// Velocity autocorrelation `C(lag) = <v(t) . v(t + lag)>` over all time origins `t`, at every multiple of the sampling
/// interval up to a longest lag, one curve a tracer. Tracers count as replicas, as for
/// [`MeanSquaredDisplacement`](crate::MeanSquaredDisplacement).
#[derive(Clone, Debug)]
pub struct VelocityAutocorrelation<const D: usize> {
    correlator: Correlator<D>,
}
resume!(VelocityAutocorrelation<const D> { values: [], parts: [correlator] });

impl<const D: usize> VelocityAutocorrelation<D> {
    /// Samples will come at this interval.
    pub fn new(interval: f64, longest_lag: f64) -> Self {
        let reach = (longest_lag / interval).round().max(2.0) as usize;
        Self { correlator: Correlator::new(interval, reach, 1, Vector::dot) }
    }

    /// The next sample: velocities of always the same tracers.
    pub fn push(&mut self, velocities: &[Vector<D>]) {
        self.correlator.push(velocities);
    }

    /// The autocorrelation of each tracer against the lag, starting with `<v^2>` at lag zero.
    pub fn curves(&self) -> Curves {
        self.correlator.curves()
    }
}

/// Initial decay rate `gamma_0 = -C'(0) / C(0)` from the first three lags 0, `h`, `2h`.
///
/// With `L(t) = -ln(C(t)/C(0))`, `gamma_0 = (4 L(h) - L(2h)) / (2h)`: exact for an exponential; otherwise off by
/// `h^2 L'''(0) / 3`. Error by jackknife over the replicas, since the three correlations come from the same velocities.
/// Not a number with fewer than three lags.
pub fn initial_friction(correlations: &Curves) -> Estimate {
    let [_, h, _, ..] = correlations.x[..] else { return Estimate::new(f64::NAN, f64::NAN) };
    let starts: Vec<[f64; 3]> = correlations.y.iter().map(|c| [c[0], c[1], c[2]]).collect();
    Estimate::jackknife(&starts, |[c0, c1, c2]| (4.0 * libm::log(c0 / c1) - libm::log(c0 / c2)) / (2.0 * h))
}

/// Running integral `D(t) = (1/d) int_0^t C` at every second lag, by Simpson's rule, with standard errors.
///
/// The diffusion coefficient is its plateau. The error grows like `sqrt(t)` for ever, so choose where to read it before
/// looking: see [`green_kubo`].
pub fn running_integral(correlations: &Curves, dimension: usize) -> Curves {
    let h = correlations.x.get(1).map_or(0.0, |x1| x1 - correlations.x[0]);
    let integrate = |c: &Vec<f64>| -> Vec<f64> {
        let mut sum = 0.0;
        let panels = c.windows(3).step_by(2).map(|p| (p[0] + 4.0 * p[1] + p[2]) * h / (3.0 * dimension as f64));
        std::iter::once(0.0)
            .chain(panels.map(|panel| {
                sum += panel;
                sum
            }))
            .collect()
    };
    Curves { x: correlations.x.iter().copied().step_by(2).collect(), y: correlations.y.iter().map(integrate).collect() }
}

/// Diffusion coefficient by Green and Kubo (Kubo 1957, doi:10.1143/JPSJ.12.570): the running integral at the last even lag
/// that is at most `until`.
///
/// Take `until` from theory, not from the data, as some multiple of `1/gamma`: an exponential is then cut off by
/// `exp(-gamma until)`, and no wish decides where the plateau is. Simpson's rule adds `(gamma h)^4 / 180`. Integrals over short paths are skewed,
/// which few replicas do not average out: paths should last 50 times `until`, lest scores be low by a tenth.
pub fn green_kubo(correlations: &Curves, dimension: usize, until: f64) -> Estimate {
    let integral = running_integral(correlations, dimension);
    let Some(last) = integral.x.iter().rposition(|&x| x <= until * (1.0 + 1e-12)) else {
        return Estimate::new(f64::NAN, f64::NAN);
    };
    integral.estimate(|_, y| y[last])
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use crate::theory::diffusion_coefficient;
    use corpuscle_core::Random;

    /// Exact sampling of Ornstein-Uhlenbeck particles in equilibrium: velocity and displacement over a step are jointly
    /// Gaussian with known covariance (Gillespie 1996, doi:10.1103/PhysRevE.54.2084).
    pub(crate) fn ornstein_uhlenbeck<const D: usize>(
        seed: u64,
        tracers: usize,
        samples: usize,
        interval: f64,
        gamma: f64,
        variance: f64,
        mut sample: impl FnMut(&[Vector<D>], &[Vector<D>]),
    ) {
        let mut random = Random::new(seed, 31);
        let mut normal = || Vector::<D>::from_fn(|_| random.normal());
        let decay = (-gamma * interval).exp();
        let velocity_variance = variance * (1.0 - decay * decay);
        let path_variance = variance / (gamma * gamma) * (2.0 * gamma * interval - 3.0 + 4.0 * decay - decay * decay);
        let covariance = variance / gamma * (1.0 - decay) * (1.0 - decay);
        let along = covariance / velocity_variance.sqrt();
        let across = (path_variance - along * along).sqrt();
        let mut positions = vec![Vector::ZERO; tracers];
        let mut velocities: Vec<Vector<D>> = (0..tracers).map(|_| normal() * variance.sqrt()).collect();
        for _ in 0..samples {
            sample(&positions, &velocities);
            for (r, v) in positions.iter_mut().zip(&mut velocities) {
                let (a, b) = (normal(), normal());
                *r += *v * ((1.0 - decay) / gamma) + a * along + b * across;
                *v = *v * decay + a * velocity_variance.sqrt();
            }
        }
    }

    #[test]
    fn friction_and_diffusion_of_ornstein_uhlenbeck_particles_are_standard_normal() {
        let (gamma, variance, interval) = (0.5, 0.4, 0.2);
        let (mut frictions, mut diffusions, mut squares) = (vec![], vec![], vec![]);
        for seed in 0..200 {
            let mut vacf = VelocityAutocorrelation::<3>::new(interval, 16.0);
            ornstein_uhlenbeck(seed, 16, 4000, interval, gamma, variance, |_, velocities| vacf.push(velocities));
            let curves = vacf.curves();
            frictions.push(initial_friction(&curves).score(gamma));
            // Cut off at exp(-8) = 0.03 %, a hundredth of the error.
            diffusions.push(green_kubo(&curves, 3, 16.0).score(diffusion_coefficient(variance, 1.0, gamma)));
            squares.push(curves.points()[0].1.score(3.0 * variance));
        }
        assert_standard_normal("initial friction", &frictions);
        assert_standard_normal("Green-Kubo", &diffusions);
        assert_standard_normal("mean square velocity", &squares);
    }

    #[test]
    fn an_exponential_is_read_exactly() {
        let x: Vec<f64> = (0..101).map(|k| 0.1 * f64::from(k)).collect();
        let y = vec![x.iter().map(|t| 6.0 * libm::exp(-0.7 * t)).collect::<Vec<_>>(); 2];
        let curves = Curves { x, y };
        assert!((initial_friction(&curves).mean - 0.7).abs() < 1e-13);
        let expected = 2.0 / 0.7 * (1.0 - libm::exp(-7.0));
        let simpson = expected * 0.07f64.powi(4) / 180.0;
        assert!(((green_kubo(&curves, 3, 10.0).mean - expected) / simpson - 1.0).abs() < 0.01);
        assert!(initial_friction(&Curves::default()).mean.is_nan() && green_kubo(&Curves::default(), 3, 1.0).mean.is_nan());
    }
}
