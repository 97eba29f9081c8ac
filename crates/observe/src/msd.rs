//! Mean squared displacement and diffusion.

use corpuscle_checkpoint::resume;
use corpuscle_core::Vector;

use crate::correlator::Correlator;
use crate::{Curves, Estimate};

/// Lags at each doubling: sixteen a level, eight new ones an octave.
const REACH: usize = 16;

/// Mean squared displacement `<|r(t + lag) - r(t)|^2>` over many time origins `t`, on a grid of lags with eight points an
/// octave, one curve a tracer. Tracers count as replicas: far apart in a dilute bath they are independent; otherwise join
/// the curves of independent runs.
#[derive(Clone, Debug)]
pub struct MeanSquaredDisplacement<const D: usize> {
    correlator: Correlator<D>,
}
resume!(MeanSquaredDisplacement<const D> { values: [], parts: [correlator] });

impl<const D: usize> MeanSquaredDisplacement<D> {
    /// Samples will come at this interval.
    pub fn new(interval: f64) -> Self {
        Self { correlator: Correlator::new(interval, REACH, 48, |then, now| (now - then).norm_squared()) }
    }

    /// The next sample: unwrapped positions ([`Unwrap`](crate::Unwrap)), always the same tracers.
    pub fn push(&mut self, positions: &[Vector<D>]) {
        self.correlator.push(positions);
    }

    /// The mean squared displacement of each tracer against the lag, starting with zero at lag zero.
    pub fn curves(&self) -> Curves {
        self.correlator.curves()
    }
}

/// Diffusion coefficient: the slope of the mean squared displacement over `2 d`, fitted for `from <= lag <= to` in each
/// replica. Start where memory has ended: in an Ornstein-Uhlenbeck process the slope is low by `exp(-gamma from)`; end well
/// before the length of the run, since few origins are left there.
pub fn diffusion(displacements: &Curves, dimension: usize, from: f64, to: f64) -> Estimate {
    displacements.slope(from, to) / (2.0 * dimension as f64)
}

/// Kurtosis `<x^4> / <x^2>^2` of independent displacements along one axis, of mean zero: 3 when they are Gaussian.
pub fn kurtosis(displacements: &[f64]) -> Estimate {
    let powers: Vec<[f64; 2]> = displacements.iter().map(|x| [x * x, x * x * x * x]).collect();
    Estimate::jackknife(&powers, |[second, fourth]| fourth / (second * second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::tests::assert_standard_normal;
    use crate::theory::{diffusion_coefficient, ornstein_uhlenbeck_displacement};
    use crate::vacf::tests::ornstein_uhlenbeck;

    const INTERVAL: f64 = 0.25;

    #[test]
    fn ornstein_uhlenbeck_particles_follow_their_curve() {
        let (gamma, temperature, mass) = (0.8, 1.5, 4.0);
        let expected = diffusion_coefficient(temperature, mass, gamma);
        let (mut slopes, mut curve) = (vec![], vec![]);
        for seed in 0..300 {
            let mut msd = MeanSquaredDisplacement::<2>::new(INTERVAL);
            ornstein_uhlenbeck(seed, 6, 800, INTERVAL, gamma, temperature / mass, |positions, _| msd.push(positions));
            let curves = msd.curves();
            // The slope is low by exp(-gamma 10) = 0.03 %, a hundredth of the error.
            slopes.push(diffusion(&curves, 2, 10.0, 30.0).score(expected));
            let point = curves.points()[12];
            curve.push(point.1.score(ornstein_uhlenbeck_displacement(2, temperature, mass, gamma, point.0)));
        }
        assert_standard_normal("diffusion by slope", &slopes);
        assert_standard_normal("displacement at lag 3", &curve);
    }

    #[test]
    fn gaussian_displacements_have_kurtosis_three() {
        let scores: Vec<f64> = (0..400)
            .map(|seed| {
                let mut random = corpuscle_core::Random::new(seed, 33);
                kurtosis(&(0..4000).map(|_| 1.7 * random.normal()).collect::<Vec<_>>()).score(3.0)
            })
            .collect();
        assert_standard_normal("kurtosis", &scores);
    }

    #[test]
    fn one_tracer_has_no_error() {
        let mut msd = MeanSquaredDisplacement::<2>::new(1.0);
        (0..10).for_each(|t| msd.push(&[Vector([f64::from(t), 0.0])]));
        let (lag, value) = msd.curves().points()[3];
        assert_eq!((lag, value.mean), (3.0, 9.0));
        assert!(value.standard_error.is_nan());
    }
}
