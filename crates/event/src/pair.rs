//! What two particles do to one another: the laws of pairs, one a file.

mod bonds;
pub(crate) mod growth;
pub(crate) mod well;

use corpuscle_core::{Axis, Boundary, Invalid, Particles, Vector};

use crate::law::{Law, Pairs};
use crate::plan::Plan;
use crate::search::{Neighbour, View};
use bonds::Bonds;

/// The law of pairs, the same for all of them; distances are in units of the contact distance `s = R1 + R2`.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Pair {
    /// Nothing beyond contact.
    #[default]
    Hard,
    /// Hard cores in square wells: the potential is `-depth` while the distance of the centres is below `range s`.
    ///
    /// A negative depth is a square shoulder, which repels. Second virial coefficient, with that of the cores `b0`:
    /// `B2 = b0 (1 - (range^D - 1) (exp(depth / kT) - 1))` (Alder and Wainwright, J. Chem. Phys. 31, 459 (1959),
    /// doi:10.1063/1.1730376).
    Well {
        /// Where the well ends, over the contact distance: above 1.
        range: f64,
        /// Energy set free when a pair enters.
        depth: f64,
    },
}

impl Pair {
    /// Checks that every number makes sense.
    ///
    /// # Errors
    /// Names the first that does not.
    pub fn validate(&self) -> Result<(), Invalid> {
        let Self::Well { range, depth } = *self else { return Ok(()) };
        if !(range > 1.0 && range.is_finite()) {
            return Err(Invalid::new("range", range, "a number above 1, the contact distance"));
        }
        if !(depth.is_finite() && depth != 0.0) {
            return Err(Invalid::new("depth", depth, "an energy, above zero for a well and below for a shoulder"));
        }
        Ok(())
    }

    /// How far the law reaches, in contact distances.
    pub(crate) fn range(&self) -> f64 {
        if let Self::Well { range, .. } = *self { range } else { 1.0 }
    }

    /// Checks that a pair cannot be in its well through two faces of the box at once.
    pub(crate) fn validate_box<const D: usize>(&self, boundary: &Boundary<D>, particles: &Particles<D>) -> Result<(), Invalid> {
        let Self::Well { range, .. } = *self else { return Ok(()) };
        let largest = particles.radius.iter().copied().fold(0.0, f64::max);
        let widest = 2.0 * IMAGE_MARGIN * 2.0 * largest * range;
        let side = |k: usize| boundary.upper[k] - boundary.lower[k];
        match (0..D).find(|&k| boundary.axes[k] == Axis::Periodic && side(k) < widest) {
            None => Ok(()),
            Some(k) => Err(Invalid::new("box", format!("{} along axis {k}", side(k)), format!("at least {widest}, two wells"))),
        }
    }
}

/// A bond is with the one image that is nearer than this times the edge of the well; others are farther in a box wide
/// enough. Wider than rounding, which may leave a pair in its well a hair beyond the edge.
const IMAGE_MARGIN: f64 = 1.01;

/// The law of pairs at work, and what it remembers; nothing where pairs are hard.
#[derive(Clone, Debug)]
pub(crate) struct State {
    law: Pair,
    pub(crate) bonds: Bonds,
    growth: Option<Growth>,
}

/// Radii are `scale + rate t` of what they are going to be, at the time `t` from the epoch.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Growth {
    pub(crate) scale: f64,
    pub(crate) rate: f64,
}

/// What has happened to a pair: the change of its relative velocity is this times their distance vector.
pub(crate) struct Outcome {
    pub(crate) change: f64,
    /// The cores have met, and not the edge of a well.
    pub(crate) core: bool,
}

impl State {
    pub(crate) fn new(law: Pair, growth: Option<Growth>, particles: usize) -> Self {
        Self { law, bonds: Bonds::none(if law == Pair::Hard { 0 } else { particles }), growth }
    }

    /// Which copy of the hot loop it needs.
    pub(crate) fn law(&self) -> Pairs {
        match (self.growth, self.law) {
            (Some(_), _) => Pairs::Growing,
            (None, Pair::Well { .. }) => Pairs::InWells,
            (None, Pair::Hard) => Pairs::Hard,
        }
    }

