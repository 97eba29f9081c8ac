//! The nearest image, written so that a compiler can vectorise it.

use corpuscle_core::{Axis, Boundary, Vector};

/// Side and half side of the box along each axis; half is infinite along an axis that is not periodic.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearestImage<const D: usize> {
    side: [f64; D],
    half: [f64; D],
}

impl<const D: usize> NearestImage<D> {
    pub(crate) fn new(boundary: &Boundary<D>) -> Self {
        let side = boundary.extent().0;
        let half = std::array::from_fn(|k| if boundary.axes[k] == Axis::Periodic { 0.5 * side[k] } else { f64::INFINITY });
        Self { side, half }
    }

    /// The nearest image of the component `difference` along axis `k`, for two points less than one and a half sides apart:
    /// two selections and no call to a rounding function, which the default x86-64 target lacks.
    #[inline]
    pub(crate) fn component(&self, k: usize, difference: f64) -> f64 {
        let down = if difference > self.half[k] { self.side[k] } else { 0.0 };
        let up = if difference < -self.half[k] { self.side[k] } else { 0.0 };
        difference - down + up
    }

    /// The nearest image of `to - from`.
    #[inline]
    pub(crate) fn displacement(&self, from: Vector<D>, to: Vector<D>) -> Vector<D> {
        Vector::from_fn(|k| self.component(k, to[k] - from[k]))
    }
}
