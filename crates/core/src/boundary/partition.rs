//! A thin hard plate across the box, whole or with a slit.

use crate::{Boundary, Invalid, Vector};

/// An opening in a partition: the strip `from..to` along one axis, over the whole box along the others.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Hole {
    /// Axis along which the strip is measured; not the partition's own axis.
    pub along: usize,
    /// Where the strip starts.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

/// A thin hard plate perpendicular to `axis` at `position`, spanning the box.
///
/// It has no thickness: a particle touches its flat side when the centre is a radius away, and the rim of its hole
/// when the rim is a radius away from the centre.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Partition {
    /// Axis the plate is perpendicular to.
    pub axis: usize,
    /// Coordinate of the plate along that axis.
    pub position: f64,
    /// The opening, if any.
    pub hole: Option<Hole>,
    /// Physical time from which on the plate is gone.
    pub removed_at: Option<f64>,
}

impl Partition {
    /// A plate without a hole that stays.
    pub fn new(axis: usize, position: f64) -> Self {
        Self { axis, position, hole: None, removed_at: None }
    }

    /// The same with a hole.
    #[must_use]
    pub fn with_hole(self, along: usize, from: f64, to: f64) -> Self {
        Self { hole: Some(Hole { along, from, to }), ..self }
    }

    /// Whether the plate is there at this time.
    pub fn stands_at(&self, time: f64) -> bool {
        self.removed_at.is_none_or(|removed| time < removed)
    }

    /// Whether the plate is there at the point with these coordinates (that is, the point is not within the hole).
    #[inline]
    pub fn covers<const D: usize>(&self, point: Vector<D>) -> bool {
        self.hole.is_none_or(|hole| !(hole.from < point[hole.along] && point[hole.along] < hole.to))
    }

    /// Distance from a point to the plate.
    pub fn distance<const D: usize>(&self, point: Vector<D>) -> f64 {
        let across = (point[self.axis] - self.position).abs();
        match self.hole {
            Some(hole) if !self.covers(point) => {
                let along = (point[hole.along] - hole.from).min(hole.to - point[hole.along]);
                across.hypot(along)
            }
            _ => across,
        }
    }

    pub(super) fn validate<const D: usize>(&self, boundary: &Boundary<D>) -> Result<(), Invalid> {
        if self.axis >= D {
            return Err(Invalid::new("partition axis", self.axis, format!("an axis below {D}")));
        }
        let (lower, upper) = (boundary.lower[self.axis], boundary.upper[self.axis]);
        if !(lower < self.position && self.position < upper) {
            return Err(Invalid::new("partition position", self.position, format!("a place inside the box, {lower} to {upper}")));
        }
        if self.removed_at.is_some_and(f64::is_nan) {
            return Err(Invalid::new("partition removed_at", f64::NAN, "a time"));
        }
        let Some(hole) = self.hole else { return Ok(()) };
        if hole.along >= D || hole.along == self.axis {
            return Err(Invalid::new("hole along", hole.along, format!("an axis below {D} other than the partition's own")));
        }
        let (lower, upper) = (boundary.lower[hole.along], boundary.upper[hole.along]);
        if !(lower <= hole.from && hole.from < hole.to && hole.to <= upper) {
            return Err(Invalid::new(
                "hole",
                format!("{} to {}", hole.from, hole.to),
                format!("from < to, both within the box, {lower} to {upper}"),
            ));
        }
        Ok(())
    }
}