    /// Radii as seen by a search for neighbours, over the true ones.
    pub(crate) fn range(&self) -> f64 {
        self.law.range()
    }

    /// The part of that radius within which no other centre comes.
    pub(crate) fn core(&self) -> f64 {
        self.growth.map_or(1.0, |growth| growth.scale.min(1.0)) / self.range()
    }

    /// Potential energy of all pairs.
    pub(crate) fn energy(&self) -> f64 {
        if let Pair::Well { depth, .. } = self.law { -depth * self.bonds.count() as f64 } else { 0.0 }
    }

    /// Sees a pair begin `r` apart, maybe in its well.
    pub(crate) fn see<const D: usize>(&mut self, ids: (u32, u32), r: Vector<D>, s: f64) {
        if r.norm() < self.law.range() * s {
            self.bonds.set(ids.0, ids.1, true);
        }
    }

    /// How the spheres grow, if they do.
    pub(crate) fn growth(&self) -> Option<Growth> {
        self.growth
    }

    /// Forgets all bonds.
    pub(crate) fn forget(&mut self) {
        self.bonds.clear();
    }

    /// Time counts from a later epoch.
    pub(crate) fn shift_epoch(&mut self, shift: f64) {
        if let Some(growth) = &mut self.growth {
            growth.scale += growth.rate * shift;
        }
    }

    fn inside<const D: usize>(&self, ids: (u32, u32), r: Vector<D>, edge: f64) -> bool {
        self.bonds.holds(ids.0, ids.1) && r.norm_squared() < (IMAGE_MARGIN * edge) * (IMAGE_MARGIN * edge)
    }

    /// When the particle stored at `i` has its next event with another; infinity for never.
    ///
    /// As in the kernel for hard spheres the time is the same bits whichever of the two is searched for.
    pub(crate) fn next_event<L: Law, const D: usize>(&self, view: &View<'_, D>, plans: &[Plan], i: usize, other: Neighbour) -> f64 {
        let j = other.slot();
        let (me, it) = (&view.flights[i], &view.flights[j]);
        let s = me.radius + it.radius;
        if i == j || s == 0.0 {
            return f64::INFINITY;
        }
        let reference = me.time.max(it.time);
        let field = if L::FIELD { view.field } else { Vector::ZERO };
        let r = it.position_at(reference, field) - me.position_at(reference, field) + view.images.shift(other);
        let v = it.velocity_at(reference, field) - me.velocity_at(reference, field);
        let delay = match (self.law, self.growth) {
            (_, Some(Growth { scale, rate })) => growth::growing_contact_delay(r, v, s * (scale + rate * reference), s * rate),
            (Pair::Well { range, .. }, None) => {
                well::next_event(r, v, s, range, self.inside((plans[i].id, plans[j].id), r, range * s)).0
            }
            (Pair::Hard, None) => crate::motion::contact_delay(r, v, s),
        };
        reference + delay
    }

    /// Executes the event of a pair that is `r` apart, closing at the rate `closing = -v.r / r.r`: who they are, their
    /// contact distance and reduced mass.
    pub(crate) fn execute<const D: usize>(&mut self, ids: (u32, u32), r: Vector<D>, closing: f64, s: f64, mu: f64) -> Outcome {
        let rr = r.norm_squared();
        if let Some(Growth { rate, .. }) = self.growth {
            let change = growth::rebound(-closing, s * rate / rr.sqrt()) + closing;
            return Outcome { change: change.max(0.0), core: true };
        }
        let Pair::Well { range, depth } = self.law else { return Outcome { change: 2.0 * closing.max(0.0), core: true } };
        let inside = self.inside(ids, r, range * s);
        let middle = 0.5 * (1.0 + range) * s;
        if inside && rr < middle * middle {
            return Outcome { change: 2.0 * closing.max(0.0), core: true };
        }
        let (change, inside) = well::step(-closing, mu * rr, depth, !inside);
        self.bonds.set(ids.0, ids.1, inside);
        Outcome { change, core: false }
    }
}
