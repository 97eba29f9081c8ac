//! A running experiment under a viewer's hands: wall time becomes physical time, orders become deeds.
//!
//! It knows no window, no thread and no clock: whoever drives it says how much time has passed and when to stop for a look.
//! Neither has any influence on what the simulation computes, only on how far it has come. Going back means running again
//! from the start with the same deeds at the same times: the bits are the same, whatever happened in between.

use std::sync::Arc;

use corpuscle_experiments::{Action, Simulation};
use corpuscle_io::{Refusal, Scenario};

use super::beside::Beside;
use super::paint::Paint;
use super::sight::Sight;
use super::snapshot::{Fault, Measured, Snapshot};

/// Parts the way to a picture is advanced in, so that there is a place to stop.
const PARTS: u32 = 16;
/// What a single step advances, in seconds of the viewer.
const STEP: f64 = 1.0 / 30.0;
/// Parts of the run that are advanced at once, at first: then as many as a look for orders has time for.
const STRIDES: f64 = 400.0;
/// Parts of the run that are advanced at once at least: what each costs by itself would else be all the work.
const FINEST: f64 = 1e5;

/// What a person asks of the simulation.
#[derive(Clone)]
pub enum Order {
    /// Run this scenario from its start.
    Start(Box<Scenario>),
    /// Let time pass, or stop it.
    Play(bool),
    /// Physical time a second of the viewer, as a multiple of the usual.
    Speed(f64),
    /// Advance by a thirtieth of a second of the viewer, and stop.
    Step,
    /// Advance to just after the next collision, and stop.
    NextEvent,
    /// Do something to the system, now.
    Act(Action),
    /// Let the bodies' colours tell something else.
    Paint(Paint),
    /// Draw velocities as arrows, or not.
    Arrows(bool),
    /// Compute the same another way beside it: how that is called, and its scenario; or no longer.
    Beside(Option<(String, Box<Scenario>)>),
    /// Watch what passes between two corners of a flat picture, or no longer.
    Probe(Option<[[f64; 2]; 2]>),
    /// Go to a physical time, back or forth, as fast as the engine can.
    GoTo(f64),
}

/// A running experiment as a viewer sees it.
pub(crate) struct Driver {
    scenario: Scenario,
    simulation: Box<dyn Simulation>,
    /// What has been done to the system, and when.
    deeds: Vec<(f64, Action)>,
    /// Deeds still ahead on the way back to a time.
    ahead: usize,
    /// Speed as a multiple of the usual.
    factor: f64,
    /// How far the simulation is advanced at once, at most.
    stride: f64,
    /// How the viewer looks at it.
    sight: Sight,
    /// Corners of what the viewer probes.
    probe: Option<[[f64; 2]; 2]>,
    /// The same computed another way.
    beside: Option<Beside>,
    seen: Snapshot,
}

impl Driver {
    /// Starts a scenario.
    pub(crate) fn new(scenario: Scenario) -> Result<Self, Refusal> {
        let simulation = scenario.start()?;
        let mut driver = Self {
            scenario,
            simulation,
            deeds: vec![],
            ahead: 0,
            factor: 1.0,
            stride: 0.0,
            sight: Sight::default(),
            probe: None,
            beside: None,
            seen: Snapshot { pace: 1.0, ..Snapshot::default() },
        };
        driver.begin();
        Ok(driver)
    }

    /// What there is to see; the scene is as of the last [`look`](Self::look).
    pub(crate) fn seen(&self) -> &Snapshot {
        &self.seen
    }

    /// Whether there is something to do without being told.
    pub(crate) fn is_busy(&self) -> bool {
        self.seen.playing || self.seen.travel.is_some()
    }

    /// Whether it is on its way to a chosen time, for which no clock counts.
    pub(crate) fn travels(&self) -> bool {
        self.seen.travel.is_some()
    }

    /// Puts what there is to know of a simulation that has just started into the snapshot.
    fn begin(&mut self) {
        self.seen.begin(self.simulation.as_ref(), self.scenario.duration);
        self.seen.run += 1;
        self.sight.begin();
        self.seen.scene = corpuscle_scene::Scene::default();
        self.seen.speed = self.seen.usual_speed() * self.factor;
        self.stride = (self.seen.end - self.seen.start) / STRIDES;
        self.seen.travel = None;
        self.simulation.probe(self.probe);
        self.measure();
    }

