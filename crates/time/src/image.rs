//! The nearest image, written so that a compiler can vectorise it.

use corpuscle_core::{Axis, Boundary, Vector};

use crate::lanes::Lanes;

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

    /// The nearest image of the component `difference` along axis `k`.
    #[inline(always)]
    pub(crate) fn component(&self, k: usize, difference: f64) -> f64 {
        difference - ((difference * self.inverse[k] + ROUND) - ROUND) * self.side[k]
    }

    /// The nearest image of `to - from`.
    #[inline]
    pub(crate) fn displacement(&self, from: Vector<D>, to: Vector<D>) -> Vector<D> {
        Vector::from_fn(|k| self.component(k, to[k] - from[k]))
    }

    /// The same for four differences at once.
    #[inline(always)]
    pub(crate) fn in_lanes<V: Lanes>(&self) -> NearestImages<V, D> {
        let mut images = NearestImages { side: [V::splat(0.0); D], inverse: [V::splat(0.0); D], round: V::splat(ROUND) };
        for k in 0..D {
            (images.side[k], images.inverse[k]) = (V::splat(self.side[k]), V::splat(self.inverse[k]));
        }
        images
    }
}

/// [`NearestImage`] in lanes.
#[derive(Clone, Copy)]
pub(crate) struct NearestImages<V, const D: usize> {
    side: [V; D],
    inverse: [V; D],
    round: V,
}

impl<V: Lanes, const D: usize> NearestImages<V, D> {
    #[inline(always)]
    pub(crate) fn component(&self, k: usize, difference: V) -> V {
        let sides = difference.mul(self.inverse[k]).add(self.round).sub(self.round);
        difference.sub(sides.mul(self.side[k]))
    }
}
