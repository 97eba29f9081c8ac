//! What is hard and not a particle: faces of the box, partitions, the rims of their holes, obstacles.

mod driven;
mod plane;
mod round;

use corpuscle_core::{Axis, Boundary, Meeting, Obstacle, Partition, Vector};

use crate::motion::Flight;
use crate::neighbours::Neighbours;
use driven::Driven;
use plane::{Gap, Plane};

pub(crate) use plane::touching;

/// A hard surface as a particle meets it. Periodic images of partitions and obstacles are surfaces of their own.
#[derive(Clone, Debug)]
pub(crate) struct Surface<const D: usize> {
    pub(crate) meeting: Meeting<D>,
    /// `kT` of a wall with a temperature.
    pub(crate) temperature: Option<f64>,
    shape: Shape<D>,
}

#[derive(Clone, Debug)]
enum Shape<const D: usize> {
    Plane(Plane),
    Driven(Driven),
    /// The rim of a hole: a point in the plane of two axes, a line in space.
    Rim {
        axes: [usize; 2],
        at: [f64; 2],
    },
    Round(Obstacle<D>),
}

/// All surfaces of a boundary at one time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surfaces<const D: usize> {
    /// First those every particle is tested against, then the obstacles.
    all: Vec<Surface<D>>,
    everywhere: usize,
    /// Which obstacles particles can touch while they are in a region: those of region `c` are
    /// `near[starts[c]..starts[c + 1]]`, as indices into `all`.
    starts: Vec<u32>,
    near: Vec<u32>,
}

