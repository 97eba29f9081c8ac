//! A point or an arrow in `D` dimensions.

use bytemuck::TransparentWrapper;
use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, Neg, Sub, SubAssign};

/// A vector of `D` real components, with the arithmetic of a vector space and the Euclidean inner product.
///
/// The dimension is a constant of the type: 2-D and 3-D are one code, compiled twice.
///
/// ```
/// use corpuscle_core::Vector;
/// let a = Vector([3.0, 4.0]);
/// assert_eq!(a.norm(), 5.0);
/// assert_eq!(2.0 * a - a, a);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::TransparentWrapper, serde::Serialize, serde::Deserialize)]
#[repr(transparent)]
#[serde(transparent)]
pub struct Vector<const D: usize>(#[serde(with = "crate::array")] pub [f64; D]);

impl<const D: usize> Vector<D> {
    /// The null vector.
    pub const ZERO: Self = Self([0.0; D]);

    /// The vector whose every component is `value`.
    #[inline]
    pub const fn splat(value: f64) -> Self {
        Self([value; D])
    }

    /// The unit vector along `axis`.
    #[inline]
    pub fn unit(axis: usize) -> Self {
        let mut unit = Self::ZERO;
        unit[axis] = 1.0;
        unit
    }

    /// The vector with components `f(0), f(1), ...`.
    #[inline]
    pub fn from_fn(f: impl FnMut(usize) -> f64) -> Self {
        Self(std::array::from_fn(f))
    }

    /// The components of many vectors as one array of numbers, vector by vector.
    #[inline]
    pub fn components(vectors: &[Self]) -> &[f64] {
        Self::peel_slice(vectors).as_flattened()
    }

    /// [`components`](Self::components), to be changed.
    #[inline]
    pub fn components_mut(vectors: &mut [Self]) -> &mut [f64] {
        Self::peel_slice_mut(vectors).as_flattened_mut()
    }

    /// Inner product, summed in the order of the axes.
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        let mut sum = self.0[0] * other.0[0];
        for axis in 1..D {
            sum += self.0[axis] * other.0[axis];
        }
        sum
    }

    /// Square of the length.
    #[inline]
    pub fn norm_squared(self) -> f64 {
        self.dot(self)
    }

    /// Length.
    #[inline]
    pub fn norm(self) -> f64 {
        self.norm_squared().sqrt()
    }

    /// Component by component, `f(self_k)`.
    #[inline]
    #[must_use]
    pub fn map(self, f: impl FnMut(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    /// Whether every component is a finite number.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }

    /// The vector in three dimensions, missing components zero: what a picture needs.
    #[inline]
    pub fn to_three(self) -> [f64; 3] {
        std::array::from_fn(|axis| if axis < D { self.0[axis] } else { 0.0 })
    }
}

impl<const D: usize> Default for Vector<D> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const D: usize> Index<usize> for Vector<D> {
    type Output = f64;
    #[inline]
    fn index(&self, axis: usize) -> &f64 {
        &self.0[axis]
    }
}

impl<const D: usize> IndexMut<usize> for Vector<D> {
    #[inline]
    fn index_mut(&mut self, axis: usize) -> &mut f64 {
        &mut self.0[axis]
    }
}

impl<const D: usize> Add for Vector<D> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::from_fn(|k| self.0[k] + other.0[k])
    }
}

impl<const D: usize> Sub for Vector<D> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::from_fn(|k| self.0[k] - other.0[k])
    }
}

impl<const D: usize> Neg for Vector<D> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

impl<const D: usize> Mul<f64> for Vector<D> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        self.map(|x| x * factor)
    }
}

impl<const D: usize> Mul<Vector<D>> for f64 {
    type Output = Vector<D>;
    #[inline]
    fn mul(self, vector: Vector<D>) -> Vector<D> {
        vector * self
    }
}

impl<const D: usize> Div<f64> for Vector<D> {
    type Output = Self;
    #[inline]
    fn div(self, divisor: f64) -> Self {
        self.map(|x| x / divisor)
    }
}

impl<const D: usize> AddAssign for Vector<D> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const D: usize> SubAssign for Vector<D> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn inner_product_is_symmetric_and_cauchy_schwarz_holds(
            a in prop::array::uniform3(-1e3..1e3f64), b in prop::array::uniform3(-1e3..1e3f64)
        ) {
            let (a, b) = (Vector(a), Vector(b));
            prop_assert_eq!(a.dot(b), b.dot(a));
            prop_assert!(a.dot(b).abs() <= a.norm() * b.norm() * (1.0 + 1e-14));
        }
    }
}
