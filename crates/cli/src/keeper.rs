//! When a checkpoint is due, and writing it.

use std::path::Path;
use std::time::{Duration, Instant};

use clap::Args;
use corpuscle_experiments::Simulation;
use corpuscle_io::checkpoint::{Policy, Run, bytes};
use corpuscle_io::{Checkpoints, WriteError};

use crate::command::positive;
use crate::console::complain;
use crate::trouble::Trouble;

/// Seconds between checkpoints when nothing else is asked for: a shorter run needs none.
const USUAL: f64 = 60.0;
/// How many are kept: should the newest be damaged, there is another.
const KEPT: usize = 2;

/// Time between two of them in units of what one takes, where the clock decides: no more than a tenth of a run goes into them.
const LEAST: u32 = 9;

/// When checkpoints are to be written.
#[derive(Args)]
pub(crate) struct Options {
    /// Write a checkpoint every so many seconds on the clock, and not so often that it costs more than a tenth of the time
    /// [default: 60, unless another interval is given].
    #[arg(long, value_name = "SECONDS", value_parser = positive, allow_hyphen_values = true)]
    checkpoint_wall: Option<f64>,
    /// Write a checkpoint whenever so much physical time has passed.
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true)]
    checkpoint_time: Option<f64>,
    /// Write a checkpoint after so many collisions or steps, as soon as they have been counted.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    checkpoint_work: Option<u64>,
    /// Keep the newest so many checkpoints, and keep them when the run has finished [default: 2, until it has].
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..))]
    checkpoints: Option<u16>,
    /// Write no checkpoints.
    #[arg(long, conflicts_with_all = ["checkpoint_wall", "checkpoint_time", "checkpoint_work", "checkpoints"])]
    no_checkpoints: bool,
}

impl Options {
    /// What they mean for a new run.
    pub(crate) fn policy(&self, pictures: bool) -> Policy {
        let (time, work) = (self.checkpoint_time, self.checkpoint_work);
        let usual = (!self.no_checkpoints && time.is_none() && work.is_none()).then_some(USUAL);
        Policy {
            wall: self.checkpoint_wall.or(usual),
            time,
            work,
            keep: self.checkpoints.map_or(KEPT, usize::from),
            stay: self.checkpoints.is_some(),
            pictures,
        }
    }

    /// What they change for a run that goes on.
    pub(crate) fn change(&self, before: Policy) -> Policy {
        let asked = [self.checkpoint_wall.is_some(), self.checkpoint_time.is_some(), self.checkpoint_work.is_some()];
        let new = self.policy(before.pictures);
        let (keep, stay) = if self.checkpoints.is_some() { (new.keep, true) } else { (before.keep, before.stay) };
        if self.no_checkpoints || asked.contains(&true) { Policy { keep, stay, ..new } } else { Policy { keep, stay, ..before } }
    }
}

/// Keeps a run: writes its checkpoints when they are due.
pub(crate) struct Keeper {
    checkpoints: Checkpoints,
    policy: Policy,
    /// When the last was written, on the clock, in physical time, and by work.
    clock: Instant,
    time: f64,
    work: u64,
    /// What the last one took.
    cost: Duration,
    /// Physical time of the newest there is.
    newest: Option<f64>,
}

impl Keeper {
    /// For the run in this folder, of whose checkpoints the newest was written at the time `newest`.
    pub(crate) fn new(folder: &Path, policy: Policy, simulation: &dyn Simulation, newest: Option<f64>) -> Self {
        let able = simulation.state().is_some();
        if !able && (policy.time.is_some() || policy.work.is_some() || policy.wall.is_some_and(|wall| wall != USUAL)) {
            complain("this experiment cannot be taken up again: no checkpoints are written");
        }
        // A policy may come from a stranger's file.
        let positive = |interval: &f64| *interval > 0.0;
        let (wall, time, work) = (policy.wall.filter(positive), policy.time.filter(positive), policy.work.filter(|&work| work > 0));
        let policy = Policy { wall, time, work, ..policy };
        let policy = if able { policy } else { Policy { wall: None, time: None, work: None, ..policy } };
        let work = if policy.work.is_some() { simulation.honesty().work } else { 0 };
        Self {
            checkpoints: Checkpoints::of(folder),
            policy,
            clock: Instant::now(),
            time: simulation.time(),
            work,
            cost: Duration::ZERO,
            newest,
        }
    }

    /// When checkpoints are written.
    pub(crate) fn policy(&self) -> &Policy {
        &self.policy
    }

    /// Physical time of the newest checkpoint.
    pub(crate) fn newest(&self) -> Option<f64> {
        self.newest
    }

    /// The physical time at which the next one is due.
    pub(crate) fn next_time(&self) -> f64 {
        let next = |interval: f64| interval * ((self.time / interval).floor() + 1.0);
        // An interval below the resolution of time is no reason to stand still.
        self.policy.time.map_or(f64::INFINITY, |interval| next(interval).max(self.time.next_up()))
    }

    /// Whether one is due now that the simulation has been asked to advance to `time`: where it says it is may be off by rounding.
    pub(crate) fn is_due(&self, simulation: &dyn Simulation, time: f64) -> bool {
        let long_enough = |seconds: f64| self.clock.elapsed() >= Duration::from_secs_f64(seconds.min(1e9)).max(LEAST * self.cost);
        self.policy.wall.is_some_and(long_enough)
            || time >= self.next_time()
            || self.policy.work.is_some_and(|interval| simulation.honesty().work / interval > self.work / interval)
    }

    /// Whether any are to be written at all.
    pub(crate) fn is_on(&self) -> bool {
        let Policy { wall, time, work, .. } = &self.policy;
        wall.is_some() || time.is_some() || work.is_some()
    }

    /// Writes one, of a simulation that has been asked to advance to `time`.
    pub(crate) fn write(&mut self, run: &Run, simulation: &dyn Simulation, time: f64) -> Result<(), Trouble> {
        let bytes = bytes(run, simulation).map_err(|fault| Trouble::Fault(format!("the state cannot be written down: {fault}")))?;
        self.checkpoints.write(&bytes, self.policy.keep)?;
        (self.time, self.newest) = (time, Some(simulation.time()));
        self.work = if self.policy.work.is_some() { simulation.honesty().work } else { 0 };
        Ok(())
    }

    /// A checkpoint, and what goes with it, has taken so long.
    pub(crate) fn took(&mut self, cost: Duration) {
        (self.clock, self.cost) = (Instant::now(), cost);
    }

    /// The run has finished and everything is written down.
    pub(crate) fn finish(&self) {
        if !self.policy.stay {
            self.checkpoints.clear();
        }
    }

    /// What could not be written, with how to go on from the last checkpoint.
    pub(crate) fn lost(&self, error: WriteError, folder: &Path) -> Trouble {
        Trouble::Lost { error, time: self.newest, folder: folder.into() }
    }
}
