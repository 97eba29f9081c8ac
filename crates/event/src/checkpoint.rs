//! Checkpoints: an engine as it is written down, and one that goes on from there to the same bits.
//!
//! Only what the future depends on is kept. Calendar, cells, what surfaces are met and the order in memory are worked out
//! again: a prediction is a function of stored states, whenever it is made. Two things more belong to the state. With
//! neighbour lists, a particle that leaves its small box beyond a periodic face changes its image, and when it does so, which
//! rounding shows, follows from where and when the box was made. And of collisions at exactly the same time that comes first
//! whose particle planned it, so that it matters in which of its two plans a collision stands, and likewise a contact with
//! the piston.

use corpuscle_core::{Boundary, Invalid, Particles, Vector, array};
use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, Serializer};

use crate::engine::{EventDriven, removals};
use crate::law::{Law, Pairs, under_its_law};
use crate::neighbours::Neighbours;
use crate::pair::Growth;
use crate::piston::{Kept, MovingPiston};
use crate::plan::due;
use crate::search::{Meet, Neighbour, View};
use crate::{Counts, Rules};

/// All of an engine's state, particles in the order of their indices.
#[derive(serde::Serialize, serde::Deserialize)]
struct State<const D: usize> {
    boundary: Boundary<D>,
    rules: Rules<D>,
    growth: Option<Growth>,
    /// As each was at its own time, which counts from the epoch.
    particles: Particles<D>,
    own_time: Vec<f64>,
    images: Vec<Turns<D>>,
    stuck: Vec<u16>,
    thermal_contacts: Vec<u32>,
    bonds: Vec<(u32, u32)>,
    boxes: Option<Boxes<D>>,
    plans: Plans,
    piston: Option<Kept>,
    epoch: f64,
    now: f64,
    time: f64,
    removed: f64,
    next_epoch: u64,
    counts: Counts,
}

