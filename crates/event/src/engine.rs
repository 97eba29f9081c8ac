//! The engine: one loop that takes the earliest event and executes it.

use std::borrow::Cow;
use std::ops::ControlFlow;

use corpuscle_core::instructions::Instructions;
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Observer, Particles, Vector};

use crate::calendar::Calendar;
use crate::law::{Law, under_its_law};
use crate::motion::Flight;
use crate::neighbours::{Candidates, Neighbours};
use crate::order::place_on_curve;
use crate::pages::with_large_pages;
use crate::pair::{Growth, State};
use crate::piston::MovingPiston;
use crate::plan::{Plan, due};
use crate::search::{Images, Neighbour};
use crate::surface::Surfaces;
use crate::{Counts, Rules};

/// Hard particles in a [`Boundary`], advanced from contact to contact.
///
/// # How it works
/// Each particle is *lazy*: it is stored as it was at its own last contact, and moved only when the next one comes.
/// Its plan holds its earliest collision with another particle, its next contact with a wall, and when it leaves its
/// cell; a calendar queue tells whose plan is due. A step is `O(1)` in the number of particles.
///
/// # Why no collision is lost
/// The predicted time `T(i, j)` of a pair is a function of the two stored states alone, symmetric in `i` and `j` to the
/// last bit: it depends neither on cells, nor on when or for which of the two it was computed. Let *planned* `P(i)` be
/// the time of the pair event in the plan of `i`. For every pair of neighbours the engine keeps
///
/// > `min(P(i), P(j)) <= T(i, j)`.
///
/// A search through the whole neighbourhood of `i` makes `P(i) <= T(i, j)` for all `j`; whenever the state of a particle
/// changes, it is searched for. So after the later of the last changes of `i` and `j` the inequality holds, for the
/// one that changed then. Later on `P(i)` changes without a change of `i` in two cases only: at a step into another
/// cell, or with a new box and list, the new neighbours may lower it; and when the event comes up but its partner has
/// changed meanwhile (its own time tells), the neighbourhood is searched again, with the same `T(i, j)`. Particles that
/// are no neighbours cannot touch before one of them steps into another cell or leaves its box, and are then tested.
/// Hence no pair passes its `T(i, j)` unnoticed, although each particle stores a single event and nothing is ever deleted
/// from other plans.
///
/// # Reproducibility
/// Reading particles or stopping at any time never writes their state, and events at equal times are ordered by
/// particle: the same start gives the same bits however it is advanced.
#[derive(Clone, Debug)]
pub struct EventDriven<const D: usize> {
    pub(crate) boundary: Boundary<D>,
    pub(crate) rules: Rules<D>,
    pub(crate) flights: Vec<Flight<D>>,
    pub(crate) plans: Vec<Plan>,
    pub(crate) bodies: Vec<Body<D>>,
    /// Number of the surface each particle meets next; empty if there are none.
    pub(crate) met: Vec<u32>,
    /// Particles are stored in the order of a curve through the box: the place of each.
    pub(crate) slots: Vec<u32>,
    pub(crate) neighbours: Neighbours<D>,
    pub(crate) candidates: Candidates,
    pub(crate) images: Images<D>,
    pub(crate) instructions: Instructions,
    pub(crate) surfaces: Surfaces<D>,
    pub(crate) pairs: State,
    /// Which pairs are in their wells is not known yet.
    pub(crate) bonds_unknown: bool,
    pub(crate) piston: Option<MovingPiston>,
    /// How often each particle has touched a wall with a temperature; empty without such walls.
    pub(crate) thermal_contacts: Vec<u32>,
    pub(crate) calendar: Calendar,
    /// Times in flights, plans and calendar count from here, so that they stay small and fine.
    pub(crate) epoch: f64,
    /// The clock, from the epoch and in physical time.
    pub(crate) now: f64,
    pub(crate) time: f64,
    pub(crate) counts: Counts,
    pub(crate) next_epoch: u64,
    /// The last month of the calendar that memory was asked for.
    pub(crate) asked_for: u64,
    /// When partitions and faces are going to go, the next one last; and when the last one went.
    pub(crate) removals: Vec<f64>,
    pub(crate) removed: f64,
}

