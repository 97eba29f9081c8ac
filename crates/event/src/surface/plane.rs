//! A fixed plane met from one side: a face of the box, or a side of a partition.

use corpuscle_core::Vector;

use crate::motion::{Flight, upward_passage};

/// A plane met from below, moving up, if `from_below`. It is not there within the gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) at: f64,
    pub(super) from_below: bool,
    pub(super) gap: Option<Gap>,
}

/// A strip of a plane that is open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub(super) along: usize,
    pub(super) from: f64,
    pub(super) to: f64,
    /// Side of the box where the axis is periodic, and the coordinate the box starts at.
    pub(super) period: Option<(f64, f64)>,
}

impl Gap {
    fn holds(&self, coordinate: f64) -> bool {
        let place = self.period.map_or(coordinate, |(side, lower)| coordinate - ((coordinate - lower) / side).floor() * side);
        self.from < place && place < self.to
    }
}

impl Plane {
    /// Whether a particle at this place has the gap before it.
    pub(super) fn is_open_at<const D: usize>(&self, position: Vector<D>) -> bool {
        self.gap.is_some_and(|gap| gap.holds(position[gap.along]))
    }

    pub(super) fn contact_delay<const D: usize>(&self, particle: &Flight<D>, field: Vector<D>) -> f64 {
        let (r, v, axis) = (particle.position, particle.velocity, self.axis);
        // Upwards means towards the plane.
        let sign = if self.from_below { 1.0 } else { -1.0 };
        let (height, v_up, g_up) = (sign * (self.at - r[axis]), sign * v[axis], sign * field[axis]);
        let h = height - particle.radius;
        // A particle on the far side of a thin plate meets this side only if it comes back through the hole.
        if height < 0.0 && (v_up >= 0.0 || v_up * v_up + 2.0 * g_up * h < 0.0) {
            return f64::INFINITY;
        }
        let delay = upward_passage(h, v_up, g_up);
        let open = |gap: Gap, t: f64| gap.holds(r[gap.along] + v[gap.along] * t + 0.5 * field[gap.along] * t * t);
        if delay.is_finite() && self.gap.is_some_and(|gap| open(gap, delay.max(0.0))) { f64::INFINITY } else { delay }
    }
}

/// Where the centre of a particle is that touches a plane. A point stays a hair on its own side, so that it never seems to
/// touch the other side as well.
#[inline]
pub(crate) fn touching(at: f64, radius: f64, from_below: bool) -> f64 {
    let place = if from_below { at - radius } else { at + radius };
    match (place == at, from_below) {
        (false, _) => place,
        (true, true) => at.next_down(),
        (true, false) => at.next_up(),
    }
}
