//! The piston: a particle of another kind, met by all.
//!
//! It is lazy like a particle, and planned like one: the engine's inequality `min(P(i), P(j)) <= T(i, j)` holds with the
//! piston as `j`. A particle that changes is tested against the piston as it is; a piston that changes is tested against
//! all particles. The time `T` is a function of the two stored states alone.
//!
//! Of events at exactly the same time that comes first whose owner has the lower index; those in the piston's own plan come behind
//! those of all particles, in the order of the particles they are with.

use std::cmp::Ordering;

use corpuscle_core::{Contact, Meeting, Piston, Vector};

use crate::engine::EventDriven;
use crate::law::Law;
use crate::motion::{Flight, upward_passage};
use crate::surface::touching;
use crate::wall::PISTON;

/// How many of the next contacts are kept: others may take the particles of the first away before they come.
const KEPT: usize = 32;

/// The piston with its plan.
#[derive(Clone, Debug)]
pub(crate) struct MovingPiston {
    /// Position and velocity as of `time`.
    state: Piston,
    time: f64,
    /// It lies still on a stop, pressed against it.
    resting: bool,
    /// Counts the changes of its motion.
    stamp: u32,
    /// Which particles are above it: none ever changes sides.
    above: Vec<bool>,
    /// The stamp each particle knew when it made its plan.
    known: Vec<u32>,
    /// The next contacts, the earliest last. All others come at `horizon` or later.
    candidates: Vec<Candidate>,
    horizon: f64,
    stop_time: f64,
}

/// A piston as it is written down. What stands in whose plan is state: of events at exactly the same time that comes first whose
/// owner has the lower index, and behind all particles is the piston.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Kept {
    pub(crate) state: Piston,
    pub(crate) time: f64,
    pub(crate) resting: bool,
    pub(crate) above: Vec<bool>,
    /// The contacts it has planned, the earliest last: when, with whom, and whether that one has not changed since.
    pub(crate) candidates: Vec<(f64, u32, bool)>,
    pub(crate) horizon: f64,
    pub(crate) stop_time: f64,
    /// Of each particle whose plan is older than the piston's motion: when it would have met the piston, if it was that it was to
    /// meet next.
    pub(crate) outdated: Vec<(u32, Option<f64>)>,
}

impl Kept {
    /// Whether it belongs to so many particles.
    pub(crate) fn fits(&self, n: usize) -> bool {
        let ids = self.candidates.iter().map(|candidate| candidate.1).chain(self.outdated.iter().map(|&(id, _)| id));
        let outdated = self.outdated.iter().filter_map(|&(_, time)| time);
        let mut times = self.candidates.iter().map(|candidate| candidate.0).chain(outdated).chain([self.horizon, self.stop_time]);
        self.above.len() == n && ids.into_iter().all(|id| (id as usize) < n) && !times.any(f64::is_nan)
    }
}

/// A contact with the particle stored at this place, if its stamp is still the same.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    time: f64,
    id: u32,
    particle: u32,
    stamp: u32,
}

impl Candidate {
    /// By time, then by particle: never by where it is stored.
    fn order(&self, other: &Self) -> Ordering {
        self.time.total_cmp(&other.time).then(self.id.cmp(&other.id))
    }
}

impl MovingPiston {
    pub(crate) fn new<const D: usize>(state: Piston, time: f64, particles: impl Iterator<Item = Vector<D>>) -> Self {
        let above: Vec<bool> = particles.map(|position| position[state.axis] > state.position).collect();
        Self {
            state,
            time,
            resting: false,
            stamp: 0,
            known: vec![0; above.len()],
            above,
            candidates: Vec::with_capacity(2 * KEPT),
            horizon: f64::INFINITY,
            stop_time: f64::INFINITY,
        }
    }

    /// A piston that goes on as it was, without its plan.
    pub(crate) fn resumed(kept: &Kept) -> Self {
        let Kept { state, time, resting, ref above, .. } = *kept;
        let fresh = Self::new::<1>(state, time, std::iter::empty());
        Self { resting, known: vec![0; above.len()], above: above.clone(), ..fresh }
    }

    fn acceleration(&self) -> f64 {
        if self.resting { 0.0 } else { self.state.acceleration() }
    }

    /// The piston as it is at a time before its next event.
    pub(crate) fn at(&self, time: f64) -> Piston {
        let (t, a) = (time - self.time, self.acceleration());
        let (position, velocity) = (self.state.position + self.state.velocity * t + 0.5 * a * t * t, self.state.velocity + a * t);
        Piston { position, velocity, ..self.state }
    }

    fn bring_to(&mut self, time: f64) {
        (self.state, self.time) = (self.at(time), time);
    }

    /// Lets its time count from a later epoch.
    pub(crate) fn shift_epoch(&mut self, shift: f64) {
        self.time -= shift;
    }

