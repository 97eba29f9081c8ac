//! The window itself: eframe's events and frames around the model, the panels and the simulation's thread.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use corpuscle_io::{Refusal, Registry, Scenario, write};
use corpuscle_render::{Picture, RenderError, window::check};
use eframe::{App, CreationContext, NativeOptions};
use egui::{ColorImage, Rect, Ui, ViewportBuilder, ViewportCommand};

use crate::film::Recording;
use crate::language::Text;
use crate::model::{Job, Model, Overlay};
use crate::painter::{Hosted, Painter};
use crate::preferences::Preferences;
use crate::previews::Previews;
use crate::runner::{Order, Runner};
use crate::{theme, ui};

/// Smallest window in which nothing is cut.
const SMALLEST: [f32; 2] = [960.0, 620.0];
/// How often a film in the making is looked after.
const LOOK: Duration = Duration::from_millis(200);

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// The scenario cannot be started.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// There is no display, or no OpenGL.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// What a window opens with, where it differs from what is remembered.
#[derive(Default)]
pub struct Options {
    /// The scenario.
    pub scenario: Option<Scenario>,
    /// Width and height in points.
    pub size: Option<[f32; 2]>,
    /// Colours.
    pub theme: Option<theme::Theme>,
    /// Language.
    pub language: Option<crate::language::Language>,
}

/// Opens the window on a scenario; with none, for the experiment of last time, with the gallery in front of it the first time.
/// Returns when it is closed.
///
/// # Errors
/// [`LabError`] when the scenario cannot be started, there is no display, or no OpenGL: it names what is missing.
pub fn open(registry: Registry, options: Options) -> Result<(), LabError> {
    let place = Preferences::place();
    let mut preferences = place.as_deref().map_or_else(Preferences::default, Preferences::read);
    preferences.size = options.size.unwrap_or(preferences.size);
    preferences.theme = options.theme.unwrap_or(preferences.theme);
    preferences.language = options.language.unwrap_or(preferences.language);
    let scenario = options.scenario;
    let asked = scenario.is_some();
    let known = |name: &String| registry.iter().find(|experiment| experiment.name == name);
    let last = preferences.experiment.as_ref().and_then(known).or(registry.first());
    let Some(scenario) = scenario.or_else(|| last.map(|experiment| Scenario::new(experiment))) else { return Ok(()) };

    let mut model = Model::new(registry, scenario, preferences);
    if !asked && model.preferences.experiment.is_none() {
        model.overlay = Overlay::Gallery;
    }
    if asked {
        let name = model.scenario.name().to_owned();
        model.preferences.experiment = registry.iter().any(|experiment| experiment.name == name).then_some(name);
    }
    // The wake-up call needs the window's context, which is made here so that it exists before the simulation's thread.
    let context = egui::Context::default();
    let waker = context.clone();
    let runner = Runner::start(model.scenario.clone(), move || waker.request_repaint())?;
    // What cannot be started is refused first, also where there is no display.
    check()?;
    runner.order(Order::Play(model.overlay == Overlay::None));

    let options = NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("Corpuscle")
            .with_app_id("corpuscle")
            .with_inner_size(model.preferences.size)
            .with_min_inner_size(SMALLEST),
        renderer: eframe::Renderer::Glow,
        system_font_fallback: false,
        ..NativeOptions::default()
    };
    let creator = move |creation: &CreationContext<'_>| {
        let lab = Lab::new(creation, model, runner, place)?;
        Ok(Box::new(lab) as Box<dyn App>)
    };
    eframe::run_native_ext("corpuscle", options, Some(context), Box::new(creator)).map_err(|error| explain(error).into())
}

/// Fonts, colours and sizes as the model has them.
pub(crate) fn dress(context: &egui::Context, model: &Model) {
    model.preferences.theme.apply(context);
    context.set_zoom_factor(zoom(model));
}

/// By how much everything is larger than usual.
pub(crate) fn zoom(model: &Model) -> f32 {
    model.preferences.scale * model.preferences.theme.enlargement()
}

/// eframe's words, with the package that helps.
fn explain(error: eframe::Error) -> RenderError {
    match error {
        eframe::Error::WinitEventLoop(_) | eframe::Error::Winit(_) => RenderError::NoDisplay { cause: error.to_string() },
        eframe::Error::NoGlutinConfigs(..) => RenderError::no_driver(),
        eframe::Error::AppCreation(fault) => match fault.downcast::<RenderError>() {
            Ok(fault) => *fault,
            Err(fault) => RenderError::Context(fault.to_string()),
        },
        error => RenderError::Context(error.to_string()),
    }
}

/// A part of the window, and the file it is for.
type Cutting = (PathBuf, ColorImage);

/// The running window.
struct Lab {
    model: Model,
    runner: Runner,
    painter: Painter,
    previews: Option<Previews>,
    recording: Option<Recording>,
    /// Parts of the window on their way into a file.
    pictures: (Sender<Cutting>, Receiver<Cutting>),
    place: Option<PathBuf>,
    /// Preferences as they were last kept.
    kept: Preferences,
    /// Colours and sizes that the window wears.
    dressed: Option<(theme::Theme, f32)>,
    mourned: bool,
}

