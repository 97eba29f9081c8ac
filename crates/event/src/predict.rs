//! Planning: what a particle is going to meet, and when.

use crate::engine::EventDriven;
use crate::law::{Law, Pairs, under_its_law};
use crate::motion::{Flight, upward_passage};
use crate::neighbours::Neighbours;
use crate::pair::State;
use crate::plan::{Exit, Plan, due};
use crate::search::{Meet, Neighbour, View, home};
use corpuscle_core::Vector;
use corpuscle_core::instructions::Instructions;

impl<const D: usize> EventDriven<D> {
    /// Plans everything anew, for all particles.
    pub(crate) fn plan_all(&mut self) {
        self.met.resize(if self.has_surfaces() { self.flights.len() } else { 0 }, 0);
        for plan in &mut self.plans {
            plan.stamp = plan.stamp.wrapping_add(1);
            plan.surface_time = f64::INFINITY;
        }
        for i in 0..self.flights.len() {
            under_its_law!(self.plan(i));
        }
        self.search_for_piston();
        self.calendar.fill(self.now, due(&self.plans, self.piston.as_ref()));
    }

    /// The state of a particle has changed: plans all it is going to do.
    pub(crate) fn plan<L: Law>(&mut self, i: usize) {
        self.plan_pair::<L>(i);
        self.plan_exit::<L>(i);
        if self.has_surfaces() {
            self.plan_surface(i);
        }
    }

    /// Sees who begins in whose well.
    pub(crate) fn find_bonds(&mut self) {
        self.bonds_unknown = false;
        self.pairs.forget();
        if self.pairs.law() != Pairs::InWells {
            return;
        }
        for i in 0..self.flights.len() {
            let words = self.neighbours.candidates(i, &mut self.candidates);
            let place = |i: usize| self.flights[i].position_at(self.now, self.rules.field);
            for other in words.iter().copied().map(Neighbour::from_word).filter(|other| other.slot() != i) {
                let (j, s) = (other.slot(), self.flights[i].radius + self.flights[other.slot()].radius);
                self.pairs.see((self.plans[i].id, self.plans[j].id), place(j) + self.images.shift(other) - place(i), s);
            }
        }
    }

    /// Searches all neighbours for the next collisions.
    #[inline]
    pub(crate) fn plan_pair<L: Law>(&mut self, i: usize) {
        self.counts.predictions += 1;
        let (words, images) = match &self.neighbours {
            Neighbours::Lists(lists) => lists.neighbours(i),
            Neighbours::Cells(cells) => {
                cells.collect(i, &mut self.candidates);
                let images = self.candidates.images;
                (self.candidates.padded(Neighbour::new(i as u32, home::<D>())), images)
            }
        };
        let view = View { flights: &self.flights, images: &self.images, field: self.rules.field };
        let found = search::<D, L>(&view, self.instructions, (&self.plans, &self.pairs), i, self.now, words, images);
        self.keep(i, found);
    }

    /// What rounding puts into the past happens now.
    #[inline]
    fn keep(&mut self, i: usize, found: Meet) {
        // From the line of memory that the search has just read.
        let since = self.flights.get(found.neighbour.slot()).map_or(0.0, |flight| flight.time);
        let plan = &mut self.plans[i];
        let time = if found.time < self.now { self.now } else { found.time };
        (plan.pair, plan.since) = (Meet { time, ..found }, since);
    }

    /// The partner of the event that came up has collided with another meanwhile.
    #[inline]
    pub(crate) fn replace_stale<L: Law>(&mut self, i: usize) {
        self.counts.stale += 1;
        self.plan_pair::<L>(i);
        self.calendar.schedule(i as u32, self.plans[i].due());
    }

    /// Plans through which face the particle leaves its cell or its box, and when.
    ///
    /// An upper face is left only while moving up and a lower one while moving down, so a particle that rounding has put
    /// on the wrong side of a face does not go back and forth.
    #[inline]
    pub(crate) fn plan_exit<L: Law>(&mut self, i: usize) {
        let flight = &self.flights[i];
        let mut best = (f64::INFINITY, Exit::new(0, 0, false, false));
        match &self.neighbours {
            Neighbours::Lists(lists) => best = self.exit::<L>(flight, 0, |axis, up| (lists.face(i, axis, up), false)),
            Neighbours::Cells(cells) => {
                for level in 0..cells.levels(i) {
                    let exit = self.exit::<L>(flight, level, |axis, up| cells.face(i, level, axis, up));
                    best = if exit.0 < best.0 { exit } else { best };
                }
            }
        }
        let time = if best.0 < self.now { self.now } else { best.0 };
        (self.plans[i].exit_time, self.plans[i].exit) = (time, best.1);
    }

