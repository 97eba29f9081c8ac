//! The box, its faces and the partitions in it. Both engines read the same description.

mod overlap;
mod partition;

pub use partition::{Hole, Partition};

use std::ops::ControlFlow;

use crate::{Invalid, Particles, Vector};

/// What happens at the two faces across one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// A particle that leaves through one face enters through the other.
    Periodic,
    /// Hard, smooth, fixed walls: the surface of a particle touches the face, so its centre stays a radius away.
    #[default]
    Walls,
    /// No face at all: space goes on for ever. The extent then only says what to draw and to sample.
    Open,
}

/// A rectangular box with one kind of face an axis, and partitions inside.
///
/// ```
/// use corpuscle_core::{Axis, Boundary};
/// let room = Boundary::new([0.0, 0.0], [10.0, 4.0], Axis::Walls);
/// assert_eq!(room.volume(), 40.0);
/// assert_eq!(room.accessible_volume(0.5), 27.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary<const D: usize> {
    /// Lower corner.
    pub lower: Vector<D>,
    /// Upper corner.
    pub upper: Vector<D>,
    /// Kind of the faces across each axis.
    pub axes: [Axis; D],
    /// Thin hard plates inside the box.
    pub partitions: Vec<Partition>,
}

impl<const D: usize> Boundary<D> {
    /// A box from `lower` to `upper` with the same kind of face across every axis and nothing inside.
    pub fn new(lower: [f64; D], upper: [f64; D], axis: Axis) -> Self {
        Self { lower: Vector(lower), upper: Vector(upper), axes: [axis; D], partitions: vec![] }
    }

    /// A periodic cube of the given side, its lower corner at the origin.
    pub fn periodic(side: f64) -> Self {
        Self::new([0.0; D], [side; D], Axis::Periodic)
    }

    /// Side lengths.
    #[inline]
    pub fn extent(&self) -> Vector<D> {
        self.upper - self.lower
    }

    /// Volume (area in 2-D) of the box.
    pub fn volume(&self) -> f64 {
        self.extent().0.iter().product()
    }

    /// Volume open to the centre of a particle of this radius: a wall takes a radius off at each face,
    /// a periodic axis nothing.
    pub fn accessible_volume(&self, radius: f64) -> f64 {
        (0..D).map(|k| self.upper[k] - self.lower[k] - if self.axes[k] == Axis::Walls { 2.0 * radius } else { 0.0 }).product()
    }

    /// Area (length in 2-D) of all walls of the box; partitions not counted.
    pub fn wall_area(&self) -> f64 {
        let volume = self.volume();
        (0..D).filter(|&k| self.axes[k] == Axis::Walls).map(|k| 2.0 * volume / (self.upper[k] - self.lower[k])).sum()
    }

    /// Whether no wall and no partition can take up momentum.
    pub fn conserves_momentum(&self) -> bool {
        self.partitions.is_empty() && self.axes.iter().all(|&axis| axis != Axis::Walls)
    }

    /// The image of `position` in the box along periodic axes; other components unchanged.
    #[inline]
    #[must_use]
    pub fn wrap(&self, mut position: Vector<D>) -> Vector<D> {
        for k in 0..D {
            if self.axes[k] == Axis::Periodic {
                let side = self.upper[k] - self.lower[k];
                let turns = ((position[k] - self.lower[k]) / side).floor();
                if turns != 0.0 {
                    position[k] -= turns * side;
                }
                // Rounding can put a point a hair below the lower face on the upper face itself.
                if position[k] >= self.upper[k] {
                    position[k] = self.lower[k];
                }
            }
        }
        position
    }

    /// The same for a position less than one side beyond the box: cheaper.
    #[inline]
    #[must_use]
    pub fn wrap_near(&self, mut position: Vector<D>) -> Vector<D> {
        for k in 0..D {
            if self.axes[k] == Axis::Periodic {
                let side = self.upper[k] - self.lower[k];
                if position[k] < self.lower[k] {
                    position[k] += side;
                }
                // Rounding can put a point a hair below the lower face on the upper face itself.
                if position[k] >= self.upper[k] {
                    position[k] -= side;
                }
            }
        }
        position
    }

