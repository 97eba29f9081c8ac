//! The window's state, without a window: what is open, what is chosen, what has been asked for. Panels change it, keys change
//! it, tests change it; nothing here draws, waits or computes physics.

use std::path::{Path, PathBuf};

use corpuscle_experiments::{Action, Experiment, Parameter, Value};
use corpuscle_io::scenario::Subject;
use corpuscle_io::{Registry, Scenario};
use corpuscle_scene::Camera;

use crate::command::Command;
use crate::film::Film;
use crate::language::{Language, Text};
use crate::notebook::Notebook;
use crate::preferences::Preferences;
use crate::rivals;
use crate::runner::{Order, Paint, Snapshot};
use crate::tools::{self, Stopwatch, Tool, Touch};

/// Factor of one press of the keys for faster and slower.
const FACTOR: f64 = 1.5;
/// Speeds that can be chosen, as multiples of the usual.
pub const SPEEDS: std::ops::RangeInclusive<f64> = 1e-4..=1e4;
/// Factor of one press of the keys for nearer and farther.
const ZOOM: f64 = 1.25;

/// What the panel on the right shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tab {
    /// Charts.
    #[default]
    Charts,
    /// Checks against theory.
    Checks,
    /// Numerical quality.
    Honesty,
    /// The notebook.
    Notebook,
}

impl Tab {
    /// All of them, with their names and what opens them.
    pub const ALL: [(Self, Text, Command); 4] = [
        (Self::Charts, Text::Charts, Command::Charts),
        (Self::Checks, Text::Checks, Command::Checks),
        (Self::Honesty, Text::Honesty, Command::Honesty),
        (Self::Notebook, Text::Notebook, Command::Notebook),
    ];
}

/// What lies over the panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The gallery of experiments.
    Gallery,
    /// The list of keys.
    Help,
    /// Opening a file.
    Open,
    /// Saving a file.
    Save,
    /// Recording.
    Record,
}

/// Something the window has to do that the model cannot: it touches files.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// Write bytes to a file.
    Write(PathBuf, Vec<u8>),
    /// Write what a part of the window shows to a file, as a picture.
    Picture(PathBuf, egui::Rect),
    /// Record a film of a scenario, given as the text of its file.
    Film {
        /// What of it, and where to.
        film: Film,
        /// The file.
        scenario: String,
    },
}

/// What a person is told at the foot of the window.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// The words.
    pub words: String,
    /// Whether something went wrong.
    pub fault: bool,
}

/// The state of the window.
pub struct Model {
    /// The experiments there are.
    pub registry: Vec<&'static Experiment>,
    /// What runs, as a file would say it.
    pub scenario: Scenario,
    /// What is remembered from one day to the next.
    pub preferences: Preferences,
    /// What the panel on the right shows.
    pub tab: Tab,
    /// Whether there are panels.
    pub panels: bool,
    /// What lies over them.
    pub overlay: Overlay,
    /// Where a person has moved the camera.
    pub camera: Option<Camera>,
    /// The body that is followed.
    pub followed: Option<usize>,
    /// What the pointer does on the stage.
    pub tool: Tool,
    /// What tools are set to.
    pub tools: tools::Settings,
    /// A touch of the system that has not ended.
    pub touch: Option<Touch>,
    /// How often velocities have been disturbed: each time otherwise.
    pub disturbances: u64,
    /// What computes the same beside it.
    pub beside: Option<String>,
    /// A click on a check has opened its chart: there is a way back.
    pub from_checks: bool,
    /// Ends of the ruler.
    pub ruler: Option<[[f64; 3]; 2]>,
    /// Corners of the probe.
    pub probe: Option<[[f64; 2]; 2]>,
    /// Stopwatch of physical time.
    pub stopwatch: Stopwatch,
    /// The notebook.
    pub notebook: Notebook,
    /// Times marked on the timeline, in ascending order.
    pub moments: Vec<f64>,
    /// The chart that is shown large, by its name; none for the first.
    pub large_chart: Option<String>,
    /// Speed as a multiple of the usual.
    pub speed: f64,
    /// What a list or a file's name is being typed as.
    pub typed: Typed,
    /// What a person is told.
    pub notice: Option<Notice>,
    /// Whether the window is to close.
    pub leaving: bool,
    orders: Vec<Order>,
    jobs: Vec<Job>,
}

