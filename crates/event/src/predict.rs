//! Planning: what a particle is going to meet, and when.

use corpuscle_core::Vector;

use crate::engine::EventDriven;
use crate::grid::{Candidates, Neighbourhood};
use crate::motion::{Flight, contact_delay, upward_passage};
use crate::plan::{Exit, Plan};

/// The search for the earliest collision of one particle.
struct Search<const D: usize> {
    index: u32,
    me: Flight<D>,
    field: Vector<D>,
    time: f64,
    partner: u32,
    image: [i8; D],
}

impl<const D: usize> Search<D> {
    /// Whether another particle in one of its periodic images comes to contact at all: a test without branches.
    ///
    /// The states are compared at the later of the two own times. Every operation is odd under exchange of the two
    /// particles, so the time found is the same bits whichever of them is searched for.
    #[inline]
    fn may_meet<const FIELD: bool, const FRESH: bool>(&self, other: &Flight<D>, shift: Vector<D>) -> bool {
        let (_, r, v) = self.approach::<FIELD, FRESH>(other, shift);
        let s = self.me.radius + other.radius;
        let b = r.dot(v);
        let c = r.norm_squared() - s * s;
        // Not `&&`: without branches the tests of many candidates overlap.
        (b < 0.0) & (b * b - v.norm_squared() * c >= 0.0)
    }

    /// The later of the two own times, and the distance and relative velocity then.
    #[inline]
    fn approach<const FIELD: bool, const FRESH: bool>(&self, other: &Flight<D>, shift: Vector<D>) -> (f64, Vector<D>, Vector<D>) {
        let me = &self.me;
        // A particle that has just collided is at the later time.
        let reference = if FRESH { me.time } else { me.time.max(other.time) };
        let (mine, its) = (reference - me.time, reference - other.time);
        if FIELD {
            let (r1, r2) = (me.position_at(reference, self.field), other.position_at(reference, self.field));
            (reference, r2 - r1 + shift, other.velocity_at(reference, self.field) - me.velocity_at(reference, self.field))
        } else {
            let r1 = if FRESH { me.position } else { me.position + me.velocity * mine };
            let r2 = other.position + other.velocity * its;
            (reference, r2 - r1 + shift, other.velocity - me.velocity)
        }
    }

    /// Tests another particle in one of its periodic images.
    #[inline]
    fn consider<const FIELD: bool>(&mut self, j: u32, other: &Flight<D>, shift: Vector<D>, image: [i8; D]) {
        if j == self.index {
            return;
        }
        let (reference, r, v) = self.approach::<FIELD, false>(other, shift);
        let s = self.me.radius + other.radius;
        let time = reference + contact_delay(r, v, s, self.time - reference);
        if (time < self.time || (time == self.time && j < self.partner)) && s > 0.0 && time < f64::INFINITY {
            (self.time, self.partner, self.image) = (time, j, image);
        }
    }
}

impl<const D: usize> EventDriven<D> {
    /// Plans everything anew, for all particles.
    pub(crate) fn plan_all(&mut self) {
        for plan in &mut self.plans {
            plan.stamp = plan.stamp.wrapping_add(1);
            plan.surface_time = f64::INFINITY;
        }
        for i in 0..self.flights.len() {
            if self.rules.field == Vector::ZERO {
                self.plan::<false>(i);
            } else {
                self.plan::<true>(i);
            }
        }
        self.calendar.fill(self.now, self.plans.iter().map(Plan::next_time));
    }

    /// The state of a particle has changed: plans all it is going to do.
    pub(crate) fn plan<const FIELD: bool>(&mut self, i: usize) {
        self.plan_pair::<FIELD>(i);
        self.plan_exit::<FIELD>(i);
        if !self.surfaces.is_empty() {
            let flight = &self.flights[i];
            let (mut delay, mut nearest) = (f64::INFINITY, 0);
            for (number, surface) in self.surfaces.iter().enumerate() {
                let candidate = surface.contact_delay(flight, self.rules.field);
                if candidate < delay {
                    (delay, nearest) = (candidate, number);
                }
            }
            let plan = &mut self.plans[i];
            (plan.surface_time, plan.surface) = ((flight.time + delay).max(self.now), nearest as u32);
        }
    }

    /// Searches the whole neighbourhood for the next collision.
    pub(crate) fn plan_pair<const FIELD: bool>(&mut self, i: usize) {
        self.counts.predictions += 1;
        let mut search = self.search(i, f64::INFINITY, u32::MAX, [0; D]);
        let flights = &self.flights;
        if let Some(number) = self.grid.is_large(i as u32) {
            self.grid.visit_reach(number, |j, shift, image| search.consider::<FIELD>(j, &flights[j as usize], shift, image));
        } else {
            let around = self.grid.neighbourhood(i as u32);
            self.grid.collect_around(&around, &mut self.candidates);
            self.choose::<FIELD>(&mut search, &around);
        }
        let flights = &self.flights;
        self.grid.visit_large(|j, shift, image| search.consider::<FIELD>(j, &flights[j as usize], shift, image));
        self.keep(i, &search);
    }

