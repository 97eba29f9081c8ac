//! A running experiment under a viewer's hands: wall time becomes physical time, keys become actions.
//!
//! It knows no window, no thread and no clock: whoever drives it says how much time has passed and when to stop for a
//! look. Neither has any influence on what the simulation computes, only on how far it has come.

use corpuscle_experiments::{Experiment, Simulation};
use corpuscle_io::number::significant;
use corpuscle_io::{Refusal, Registry, Scenario};
use corpuscle_render::window::Action;
use corpuscle_scene::Scene;

/// Seconds of the viewer in which the whole experiment passes by, unless it is told to go faster or slower.
const SECONDS: f64 = 30.0;
/// Parts the way to a picture is advanced in, so that there is a place to stop.
const PARTS: u32 = 16;
/// What one press of the single-step key advances, in seconds of the viewer.
const STEP: f64 = 1.0 / 30.0;
/// Factor of one press of the keys for faster and slower.
const FACTOR: f64 = 1.5;
/// Presses that still have an effect in either direction, from the usual speed: a factor of about 3000.
const PRESSES: i32 = 20;

/// A running experiment as a viewer sees it.
pub(super) struct Driver {
    registry: Vec<&'static Experiment>,
    scenario: Scenario,
    simulation: Box<dyn Simulation>,
    /// Physical time to be shown; the simulation has been advanced to it.
    now: f64,
    /// Physical time a second of the viewer, before anybody changes it.
    usual_speed: f64,
    /// Presses of faster less presses of slower.
    presses: i32,
    paused: bool,
    /// The trails belong to a run that has ended.
    fresh: bool,
    /// Something has happened since the last drawing.
    changed: bool,
    /// What went wrong, or could not be done; shown until the next action.
    notice: String,
}

impl Driver {
    /// Starts a scenario.
    pub(super) fn new(registry: Registry, scenario: Scenario) -> Result<Self, Refusal> {
        let simulation = scenario.start()?;
        let now = simulation.time();
        let usual_speed = (scenario.duration.unwrap_or_else(|| simulation.end()) - now) / SECONDS;
        Ok(Self {
            registry: registry.to_vec(),
            scenario,
            simulation,
            now,
            usual_speed,
            presses: 0,
            paused: false,
            fresh: true,
            changed: true,
            notice: String::new(),
        })
    }

    /// What runs.
    pub(super) fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Physical time a second of the viewer.
    fn speed(&self) -> f64 {
        self.usual_speed * FACTOR.powi(self.presses)
    }

    /// Lets `seconds` of the viewer pass, unless paused; fewer when `enough` says so on the way. What did not fit is
    /// dropped, not owed: a slow engine makes a slow film, never a growing debt.
    pub(super) fn pass(&mut self, seconds: f64, enough: impl Fn() -> bool) {
        if !self.paused && seconds > 0.0 {
            self.advance(self.now + seconds * self.speed(), enough);
        }
    }

    fn advance(&mut self, to: f64, enough: impl Fn() -> bool) {
        let from = self.now;
        for part in 1..=PARTS {
            let next = if part == PARTS { to } else { from + (to - from) * f64::from(part) / f64::from(PARTS) };
            self.changed = true;
            if let Err(failure) = self.simulation.advance(next) {
                self.notice = failure.to_string();
                self.paused = true;
                return;
            }
            self.now = next;
            if enough() {
                return;
            }
        }
    }

    /// Does what the viewer asks for.
    pub(super) fn act(&mut self, action: Action) {
        self.notice.clear();
        self.changed = true;
        match action {
            Action::TogglePause => self.paused = !self.paused,
            Action::Step => {
                self.paused = true;
                self.advance(self.now + STEP * self.speed(), || false);
            }
            Action::Reset => {
                let (presses, paused) = (self.presses, self.paused);
                self.replace(self.scenario.clone());
                (self.presses, self.paused) = (presses, paused);
            }
            Action::Faster => self.presses = (self.presses + 1).min(PRESSES),
            Action::Slower => self.presses = (self.presses - 1).max(-PRESSES),
            Action::Reverse => {
                if let Err(invalid) = self.simulation.act(corpuscle_experiments::Action::Reverse) {
                    self.notice = format!("this experiment cannot be reversed: expected {}", invalid.expected);
                }
            }
            Action::Previous => self.neighbour(self.registry.len().saturating_sub(1)),
            Action::Next => self.neighbour(1),
        }
    }

    /// What went wrong, or could not be done, since the last action; empty when nothing did.
    pub(super) fn notice(&self) -> &str {
        &self.notice
    }

    /// Brings a scene, the one of the last call, up to date; false when there is nothing new.
    pub(super) fn draw(&mut self, scene: &mut Scene) -> bool {
        if !std::mem::take(&mut self.changed) {
            return false;
        }
        if std::mem::take(&mut self.fresh) {
            *scene = Scene::default();
        }
        self.simulation.draw(scene);
        // First what the viewer has just changed: a narrow window cuts the end.
        let notice = if self.notice.is_empty() { String::new() } else { format!("{} · ", self.notice) };
        let pause = if self.paused { "paused · " } else { "" };
        scene.caption = format!("{notice}{pause}speed {} a second · {}", significant(self.speed(), 3), scene.caption);
        true
    }

    /// Starts a scenario in place of this one.
    fn replace(&mut self, scenario: Scenario) {
        match Self::new(&self.registry, scenario) {
            Ok(driver) => *self = driver,
            // It started before, or has only defaults; still, a person should read why and not see a window vanish.
            Err(refusal) => self.notice = refusal.to_string(),
        }
    }

    /// Another experiment, so many places further in the list.
    fn neighbour(&mut self, places: usize) {
        let name = self.scenario.name();
        let here = self.registry.iter().position(|experiment| experiment.name == name).unwrap_or(0);
        if let Some(experiment) = self.registry.get((here + places) % self.registry.len().max(1)) {
            self.replace(Scenario::new(experiment));
        }
    }
}

#[cfg(test)]
mod tests;