/// Texts in the making.
#[derive(Clone, Debug, Default)]
pub struct Typed {
    /// Name of a file to open or to save.
    pub path: String,
    /// The dialog has just opened: what is typed next is meant for it.
    pub fresh: bool,
    /// A list of numbers, with the key it is for.
    pub list: Option<(String, String)>,
    /// A parameter's value under a hand that has not let go, with its key.
    pub dragged: Option<(&'static str, f64)>,
    /// What is to be recorded.
    pub film: Film,
}

impl Model {
    /// A window on a scenario.
    pub fn new(registry: Registry, scenario: Scenario, preferences: Preferences) -> Self {
        let mut orders = vec![];
        if preferences.paint != Paint::default() {
            orders.push(Order::Paint(preferences.paint));
        }
        if preferences.arrows {
            orders.push(Order::Arrows(true));
        }
        Self {
            registry: registry.to_vec(),
            scenario,
            preferences,
            tab: Tab::default(),
            panels: true,
            overlay: Overlay::None,
            camera: None,
            followed: None,
            tool: Tool::default(),
            tools: tools::Settings::default(),
            touch: None,
            disturbances: 0,
            beside: None,
            from_checks: false,
            ruler: None,
            probe: None,
            stopwatch: Stopwatch::Off,
            notebook: Notebook::default(),
            moments: vec![],
            large_chart: None,
            speed: 1.0,
            typed: Typed::default(),
            notice: None,
            leaving: false,
            orders,
            jobs: vec![],
        }
    }

    /// The language.
    pub fn language(&self) -> Language {
        self.preferences.language
    }

    /// A word in the language.
    pub fn text(&self, text: Text) -> &'static str {
        self.language().text(text)
    }

    /// What has been asked of the simulation since the last call.
    pub fn take_orders(&mut self) -> Vec<Order> {
        std::mem::take(&mut self.orders)
    }

    /// What has been asked of the window since the last call.
    pub fn take_jobs(&mut self) -> Vec<Job> {
        std::mem::take(&mut self.jobs)
    }

    /// Asks for something to be done with files.
    pub fn ask(&mut self, job: Job) {
        self.jobs.push(job);
    }

    /// Asks something of the simulation.
    pub fn order(&mut self, order: Order) {
        self.orders.push(order);
    }

    /// Tells the person something.
    pub fn tell(&mut self, words: String) {
        self.notice = Some(Notice { words, fault: false });
    }

    /// Tells the person what went wrong.
    pub fn complain(&mut self, words: String) {
        self.notice = Some(Notice { words, fault: true });
    }

