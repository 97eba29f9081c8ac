//! Collisions of two particles: impulses and what is planned afterwards.
#![allow(clippy::inline_always, reason = "what no observer looks at is then not computed")]

use corpuscle_core::{Contact, Meeting, Party, Vector};

use crate::engine::EventDriven;
use crate::law::{Law, Pairs};
use crate::plan::Plan;
use crate::search::Neighbour;

impl<const D: usize> EventDriven<D> {
    /// Two particles touch, the second in a periodic image: each gets the impulse `J = (1 + e) mu |v.k|`, with the unit
    /// normal `k` and the reduced mass `mu = m1 m2 / (m1 + m2)`.
    ///
    /// The partner of lower index is the first, so the result does not depend on whose event it was.
    #[inline(always)]
    pub(crate) fn collide<L: Law>(&mut self, i: usize, partner: Neighbour) -> Contact<D> {
        let (j, shift) = (partner.slot(), self.images.shift(partner));
        let (i, j, shift) = if self.plans[i].id < self.plans[j].id { (i, j, shift) } else { (j, i, -shift) };
        self.count_stuck(i);
        self.count_stuck(j);
        self.settle(i);
        self.settle(j);
        let (m1, m2) = (self.plans[i].mass, self.plans[j].mass);
        let (v1, v2) = (self.flights[i].velocity, self.flights[j].velocity);
        let r = self.flights[j].position - self.flights[i].position + shift;
        let distance = r.norm();
        let mu = m1 * m2 / (m1 + m2);
        // With `r` in place of a rounded unit vector: distances at contact repeat, so the rounding of `k` would be biased
        // and heat the system.
        let rr = r.norm_squared();
        let closing = -(v2 - v1).dot(r) / rr;
        let change = if L::PAIRS == Pairs::Hard {
            self.counts.collisions += 1;
            let radii = [self.flights[i].radius, self.flights[j].radius];
            ((1.0 + self.rules.restitution_at(closing * distance, radii, mu)) * mu * closing).max(0.0)
        } else {
            self.pass::<L>(i, j, r, closing, mu)
        };
        self.flights[i].velocity = v1 - r * (change / m1);
        self.flights[j].velocity = v2 + r * (change / m2);
        self.stamp(i);
        self.stamp(j);
        let contact = Contact {
            time: self.epoch + self.now,
            first: self.party(i, v1),
            with: Meeting::Pair(self.party(j, v2)),
            normal: r / distance,
            impulse: change * distance,
            distance,
        };
        self.plan_and_schedule::<L>(i);
        self.plan_and_schedule::<L>(j);
        contact
    }

    /// The same for pairs that are more than hard: what `r` is to be multiplied by for the impulse, which attracts when negative.
    fn pass<L: Law>(&mut self, i: usize, j: usize, r: Vector<D>, closing: f64, mu: f64) -> f64 {
        let radii = [self.flights[i].radius, self.flights[j].radius];
        let outcome = self.pairs.execute((self.plans[i].id, self.plans[j].id), r, closing, radii[0] + radii[1], mu);
        if outcome.core {
            self.counts.collisions += 1;
            let e = if L::PAIRS == Pairs::Growing { 1.0 } else { self.rules.restitution_at(closing * r.norm(), radii, mu) };
            0.5 * (1.0 + e) * mu * outcome.change
        } else {
            self.counts.edges += 1;
            mu * outcome.change
        }
    }

    #[inline]
    pub(crate) fn stamp(&mut self, i: usize) {
        self.plans[i].stamp = self.plans[i].stamp.wrapping_add(1);
    }

    #[inline]
    pub(crate) fn plan_and_schedule<L: Law>(&mut self, i: usize) {
        self.plan::<L>(i);
        self.calendar.schedule(i as u32, self.plans[i].due());
    }

    /// Counts contacts at the same instant: in an inelastic collapse the clock stops.
    #[inline]
    pub(crate) fn count_stuck(&mut self, i: usize) {
        self.plans[i].stuck = if self.flights[i].time >= self.now { self.plans[i].stuck.saturating_add(1) } else { 0 };
    }

    #[inline(always)]
    pub(crate) fn party(&self, i: usize, before: corpuscle_core::Vector<D>) -> Party<D> {
        let flight = &self.flights[i];
        let position = self.boundary.wrap_near(flight.position);
        let Plan { id, mass, .. } = self.plans[i];
        Party { index: id as usize, mass, position, before, after: flight.velocity }
    }
}