impl<const D: usize> Surfaces<D> {
    pub(crate) fn new(boundary: &Boundary<D>, time: f64, neighbours: &Neighbours<D>, flights: &[Flight<D>]) -> Self {
        let mut all = faces(boundary, time);
        for (index, plate) in boundary.partitions.iter().enumerate().filter(|(_, plate)| plate.stands_at(time)) {
            all.extend(sides_and_rims(boundary, index, plate));
        }
        let everywhere = all.len();
        for (index, obstacle) in boundary.obstacles.iter().enumerate() {
            for shift in shifts(boundary) {
                let shape = Shape::Round(Obstacle { centre: obstacle.centre + shift, radius: obstacle.radius });
                all.push(Surface { meeting: Meeting::Obstacle { index }, temperature: None, shape });
            }
        }
        let (mut starts, mut near) = (vec![], vec![]);
        if everywhere < all.len() {
            let overhang = neighbours.overhang(flights);
            let mut pairs = vec![];
            for (number, surface) in all.iter().enumerate() {
                let Shape::Round(Obstacle { centre, radius }) = surface.shape else { continue };
                // The margin, wider than rounding, lets a particle know an obstacle before it can touch.
                let far = Vector::splat((radius + overhang) * (1.0 + 1e-6));
                neighbours.regions_meeting(centre - far, centre + far, |region| pairs.push((region, number as u32)));
            }
            pairs.sort_unstable();
            starts = (0..=neighbours.region_count()).map(|region| pairs.partition_point(|pair| pair.0 < region) as u32).collect();
            near = pairs.into_iter().map(|pair| pair.1).collect();
        }
        Self { all, everywhere, starts, near }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    #[inline]
    pub(crate) fn has_obstacles(&self) -> bool {
        self.everywhere < self.all.len()
    }

    #[inline]
    pub(crate) fn get(&self, number: u32) -> &Surface<D> {
        &self.all[number as usize]
    }

    /// Numbers of the surfaces every particle is tested against.
    #[inline]
    pub(crate) fn everywhere(&self) -> std::ops::Range<u32> {
        0..self.everywhere as u32
    }

    /// Numbers of all obstacles.
    pub(crate) fn obstacles(&self) -> std::ops::Range<u32> {
        self.everywhere as u32..self.all.len() as u32
    }

    /// Numbers of the obstacles that can be touched from a region.
    pub(crate) fn obstacles_near(&self, region: usize) -> &[u32] {
        &self.near[self.starts[region] as usize..self.starts[region + 1] as usize]
    }
}

/// The walls that stand. Periodic faces are none.
fn faces<const D: usize>(boundary: &Boundary<D>, time: f64) -> Vec<Surface<D>> {
    let mut all = vec![];
    for axis in (0..D).filter(|&axis| boundary.axes[axis] == Axis::Walls) {
        for (upper, at) in [(false, boundary.lower[axis]), (true, boundary.upper[axis])] {
            let face = &boundary.faces[axis][usize::from(upper)];
            if !face.stands_at(time) {
                continue;
            }
            let shape = match &face.motion {
                Some(motion) => Shape::Driven(Driven { axis, from_below: upper, motion: motion.clone() }),
                None => Shape::Plane(Plane { axis, at, from_below: upper, gap: None }),
            };
            all.push(Surface { meeting: Meeting::Face { axis, upper }, temperature: face.temperature, shape });
        }
    }
    all
}

/// Both sides of a partition and the rims of its hole, in all periodic images.
fn sides_and_rims<const D: usize>(boundary: &Boundary<D>, index: usize, plate: &Partition) -> Vec<Surface<D>> {
    let mut all = vec![];
    let side = boundary.extent();
    let mut push = |shape| all.push(Surface { meeting: Meeting::Partition { index }, temperature: None, shape });
    for &image in images(boundary, plate.axis) {
        let at = plate.position + image * side[plate.axis];
        let gap = plate.hole.map(|hole| {
            let (side, lower) = (side[hole.along], boundary.lower[hole.along]);
            let period = (boundary.axes[hole.along] == Axis::Periodic).then_some((side, lower));
            Gap { along: hole.along, from: hole.from, to: hole.to, period }
        });
        for from_below in [true, false] {
            push(Shape::Plane(Plane { axis: plate.axis, at, from_below, gap }));
        }
        let Some(hole) = plate.hole else { continue };
        let (lower, upper) = (boundary.lower[hole.along], boundary.upper[hole.along]);
        // A hole that reaches the face of the box has no rim there, unless the plate goes on behind a periodic one.
        let periodic = boundary.axes[hole.along] == Axis::Periodic;
        let rims = [
            (hole.from, hole.from > lower || periodic && hole.to < upper),
            (hole.to, hole.to < upper || periodic && hole.from > lower),
        ];
        for (rim, _) in rims.into_iter().filter(|(_, there)| *there) {
            for image in images(boundary, hole.along) {
                let along = rim + image * side[hole.along];
                push(Shape::Rim { axes: [plate.axis, hole.along], at: [at, along] });
            }
        }
    }
    all
}

fn images<const D: usize>(boundary: &Boundary<D>, axis: usize) -> &'static [f64] {
    if boundary.axes[axis] == Axis::Periodic { &[-1.0, 0.0, 1.0] } else { &[0.0] }
}

/// Shifts to all periodic images next to the box, that itself included.
fn shifts<const D: usize>(boundary: &Boundary<D>) -> Vec<Vector<D>> {
    (0..D).fold(vec![Vector::ZERO], |shifts, axis| {
        let side = Vector::unit(axis) * boundary.extent()[axis];
        let images = images(boundary, axis);
        shifts.iter().flat_map(|&shift| images.iter().map(move |&image| shift + side * image)).collect()
    })
}

impl<const D: usize> Surface<D> {
    /// How long after its own time, which counts from `epoch`, the particle touches this surface; infinity for never.
    pub(crate) fn contact_delay(&self, particle: &Flight<D>, field: Vector<D>, epoch: f64) -> f64 {
        let (r, v, radius) = (particle.position, particle.velocity, particle.radius);
        match &self.shape {
            Shape::Plane(plane) => plane.contact_delay(particle, field),
            Shape::Driven(face) => face.contact_delay(particle, field, epoch),
            &Shape::Rim { axes, at } => {
                let flat = |x: Vector<D>| Vector(axes.map(|axis| x[axis]));
                round::fall_delay(flat(r) - Vector(at), flat(v), flat(field), radius)
            }
            Shape::Round(obstacle) => round::fall_delay(r - obstacle.centre, v, field, radius + obstacle.radius),
        }
    }

