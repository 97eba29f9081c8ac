//! Replicas that are sampled at the same times, and what is said of hard particles in all of them.

use std::ops::ControlFlow;

use corpuscle_checkpoint::{Fault, Reader, Resume, Writer};
use corpuscle_core::{Contact, Engine, Failure, Observer};
use corpuscle_event::EventDriven;
use corpuscle_observe::{Check, Estimate, Schedule};

use crate::{Honesty, ensemble};

/// One of several independent systems, with what is noted of it.
pub(crate) trait Member: Resume + Send {
    /// Advances to `time` after the start of the measurement.
    fn advance(&mut self, time: f64) -> Result<(), Failure>;

    /// Notes what is measured, now.
    fn sample(&mut self);

    /// Time since the start of the measurement.
    fn time(&self) -> f64;
}

/// Systems side by side, sampled together at multiples of an interval; the first is on show.
pub(crate) struct Replicas<M> {
    pub(crate) members: Vec<M>,
    /// Times of the samples.
    pub(crate) times: Vec<f64>,
    schedule: Schedule,
}

impl<M: Member> Replicas<M> {
    /// Takes the first sample of each.
    pub(crate) fn new(interval: f64, mut members: Vec<M>) -> Self {
        members.iter_mut().for_each(Member::sample);
        Self { members, times: vec![0.0], schedule: Schedule::new(interval).after_start() }
    }

    /// Advances to `to`: all members to the last sample, the one on show all the way.
    ///
    /// # Errors
    /// The failure of the first member that failed.
    pub(crate) fn advance(&mut self, to: f64) -> Result<(), Failure> {
        while let Some(time) = self.schedule.due(to) {
            ensemble::for_each(&mut self.members, |member| {
                member.advance(time)?;
                member.sample();
                Ok(())
            })?;
            self.times.push(time);
        }
        self.members[0].advance(to)
    }

    /// Time of the member on show.
    pub(crate) fn time(&self) -> f64 {
        self.members[0].time()
    }

    /// Time of the last sample.
    pub(crate) fn sampled(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// One number of each member.
    pub(crate) fn values(&self, number: impl Fn(&M) -> f64) -> Vec<f64> {
        self.members.iter().map(number).collect()
    }

    /// The mean of one number over the members.
    pub(crate) fn mean(&self, number: impl Fn(&M) -> f64) -> Estimate {
        Estimate::from_replicas(&self.values(number))
    }
}

impl<M: Member> Resume for Replicas<M> {
    fn save(&self, out: &mut Writer) -> Result<(), Fault> {
        out.fields(3)?;
        out.value("times", &self.times)?;
        out.value("schedule", &self.schedule)?;
        out.part("members", &self.members)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Fault> {
        from.fields(3)?;
        self.times = from.value("times")?;
        self.schedule = from.value("schedule")?;
        from.part("members", &mut self.members)
    }
}

/// Calls a closure at each contact. One type for all: the engine's loop is compiled anew for every observer it meets.
pub(crate) struct Watch<'a, const D: usize>(pub(crate) &'a mut dyn FnMut(&Contact<D>));

impl<const D: usize> Observer<D> for Watch<'_, D> {
    fn contact(&mut self, contact: &Contact<D>) -> ControlFlow<()> {
        (self.0)(contact);
        ControlFlow::Continue(())
    }
}

/// What can be said of the numbers of event-driven runs, each with the energy it started with where that is conserved.
pub(crate) fn honesty<'a, const D: usize>(runs: impl Iterator<Item = (&'a EventDriven<D>, Option<f64>)>) -> Honesty {
    let mut honesty = Honesty { engine: "event-driven".into(), work_unit: "collisions", ..Honesty::default() };
    let largest = |so_far: Option<f64>, value: f64| {
        Some(so_far.map_or(value, |most| if value > most || value.is_nan() { value } else { most }))
    };
    let mut rejected = 0;
    for (engine, energy) in runs {
        let counts = engine.counts();
        honesty.work += counts.collisions + counts.wall_collisions;
        rejected += counts.stale;
        if let Some(start) = energy {
            let now = engine.kinetic_energy() + engine.potential_energy();
            honesty.energy_drift = largest(honesty.energy_drift, (now / start - 1.0).abs());
        }
        let diameter = 2.0 * (0..engine.particle_count()).map(|i| engine.radius(i)).fold(0.0, f64::max);
        if diameter > 0.0 {
            let depth = engine.boundary().largest_overlap(&engine.snapshot()) / diameter;
            honesty.largest_overlap = largest(honesty.largest_overlap, depth);
        }
    }
    honesty.rejected_events = Some(rejected);
    honesty
}

/// The check of the energy that elastic collisions conserve.
pub(crate) fn energy_check(honesty: &Honesty) -> Option<Check> {
    let drift = honesty.energy_drift?;
    Some(Check::at_most("relative energy drift", drift, 1e-11, "elastic collisions, double precision"))
}
