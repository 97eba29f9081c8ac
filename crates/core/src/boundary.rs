//! The box, its faces and the partitions in it. Both engines read the same description.

mod face;
mod motion;
mod obstacle;
mod overlap;
mod partition;
mod piston;

pub use face::Face;
pub use motion::Motion;
pub use obstacle::Obstacle;
pub use partition::{Hole, Partition};
pub use piston::Piston;

use std::ops::ControlFlow;

use crate::{Invalid, Particles, Vector};

/// What happens at the two faces across one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Axis {
    /// A particle that leaves through one face enters through the other.
    Periodic,
    /// Hard, smooth walls: the surface of a particle touches the face, so its centre stays a radius away. They are fixed
    /// and closed unless the boundary's [`Face`]s say otherwise.
    #[default]
    Walls,
    /// No face at all: space goes on for ever. The extent then only says what to draw and to sample.
    Open,
}

/// A rectangular box with one kind of face an axis, and what is inside besides particles.
///
/// ```
/// use corpuscle_core::{Axis, Boundary};
/// let room = Boundary::new([0.0, 0.0], [10.0, 4.0], Axis::Walls);
/// assert_eq!(room.volume(), 40.0);
/// assert_eq!(room.accessible_volume(0.5), 27.0);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Boundary<const D: usize> {
    /// Lower corner.
    pub lower: Vector<D>,
    /// Upper corner.
    pub upper: Vector<D>,
    /// Kind of the faces across each axis.
    #[serde(with = "crate::array")]
    pub axes: [Axis; D],
    /// Thin hard plates inside the box.
    pub partitions: Vec<Partition>,
    /// The lower and upper face across each axis: what they do where they are walls.
    #[serde(with = "crate::array")]
    pub faces: [[Face; 2]; D],
    /// Fixed round bodies.
    pub obstacles: Vec<Obstacle<D>>,
    /// A movable plane across the box.
    pub piston: Option<Piston>,
}