    /// The arrow from the centre of a particle that touches the surface to where it touches, or on to the centre of an
    /// obstacle; of a plane a unit vector, whatever the distance.
    pub(crate) fn arrow(&self, position: Vector<D>) -> Vector<D> {
        match &self.shape {
            &Shape::Plane(Plane { axis, from_below, .. }) | &Shape::Driven(Driven { axis, from_below, .. }) => {
                Vector::unit(axis) * if from_below { 1.0 } else { -1.0 }
            }
            Shape::Rim { axes: [a, b], at } => {
                let mut arrow = Vector::ZERO;
                (arrow[*a], arrow[*b]) = (at[0] - position[*a], at[1] - position[*b]);
                arrow
            }
            Shape::Round(obstacle) => obstacle.centre - position,
        }
    }

    /// Distance of the particle's centre from the surface, or from the centre of an obstacle.
    pub(crate) fn distance(&self, position: Vector<D>, time: f64) -> f64 {
        match &self.shape {
            Shape::Plane(plane) => (plane.at - position[plane.axis]).abs(),
            Shape::Driven(face) => (face.motion.at(time).0 - position[face.axis]).abs(),
            Shape::Rim { .. } | Shape::Round(_) => self.arrow(position).norm(),
        }
    }

    /// Velocity of the surface along the arrow of a plane.
    pub(crate) fn velocity(&self, time: f64) -> f64 {
        match &self.shape {
            Shape::Driven(face) => face.motion.at(time).1 * if face.from_below { 1.0 } else { -1.0 },
            _ => 0.0,
        }
    }

    /// Whether a particle lies on this surface and is pressed against it: it would touch it for ever, which is no collision. From a
    /// wall with a temperature it is thrown.
    pub(crate) fn carries(&self, particle: &Flight<D>, field: Vector<D>, time: f64) -> bool {
        let (arrow, radius) = (self.arrow(particle.position), particle.radius);
        let (reach, scale) = match &self.shape {
            Shape::Plane(plane) if plane.is_open_at(particle.position) => return false,
            Shape::Plane(plane) => (radius, plane.at.abs() + radius),
            Shape::Driven(face) => (radius, face.motion.at(time).0.abs() + radius),
            Shape::Rim { .. } => (radius, radius),
            Shape::Round(obstacle) => (radius + obstacle.radius, radius + obstacle.radius),
        };
        // On the other side of a thin plate the field that presses here lifts there.
        let off = match &self.shape {
            Shape::Plane(Plane { axis, at, .. }) => arrow[*axis] * (at - particle.position[*axis]),
            _ => self.distance(particle.position, time),
        };
        let touches = (off - reach).abs() <= (4.0 * f64::EPSILON * scale).max(f64::MIN_POSITIVE);
        let still = particle.velocity.dot(arrow) / arrow.norm() == self.velocity(time);
        self.temperature.is_none() && touches && still && field.dot(arrow) > 0.0
    }

    /// Radius of what is touched; infinity for flat things, and for rims, whose edges are taken as hard as walls.
    pub(crate) fn radius(&self) -> f64 {
        if let Shape::Round(obstacle) = &self.shape { obstacle.radius } else { f64::INFINITY }
    }

    /// Puts a particle that touches a plane exactly onto it, so that rounding does not add up over many contacts.
    pub(crate) fn align(&self, particle: &mut Flight<D>, time: f64) {
        let (axis, at, from_below) = match &self.shape {
            Shape::Plane(plane) => (plane.axis, plane.at, plane.from_below),
            Shape::Driven(face) => (face.axis, face.motion.at(time).0, face.from_below),
            Shape::Rim { .. } | Shape::Round(_) => return,
        };
        particle.position[axis] = touching(at, particle.radius, from_below);
    }
}
