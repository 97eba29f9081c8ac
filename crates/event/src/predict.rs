//! Planning: what a particle is going to meet, and when.

use corpuscle_core::Vector;

use crate::engine::EventDriven;
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
    /// Tests another particle in one of its periodic images.
    ///
    /// The states are compared at the later of the two own times. Every operation is odd under exchange of the two
    /// particles, so the time found is the same bits whichever of them is searched for.
    #[inline]
    fn consider<const FIELD: bool>(&mut self, j: u32, other: &Flight<D>, shift: Vector<D>, image: [i8; D]) {
        if j == self.index {
            return;
        }
        let me = &self.me;
        let reference = me.time.max(other.time);
        let (mine, its) = (reference - me.time, reference - other.time);
        let (r, v) = if FIELD {
            let (r1, r2) = (me.position_at(reference, self.field), other.position_at(reference, self.field));
            (r2 - r1 + shift, other.velocity_at(reference, self.field) - me.velocity_at(reference, self.field))
        } else {
            let (r1, r2) = (me.position + me.velocity * mine, other.position + other.velocity * its);
            (r2 - r1 + shift, other.velocity - me.velocity)
        };
        let s = me.radius + other.radius;
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
        let mut consider = |j: u32, shift, image| search.consider::<FIELD>(j, &flights[j as usize], shift, image);
        if let Some(number) = self.grid.is_large(i as u32) {
            self.grid.visit_reach(number, &mut consider);
        } else {
            self.grid.visit_around(&self.grid.neighbourhood(i as u32), &mut consider);
        }
        self.grid.visit_large(&mut consider);
        self.keep(i, &search);
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
                let flights = &self.flights;
                let mut consider = |j: u32, shift, image| search.consider::<FIELD>(j, &flights[j as usize], shift, image);
                self.grid.visit_ahead(&self.grid.neighbourhood(i as u32), axis, exit.up, &mut consider);
                // It may have come within reach of a large particle, which knows nothing of it yet.
                self.grid.visit_large(&mut consider);
                if (search.time, search.partner, search.image) != (plan.pair_time, plan.partner, plan.image) {
                    self.keep(i, &search);
                }
            }
            self.plan_exit::<FIELD>(i);
        }
        self.calendar.schedule(i as u32, self.plans[i].next_time());
    }
}