/// The species of a particle, and how often it went around the periodic box: rarely needed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<const D: usize> {
    pub(crate) images: [i32; D],
    pub(crate) species: u16,
}

/// A particle may have this many contacts at one instant before the clock counts as stalled.
const STUCK: u16 = 10_000;

impl<const D: usize> EventDriven<D> {
    /// An engine at time 0.
    ///
    /// # Errors
    /// When box, particles or rules make no sense, particles overlap, one has no mass or lies on a wall, pressed by the field: names
    /// what is wrong.
    #[allow(clippy::needless_pass_by_value, reason = "the engine takes the particles over")]
    pub fn new(boundary: Boundary<D>, particles: Particles<D>, rules: Rules<D>) -> Result<Self, Invalid> {
        boundary.validate_particles(&particles)?;
        Self::start(boundary, &particles, rules, None)
    }

    /// An engine at time 0 whose spheres grow: at the time `t` their radii are `scale + rate t` of those of `particles`.
    ///
    /// Contacts of two are elastic, in the frame of their growing surfaces, and so heat them (Lubachevsky and Stillinger
    /// 1990, doi:10.1007/BF01025983). From walls they keep as far as their whole radii ask for. Meant for `scale + rate t`
    /// up to 1: see [`grown`](crate::grown).
    ///
    /// # Errors
    /// As [`new`](Self::new); the whole spheres have to fit between the walls, those that are small yet next to each other.
    #[allow(clippy::needless_pass_by_value, reason = "the engine takes the particles over")]
    pub fn growing(boundary: Boundary<D>, particles: Particles<D>, scale: f64, rate: f64) -> Result<Self, Invalid> {
        if !(0.0..=1.0).contains(&scale) {
            return Err(Invalid::new("scale", scale, "a number from 0 to 1"));
        }
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(Invalid::new("rate", rate, "a number above 0"));
        }
        let mut small = particles.clone();
        small.radius.iter_mut().for_each(|radius| *radius *= scale);
        boundary.validate_particles(&small)?;
        for i in 0..particles.len() {
            let mut alone = Particles::new();
            alone.push(particles.position[i], Vector::ZERO, 1.0, particles.radius[i], 0);
            boundary.validate_particles(&alone)?;
        }
        Self::start(boundary, &particles, Rules::default(), Some(Growth { scale, rate }))
    }

    fn start(boundary: Boundary<D>, particles: &Particles<D>, rules: Rules<D>, growth: Option<Growth>) -> Result<Self, Invalid> {
        let mut engine = Self::idle(boundary, particles, rules, growth)?;
        engine.begin_anew();
        engine.refuse_lasting_contacts()?;
        Ok(engine)
    }

    /// An engine at time 0 that has no plans yet.
    pub(crate) fn idle(
        boundary: Boundary<D>,
        particles: &Particles<D>,
        rules: Rules<D>,
        growth: Option<Growth>,
    ) -> Result<Self, Invalid> {
        rules.validate()?;
        rules.pair.validate_box(&boundary, particles)?;
        if let Some(i) = particles.mass.iter().position(|&mass| mass <= 0.0) {
            return Err(Invalid::new(
                format!("mass of particle {i}"),
                particles.mass[i],
                "a positive mass: collisions need inertia",
            ));
        }
        if particles.len() >= Neighbour::LIMIT {
            return Err(Invalid::new("particles", particles.len(), format!("fewer than {}", Neighbour::LIMIT)));
        }
        let flight = |i: usize| Flight {
            position: boundary.wrap(particles.position[i]),
            velocity: particles.velocity[i],
            time: 0.0,
            radius: particles.radius[i],
        };
        let body = |i: usize| Body { images: [0; D], species: particles.species[i] };
        let n = particles.len();
        let flights: Vec<_> = (0..n).map(flight).collect();
        let images = Images::new(boundary.extent());
        let mut candidates = Candidates::default();
        let mut engine = Self {
            neighbours: Neighbours::new(&boundary, &[], 1.0, |_| Vector::ZERO, &images, &mut candidates),
            candidates,
            images,
            instructions: Instructions::detect(),
            surfaces: Surfaces::default(),
            pairs: State::new(rules.pair, growth, n),
            bonds_unknown: true,
            piston: boundary.piston.map(|piston| MovingPiston::new(piston, 0.0, flights.iter().map(|flight| flight.position))),
            thermal_contacts: vec![],
            removals: removals(&boundary, 0.0),
            removed: 0.0,
            flights,
            plans: (0..n).map(|i| Plan::idle(i, particles.mass[i])).collect(),
            bodies: (0..n).map(body).collect(),
            met: vec![],
            slots: (0..n as u32).collect(),
            calendar: Calendar::new(n + usize::from(boundary.piston.is_some())),
            boundary,
            rules,
            epoch: 0.0,
            now: 0.0,
            time: 0.0,
            counts: Counts::default(),
            next_epoch: 0,
            asked_for: 0,
        };
        engine.next_epoch = engine.contacts_per_epoch();
        engine.count_thermal_contacts();
        Ok(engine)
    }

    /// Changes the box between two events: a partition goes, a wall moves away. Particles keep their velocities; a piston
    /// starts as the new box describes it, which may be as [`piston`](Self::piston) tells.
    ///
    /// # Errors
    /// When the particles do not fit into the new box; the old one then stays.
    pub fn set_boundary(&mut self, boundary: Boundary<D>) -> Result<(), Invalid> {
        boundary.validate_particles_at(self.time, &self.snapshot())?;
        self.rules.pair.validate_box(&boundary, &self.snapshot())?;
        self.bonds_unknown = true;
        for i in 0..self.flights.len() {
            self.settle(i);
            self.flights[i].position = boundary.wrap(self.flights[i].position);
        }
        self.images = Images::new(boundary.extent());
        let (now, slots, flights) = (self.now, &self.slots, &self.flights);
        let positions = slots.iter().map(|&i| flights[i as usize].position);
        self.piston = boundary.piston.map(|piston| MovingPiston::new(piston, now, positions));
        self.calendar = Calendar::new(self.flights.len() + usize::from(self.piston.is_some()));
        (self.removals, self.removed) = (removals(&boundary, self.time), self.time);
        self.boundary = boundary;
        self.count_thermal_contacts();
        self.begin_anew();
        Ok(())
    }

    /// Turns every velocity round, now. The system retraces its path until rounding has grown too large.
    ///
    /// The piston turns round as well; what moves as prescribed does not.
    pub fn reverse_velocities(&mut self) {
        if let Some(piston) = &mut self.piston {
            piston.reverse(self.now);
        }
        self.set_velocities(|_, velocity| *velocity = -*velocity);
    }

    /// Changes velocities now: `change(index, velocity)` is called for every particle and must leave finite numbers.
    pub fn set_velocities(&mut self, mut change: impl FnMut(usize, &mut Vector<D>)) {
        for id in 0..self.slots.len() {
            let i = self.slots[id] as usize;
            self.settle(i);
            change(id, &mut self.flights[i].velocity);
        }
        self.begin_anew();
    }

    /// Moves the centre of one particle, now.
    ///
    /// # Errors
    /// When it would be outside of the box or overlap another; nothing is changed then.
    pub fn shift_position(&mut self, index: usize, shift: Vector<D>) -> Result<(), Invalid> {
        if index >= self.flights.len() {
            return Err(Invalid::new("particle", index, format!("an index below {}", self.flights.len())));
        }
        let mut particles = self.snapshot();
        let target = particles.position[index] + shift;
        particles.position[index] = self.boundary.wrap(target);
        Boundary { piston: self.piston(), ..self.boundary.clone() }.validate_particles_at(self.time, &particles)?;
        let i = self.slots[index] as usize;
        self.settle(i);
        self.flights[i].position = target;
        self.bonds_unknown = true;
        self.begin_anew();
        Ok(())
    }

    /// Brings a particle to the present: a change of its state, so only for events that change it anyway.
    ///
    /// Its own time always grows, if only by the last bit where it changes several times at one instant: from it others
    /// see that its flight has changed.
    #[inline]
    pub(crate) fn settle(&mut self, i: usize) {
        let flight = &mut self.flights[i];
        let before = flight.time;
        flight.bring_to(self.now, self.rules.field);
        if before >= self.now {
            flight.time = before.next_up();
        }
    }

    /// Brings a particle that is beyond a periodic face back into the box; says whether it was.
    pub(crate) fn wrap(&mut self, i: usize) -> bool {
        let mut wrapped = false;
        for k in 0..D {
            if self.boundary.axes[k] == Axis::Periodic {
                let (lower, upper) = (self.boundary.lower[k], self.boundary.upper[k]);
                let now = self.flights[i].position_at(self.now, self.rules.field)[k];
                if now < lower || now >= upper {
                    let turns = ((now - lower) / (upper - lower)).floor();
                    self.flights[i].position[k] -= turns * (upper - lower);
                    self.bodies[i].images[k] += turns as i32;
                    wrapped = true;
                }
            }
        }
        wrapped
    }

    /// Sorts the particles in memory, looks for all their neighbours and plans everything anew.
    pub(crate) fn begin_anew(&mut self) {
        for i in 0..self.flights.len() {
            self.wrap(i);
        }
        self.sort();
        self.find_neighbours(|_, position| position);
        self.plan_all();
    }

    /// Looks for all neighbours. `centre` tells, from a particle's place in memory and its position now, around where it is
    /// to be looked for.
    pub(crate) fn find_neighbours(&mut self, centre: impl Fn(usize, Vector<D>) -> Vector<D>) {
        let (flights, now, field) = (&self.flights, self.now, self.rules.field);
        // To a search for neighbours particles are as large as their pair law reaches.
        let range = self.pairs.range();
        let wide = |flight: &Flight<D>| Flight { radius: range * flight.radius, ..*flight };
        let flights: Cow<[_]> = if range == 1.0 { flights.into() } else { flights.iter().map(wide).collect() };
        let position = |i: usize| centre(i, flights[i].position_at(now, field));
        let core = self.pairs.core();
        self.neighbours = Neighbours::new(&self.boundary, &flights, core, position, &self.images, &mut self.candidates);
        self.surfaces = Surfaces::new(&self.boundary, self.removed, &self.neighbours, &self.flights);
        if self.bonds_unknown {
            self.find_bonds();
        }
    }

    /// The number by which a particle is known outside, of the one stored at this place.
    #[inline]
    pub(crate) fn id(&self, i: usize) -> usize {
        self.plans[i].id as usize
    }

    /// Brings particles that are near each other in space near each other in memory.
    pub(crate) fn sort(&mut self) {
        let place = |i: usize| place_on_curve(&self.boundary, self.flights[i].position_at(self.now, self.rules.field));
        let mut order: Vec<(u64, u32)> = (0..self.flights.len()).map(|i| (place(i), i as u32)).collect();
        order.sort_unstable_by_key(|&(place, i)| (place, self.plans[i as usize].id));
        arrange(&mut self.flights, &order);
        arrange(&mut self.plans, &order);
        arrange(&mut self.bodies, &order);
        for (slot, plan) in self.plans.iter().enumerate() {
            self.slots[plan.id as usize] = slot as u32;
        }
    }

    fn contacts_per_epoch(&self) -> u64 {
        (64 * self.flights.len() as u64).max(1 << 16)
    }

    /// Lets time count from a later epoch. It happens after a fixed number of contacts, and the shift is a power of two,
    /// so that it is exact and never depends on where a caller stopped.
    fn begin_epoch(&mut self) {
        self.next_epoch += self.contacts_per_epoch();
        let shift = if self.now > 0.0 { power_of_two_below(self.now) } else { 0.0 };
        self.epoch += shift;
        self.now -= shift;
        for flight in &mut self.flights {
            flight.time -= shift;
        }
        if let Some(piston) = &mut self.piston {
            piston.shift_epoch(shift);
        }
        self.pairs.shift_epoch(shift);
        self.begin_anew();
    }

    fn run<L: Law>(&mut self, to: f64, observer: &mut impl Observer<D>) -> Result<ControlFlow<()>, Failure> {
        let large = self.is_large();
        while let Some((time, i)) = self.calendar.take(to - self.epoch, due(&self.plans, self.piston.as_ref())) {
            self.now = time;
            let i = i as usize;
            if large {
                self.ask_for_what_is_coming();
            }
            let Some(plan) = self.plans.get(i) else {
                // Behind the particles: the piston.
                if let Some(contact) = self.piston_event::<L>()
                    && self.report(&contact, observer)?.is_break()
                {
                    return Ok(ControlFlow::Break(()));
                }
                continue;
            };
            let contact = if plan.pair.time == time {
                let partner = plan.pair.neighbour;
                if self.flights[partner.slot()].time != plan.since {
                    self.replace_stale::<L>(i);
                    continue;
                }
                self.collide::<L>(i, partner)
            } else if plan.surface_time == time {
                let Some(contact) = self.touch::<L>(i) else { continue };
                contact
            } else {
                self.leave::<L>(i);
                continue;
            };
            if self.report(&contact, observer)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// A contact has happened: looks whether the clock still runs, and tells the observer.
    #[allow(clippy::inline_always, reason = "what no observer looks at is then not computed")]
    #[inline(always)]
    fn report<O: Observer<D>>(&mut self, contact: &Contact<D>, observer: &mut O) -> Result<ControlFlow<()>, Failure> {
        if self.plans[self.slots[contact.first.index] as usize].stuck > STUCK {
            self.time = contact.time;
            return Err(Failure {
                time: contact.time,
                particle: Some(contact.first.index),
                cause: format!(
                    "{STUCK} contacts without any time passing; set elastic_below (now {}) to a small positive speed, leave no \
                     particle at rest on a wall, and none where a wall that moves would crush it",
                    self.rules.elastic_below
                ),
            });
        }
        if self.counts.collisions + self.counts.edges + self.counts.wall_collisions >= self.next_epoch {
            self.begin_epoch();
        }
        let flow = observer.contact(contact);
        if flow.is_break() {
            self.time = contact.time;
        }
        Ok(flow)
    }

    /// Partitions and faces whose time has come are gone: nobody moves, all plan anew.
    fn remove(&mut self, time: f64) {
        self.removals.pop();
        self.now = self.now.max(time - self.epoch);
        (self.time, self.removed) = (time, time);
        self.begin_anew();
    }
}

/// Times after `now` at which a partition or a face goes, the earliest last.
pub(crate) fn removals<const D: usize>(boundary: &Boundary<D>, now: f64) -> Vec<f64> {
    let plates = boundary.partitions.iter().filter_map(|plate| plate.removed_at);
    let faces = boundary.faces.iter().flatten().filter_map(|face| face.opened_at);
    let mut times: Vec<f64> = plates.chain(faces).filter(|&time| now < time && time.is_finite()).collect();
    times.sort_by(|a, b| b.total_cmp(a));
    times.dedup();
    times
}

/// Puts items into an order.
fn arrange<T: Copy>(items: &mut Vec<T>, order: &[(u64, u32)]) {
    let mut arranged = with_large_pages(items.len());
    arranged.extend(order.iter().map(|&(_, i)| items[i as usize]));
    *items = arranged;
}

/// The largest power of two not above a positive normal number: its exponent with an empty mantissa.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (0x7ff << 52))
}

