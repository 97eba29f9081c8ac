//! A fixed round body in the box.

use crate::{Boundary, Invalid, Vector};

/// A fixed hard sphere (disc in 2-D): a peg of a Galton board, a scatterer of a Lorentz gas. Obstacles may overlap one
/// another and stick out of walls.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Obstacle<const D: usize> {
    /// Where its centre is, in the box.
    pub centre: Vector<D>,
    /// Its radius.
    pub radius: f64,
}

impl<const D: usize> Obstacle<D> {
    pub(super) fn validate(&self, boundary: &Boundary<D>) -> Result<(), Invalid> {
        let inside = (0..D).all(|k| boundary.lower[k] <= self.centre[k] && self.centre[k] <= boundary.upper[k]);
        if !(self.centre.is_finite() && inside) {
            return Err(Invalid::new("obstacle centre", format!("{:?}", self.centre.0), "a place in the box"));
        }
        if !(self.radius >= 0.0 && self.radius.is_finite()) {
            return Err(Invalid::new("obstacle radius", self.radius, "a finite number, zero or more"));
        }
        Ok(())
    }
}
