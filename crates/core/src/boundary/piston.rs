//! A movable plane across the box.

use crate::{Axis, Boundary, Invalid};

/// A thin hard plane of finite mass across the whole box, without friction. Particles on both sides push it by the law
/// of two-body contacts, a constant force accelerates it by `force / mass`, and at its stops it bounces elastically.
///
/// A uniform field acts on particles only: the weight of a piston is part of its `force`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Piston {
    /// Axis it moves along, one with walls.
    pub axis: usize,
    /// Coordinate at the start.
    pub position: f64,
    /// Velocity at the start.
    pub velocity: f64,
    /// Its mass.
    pub mass: f64,
    /// Constant force on it along the axis.
    pub force: f64,
    /// The lowest and the highest coordinate it can reach.
    pub stops: [f64; 2],
}

impl Piston {
    /// Its acceleration between contacts.
    #[inline]
    pub fn acceleration(&self) -> f64 {
        self.force / self.mass
    }

    /// Kinetic energy, and potential energy `-F x` under the constant force.
    pub fn energy(&self) -> f64 {
        0.5 * self.mass * self.velocity * self.velocity - self.force * self.position
    }

    pub(super) fn validate<const D: usize>(&self, boundary: &Boundary<D>) -> Result<(), Invalid> {
        if self.axis >= D || boundary.axes[self.axis] != Axis::Walls {
            return Err(Invalid::new("piston axis", self.axis, format!("an axis below {D} with walls")));
        }
        if !(self.mass > 0.0 && self.mass.is_finite()) {
            return Err(Invalid::new("piston mass", self.mass, "a positive number"));
        }
        if !(self.force.is_finite() && self.velocity.is_finite()) {
            return Err(Invalid::new("piston force and velocity", format!("{}, {}", self.force, self.velocity), "finite numbers"));
        }
        let ([from, to], k) = (self.stops, self.axis);
        if !(boundary.lower[k] <= from && from < to && to <= boundary.upper[k]) {
            return Err(Invalid::new("piston stops", format!("{from} to {to}"), "two places in the box, the lower first"));
        }
        if !(from <= self.position && self.position <= to) {
            return Err(Invalid::new("piston position", self.position, format!("a place between its stops, {from} to {to}")));
        }
        let crosses = |low: f64, high: f64| low <= to && from <= high;
        let partitions = boundary.partitions.iter().any(|plate| plate.axis != k || crosses(plate.position, plate.position));
        let obstacles = boundary.obstacles.iter().any(|o| crosses(o.centre[k] - o.radius, o.centre[k] + o.radius));
        let faces = boundary.faces[k].iter().filter_map(|face| face.motion.as_ref()).any(|motion| {
            let (low, high) = motion.range();
            low < to && from < high
        });
        if partitions || obstacles || faces {
            return Err(Invalid::new(
                "piston stops",
                format!("{from} to {to}"),
                "stops between which it meets no partition, no obstacle and no moving face",
            ));
        }
        Ok(())
    }
}