    /// The shortest `to - from` over all periodic images (nearest image; unique while shorter than half a side).
    #[inline]
    pub fn displacement(&self, from: Vector<D>, to: Vector<D>) -> Vector<D> {
        let mut arrow = to - from;
        for k in 0..D {
            if self.axes[k] == Axis::Periodic {
                let side = self.upper[k] - self.lower[k];
                arrow[k] -= (arrow[k] / side).round() * side;
            }
        }
        arrow
    }

    /// Checks the box and its partitions.
    ///
    /// # Errors
    /// Names the corner or partition that makes no sense.
    pub fn validate(&self) -> Result<(), Invalid> {
        for k in 0..D {
            let (lower, upper) = (self.lower[k], self.upper[k]);
            if !(lower.is_finite() && upper.is_finite() && lower < upper) {
                return Err(Invalid::new(
                    "box",
                    format!("from {lower} to {upper} along axis {k}"),
                    "finite corners, lower < upper",
                ));
            }
        }
        self.partitions.iter().try_for_each(|plate| plate.validate(self))
    }

    /// Checks that particles and box fit: centres inside (walls kept a radius away), no two spheres overlapping,
    /// none cut by a partition. Cost `O(N)`.
    ///
    /// # Errors
    /// Names the first particle, or a pair, at fault.
    pub fn validate_particles(&self, particles: &Particles<D>) -> Result<(), Invalid> {
        self.validate()?;
        particles.validate()?;
        for (i, (&r, &radius)) in particles.position.iter().zip(&particles.radius).enumerate() {
            for k in 0..D {
                let margin = match self.axes[k] {
                    Axis::Open => continue,
                    Axis::Periodic => {
                        if self.upper[k] - self.lower[k] < 2.0 * radius {
                            return Err(Invalid::new(
                                format!("radius of particle {i}"),
                                radius,
                                format!("a diameter that fits into the box, {} along axis {k}", self.upper[k] - self.lower[k]),
                            ));
                        }
                        0.0
                    }
                    Axis::Walls => radius * (1.0 - 1e-12),
                };
                if r[k] < self.lower[k] + margin || r[k] > self.upper[k] - margin {
                    return Err(Invalid::new(
                        format!("position of particle {i}"),
                        format!("{:?}", r.0),
                        format!("a centre between {} and {} along axis {k}", self.lower[k] + margin, self.upper[k] - margin),
                    ));
                }
            }
            if let Some(index) = self.partitions.iter().position(|plate| plate.distance(r) < radius * (1.0 - 1e-12)) {
                return Err(Invalid::new(
                    format!("position of particle {i}"),
                    format!("{:?}", r.0),
                    format!("a centre at least its radius {radius} away from partition {index}"),
                ));
            }
        }
        self.first_overlap(particles).map_or(Ok(()), |(i, j, depth)| {
            Err(Invalid::new(
                format!("particles {i} and {j}"),
                format!("overlapping by {depth:.3e}"),
                "spheres that do not overlap at the start",
            ))
        })
    }

    /// Deepest overlap `R_i + R_j - |r_ij|` among all pairs, zero when none overlap. Cost `O(N)`.
    pub fn largest_overlap(&self, particles: &Particles<D>) -> f64 {
        let mut largest: f64 = 0.0;
        self.for_each_overlap(particles, 0.0, |_, _, depth| {
            largest = largest.max(depth);
            ControlFlow::Continue(())
        });
        largest
    }

    /// A pair that overlaps by more than rounding.
    fn first_overlap(&self, particles: &Particles<D>) -> Option<(usize, usize, f64)> {
        let mut first = None;
        self.for_each_overlap(particles, 1e-12, |i, j, depth| {
            first = Some((i.min(j), i.max(j), depth));
            ControlFlow::Break(())
        });
        first
    }
}

#[cfg(test)]
mod tests;
