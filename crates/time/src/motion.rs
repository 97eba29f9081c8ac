//! Kicks and drifts of whole arrays.

use corpuscle_core::instructions::Kernel;

/// Numbers handled together.
const LANES: usize = 8;

/// `v += a dt`, component by component. Tells whether every result is a finite number.
pub(crate) struct Kick<'a> {
    pub(crate) velocity: &'a mut [f64],
    pub(crate) acceleration: &'a [f64],
    pub(crate) dt: f64,
}

impl Kernel for Kick<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let (velocities, last_velocities) = self.velocity.as_chunks_mut::<LANES>();
        let (accelerations, last_accelerations) = self.acceleration.as_chunks::<LANES>();
        let mut doubt = Doubt::default();
        for (velocity, acceleration) in velocities.iter_mut().zip(accelerations) {
            let mut v = *velocity; // a copy, so that nothing read can depend on something written
            for lane in 0..LANES {
                v[lane] += acceleration[lane] * self.dt;
            }
            doubt.consider(&v);
            *velocity = v;
        }
        for (v, a) in last_velocities.iter_mut().zip(last_accelerations) {
            *v += a * self.dt;
            doubt.consider(&[*v; LANES]);
        }
        doubt.is_none()
    }
}

/// `v += a kick`, then `r += v drift`, component by component. Tells whether every `r` is a finite number.
pub(crate) struct KickAndDrift<'a> {
    pub(crate) position: &'a mut [f64],
    pub(crate) velocity: &'a mut [f64],
    pub(crate) acceleration: &'a [f64],
    pub(crate) kick: f64,
    pub(crate) drift: f64,
}

impl Kernel for KickAndDrift<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let Self { kick, drift, .. } = self;
        let (positions, last_positions) = self.position.as_chunks_mut::<LANES>();
        let (velocities, last_velocities) = self.velocity.as_chunks_mut::<LANES>();
        let (accelerations, last_accelerations) = self.acceleration.as_chunks::<LANES>();
        let mut doubt = Doubt::default();
        for ((position, velocity), acceleration) in positions.iter_mut().zip(velocities).zip(accelerations) {
            let (mut r, mut v) = (*position, *velocity);
            for lane in 0..LANES {
                v[lane] += acceleration[lane] * kick;
                r[lane] += v[lane] * drift;
            }
            doubt.consider(&r);
            (*position, *velocity) = (r, v);
        }
        for ((r, v), a) in last_positions.iter_mut().zip(last_velocities).zip(last_accelerations) {
            *v += a * kick;
            *r += *v * drift;
            doubt.consider(&[*r; LANES]);
        }
        doubt.is_none()
    }
}

/// Sums of products with zero: they stay zero unless a factor is infinite or no number.
#[derive(Default)]
struct Doubt([f64; LANES]);

impl Doubt {
    #[inline(always)]
    fn consider(&mut self, numbers: &[f64; LANES]) {
        for lane in 0..LANES {
            self.0[lane] += numbers[lane] * 0.0;
        }
    }

    #[inline(always)]
    fn is_none(&self) -> bool {
        self.0.iter().sum::<f64>() == 0.0
    }
}