    /// Turns its velocity round, now.
    pub(crate) fn reverse(&mut self, now: f64) {
        self.bring_to(now);
        self.state.velocity = -self.state.velocity;
    }

    /// When a particle and the piston touch, if neither changes before.
    fn contact_time<const D: usize>(&self, id: usize, particle: &Flight<D>, field: Vector<D>) -> f64 {
        let axis = self.state.axis;
        let reference = particle.time.max(self.time);
        let (r, v) = (particle.position_at(reference, field)[axis], particle.velocity_at(reference, field)[axis]);
        let piston = self.at(reference);
        // Upwards means towards the piston.
        let sign = if self.above[id] { -1.0 } else { 1.0 };
        let h = sign * (piston.position - r) - particle.radius;
        reference + upward_passage(h, sign * (v - piston.velocity), sign * (field[axis] - self.acceleration()))
    }

    /// The same, for the plan of the particle.
    pub(crate) fn contact_with<const D: usize>(&mut self, id: usize, particle: &Flight<D>, field: Vector<D>) -> f64 {
        self.known[id] = self.stamp;
        self.contact_time(id, particle, field)
    }

    /// Whether a particle made its plan with the piston as it is.
    pub(crate) fn is_known_to(&self, id: usize) -> bool {
        self.known[id] == self.stamp
    }

    pub(crate) fn next_time(&self) -> f64 {
        self.candidates.last().map_or(self.horizon, |candidate| candidate.time).min(self.stop_time)
    }

    /// Tests all particles, `(id, place, stamp, flight)` each, and keeps the earliest contacts. What rounding puts before `now`
    /// happens now: the calendar does not look back.
    fn search<'a, const D: usize>(
        &mut self,
        now: f64,
        field: Vector<D>,
        particles: impl Iterator<Item = (usize, u32, u32, &'a Flight<D>)>,
    ) {
        let mut found = std::mem::take(&mut self.candidates);
        found.clear();
        self.horizon = f64::INFINITY;
        for (id, particle, stamp, flight) in particles {
            let time = self.contact_time(id, flight, field);
            // Those that never meet may have a time that is no number.
            let time = if time < f64::INFINITY { time.max(now) } else { continue };
            if time <= self.horizon {
                found.push(Candidate { time, id: id as u32, particle, stamp });
                if found.len() == 2 * KEPT {
                    found.select_nth_unstable_by(KEPT - 1, Candidate::order);
                    found.truncate(KEPT);
                    self.horizon = found[KEPT - 1].time;
                }
            }
        }
        found.sort_unstable_by(|a, b| b.order(a));
        self.candidates = found;
        let a = self.acceleration();
        let stop = |k: usize, sign: f64| {
            self.time + upward_passage(sign * (self.state.stops[k] - self.state.position), sign * self.state.velocity, sign * a)
        };
        self.stop_time = stop(0, -1.0).min(stop(1, 1.0)).max(now);
    }

    /// At a stop: it bounces, or lies still if it is at rest there.
    fn stop(&mut self, now: f64) {
        self.bring_to(now);
        let [lower, upper] = self.state.stops;
        let at_upper = (upper - self.state.position).abs() < (self.state.position - lower).abs();
        self.state.position = if at_upper { upper } else { lower };
        self.state.velocity = self.state.velocity.abs() * if at_upper { -1.0 } else { 1.0 };
        self.resting = self.state.velocity == 0.0;
        self.stamp = self.stamp.wrapping_add(1);
    }
}

impl<const D: usize> EventDriven<D> {
    /// The piston with all that stands in plans about it.
    pub(crate) fn kept_piston(&self) -> Option<Kept> {
        let piston = self.piston.as_ref()?;
        let MovingPiston { state, time, resting, stamp: _, ref above, ref known, ref candidates, horizon, stop_time } = *piston;
        let is_fresh = |candidate: &Candidate| self.plans[candidate.particle as usize].stamp == candidate.stamp;
        let candidates = candidates.iter().map(|candidate| (candidate.time, candidate.id, is_fresh(candidate))).collect();
        let meets = |id: usize| {
            let i = self.slots[id] as usize;
            (self.met[i] == PISTON).then_some(self.plans[i].surface_time)
        };
        let outdated = (0..known.len()).filter(|&id| !piston.is_known_to(id)).map(|id| (id as u32, meets(id))).collect();
        Some(Kept { state, time, resting, above: above.clone(), candidates, horizon, stop_time, outdated })
    }

