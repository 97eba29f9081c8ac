//! Advancing a simulation in slices short enough to show progress and to hear a signal.

use std::time::{Duration, Instant};

use corpuscle_core::Failure;
use corpuscle_experiments::Simulation;
use indicatif::{ProgressBar, ProgressStyle};

use crate::signal::Stop;

/// Parts the bar is divided into.
const PARTS: f64 = 10_000.0;

/// The first slice is so small a part of the way that a signal is heard soon and a checkpoint written in time, however long the way.
const FIRST: f64 = 1e-9;

/// Drives a simulation through physical time. The slices adapt to the clock, which the simulation does not notice: where
/// a caller stops has no influence on what it computes.
pub(crate) struct Progress {
    bar: ProgressBar,
    start: f64,
    end: f64,
    now: f64,
    slice: f64,
    wall: Duration,
    stop: Stop,
}

impl Progress {
    /// Progress of a simulation towards `end`, shown when standard error is a terminal.
    pub(crate) fn new(simulation: &dyn Simulation, end: f64, quiet: bool, stop: Stop) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(PARTS as u64) };
        let style = ProgressStyle::with_template("{wide_bar:.cyan/dim} {percent:>3} %  {elapsed} of about {duration}  {msg}");
        // The template is a constant that every test of the command shows to be right.
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let start = simulation.time();
        Self { bar, start, end, now: start, slice: FIRST * (end - start), wall: Duration::ZERO, stop }
    }

    /// Advances to the physical time `to`; false when a signal came before it was reached.
    pub(crate) fn advance(&mut self, simulation: &mut dyn Simulation, to: f64) -> Result<bool, Failure> {
        while self.now < to {
            if self.stop.asked() {
                return Ok(false);
            }
            self.slice(simulation, to)?;
        }
        Ok(true)
    }

    /// Advances by one slice, and not beyond `to`.
    pub(crate) fn slice(&mut self, simulation: &mut dyn Simulation, to: f64) -> Result<(), Failure> {
        if self.now < to {
            let next = (self.now + self.slice).max(self.now.next_up()).min(to);
            let started = Instant::now();
            let outcome = simulation.advance(next);
            let spent = started.elapsed();
            self.wall += spent;
            outcome?;
            self.now = next;
            match spent.as_millis() {
                0..50 => self.slice *= 2.0,
                200.. => self.slice *= 0.5,
                _ => {}
            }
            self.bar.set_position((PARTS * ((self.now - self.start) / (self.end - self.start)).clamp(0.0, 1.0)) as u64);
            self.bar.set_message(format!("t = {}", corpuscle_io::number::significant(self.now, 4)));
        }
        Ok(())
    }

    /// Physical time reached.
    pub(crate) fn now(&self) -> f64 {
        self.now
    }

    /// Whether a signal has come.
    pub(crate) fn stopped(&self) -> bool {
        self.stop.asked()
    }

    /// Time on the clock spent in the simulation.
    pub(crate) fn wall(&self) -> Duration {
        self.wall
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