    /// Does what a key or a button asks for.
    pub fn obey(&mut self, command: Command, seen: &Snapshot) {
        self.notice = None;
        match command {
            Command::TogglePlay => self.order(Order::Play(!seen.playing)),
            Command::Step => self.order(Order::Step),
            Command::NextEvent => self.order(Order::NextEvent),
            Command::Reverse => self.act(Action::Reverse),
            Command::Disturb => {
                self.disturbances += 1;
                let seed = self.scenario.settings.seed.wrapping_add(self.disturbances << 32);
                self.act(Action::Disturb { strength: self.tools.disturbance, seed });
            }
            Command::OpenPartitions => self.act(Action::OpenPartitions),
            Command::Arrows => {
                self.preferences.arrows = !self.preferences.arrows;
                self.order(Order::Arrows(self.preferences.arrows));
            }
            Command::Faster => self.set_speed(self.speed * FACTOR),
            Command::Slower => self.set_speed(self.speed / FACTOR),
            Command::Restart => self.restart(),
            Command::NewSeed => {
                self.scenario.settings.seed = self.scenario.settings.seed.wrapping_add(1);
                self.restart();
            }
            Command::Remember => self.remember(seen.time),
            Command::PreviousMoment => self.previous_moment(seen),
            Command::NextMoment => {
                if let Some(&moment) = self.moments.iter().find(|&&moment| moment > seen.time) {
                    self.order(Order::GoTo(moment));
                }
            }
            Command::Fit => (self.camera, self.followed) = (None, None),
            Command::ZoomIn => self.zoom(ZOOM, seen),
            Command::ZoomOut => self.zoom(1.0 / ZOOM, seen),
            Command::NextPaint => self.set_paint(self.preferences.paint.next()),
            Command::NextTool => self.tool = self.tool.next(seen),
            Command::Stopwatch => self.stopwatch = self.stopwatch.pressed(seen.time),
            Command::RecordRow => {
                self.notebook.record(&self.scenario, seen);
                self.show(Tab::Notebook);
            }
            Command::PreviousExperiment => self.neighbour(self.registry.len().saturating_sub(1)),
            Command::NextExperiment => self.neighbour(1),
            Command::Gallery => self.toggle(Overlay::Gallery),
            Command::Charts => self.show(Tab::Charts),
            Command::Checks => self.show(Tab::Checks),
            Command::Honesty => self.show(Tab::Honesty),
            Command::Notebook => self.show(Tab::Notebook),
            Command::Panels => self.panels = !self.panels,
            Command::Open => self.toggle(Overlay::Open),
            Command::Save => {
                self.typed.path = format!("{}.toml", self.scenario.name());
                self.toggle(Overlay::Save);
            }
            Command::Record => {
                self.typed.film.until = seen.end;
                self.toggle(Overlay::Record);
            }
            Command::Palette => self.preferences.theme = self.preferences.theme.next(),
            Command::Language => self.preferences.language = self.preferences.language.next(),
            Command::Larger => self.preferences.resize_text(1),
            Command::Smaller => self.preferences.resize_text(-1),
            Command::Help => self.toggle(Overlay::Help),
            Command::Close => self.overlay = Overlay::None,
            Command::Quit => self.leaving = true,
        }
    }

    fn toggle(&mut self, overlay: Overlay) {
        self.overlay = if self.overlay == overlay { Overlay::None } else { overlay };
        self.typed.fresh = true;
    }

    fn show(&mut self, tab: Tab) {
        self.from_checks &= tab == Tab::Charts;
        (self.tab, self.panels) = (tab, true);
    }

    /// Does something to the system, now.
    pub fn act(&mut self, action: Action) {
        self.notice = None;
        self.order(Order::Act(action));
    }

    /// Lets the bodies' colours tell something else.
    pub fn set_paint(&mut self, paint: Paint) {
        self.preferences.paint = paint;
        self.order(Order::Paint(paint));
    }

    /// Shows the chart that a check is about, with a way back to the checks.
    pub fn show_chart(&mut self, name: &str) {
        (self.large_chart, self.from_checks) = (Some(name.to_owned()), true);
        self.show(Tab::Charts);
    }

    /// Chooses a speed, as a multiple of the usual.
    pub fn set_speed(&mut self, factor: f64) {
        self.speed = factor.clamp(*SPEEDS.start(), *SPEEDS.end());
        self.order(Order::Speed(self.speed));
    }

    /// Lays the probe between two corners, or takes it up.
    pub fn set_probe(&mut self, corners: Option<[[f64; 2]; 2]>) {
        if corners != self.probe {
            self.probe = corners;
            self.order(Order::Probe(corners));
        }
    }

    /// Marks a time on the timeline.
    pub fn remember(&mut self, time: f64) {
        if !self.moments.contains(&time) {
            self.moments.push(time);
            self.moments.sort_by(f64::total_cmp);
        }
    }

    fn previous_moment(&mut self, seen: &Snapshot) {
        let before = self.moments.iter().rev().find(|&&moment| moment < seen.time).copied();
        self.order(Order::GoTo(before.unwrap_or(seen.start)));
    }

    /// Moves the camera nearer by a factor.
    fn zoom(&mut self, factor: f64, seen: &Snapshot) {
        let camera = self.camera.unwrap_or(seen.scene.camera);
        self.camera = Some(match camera {
            Camera::Plane { centre, extent } => Camera::Plane { centre, extent: extent.map(|length| length / factor) },
            Camera::Orbit { target, distance, yaw, pitch } => Camera::Orbit { target, distance: distance / factor, yaw, pitch },
        });
    }