    /// Puts all that stands in plans about the piston where it stood, rather than where it would stand if planned now.
    pub(crate) fn recall_piston(&mut self, kept: &Kept) {
        let Some(mut piston) = self.piston.take() else { return };
        for &(id, meets) in &kept.outdated {
            piston.known[id as usize] = piston.stamp.wrapping_sub(1);
            let i = self.slots[id as usize] as usize;
            // As long as the piston is away, this finds the surfaces only.
            self.plan_surface(i);
            if let Some(time) = meets {
                (self.plans[i].surface_time, self.met[i]) = (time, PISTON);
            }
        }
        piston.candidates.clear();
        piston.candidates.extend(kept.candidates.iter().map(|&(time, id, is_fresh)| {
            let particle = self.slots[id as usize];
            let stamp = self.plans[particle as usize].stamp;
            Candidate { time, id, particle, stamp: if is_fresh { stamp } else { stamp.wrapping_sub(1) } }
        }));
        (piston.horizon, piston.stop_time) = (kept.horizon, kept.stop_time);
        self.piston = Some(piston);
    }

    /// The piston as it is now.
    pub fn piston(&self) -> Option<Piston> {
        self.piston.as_ref().map(|piston| piston.at(self.now))
    }

    /// When the piston's next event comes.
    pub(crate) fn piston_time(&self) -> Option<f64> {
        self.piston.as_ref().map(|piston| piston.next_time().max(self.now))
    }

    /// The motion of the piston has changed, or it ran out of candidates: finds whom it meets next.
    pub(crate) fn search_for_piston(&mut self) {
        let Some(mut piston) = self.piston.take() else { return };
        let particles = self.flights.iter().enumerate().map(|(i, flight)| (self.id(i), i as u32, self.plans[i].stamp, flight));
        piston.search(self.now, self.rules.field, particles);
        self.piston = Some(piston);
        self.counts.predictions += 1;
    }

    fn schedule_piston(&mut self) {
        if let Some(time) = self.piston_time() {
            let behind = self.flights.len() as u32;
            self.calendar.schedule(behind, (time, behind));
        }
    }

    /// Executes the piston's own next event: a contact with a particle, or none that concerns one.
    #[cold]
    pub(crate) fn piston_event<L: Law>(&mut self) -> Option<Contact<D>> {
        let now = self.now;
        let piston = self.piston.as_mut()?;
        if piston.stop_time <= now {
            piston.stop(now);
            self.search_for_piston();
            self.schedule_piston();
            return None;
        }
        let next = piston.candidates.pop();
        if let Some(Candidate { particle, stamp, .. }) = next
            && self.plans[particle as usize].stamp == stamp
        {
            return self.push_piston::<L>(particle as usize);
        }
        // Obsolete, and perhaps the ones behind it as well.
        self.counts.stale += 1;
        let plans = &self.plans;
        let is_obsolete = |candidate: &Candidate| plans[candidate.particle as usize].stamp != candidate.stamp;
        while piston.candidates.pop_if(|candidate| is_obsolete(candidate)).is_some() {}
        if piston.candidates.is_empty() && piston.horizon < f64::INFINITY {
            self.search_for_piston();
        }
        self.schedule_piston();
        None
    }

    /// A particle and the piston touch: `J = (1 + e) mu w` with the reduced mass `mu = m M / (m + M)` and the normal speed
    /// `w` of approach.
    pub(crate) fn push_piston<L: Law>(&mut self, i: usize) -> Option<Contact<D>> {
        self.counts.wall_collisions += 1;
        self.count_stuck(i);
        self.settle(i);
        let (id, m, now) = (self.id(i), self.plans[i].mass, self.now);
        let piston = self.piston.as_mut()?;
        piston.bring_to(now);
        let sign = if piston.above[id] { -1.0 } else { 1.0 };
        let flight = &mut self.flights[i];
        let (axis, before, u) = (piston.state.axis, flight.velocity, piston.state.velocity);
        flight.position[axis] = touching(piston.state.position, flight.radius, sign > 0.0);
        let mu = m * piston.state.mass / (m + piston.state.mass);
        let approach = sign * (before[axis] - u);
        let e = self.rules.restitution_at(approach, [flight.radius, f64::INFINITY], mu);
        let impulse = ((1.0 + e) * mu * approach).max(0.0);
        flight.velocity[axis] -= sign * impulse / m;
        piston.state.velocity += sign * impulse / piston.state.mass;
        piston.resting = false;
        piston.stamp = piston.stamp.wrapping_add(1);
        let (after, distance) = (piston.state.velocity, (piston.state.position - flight.position[axis]).abs());
        self.stamp(i);
        let contact = Contact {
            time: self.epoch + now,
            first: self.party(i, before),
            with: Meeting::Piston { before: u, after },
            normal: Vector::unit(axis) * sign,
            impulse,
            distance,
        };
        self.plan_and_schedule::<L>(i);
        self.search_for_piston();
        self.schedule_piston();
        Some(contact)
    }
}