    /// The first of the faces that a particle passes, two to an axis: `face(axis, up)` tells where it is and whether it is
    /// a periodic face of the box.
    #[inline]
    fn exit<L: Law>(&self, flight: &Flight<D>, level: usize, face: impl Fn(usize, bool) -> (f64, bool)) -> (f64, Exit) {
        let (field, now) = (self.rules.field, self.now);
        // Directions are random: the first is found by arithmetic on bits, not by branches.
        let (mut first, mut first_axis, mut ups, mut arounds) = (f64::INFINITY, 0, 0, 0);
        for axis in 0..D {
            let (time, up, around) = if L::FIELD && field[axis] != 0.0 {
                [false, true]
                    .map(|up| {
                        let (face, around) = face(axis, up);
                        if face.is_infinite() {
                            return (f64::INFINITY, up, around);
                        }
                        // On a parabola an inner face may lie behind, passed before: it is looked at from where the particle
                        // is now. Faces of the box are always ahead, and are looked at from the stored state, which makes the
                        // time a function of it alone.
                        let from = if around { flight.time } else { now };
                        let (r, v) = (flight.position_at(from, field)[axis], flight.velocity_at(from, field)[axis]);
                        let sign = if up { 1.0 } else { -1.0 };
                        (from + upward_passage(sign * (face - r), sign * v, sign * field[axis]), up, around)
                    })
                    .into_iter()
                    .fold((f64::INFINITY, false, false), |best, exit| if exit.0 < best.0 { exit } else { best })
            } else {
                let v = flight.velocity[axis];
                let up = v.is_sign_positive();
                let (face, around) = face(axis, up);
                // At rest it takes practically for ever.
                let speed = if v.abs() > f64::MIN_POSITIVE { v.abs() } else { f64::MIN_POSITIVE };
                (flight.time + (face - flight.position[axis]) * 1f64.copysign(v) / speed, up, around)
            };
            let earlier = time < first;
            first = if earlier { time } else { first };
            let mask = usize::from(earlier).wrapping_neg();
            first_axis = (axis & mask) | (first_axis & !mask);
            ups |= usize::from(up) << axis;
            arounds |= usize::from(around) << axis;
        }
        (first, Exit::new(level, first_axis, ups >> first_axis & 1 == 1, arounds >> first_axis & 1 == 1))
    }

    /// The particle leaves its cell or its box.
    #[inline]
    pub(crate) fn leave<L: Law>(&mut self, i: usize) {
        match &mut self.neighbours {
            Neighbours::Cells(_) => self.leave_cell::<L>(i),
            Neighbours::Lists(_) => self.leave_box::<L>(i),
        }
        self.calendar.schedule(i as u32, self.plans[i].due());
    }

    fn leave_cell<L: Law>(&mut self, i: usize) {
        let Neighbours::Cells(cells) = &mut self.neighbours else { return };
        self.counts.crossings += 1;
        let exit = self.plans[i].exit;
        cells.step(i, exit);
        if exit.around() {
            // Around the box is a change of state: the particle is brought to the very face.
            self.settle(i);
            let axis = exit.axis();
            let (lower, upper) = (self.boundary.lower[axis], self.boundary.upper[axis]);
            self.flights[i].position[axis] = if exit.up() { lower } else { upper };
            self.bodies[i].images[axis] += if exit.up() { 1 } else { -1 };
            self.stamp(i);
            return self.plan::<L>(i);
        }
        cells.collect_new(i, exit, &mut self.candidates);
        let images = self.candidates.images;
        let words = self.candidates.padded(Neighbour::new(i as u32, home::<D>()));
        let view = View { flights: &self.flights, images: &self.images, field: self.rules.field };
        let found = search::<D, L>(&view, self.instructions, (&self.plans, &self.pairs), i, self.now, words, images);
        if earlier(found, self.plans[i].pair, &self.plans) {
            self.keep(i, found);
        }
        self.plan_exit::<L>(i);
        self.plan_obstacles(i);
    }

    fn leave_box<L: Law>(&mut self, i: usize) {
        let wrapped = self.wrap(i);
        let place = self.flights[i].position_at(self.now, self.rules.field);
        let Neighbours::Lists(lists) = &mut self.neighbours else { return };
        self.counts.rebuilds += 1;
        lists.move_box(i, place, &self.images, &mut self.candidates);
        if wrapped {
            // A change of state, if only by rounding.
            self.settle(i);
            self.stamp(i);
            self.plan::<L>(i);
        } else {
            self.plan_pair::<L>(i);
            self.plan_exit::<L>(i);
            self.plan_obstacles(i);
        }
    }
}

/// Earlier, or at the same time with a partner that comes first.
#[inline]
fn earlier(a: Meet, b: Meet, plans: &[Plan]) -> bool {
    let rank = |neighbour: Neighbour| (plans.get(neighbour.slot()).map(|plan| plan.id), neighbour.image());
    a.time < b.time || (a.time == b.time && a.time < f64::INFINITY && rank(a.neighbour) < rank(b.neighbour))
}

/// The earliest event among candidates (words, a whole number of blocks).
#[inline]
fn search<const D: usize, L: Law>(
    view: &View<'_, D>,
    instructions: Instructions,
    (plans, pairs): (&[Plan], &State),
    i: usize,
    now: f64,
    words: &[u32],
    images: bool,
) -> Meet {
    let me = &view.flights[i];
    if L::PAIRS != Pairs::Hard {
        return one_by_one(plans, words, |other| pairs.next_event::<L, D>(view, plans, i, other));
    }
    let (found, tied) = if me.time == now {
        view.earliest::<L, true>(instructions, me, words, images)
    } else {
        view.earliest::<L, false>(instructions, me, words, images)
    };
    if tied { one_by_one(plans, words, |other| view.contact::<L>(me, other)) } else { found }
}

/// The same one by one: when some come at exactly the same time, so that the order of the candidates shows nowhere, and
/// under laws that have no kernel of their own.
#[inline(never)]
fn one_by_one(plans: &[Plan], words: &[u32], time: impl Fn(Neighbour) -> f64) -> Meet {
    let mut found = Meet::NEVER;
    for neighbour in words.iter().copied().map(Neighbour::from_word) {
        let meet = Meet { time: time(neighbour), neighbour };
        if earlier(meet, found, plans) {
            found = meet;
        }
    }
    found
}