    /// Lets `seconds` of the viewer pass; fewer when `enough` says so on the way. Returns the share of the way that was gone.
    pub(crate) fn pass(&mut self, seconds: f64, enough: impl Fn() -> bool) -> f64 {
        if self.seen.travel.is_some() {
            self.travel(enough);
            return 1.0;
        }
        if !self.seen.playing || seconds <= 0.0 {
            return 1.0;
        }
        let from = self.seen.time;
        let way = seconds * self.seen.speed;
        // The first time round the run stops where it has measured what it set out to measure: there the verdict is due.
        let ends = from < self.seen.end && from + way >= self.seen.end;
        self.advance(if ends { self.seen.end } else { from + way }, enough);
        if ends && self.seen.time == self.seen.end {
            self.seen.playing = false;
            self.measure();
            return 1.0;
        }
        ((self.seen.time - from) / way).clamp(0.0, 1.0)
    }

    /// The share of the asked speed that is reached, as whoever holds the clock measured it.
    pub(crate) fn set_pace(&mut self, pace: f64) {
        self.seen.pace = pace;
    }

    fn advance(&mut self, to: f64, enough: impl Fn() -> bool) {
        let part = (to - self.seen.time) / f64::from(PARTS);
        let mut strides = 0;
        while self.seen.time < to {
            let stride = if self.stride > 0.0 { part.min(self.stride) } else { part };
            let next = if self.seen.time + 1.01 * stride < to { self.seen.time + stride } else { to };
            if !self.reach(next) {
                return;
            }
            strides += 1;
            if enough() {
                self.fit_stride(strides);
                return;
            }
        }
    }

    /// So many strides took as long as one look may: fewer or more of them should.
    fn fit_stride(&mut self, strides: u32) {
        let factor = if strides > 4 { 2.0 } else { 1.0 / (1.0 + 1.0 / f64::from(strides)) };
        self.stride = (self.stride * factor).max((self.seen.end - self.seen.start) / FINEST);
    }

    /// Advances to a time; false when the dynamics broke down.
    fn reach(&mut self, to: f64) -> bool {
        let own = self.simulation.as_mut();
        let outcome = match &mut self.beside {
            Some(beside) => beside.advance(own, to),
            None => own.advance(to),
        };
        if let Err(failure) = outcome {
            self.seen.fault = Some(Fault::Failed(failure.to_string()));
            (self.seen.playing, self.seen.travel) = (false, None);
            return false;
        }
        self.seen.time = to;
        true
    }

    /// Goes on towards a chosen time, through the deeds on the way, in strides that last about as long as one look may.
    fn travel(&mut self, enough: impl Fn() -> bool) {
        let Some((_, goal)) = self.seen.travel else { return };
        let mut strides = 0;
        while self.seen.time < goal || self.next_deed().is_some_and(|(time, _)| time <= goal) {
            if let Some((time, action)) = self.next_deed()
                && time <= self.seen.time
            {
                self.ahead += 1;
                // It was possible then, so it is possible now.
                let _ = self.simulation.act(action);
                self.beside.iter_mut().for_each(|beside| beside.act(action));
                continue;
            }
            let stop = self.next_deed().map_or(goal, |(time, _)| time.min(goal));
            if !self.reach((self.seen.time + self.stride).min(stop)) {
                return;
            }
            strides += 1;
            if enough() {
                self.fit_stride(strides);
                return;
            }
        }
        self.deeds.truncate(self.ahead);
        self.seen.deeds = Arc::new(self.deeds.clone());
        self.seen.travel = None;
        self.measure();
    }

    fn next_deed(&self) -> Option<(f64, Action)> {
        self.deeds.get(self.ahead).copied()
    }

    /// Does what the viewer asks for.
    pub(crate) fn obey(&mut self, order: Order) {
        self.seen.fault = None;
        match order {
            Order::Start(scenario) => self.start(*scenario),
            Order::Play(on) => {
                self.seen.playing = on;
                if !on {
                    self.measure();
                }
            }
            Order::Speed(factor) => {
                self.factor = factor;
                self.seen.speed = self.seen.usual_speed() * factor;
            }
            Order::Step => {
                self.seen.playing = false;
                if self.seen.travel.is_none() {
                    self.advance(self.seen.time + STEP * self.seen.speed, || false);
                    self.measure();
                }
            }
            Order::NextEvent => self.next_event(),
            Order::Act(action) => self.act(action),
            Order::Paint(paint) => self.sights().for_each(|sight| sight.set_paint(paint)),
            Order::Arrows(on) => self.sights().for_each(|sight| sight.set_arrows(on)),
            Order::Beside(rival) => self.set_beside(rival),
            Order::Probe(corners) => {
                self.probe = corners;
                self.simulation.probe(corners);
            }
            Order::GoTo(time) => self.go_to(time),
        }
    }