impl<const D: usize> Engine<D> for EventDriven<D> {
    fn time(&self) -> f64 {
        self.time
    }

    fn advance<O: Observer<D>>(&mut self, to: f64, observer: &mut O) -> Result<(), Failure> {
        if !to.is_finite() {
            return Err(Failure { time: self.time, particle: None, cause: format!("cannot advance to t = {to}") });
        }
        if to <= self.time {
            return Ok(());
        }
        loop {
            let removal = self.removals.last().copied().filter(|&time| time <= to);
            let stop = removal.unwrap_or(to);
            let flow = under_its_law!(self.run(stop, observer))?;
            if flow.is_break() {
                return Ok(());
            }
            let Some(time) = removal else { break };
            self.remove(time);
        }
        self.now = self.now.max(to - self.epoch);
        self.time = to;
        Ok(())
    }

    fn snapshot_into(&self, particles: &mut Particles<D>) {
        let n = self.flights.len();
        particles.position.clear();
        particles.position.extend((0..n).map(|i| self.position(i)));
        particles.velocity.clear();
        particles.velocity.extend((0..n).map(|i| self.velocity(i)));
        particles.mass.clear();
        particles.mass.extend(self.slots.iter().map(|&i| self.plans[i as usize].mass));
        particles.radius.clear();
        particles.radius.extend(self.slots.iter().map(|&i| self.flights[i as usize].radius));
        particles.species.clear();
        particles.species.extend(self.slots.iter().map(|&i| self.bodies[i as usize].species));
    }
}