impl<const D: usize> Boundary<D> {
    /// A box from `lower` to `upper` with the same kind of face across every axis and nothing inside.
    pub fn new(lower: [f64; D], upper: [f64; D], axis: Axis) -> Self {
        Self {
            lower: Vector(lower),
            upper: Vector(upper),
            axes: [axis; D],
            partitions: vec![],
            faces: std::array::from_fn(|_| Default::default()),
            obstacles: vec![],
            piston: None,
        }
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

    /// Whether no wall, no partition and no obstacle can take up momentum.
    pub fn conserves_momentum(&self) -> bool {
        self.partitions.is_empty() && self.obstacles.is_empty() && self.axes.iter().all(|&axis| axis != Axis::Walls)
    }

    /// Whether no particle can ever get out.
    pub fn is_closed(&self) -> bool {
        (0..D).all(|k| match self.axes[k] {
            Axis::Periodic => true,
            Axis::Walls => self.faces[k].iter().all(|face| face.opened_at.is_none()),
            Axis::Open => false,
        })
    }

    /// Whether there is nothing but fixed walls without a temperature, periodic and open faces, and partitions that stay.
    pub fn is_plain(&self) -> bool {
        self.obstacles.is_empty()
            && self.piston.is_none()
            && self.partitions.iter().all(|plate| plate.removed_at.is_none())
            && self.faces.iter().flatten().all(|face| *face == Face::default())
    }

    /// Coordinate and velocity of a face at a time.
    #[inline]
    pub fn face_at(&self, axis: usize, upper: bool, time: f64) -> (f64, f64) {
        let still = if upper { self.upper[axis] } else { self.lower[axis] };
        self.faces[axis][usize::from(upper)].motion.as_ref().map_or((still, 0.0), |motion| motion.at(time))
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
        self.partitions.iter().try_for_each(|plate| plate.validate(self))?;
        self.obstacles.iter().try_for_each(|obstacle| obstacle.validate(self))?;
        for k in 0..D {
            for face in &self.faces[k] {
                if self.axes[k] != Axis::Walls && *face != Face::default() {
                    return Err(Invalid::new("face", format!("{face:?} across axis {k}"), "nothing special: there are no walls"));
                }
                face.validate(self.lower[k], self.upper[k])?;
            }
        }
        self.piston.map_or(Ok(()), |piston| piston.validate(self))
    }

    /// Checks that particles and box fit at time 0: centres inside (walls kept a radius away), no two spheres overlapping,
    /// none cut by a partition, an obstacle or the piston. Cost `O(N)`.
    ///
    /// # Errors
    /// Names the first particle, or a pair, at fault.
    pub fn validate_particles(&self, particles: &Particles<D>) -> Result<(), Invalid> {
        self.validate_particles_at(0.0, particles)
    }

    /// The same at another time, with faces where they then are and without what is gone by then.
    ///
    /// # Errors
    /// Names the first particle, or a pair, at fault.
    pub fn validate_particles_at(&self, time: f64, particles: &Particles<D>) -> Result<(), Invalid> {
        self.validate()?;
        particles.validate()?;
        for (i, (&r, &radius)) in particles.position.iter().zip(&particles.radius).enumerate() {
            for k in 0..D {
                let close = radius * (1.0 - 1e-12);
                let (mut low, mut high) = (self.lower[k], self.upper[k]);
                match self.axes[k] {
                    Axis::Open => continue,
                    Axis::Periodic if high - low < 2.0 * radius => {
                        return Err(Invalid::new(
                            format!("radius of particle {i}"),
                            radius,
                            format!("a diameter that fits into the box, {} along axis {k}", high - low),
                        ));
                    }
                    Axis::Periodic => {}
                    Axis::Walls => {
                        let stands = |upper: bool| self.faces[k][usize::from(upper)].stands_at(time);
                        low = if stands(false) { self.face_at(k, false, time).0 + close } else { f64::NEG_INFINITY };
                        high = if stands(true) { self.face_at(k, true, time).0 - close } else { f64::INFINITY };
                    }
                }
                if r[k] < low || r[k] > high {
                    return Err(Invalid::new(
                        format!("position of particle {i}"),
                        format!("{:?}", r.0),
                        format!("a centre between {low} and {high} along axis {k}"),
                    ));
                }
            }
            let cuts = |plate: &Partition| plate.stands_at(time) && plate.distance(r) < radius * (1.0 - 1e-12);
            if let Some(index) = self.partitions.iter().position(cuts) {
                return Err(Invalid::new(
                    format!("position of particle {i}"),
                    format!("{:?}", r.0),
                    format!("a centre at least its radius {radius} away from partition {index}"),
                ));
            }
            if let Some(piston) = self.piston
                && (r[piston.axis] - piston.position).abs() < radius * (1.0 - 1e-12)
            {
                return Err(Invalid::new(
                    format!("position of particle {i}"),
                    format!("{:?}", r.0),
                    format!("a centre at least its radius {radius} away from the piston"),
                ));
            }
        }
        self.first_overlap(particles).map_or(Ok(()), |(i, j, depth)| {
            let n = particles.len();
            let who = if j < n { format!("particles {i} and {j}") } else { format!("particle {i} and obstacle {}", j - n) };
            Err(Invalid::new(who, format!("overlapping by {depth:.3e}"), "spheres that do not overlap at the start"))
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

    /// A pair that overlaps by more than rounding; obstacles are counted on after the particles.
    fn first_overlap(&self, particles: &Particles<D>) -> Option<(usize, usize, f64)> {
        let n = particles.len();
        let mut all = particles.clone();
        for obstacle in &self.obstacles {
            all.push(obstacle.centre, Vector::ZERO, 1.0, obstacle.radius, 0);
        }
        let mut first = None;
        self.for_each_overlap(&all, 1e-12, |i, j, depth| {
            if i.min(j) >= n {
                return ControlFlow::Continue(());
            }
            first = Some((i.min(j), i.max(j), depth));
            ControlFlow::Break(())
        });
        first
    }
}

#[cfg(test)]
mod tests;