    fn sights(&mut self) -> impl Iterator<Item = &mut Sight> {
        std::iter::once(&mut self.sight).chain(self.beside.iter_mut().map(|beside| &mut beside.sight))
    }

    /// Two that are to be compared begin together: the run goes once more to where it is.
    fn set_beside(&mut self, rival: Option<(String, Box<Scenario>)>) {
        self.beside = None;
        if let Some((name, scenario)) = rival {
            match Beside::new(name, *scenario, self.sight.clone()) {
                Ok(beside) => self.beside = Some(beside),
                Err(refusal) => {
                    self.seen.fault = Some(Fault::Unable(refusal.invalid.to_string()));
                    return;
                }
            }
            let now = self.seen.time;
            if self.restart() {
                self.ahead = 0;
                self.seen.travel = Some((self.seen.start, now));
            }
        }
        self.measure();
    }

    fn next_event(&mut self) {
        self.seen.playing = false;
        if self.seen.travel.is_some() {
            return;
        }
        match self.simulation.next_event() {
            // A hair later: the collision has then happened.
            Some(time) => {
                self.reach(time.max(self.seen.time) + 4.0 * f64::EPSILON * time.abs().max(1.0));
                self.measure();
            }
            None => self.seen.fault = Some(Fault::NoCollisions),
        }
    }

    fn act(&mut self, action: Action) {
        if self.seen.travel.is_some() {
            return;
        }
        match self.simulation.act(action) {
            Ok(()) => {
                self.beside.iter_mut().for_each(|beside| beside.act(action));
                self.deeds.push((self.seen.time, action));
                self.ahead = self.deeds.len();
                self.seen.deeds = Arc::new(self.deeds.clone());
                self.measure();
            }
            Err(invalid) => self.seen.fault = Some(Fault::Unable(invalid.expected)),
        }
    }

    fn go_to(&mut self, time: f64) {
        let goal = time.max(self.seen.start);
        if goal < self.seen.time {
            if !self.restart() {
                return;
            }
            self.deeds.retain(|deed| deed.0 <= goal);
            self.seen.deeds = Arc::new(self.deeds.clone());
            self.ahead = 0;
        }
        self.seen.travel = Some((self.seen.time, goal));
    }

    /// Runs a scenario in place of this one; what cannot be started leaves everything as it is.
    fn start(&mut self, scenario: Scenario) {
        match scenario.start() {
            Ok(simulation) => {
                (self.scenario, self.simulation) = (scenario, simulation);
                self.beside = None;
                self.deeds.clear();
                self.seen.deeds = Arc::default();
                self.ahead = 0;
                self.begin();
            }
            Err(refusal) => {
                let (key, expected) = (refusal.invalid.key, refusal.invalid.expected);
                self.seen.fault = Some(Fault::Refused { key, expected });
            }
        }
    }

    /// Runs the scenario again from its start; false when it cannot be started.
    fn restart(&mut self) -> bool {
        let Ok(simulation) = self.scenario.start() else { return false };
        self.simulation = simulation;
        self.beside.iter_mut().for_each(Beside::restart);
        self.begin();
        true
    }

    /// Brings charts, checks and honesty up to date.
    pub(crate) fn measure(&mut self) {
        let mut measured = Measured::of(self.simulation.as_ref(), self.seen.run);
        measured.time = self.seen.time;
        if let Some(beside) = &self.beside {
            measured.charts.insert(0, beside.chart());
        }
        self.seen.measured = Arc::new(measured);
    }

    /// Brings the scene up to date.
    pub(crate) fn look(&mut self) {
        self.seen.look += 1;
        self.sight.look(self.simulation.as_ref(), &mut self.seen.scene);
        self.seen.beside = self.beside.as_mut().map(Beside::look);
        self.seen.probed = self.simulation.probed();
    }
}

#[cfg(test)]
#[path = "driver_tests.rs"]
mod tests;
