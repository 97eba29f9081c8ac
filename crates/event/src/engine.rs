//! The engine: one loop that takes the earliest event and executes it.

use std::ops::ControlFlow;

use corpuscle_core::{Axis, Boundary, Engine, Failure, Invalid, Observer, Particles, Vector};

use crate::calendar::Calendar;
use crate::grid::{Candidates, Grid};
use crate::motion::Flight;
use crate::plan::Plan;
use crate::surface::{Surface, surfaces};
use crate::{Counts, Rules};

/// Hard particles in a [`Boundary`], advanced from contact to contact.
///
/// # How it works
/// Each particle is *lazy*: it is stored as it was at its own last contact, and moved only when the next one comes.
/// Its plan holds its earliest collision with another particle, its next contact with a wall, and when it leaves its
/// cell; a calendar queue of one entry a particle tells whose plan is due. A step is `O(1)` in the number of particles.
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
/// cell the new neighbours may lower it; and when the event comes up but its partner has changed meanwhile (its stamp
/// tells), the neighbourhood is searched again, with the same `T(i, j)`. Particles that are no neighbours cannot touch
/// before one of them steps into another cell, and are then tested. Hence no pair passes its `T(i, j)` unnoticed,
/// although each particle stores a single event and nothing is ever deleted from other plans.
///
/// # Reproducibility
/// Reading particles or stopping at any time never writes their state, and events at equal times are ordered by
/// particle: the same start gives the same bits however it is advanced.
#[derive(Clone, Debug)]
pub struct EventDriven<const D: usize> {
    pub(crate) boundary: Boundary<D>,
    pub(crate) rules: Rules<D>,
    pub(crate) flights: Vec<Flight<D>>,
    pub(crate) plans: Vec<Plan<D>>,
    pub(crate) bodies: Vec<Body<D>>,
    pub(crate) grid: Grid<D>,
    pub(crate) candidates: Candidates,
    pub(crate) surfaces: Vec<Surface<D>>,
    pub(crate) calendar: Calendar,
    /// Times in flights, plans and calendar count from here, so that they stay small and fine.
    pub(crate) epoch: f64,
    /// The clock, from the epoch and in physical time.
    pub(crate) now: f64,
    pub(crate) time: f64,
    pub(crate) counts: Counts,
    next_epoch: u64,
}

/// What a particle is, and how often it went around the periodic box: rarely needed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<const D: usize> {
    pub(crate) mass: f64,
    pub(crate) images: [i32; D],
    pub(crate) species: u16,
}

/// A particle may have this many contacts at one instant before the clock counts as stalled.
const STUCK: u32 = 10_000;

impl<const D: usize> EventDriven<D> {
    /// An engine at time 0.
    ///
    /// # Errors
    /// When box, particles or rules make no sense, particles overlap, or one has no mass: names what is wrong.
    #[allow(clippy::needless_pass_by_value, reason = "the engine takes the particles over")]
    pub fn new(boundary: Boundary<D>, particles: Particles<D>, rules: Rules<D>) -> Result<Self, Invalid> {
        boundary.validate_particles(&particles)?;
        rules.validate()?;
        if let Some(i) = particles.mass.iter().position(|&mass| mass <= 0.0) {
            return Err(Invalid::new(
                format!("mass of particle {i}"),
                particles.mass[i],
                "a positive mass: collisions need inertia",
            ));
        }
        if particles.len() >= 1 << 30 {
            return Err(Invalid::new("particles", particles.len(), "fewer than 2^30"));
        }
        let flight = |i: usize| Flight {
            position: boundary.wrap(particles.position[i]),
            velocity: particles.velocity[i],
            time: 0.0,
            radius: particles.radius[i],
        };
        let body = |i: usize| Body { mass: particles.mass[i], images: [0; D], species: particles.species[i] };
        let n = particles.len();
        let flights: Vec<_> = (0..n).map(flight).collect();
        let mut engine = Self {
            grid: Grid::new(&boundary, |i| flights[i].position, &particles.radius),
            candidates: Candidates::default(),
            surfaces: surfaces(&boundary),
            flights,
            plans: vec![Plan::IDLE; n],
            bodies: (0..n).map(body).collect(),
            calendar: Calendar::new(n),
            boundary,
            rules,
            epoch: 0.0,
            now: 0.0,
            time: 0.0,
            counts: Counts::default(),
            next_epoch: 0,
        };
        engine.next_epoch = engine.contacts_per_epoch();
        engine.plan_all();
        Ok(engine)
    }

