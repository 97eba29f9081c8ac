//! The window's side of a running experiment: wall time becomes physical time, keys become actions.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use corpuscle_experiments::{Experiment, Simulation};
use corpuscle_io::number::significant;
use corpuscle_io::{Refusal, Registry, Scenario};
use corpuscle_render::window::{Action, Options, WindowApp, view};
use corpuscle_scene::Scene;

use crate::console;
use crate::trouble::Trouble;

/// Seconds on the clock in which the whole experiment passes by, unless it is told to go faster or slower.
const SECONDS: f64 = 30.0;
/// Share of a frame's time that the simulation may take: the window stays answerable however slow the engine is.
const BUDGET: Duration = Duration::from_millis(12);
/// Parts a frame's physical time is advanced in, so that the budget can be kept.
const PARTS: u32 = 16;
/// What one press of the single-step key advances, in seconds of the clock at normal speed.
const STEP: f64 = 1.0 / 30.0;

/// Opens a window on a scenario and returns when it is closed.
pub(super) fn open(registry: Registry, scenario: Scenario, options: Options) -> Result<(), Trouble> {
    let stage = Stage::new(registry.to_vec(), scenario)?;
    console::print(&format!("{}, seed {}; h shows the keys\n", stage.scenario.name(), stage.scenario.settings.seed))?;
    Ok(view(options, stage)?)
}

/// A running experiment as the window sees it.
struct Stage {
    registry: Vec<&'static Experiment>,
    scenario: Scenario,
    simulation: Box<dyn Simulation>,
    /// Physical time to be shown; the simulation is advanced to it.
    target: f64,
    /// Physical time a second of the clock.
    speed: f64,
    paused: bool,
    /// The trails belong to a run that has ended.
    fresh: bool,
    /// What went wrong, or could not be done; shown until the next action.
    notice: String,
}

impl Stage {
    fn new(registry: Vec<&'static Experiment>, scenario: Scenario) -> Result<Self, Refusal> {
        let simulation = scenario.start()?;
        let target = simulation.time();
        let speed = (scenario.duration.unwrap_or_else(|| simulation.end()) - target) / SECONDS;
        Ok(Self { registry, scenario, simulation, target, speed, paused: false, fresh: true, notice: String::new() })
    }

    /// Advances for as long as the budget lasts. Physical time that did not fit is dropped, not owed: a slow engine makes a
    /// slow film, never a growing debt.
    fn advance(&mut self, to: f64) {
        let (from, started) = (self.target, Instant::now());
        for part in 1..=PARTS {
            let next = if part == PARTS { to } else { from + (to - from) * f64::from(part) / f64::from(PARTS) };
            if let Err(failure) = self.simulation.advance(next) {
                self.notice = failure.to_string();
                self.paused = true;
                return;
            }
            self.target = next;
            if started.elapsed() > BUDGET {
                return;
            }
        }
    }

    /// Starts a scenario in place of this one.
    fn replace(&mut self, scenario: Scenario) {
        match Self::new(self.registry.clone(), scenario) {
            Ok(stage) => *self = stage,
            // It started before, or has only defaults; still, a person should read why and not see a window vanish.
            Err(refusal) => self.notice = refusal.to_string(),
        }
    }

    /// Another experiment, so many places further in the list.
    fn neighbour(&mut self, places: usize) {
        let name = self.scenario.name();
        let count = self.registry.len();
        let here = self.registry.iter().position(|experiment| experiment.name == name).unwrap_or(0);
        if let Some(experiment) = self.registry.get((here + places) % count.max(1)) {
            self.replace(Scenario::new(experiment));
        }
    }
}

impl WindowApp for Stage {
    fn frame(&mut self, elapsed_wall: f64, scene: &mut Scene) -> ControlFlow<()> {
        if self.fresh {
            *scene = Scene::default();
            self.fresh = false;
        }
        if !self.paused {
            self.advance(self.target + elapsed_wall * self.speed);
        }
        self.simulation.draw(scene);
        let pause = if self.paused { "paused · " } else { "" };
        let more = if self.notice.is_empty() { String::new() } else { format!(" · {}", self.notice) };
        scene.caption = format!("{} · {pause}{} a second{more}", scene.caption, significant(self.speed, 3));
        ControlFlow::Continue(())
    }

    fn act(&mut self, action: Action) {
        self.notice.clear();
        match action {
            Action::TogglePause => self.paused = !self.paused,
            Action::Step => {
                self.paused = true;
                self.advance(self.target + STEP * self.speed);
            }
            Action::Reset => self.replace(self.scenario.clone()),
            Action::Faster => self.speed *= 1.5,
            Action::Slower => self.speed /= 1.5,
            Action::Reverse => {
                if let Err(invalid) = self.simulation.act(corpuscle_experiments::Action::Reverse) {
                    self.notice = format!("this experiment cannot be reversed: {invalid}");
                }
            }
            Action::Previous => self.neighbour(self.registry.len().saturating_sub(1)),
            Action::Next => self.neighbour(1),
        }
        if !self.notice.is_empty() {
            console::complain(&self.notice);
        }
    }
}