    /// Finds the earliest collision among the candidates: first, without a branch, who comes to contact at all, then when.
    fn choose<const FIELD: bool>(&mut self, search: &mut Search<D>, around: &Neighbourhood<D>) {
        let count = match (search.me.time == self.now, around.inside) {
            (true, true) => self.filter::<FIELD, true, true>(search, around),
            (true, false) => self.filter::<FIELD, true, false>(search, around),
            (false, true) => self.filter::<FIELD, false, true>(search, around),
            (false, false) => self.filter::<FIELD, false, false>(search, around),
        };
        for &number in &self.candidates.chosen[..count] {
            let (j, cell) = (self.candidates.index[number as usize], self.candidates.cell[number as usize]);
            let (image, shift) = if around.inside { ([0; D], Vector::ZERO) } else { around.image(cell) };
            search.consider::<FIELD>(j, &self.flights[j as usize], shift, image);
        }
    }

    fn filter<const FIELD: bool, const FRESH: bool, const INSIDE: bool>(
        &mut self,
        search: &Search<D>,
        around: &Neighbourhood<D>,
    ) -> usize {
        let Candidates { index, cell, count, chosen } = &mut self.candidates;
        let (index, cell, chosen) = (&index[..*count], &cell[..*count], &mut chosen[..*count]);
        let mut met = 0;
        for number in 0..*count {
            let shift = if INSIDE { Vector::ZERO } else { around.image(cell[number]).1 };
            chosen[met] = number as u32;
            met += usize::from(search.may_meet::<FIELD, FRESH>(&self.flights[index[number] as usize], shift));
        }
        met
    }

    fn search(&self, i: usize, time: f64, partner: u32, image: [i8; D]) -> Search<D> {
        Search { index: i as u32, me: self.flights[i], field: self.rules.field, time, partner, image }
    }

    /// An event cannot be in the past: what rounding puts there happens now.
    fn keep(&mut self, i: usize, search: &Search<D>) {
        let stamp = self.plans.get(search.partner as usize).map_or(0, |partner| partner.stamp);
        let plan = &mut self.plans[i];
        plan.pair_time = search.time.max(self.now);
        (plan.partner, plan.partner_stamp, plan.image) = (search.partner, stamp, search.image);
    }

    /// Plans through which face the particle leaves its cell, and when.
    ///
    /// An upper face is left only while moving up and a lower one while moving down, so a particle that rounding has put
    /// on the wrong side of a face does not go back and forth.
    pub(crate) fn plan_exit<const FIELD: bool>(&mut self, i: usize) {
        let (flight, field, now) = (&self.flights[i], self.rules.field, self.now);
        let (mut earliest, mut exit) = (f64::INFINITY, Exit::default());
        for axis in 0..D {
            if FIELD && field[axis] != 0.0 {
                for up in [false, true] {
                    let (face, around) = self.grid.exit(i as u32, axis, up);
                    if face.is_infinite() {
                        continue;
                    }
                    // On a parabola an inner face may lie behind, passed before: it is looked at from where the particle
                    // is now. Faces of the box are always ahead, and are looked at from the stored state, which makes the
                    // time a function of it alone.
                    let from = if around { flight.time } else { now };
                    let (r, v) = (flight.position_at(from, field)[axis], flight.velocity_at(from, field)[axis]);
                    let sign = if up { 1.0 } else { -1.0 };
                    let time = from + upward_passage(sign * (face - r), sign * v, sign * field[axis]);
                    if time < earliest {
                        (earliest, exit) = (time, Exit { axis: axis as u8, up, around });
                    }
                }
            } else {
                let v = flight.velocity[axis];
                if v == 0.0 {
                    continue;
                }
                let (face, around) = self.grid.exit(i as u32, axis, v > 0.0);
                let time = flight.time + (face - flight.position[axis]) / v;
                if time < earliest {
                    (earliest, exit) = (time, Exit { axis: axis as u8, up: v > 0.0, around });
                }
            }
        }
        let plan = &mut self.plans[i];
        (plan.exit_time, plan.exit) = (earliest.max(now), exit);
    }

    /// Executes the passage into the next cell.
    pub(crate) fn leave_cell<const FIELD: bool>(&mut self, i: usize, exit: Exit) {
        self.counts.crossings += 1;
        let axis = exit.axis as usize;
        self.grid.step(i as u32, axis, exit.up);
        if exit.around {
            // Around the box is a change of state: the particle is brought to the very face.
            self.settle(i);
            let (lower, upper) = (self.boundary.lower[axis], self.boundary.upper[axis]);
            self.flights[i].position[axis] = if exit.up { lower } else { upper };
            self.bodies[i].images[axis] += if exit.up { 1 } else { -1 };
            self.plans[i].stamp = self.plans[i].stamp.wrapping_add(1);
            self.plan::<FIELD>(i);
        } else {
            if self.grid.is_large(i as u32).is_some() {
                self.plan_pair::<FIELD>(i);
            } else {
                let plan = self.plans[i];
                let mut search = self.search(i, plan.pair_time, plan.partner, plan.image);
                let around = self.grid.neighbourhood(i as u32);
                self.grid.collect_ahead(&around, axis, exit.up, &mut self.candidates);
                self.choose::<FIELD>(&mut search, &around);
                // It may have come within reach of a large particle, which knows nothing of it yet.
                let flights = &self.flights;
                self.grid.visit_large(|j, shift, image| search.consider::<FIELD>(j, &flights[j as usize], shift, image));
                if (search.time, search.partner, search.image) != (plan.pair_time, plan.partner, plan.image) {
                    self.keep(i, &search);
                }
            }
            self.plan_exit::<FIELD>(i);
        }
        self.calendar.schedule(i as u32, self.plans[i].next_time());
    }
}