    /// Changes the box between two events: a partition goes, a wall moves away. Particles keep their velocities.
    ///
    /// # Errors
    /// When the particles do not fit into the new box; the old one then stays.
    pub fn set_boundary(&mut self, boundary: Boundary<D>) -> Result<(), Invalid> {
        boundary.validate_particles(&self.snapshot())?;
        for i in 0..self.flights.len() {
            self.settle(i);
            self.flights[i].position = boundary.wrap(self.flights[i].position);
        }
        self.boundary = boundary;
        self.surfaces = surfaces(&self.boundary);
        self.rebuild_grid();
        self.plan_all();
        Ok(())
    }

    /// Turns every velocity round, now. The system retraces its path until rounding has grown too large.
    pub fn reverse_velocities(&mut self) {
        self.set_velocities(|_, velocity| *velocity = -*velocity);
    }

    /// Changes velocities now: `change(index, velocity)` is called for every particle and must leave finite numbers.
    pub fn set_velocities(&mut self, mut change: impl FnMut(usize, &mut Vector<D>)) {
        for i in 0..self.flights.len() {
            self.settle(i);
            change(i, &mut self.flights[i].velocity);
        }
        self.plan_all();
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
        self.boundary.validate_particles(&particles)?;
        self.settle(index);
        self.flights[index].position = particles.position[index];
        for k in 0..D {
            if self.boundary.axes[k] == Axis::Periodic {
                let side = self.boundary.upper[k] - self.boundary.lower[k];
                self.bodies[index].images[k] += ((target[k] - particles.position[index][k]) / side).round() as i32;
            }
        }
        self.rebuild_grid();
        self.plan_all();
        Ok(())
    }

    /// Brings a particle to the present: a change of its state, so only for events that change it anyway.
    #[inline]
    pub(crate) fn settle(&mut self, i: usize) {
        self.flights[i].bring_to(self.now, self.rules.field);
    }

    fn rebuild_grid(&mut self) {
        let (flights, now, field) = (&self.flights, self.now, self.rules.field);
        let radii: Vec<f64> = flights.iter().map(|flight| flight.radius).collect();
        self.grid = Grid::new(&self.boundary, |i| flights[i].position_at(now, field), &radii);
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
        self.plan_all();
    }

    fn run<const FIELD: bool, O: Observer<D>>(&mut self, to: f64, observer: &mut O) -> Result<ControlFlow<()>, Failure> {
        while let Some((time, i)) = self.calendar.take(to - self.epoch) {
            self.now = time;
            let i = i as usize;
            let plan = self.plans[i];
            let contact = if plan.pair_time == time {
                let j = plan.partner as usize;
                if self.plans[j].stamp != plan.partner_stamp {
                    self.counts.stale += 1;
                    self.plan_pair::<FIELD>(i);
                    self.calendar.schedule(i as u32, self.plans[i].next_time());
                    continue;
                }
                self.collide::<FIELD>(i, j, plan.image)
            } else if plan.surface_time == time {
                self.bounce::<FIELD>(i, plan.surface as usize)
            } else {
                self.leave_cell::<FIELD>(i, plan.exit);
                continue;
            };
            if self.plans[contact.first.index].stuck > STUCK {
                self.time = contact.time;
                return Err(Failure {
                    time: contact.time,
                    particle: Some(contact.first.index),
                    cause: format!(
                        "{STUCK} contacts without any time passing; set elastic_below (now {}) to a small positive speed, \
                         and leave no particle at rest on a wall",
                        self.rules.elastic_below
                    ),
                });
            }
            if self.counts.collisions + self.counts.wall_collisions >= self.next_epoch {
                self.begin_epoch();
            }
            if observer.contact(&contact).is_break() {
                self.time = contact.time;
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }
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
        let flow =
            if self.rules.field == Vector::ZERO { self.run::<false, O>(to, observer) } else { self.run::<true, O>(to, observer) }?;
        if flow.is_continue() {
            self.now = self.now.max(to - self.epoch);
            self.time = to;
        }
        Ok(())
    }

    fn snapshot_into(&self, particles: &mut Particles<D>) {
        let n = self.flights.len();
        particles.position.clear();
        particles.position.extend((0..n).map(|i| self.position(i)));
        particles.velocity.clear();
        particles.velocity.extend((0..n).map(|i| self.velocity(i)));
        particles.mass.clear();
        particles.mass.extend(self.bodies.iter().map(|body| body.mass));
        particles.radius.clear();
        particles.radius.extend(self.flights.iter().map(|flight| flight.radius));
        particles.species.clear();
        particles.species.extend(self.bodies.iter().map(|body| body.species));
    }
}
