//! The whole window without a window: the same panels, drawn by the same OpenGL into memory.

use std::sync::Arc;

use corpuscle_experiments::Simulation;
use corpuscle_io::{Registry, Scenario};
use corpuscle_render::{Picture, RenderError, Surface};
use egui::{RawInput, Rect, ViewportId, ViewportInfo, pos2};

use crate::model::{Model, Overlay, Tab};
use crate::painter::{Hosted, Painter};
use crate::preferences::Preferences;
use crate::previews::Previews;
use crate::runner::sight::Sight;
use crate::runner::{Measured, Snapshot};
use crate::{theme, ui};

impl Default for StudioView {
    fn default() -> Self {
        let (size, preferences) = ([1280, 800], Preferences::default());
        Self { size, scale: 1.0, preferences, tab: Tab::default(), overlay: Overlay::default() }
    }
}

/// Passes until texts and panels have found their sizes.
const PASSES: usize = 4;

/// How the window is to look.
#[derive(Clone, Debug)]
pub struct StudioView {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Pixels in a point.
    pub scale: f32,
    /// Language, colours, size of text.
    pub preferences: Preferences,
    /// What the panel on the right shows.
    pub tab: Tab,
    /// What lies over the panels.
    pub overlay: Overlay,
}

/// A window that nobody sees, but in pictures: whoever drives the simulation shows it to the window.
pub struct Studio {
    context: egui::Context,
    glow: egui_glow::Painter,
    painter: Painter,
    surface: Surface,
    model: Model,
    previews: Previews,
    view: StudioView,
    seen: Snapshot,
    sight: Sight,
    frames: u32,
}

impl Studio {
    /// A window on a scenario.
    ///
    /// # Errors
    /// [`RenderError`] when there is no OpenGL, or not for a picture of this size.
    pub fn new(registry: Registry, scenario: Scenario, view: StudioView) -> Result<Self, RenderError> {
        let surface = Surface::new(view.size[0], view.size[1])?;
        let glow = egui_glow::Painter::new(surface.gl().clone(), "", None, false);
        let glow = glow.map_err(|fault| RenderError::Context(fault.to_string()))?;
        let previews = if view.overlay == Overlay::Gallery { Previews::all(registry) } else { Previews::none() };
        let mut model = Model::new(registry, scenario, view.preferences.clone());
        (model.tab, model.overlay) = (view.tab, view.overlay);
        let context = egui::Context::default();
        context.set_fonts(theme::fonts());
        let painter = Painter::new(surface.gl().clone());
        let seen = Snapshot { pace: 1.0, ..Snapshot::default() };
        Ok(Self { context, glow, painter, surface, model, previews, view, seen, sight: Sight::default(), frames: 0 })
    }

    /// The window's state, to change it before a picture.
    pub fn model(&mut self) -> &mut Model {
        &mut self.model
    }

    /// Looks at the simulation without drawing, so that trails have a point for this moment. False when there are none,
    /// and looking is therefore of no use.
    pub fn look(&mut self, simulation: &dyn Simulation) -> bool {
        let seen = &mut self.seen;
        if seen.look == 0 {
            seen.begin(simulation, self.model.scenario.duration);
            seen.speed = seen.usual_speed();
        }
        seen.look += 1;
        seen.time = simulation.time();
        self.sight.set_paint(self.model.preferences.paint);
        self.sight.set_arrows(self.model.preferences.arrows);
        self.sight.look(simulation, &mut seen.scene);
        seen.probed = simulation.probed();
        !seen.scene.trails.is_empty()
    }

    /// The window as it is now; `playing` is what its button shows.
    ///
    /// # Errors
    /// [`RenderError`] when OpenGL refuses.
    pub fn picture(&mut self, simulation: &dyn Simulation, playing: bool) -> Result<Picture, RenderError> {
        self.look(simulation);
        self.seen.playing = playing;
        self.seen.measured = Arc::new(Measured::of(simulation, 0));
        let passes = if self.frames == 0 { PASSES } else { 1 };
        for _ in 0..passes {
            self.pass()?;
        }
        Ok(self.surface.picture())
    }

    /// Records a row in the notebook, as the key does.
    pub fn record_row(&mut self, simulation: &dyn Simulation) {
        self.look(simulation);
        self.seen.measured = Arc::new(Measured::of(simulation, 0));
        self.model.notebook.record(&self.model.scenario, &self.seen);
    }

    fn pass(&mut self) -> Result<(), RenderError> {
        self.surface.bind()?;
        let pixels = self.view.scale;
        crate::window::dress(&self.context, &self.model);
        let zoom = crate::window::zoom(&self.model);
        let size = egui::vec2(self.view.size[0] as f32, self.view.size[1] as f32) / (pixels * zoom);
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), size)),
            time: Some(f64::from(self.frames)),
            focused: true,
            ..RawInput::default()
        };
        input.viewports.insert(ViewportId::ROOT, ViewportInfo { native_pixels_per_point: Some(pixels), ..ViewportInfo::default() });
        self.frames += 1;
        let Self { context, glow, painter, model, previews, seen, .. } = self;
        let mut output = context.clone().run_ui(input, |ui| {
            let mut register = |texture| glow.register_native_texture(texture);
            ui::show(ui, model, seen, previews, &mut Hosted { painter, register: &mut register });
        });
        let meshes = self.context.tessellate(output.shapes, output.pixels_per_point);
        self.surface.bind()?;
        self.glow.clear(self.view.size, [0.0, 0.0, 0.0, 1.0]);
        self.glow.paint_and_update_textures(self.view.size, output.pixels_per_point, &meshes, &mut output.textures_delta);
        self.painter.fault.take().map_or(Ok(()), Err)
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        // OpenGL's objects go in their own context, before it does.
        if self.surface.bind().is_ok() {
            self.glow.destroy();
        }
        self.painter = Painter::new(Arc::clone(self.surface.gl()));
    }
}