impl Lab {
    fn new(creation: &CreationContext<'_>, model: Model, runner: Runner, place: Option<PathBuf>) -> Result<Self, RenderError> {
        let gl = creation.gl.clone().ok_or_else(RenderError::no_driver)?;
        creation.egui_ctx.set_fonts(theme::fonts());
        // What the drivers' shaders refuse is to be known before the window shows.
        drop(corpuscle_render::Backdrop::new(gl.clone())?);
        let painter = Painter::new(gl);
        Ok(Self {
            kept: model.preferences.clone(),
            model,
            runner,
            painter,
            previews: None,
            recording: None,
            pictures: channel(),
            place,
            dressed: None,
            mourned: false,
        })
    }

    fn dress(&mut self, context: &egui::Context) {
        let preferences = &self.model.preferences;
        let wanted = (preferences.theme, preferences.scale);
        if self.dressed != Some(wanted) {
            dress(context, &self.model);
            self.dressed = Some(wanted);
        }
    }

    /// Does what the model asked for.
    fn work(&mut self, context: &egui::Context) {
        for order in self.model.take_orders() {
            self.runner.order(order);
        }
        for job in self.model.take_jobs() {
            match job {
                Job::Write(path, bytes) => self.write(&path, &bytes),
                Job::Picture(path, part) => self.ask_for_picture(context, path, part),
                Job::Film { film, scenario } => match Recording::start(&film, &scenario) {
                    Ok(recording) => {
                        self.model.tell(self.model.language().fill(Text::Recording, &[&film.path]));
                        self.recording = Some(recording);
                    }
                    Err(error) => self.model.complain(self.model.language().fill(Text::RecordFailed, &[&error.to_string()])),
                },
            }
        }
        while let Ok((path, image)) = self.pictures.1.try_recv() {
            let [width, height] = image.size.map(|side| side as u32);
            match (Picture { width, height, rgba: image.as_raw().to_vec() }).to_png() {
                Ok(bytes) => self.write(&path, &bytes),
                Err(error) => self.model.complain(error.to_string()),
            }
        }
        if let Some(recording) = &mut self.recording {
            match recording.outcome() {
                None => context.request_repaint_after(LOOK),
                Some(outcome) => {
                    self.recording = None;
                    let language = self.model.language();
                    match outcome {
                        Ok(path) => self.model.tell(language.fill(Text::Recorded, &[&path.display().to_string()])),
                        Err(words) => self.model.complain(language.fill(Text::RecordFailed, &[&words])),
                    }
                }
            }
        }
    }

    /// What a part of the window shows comes back with the frame.
    fn ask_for_picture(&self, context: &egui::Context, path: PathBuf, part: Rect) {
        let (sender, waker, pixels) = (self.pictures.0.clone(), context.clone(), context.pixels_per_point());
        let part = part.intersect(context.content_rect());
        context.request_screenshot(move |image| {
            // Whoever would have received it has gone with the window.
            let _ = sender.send((path, image.region(&part, Some(pixels))));
            waker.request_repaint();
        });
    }

    fn write(&mut self, path: &Path, bytes: &[u8]) {
        let shown = std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).display().to_string();
        match write::atomically(path, bytes) {
            Ok(()) => self.model.tell(self.model.language().fill(Text::Saved, &[&shown])),
            Err(error) => self.model.complain(error.to_string()),
        }
    }

    /// Whoever ends the window from outside loses no choice. Its size is kept with the next one, or at the end.
    fn keep_preferences(&mut self) {
        let now = &self.model.preferences;
        if let Some(place) = &self.place
            && (Preferences { size: self.kept.size, ..now.clone() }) != self.kept
        {
            now.keep(place);
            self.kept = now.clone();
        }
    }

    /// Files dropped onto the window are opened.
    fn dropped(&mut self, context: &egui::Context) {
        let path = context.input(|input| input.raw.dropped_files.first().map(|file| file.path().to_owned()));
        if let Some(path) = path {
            self.model.open(&path);
        }
    }
}

impl App for Lab {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.dress(&context);
        self.dropped(&context);
        self.runner.refresh();
        if self.model.overlay == Overlay::Gallery {
            let waker = context.clone();
            let registry = &self.model.registry;
            self.previews.get_or_insert_with(|| Previews::begin(registry, move || waker.request_repaint())).refresh();
        } else {
            self.painter.keep_stage_only();
        }
        if !self.runner.is_alive() && !self.mourned {
            self.mourned = true;
            self.model.complain(self.model.text(Text::ThreadEnded).to_owned());
        }
        let none = Previews::none();
        let previews = self.previews.as_ref().unwrap_or(&none);
        let mut register = |texture| frame.register_native_glow_texture(texture);
        let mut easel = Hosted { painter: &mut self.painter, register: &mut register };
        ui::show(ui, &mut self.model, self.runner.snapshot(), previews, &mut easel);
        if let Some(fault) = self.painter.fault.take() {
            self.model.complain(fault.to_string());
        }
        self.work(&context);
        let size = context.content_rect().size() * context.zoom_factor();
        self.model.preferences.size = size.into();
        self.keep_preferences();
        if self.model.leaving {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    fn on_exit(&mut self, _: Option<&glow::Context>) {
        if let Some(place) = &self.place {
            self.model.preferences.keep(place);
        }
    }
}