    /// The camera of this moment: where a person has moved it, on the body that is followed.
    pub fn camera_now(&self, seen: &Snapshot) -> Camera {
        let camera = self.camera.unwrap_or(seen.scene.camera);
        let Some(body) = self.followed.and_then(|index| seen.scene.bodies.get(index)) else { return camera };
        let (place, _) = crate::tools::state_of(body, &seen.scene);
        match camera {
            Camera::Plane { extent, .. } => Camera::Plane { centre: [place[0], place[1]], extent },
            Camera::Orbit { distance, yaw, pitch, .. } => Camera::Orbit { target: place, distance, yaw, pitch },
        }
    }

    /// Computes the same another way beside it, or no longer.
    pub fn set_beside(&mut self, name: Option<&str>) {
        let rival = name.and_then(|name| rivals::of(&self.scenario).into_iter().find(|rival| rival.name == name));
        self.beside = rival.as_ref().map(|rival| rival.name.clone());
        self.order(Order::Beside(rival.map(|rival| (rival.name, Box::new(rival.scenario)))));
        if self.beside.is_some() {
            self.large_chart = None;
        }
    }

    /// Runs the scenario from its start, and what is beside it as well.
    pub fn restart(&mut self) {
        self.order(Order::Start(Box::new(self.scenario.clone())));
        if let Some(name) = self.beside.take() {
            self.set_beside(Some(&name));
        }
        self.moments.clear();
        self.stopwatch = Stopwatch::Off;
    }

    /// Runs another scenario, and lets its time pass.
    pub fn run(&mut self, scenario: Scenario) {
        if scenario.name() != self.scenario.name() {
            self.notebook = Notebook::default();
            self.beside = None;
            self.large_chart = None;
        }
        self.preferences.experiment = match scenario.subject {
            Subject::Experiment(experiment) => Some(experiment.name.to_owned()),
            Subject::Free(_) => self.preferences.experiment.take(),
        };
        self.scenario = scenario;
        (self.camera, self.followed, self.ruler) = (None, None, None);
        self.set_probe(None);
        self.overlay = Overlay::None;
        self.typed.list = None;
        self.restart();
        self.order(Order::Play(true));
    }

    /// Another experiment, so many places further in the list.
    fn neighbour(&mut self, places: usize) {
        let name = self.scenario.name();
        let here = self.registry.iter().position(|experiment| experiment.name == name).unwrap_or(0);
        if let Some(experiment) = self.registry.get((here + places) % self.registry.len().max(1)) {
            self.run(Scenario::new(experiment));
        }
    }

    /// Opens a scenario file.
    pub fn open(&mut self, path: &Path) {
        match Scenario::read(&self.registry, path) {
            Ok(scenario) => self.run(scenario),
            Err(refusal) => self.complain(refusal.to_string()),
        }
    }

    /// Gives a parameter a value, and runs the experiment from its start with it; none for its default.
    pub fn set_parameter(&mut self, parameter: &'static Parameter, value: Option<Value>) {
        let Subject::Experiment(experiment) = self.scenario.subject else { return };
        let mut scenario = Scenario::new(experiment);
        scenario.settings.seed = self.scenario.settings.seed;
        (scenario.duration, scenario.deeds) = (self.scenario.duration, self.scenario.deeds.clone());
        let kept = self.scenario.parameters().filter(|(known, _, given)| *given && known.name != parameter.name);
        let given: Vec<(&str, Value)> = kept.map(|(known, value, _)| (known.name, value.clone())).collect();
        let all = given.into_iter().chain(value.map(|value| (parameter.name, value)));
        for (key, value) in all {
            if let Err(invalid) = scenario.settings.set(key, value) {
                self.complain(invalid.to_string());
                return;
            }
        }
        self.notice = None;
        self.scenario = scenario;
        self.restart();
    }

    /// Chooses a seed, and runs the experiment from its start with it.
    pub fn set_seed(&mut self, seed: u64) {
        self.scenario.settings.seed = seed;
        self.restart();
    }
}

#[cfg(test)]
#[path = "model_tests.rs"]
mod tests;