#[derive(Clone, Copy, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
struct Turns<const D: usize>(#[serde(with = "array")] [i32; D]);

/// The small boxes of neighbour lists: where they are, and when their particles leave them.
#[derive(serde::Serialize, serde::Deserialize)]
struct Boxes<const D: usize> {
    centre: Vec<Vector<D>>,
    exit_time: Vec<f64>,
}

/// The collision in the plan of each particle: when, with whom in which image, and the own time of that one when it was planned.
#[derive(serde::Serialize, serde::Deserialize)]
struct Plans {
    time: Vec<f64>,
    partner: Vec<Option<(u32, u8)>>,
    since: Vec<f64>,
}

impl<const D: usize> State<D> {
    fn of(engine: &EventDriven<D>) -> Self {
        // What is not named here is worked out again; a new field has to be put on one side or the other.
        let EventDriven {
            boundary,
            rules,
            flights,
            plans,
            bodies,
            slots,
            neighbours,
            pairs,
            piston: _,
            thermal_contacts,
            epoch,
            now,
            time,
            counts,
            next_epoch,
            removed,
            met: _,
            candidates: _,
            images: _,
            instructions: _,
            surfaces: _,
            bonds_unknown: _,
            calendar: _,
            asked_for: _,
            removals: _,
        } = engine;
        let slots = || slots.iter().map(|&slot| slot as usize);
        let boxes = match neighbours {
            Neighbours::Cells(_) => None,
            Neighbours::Lists(lists) => Some(Boxes {
                centre: slots().map(|i| lists.centre(i)).collect(),
                exit_time: slots().map(|i| plans[i].exit_time).collect(),
            }),
        };
        let partner = |other: Neighbour| plans.get(other.slot()).map(|plan| (plan.id, other.image() as u8));
        Self {
            plans: Plans {
                time: slots().map(|i| plans[i].pair.time).collect(),
                partner: slots().map(|i| partner(plans[i].pair.neighbour)).collect(),
                since: slots().map(|i| plans[i].since).collect(),
            },
            boundary: boundary.clone(),
            rules: *rules,
            growth: pairs.growth(),
            particles: Particles {
                position: slots().map(|i| flights[i].position).collect(),
                velocity: slots().map(|i| flights[i].velocity).collect(),
                mass: slots().map(|i| plans[i].mass).collect(),
                radius: slots().map(|i| flights[i].radius).collect(),
                species: slots().map(|i| bodies[i].species).collect(),
            },
            own_time: slots().map(|i| flights[i].time).collect(),
            images: slots().map(|i| Turns(bodies[i].images)).collect(),
            stuck: slots().map(|i| plans[i].stuck).collect(),
            thermal_contacts: thermal_contacts.clone(),
            bonds: pairs.bonds.pairs().collect(),
            boxes,
            piston: engine.kept_piston(),
            epoch: *epoch,
            now: *now,
            time: *time,
            removed: *removed,
            next_epoch: *next_epoch,
            counts: *counts,
        }
    }

    /// What a checksum does not tell: whether it is the state of an engine at all.
    fn validate(&self) -> Result<(), Invalid> {
        self.boundary.validate()?;
        self.particles.validate()?;
        let n = self.particles.len();
        let as_many = |key: &str, found: usize| {
            if found == n { Ok(()) } else { Err(Invalid::new(key, format!("{found} of them"), format!("one for each of {n}"))) }
        };
        as_many("own_time", self.own_time.len())?;
        as_many("images", self.images.len())?;
        as_many("stuck", self.stuck.len())?;
        if !self.thermal_contacts.is_empty() {
            as_many("thermal_contacts", self.thermal_contacts.len())?;
        }
        if let Some(boxes) = &self.boxes {
            as_many("boxes.centre", boxes.centre.len())?;
            as_many("boxes.exit_time", boxes.exit_time.len())?;
            if boxes.exit_time.iter().any(|time| time.is_nan()) || !boxes.centre.iter().all(|r| r.is_finite()) {
                return Err(Invalid::new("boxes", "something that is no number", "numbers"));
            }
        }
        as_many("plans.time", self.plans.time.len())?;
        as_many("plans.partner", self.plans.partner.len())?;
        as_many("plans.since", self.plans.since.len())?;
        let images = 3u8.pow(D as u32);
        for (i, (&time, &partner)) in self.plans.time.iter().zip(&self.plans.partner).enumerate() {
            let possible = partner.map_or(time == f64::INFINITY, |(j, image)| (j as usize) < n && image < images);
            if !(possible && time >= self.now) {
                return Err(Invalid::new("plans", format!("{partner:?} at {time} for particle {i}"), "a particle, from now on"));
            }
        }
        if let Some(piston) = &self.piston {
            as_many("piston.above", piston.above.len())?;
            if !piston.fits(n) {
                return Err(Invalid::new("piston", "plans with others", format!("times, and some of {n} particles")));
            }
        }
        if self.piston.is_some() != self.boundary.piston.is_some() {
            return Err(Invalid::new("piston", self.piston.is_some(), "one if the box has one"));
        }
        let clocks = [self.epoch, self.now, self.time, self.removed];
        if let Some(clock) = clocks.into_iter().chain(self.own_time.iter().copied()).find(|clock| !clock.is_finite()) {
            return Err(Invalid::new("time", clock, "a finite number"));
        }
        let there = |&(i, j): &(u32, u32)| i < j && (j as usize) < n;
        if let Some(bond) = self.bonds.iter().find(|bond| !there(bond)) {
            return Err(Invalid::new("bonds", format!("{bond:?}"), format!("two of {n} particles, in order")));
        }
        Ok(())
    }

    fn resume(self) -> Result<EventDriven<D>, Invalid> {
        self.validate()?;
        let mut engine = EventDriven::idle(self.boundary, &self.particles, self.rules, self.growth)?;
        for i in 0..self.particles.len() {
            let flight = &mut engine.flights[i];
            // As it was, and not brought into the box.
            (flight.position, flight.time) = (self.particles.position[i], self.own_time[i]);
            (engine.bodies[i].images, engine.plans[i].stuck) = (self.images[i].0, self.stuck[i]);
        }
        for (i, j) in self.bonds {
            engine.pairs.bonds.set(i, j, true);
        }
        engine.bonds_unknown = false;
        engine.thermal_contacts = self.thermal_contacts;
        engine.piston = self.piston.as_ref().map(MovingPiston::resumed);
        (engine.epoch, engine.now, engine.time) = (self.epoch, self.now, self.time);
        (engine.removals, engine.removed) = (removals(&engine.boundary, self.time), self.removed);
        engine.sort();
        let ids: Vec<usize> = (0..engine.flights.len()).map(|i| engine.id(i)).collect();
        let boxes = self.boxes.as_ref();
        engine.find_neighbours(|i, position| boxes.map_or(position, |boxes| boxes.centre[ids[i]]));
        if matches!(engine.neighbours, Neighbours::Lists(_)) != boxes.is_some() {
            return Err(Invalid::new("boxes", boxes.is_some(), "neighbours to be found in the same way as before"));
        }
        engine.plan_all();
        if let Some(boxes) = boxes {
            engine.plans.iter_mut().zip(&ids).for_each(|(plan, &id)| plan.exit_time = boxes.exit_time[id]);
        }
        engine.recall(&self.plans, &ids);
        if let Some(piston) = &self.piston {
            engine.recall_piston(piston);
        }
        engine.calendar.fill(engine.now, due(&engine.plans, engine.piston.as_ref()));
        (engine.counts, engine.next_epoch) = (self.counts, self.next_epoch);
        Ok(engine)
    }
}

impl<const D: usize> EventDriven<D> {
    /// Puts collisions into the plans they stood in, rather than into those of both particles.
    fn recall(&mut self, kept: &Plans, ids: &[usize]) {
        let anew: Vec<(Meet, f64)> = self.plans.iter().map(|plan| (plan.pair, plan.since)).collect();
        for (plan, &id) in self.plans.iter_mut().zip(ids) {
            let partner = kept.partner[id].map(|(id, image)| Neighbour::new(self.slots[id as usize], image));
            plan.pair = Meet { time: kept.time[id], neighbour: partner.unwrap_or(Neighbour::NONE) };
            plan.since = kept.since[id];
        }
        // Rounding may have put a particle into the next cell before its time, where it has neighbours it did not plan with.
        for (i, (pair, since)) in anew.into_iter().enumerate() {
            if self.plans[i].pair.time > pair.time && !under_its_law!(self.is_planned(i)) {
                (self.plans[i].pair, self.plans[i].since) = (pair, since);
            }
        }
    }

    /// Whether all that the particle meets before its planned collision stands in the plans of the others:
    /// `min(P(i), P(j)) <= T(i, j)`.
    fn is_planned<L: Law>(&mut self, i: usize) -> bool {
        let words = self.neighbours.candidates(i, &mut self.candidates);
        let view = View { flights: &self.flights, images: &self.images, field: self.rules.field };
        !words.iter().copied().map(Neighbour::from_word).filter(|other| other.slot() != i).any(|other| {
            let time = match L::PAIRS {
                Pairs::Hard => view.contact::<L>(&self.flights[i], other),
                Pairs::InWells | Pairs::Growing => self.pairs.next_event::<L, D>(&view, &self.plans, i, other),
            };
            // Those that never meet may have a time that is no number.
            time < self.plans[i].pair.time && self.plans[other.slot()].pair.time > time.max(self.now)
        })
    }
}

/// The state at this instant, from which [`Deserialize`] makes an engine that goes on to the same bits. The clock stands
/// still meanwhile: writing down changes nothing.
impl<const D: usize> Serialize for EventDriven<D> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        State::of(self).serialize(serializer)
    }
}

impl<'de, const D: usize> Deserialize<'de> for EventDriven<D> {
    fn deserialize<R: Deserializer<'de>>(deserializer: R) -> Result<Self, R::Error> {
        State::deserialize(deserializer)?.resume().map_err(R::Error::custom)
    }
}
