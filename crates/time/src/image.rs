//! The nearest image, written so that a compiler can vectorise it.

use corpuscle_core::{Axis, Boundary, Vector};

/// Side of the box along each axis and its inverse; both zero along an axis that is not periodic.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearestImage<const D: usize> {
    side: [f64; D],
    inverse: [f64; D],
}

/// `1.5 * 2^52`: a small number added to it and taken off again is rounded to an integer, without a call to a rounding function,
/// which the default x86-64 target lacks.
const ROUND: f64 = 6_755_399_441_055_744.0;

impl<const D: usize> NearestImage<D> {
    pub(crate) fn new(boundary: &Boundary<D>) -> Self {
        let side = std::array::from_fn(|k| if boundary.axes[k] == Axis::Periodic { boundary.extent()[k] } else { 0.0 });
        Self { side, inverse: side.map(|side| if side > 0.0 { 1.0 / side } else { 0.0 }) }
    }

    /// The nearest image of the component `difference` along axis `k`, for two points less than one and a half sides apart.
    #[inline(always)]
    pub(crate) fn component(&self, k: usize, difference: f64) -> f64 {
        let sides = difference * self.inverse[k];
        let sides = if sides < 1.0 { sides } else { 1.0 };
        let sides = if sides > -1.0 { sides } else { -1.0 };
        difference - ((sides + ROUND) - ROUND) * self.side[k]
    }

    /// The nearest image of `to - from`.
    #[inline]
    pub(crate) fn displacement(&self, from: Vector<D>, to: Vector<D>) -> Vector<D> {
        Vector::from_fn(|k| self.component(k, to[k] - from[k]))
    }
}
