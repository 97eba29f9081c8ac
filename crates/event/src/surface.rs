//! What is fixed and hard: faces of the box, partitions, the rims of their holes.

use corpuscle_core::{Axis, Boundary, Meeting, Vector, polynomial};

use crate::motion::{Flight, contact_delay, upward_passage};

/// A fixed hard surface as a particle meets it. Periodic images of a partition are surfaces of their own.
#[derive(Clone, Debug)]
pub(crate) struct Surface<const D: usize> {
    pub(crate) meeting: Meeting<D>,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// A plane met from one side: from below, moving up, if `from_below`. It is not there within the gap.
    Plane { axis: usize, at: f64, from_below: bool, gap: Option<Gap> },
    /// The rim of a hole: a point in the plane of two axes, a line in space.
    Rim { axes: [usize; 2], at: [f64; 2] },
}

#[derive(Clone, Copy, Debug)]
struct Gap {
    along: usize,
    from: f64,
    to: f64,
    /// Side of the box where the axis is periodic, and the coordinate the box starts at.
    period: Option<(f64, f64)>,
}

impl Gap {
    fn holds(&self, coordinate: f64) -> bool {
        let place = self.period.map_or(coordinate, |(side, lower)| coordinate - ((coordinate - lower) / side).floor() * side);
        self.from < place && place < self.to
    }
}

/// All surfaces of a boundary. Periodic faces are none.
pub(crate) fn surfaces<const D: usize>(boundary: &Boundary<D>) -> Vec<Surface<D>> {
    let mut all = vec![];
    for axis in (0..D).filter(|&axis| boundary.axes[axis] == Axis::Walls) {
        for (upper, at) in [(false, boundary.lower[axis]), (true, boundary.upper[axis])] {
            let shape = Shape::Plane { axis, at, from_below: upper, gap: None };
            all.push(Surface { meeting: Meeting::Face { axis, upper }, shape });
        }
    }
    let side = boundary.extent();
    let images = |axis: usize| -> &'static [f64] { if boundary.axes[axis] == Axis::Periodic { &[-1.0, 0.0, 1.0] } else { &[0.0] } };
    for (index, plate) in boundary.partitions.iter().enumerate() {
        let meeting = Meeting::Partition { index };
        for image in images(plate.axis) {
            let at = plate.position + image * side[plate.axis];
            let gap = plate.hole.map(|hole| {
                let (side, lower) = (side[hole.along], boundary.lower[hole.along]);
                let period = (boundary.axes[hole.along] == Axis::Periodic).then_some((side, lower));
                Gap { along: hole.along, from: hole.from, to: hole.to, period }
            });
            for from_below in [true, false] {
                all.push(Surface { meeting, shape: Shape::Plane { axis: plate.axis, at, from_below, gap } });
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
                for image in images(hole.along) {
                    let along = rim + image * side[hole.along];
                    all.push(Surface { meeting, shape: Shape::Rim { axes: [plate.axis, hole.along], at: [at, along] } });
                }
            }
        }
    }
    all
}

impl<const D: usize> Surface<D> {
    /// How long after its own time the particle touches this surface; infinity for never.
    pub(crate) fn contact_delay(&self, particle: &Flight<D>, field: Vector<D>) -> f64 {
        let (r, v, radius) = (particle.position, particle.velocity, particle.radius);
        match self.shape {
            Shape::Plane { axis, at, from_below, gap } => {
                // Upwards means towards the plane.
                let sign = if from_below { 1.0 } else { -1.0 };
                let (height, v_up, g_up) = (sign * (at - r[axis]), sign * v[axis], sign * field[axis]);
                let h = height - radius;
                // A particle on the far side of a thin plate meets this side only if it comes back through the hole.
                if height < 0.0 && (v_up >= 0.0 || v_up * v_up + 2.0 * g_up * h < 0.0) {
                    return f64::INFINITY;
                }
                let delay = upward_passage(h, v_up, g_up);
                let open = |gap: Gap, t: f64| gap.holds(r[gap.along] + v[gap.along] * t + 0.5 * field[gap.along] * t * t);
                if delay.is_finite() && gap.is_some_and(|gap| open(gap, delay.max(0.0))) { f64::INFINITY } else { delay }
            }
            Shape::Rim { axes: [a, b], at } => {
                let arrow = Vector([at[0] - r[a], at[1] - r[b]]);
                let closing = Vector([-v[a], -v[b]]);
                if field[a] == 0.0 && field[b] == 0.0 {
                    contact_delay(arrow, closing, radius, f64::INFINITY)
                } else {
                    rim_delay(arrow, closing, Vector([-field[a], -field[b]]), radius)
                }
            }
        }
    }

    /// The unit normal from a particle that touches the surface towards it, and the distance from its centre.
    pub(crate) fn normal(&self, position: Vector<D>) -> (Vector<D>, f64) {
        match self.shape {
            Shape::Plane { axis, at, from_below, .. } => {
                let sign = if from_below { 1.0 } else { -1.0 };
                (Vector::unit(axis) * sign, (at - position[axis]) * sign)
            }
            Shape::Rim { axes: [a, b], at } => {
                let mut arrow = Vector::ZERO;
                (arrow[a], arrow[b]) = (at[0] - position[a], at[1] - position[b]);
                let distance = arrow.norm();
                (arrow / distance, distance)
            }
        }
    }

    /// Puts a particle that touches a plane exactly onto it, so that rounding does not add up over many contacts.
    pub(crate) fn align(&self, particle: &mut Flight<D>) {
        if let Shape::Plane { axis, at, from_below, .. } = self.shape {
            particle.position[axis] = if from_below { at - particle.radius } else { at + particle.radius };
        }
    }
}

/// First `t >= 0` at which `|r + v t + g t^2 / 2|` falls to `s`: a quartic, whose roots are bracketed one by one.
fn rim_delay(r: Vector<2>, v: Vector<2>, g: Vector<2>, s: f64) -> f64 {
    let c = r.norm_squared() - s * s;
    if c <= 0.0 && r.dot(v) < 0.0 {
        return 0.0;
    }
    let quartic = [c, 2.0 * r.dot(v), v.norm_squared() + r.dot(g), v.dot(g), 0.25 * g.norm_squared()];
    // Cauchy: no root is larger than this.
    let bound = 1.0 + quartic.iter().take(4).fold(0.0, |largest: f64, x| largest.max(x.abs())) / quartic[4];
    // Where the distance falls, the contact; where it grows, the end of an overlap by rounding.
    let falling = |t: f64| (r + v * t + g * (0.5 * t * t)).dot(v + g * t) < 0.0;
    polynomial::roots(&quartic, 0.0, bound).into_iter().find(|&t| falling(t)).unwrap_or(f64::INFINITY)
}
