//! The stage's painter: scenes into textures, for a window and without one alike.

use std::collections::HashMap;
use std::sync::Arc;

use corpuscle_render::{Backdrop, RenderError, View};
use corpuscle_scene::Scene;
use egui::TextureId;

use crate::ui::{Canvas, Easel};

/// The textures of one OpenGL context.
pub(crate) struct Painter {
    gl: Arc<glow::Context>,
    canvases: HashMap<Canvas, Sheet>,
    /// The first thing that went wrong.
    pub(crate) fault: Option<RenderError>,
}

/// A texture, its name among the host's, and what is on it: the same look from the same view need not be drawn again.
struct Sheet {
    backdrop: Backdrop,
    texture: TextureId,
    painted: Option<(u64, View)>,
}

impl Painter {
    pub(crate) fn new(gl: Arc<glow::Context>) -> Self {
        Self { gl, canvases: HashMap::new(), fault: None }
    }

    /// Draws a scene; `register` gives a new texture its name among the host's.
    fn paint(
        &mut self,
        canvas: Canvas,
        look: u64,
        scene: &Scene,
        view: &View,
        register: &mut dyn FnMut(glow::Texture) -> TextureId,
    ) -> Result<TextureId, RenderError> {
        if !self.canvases.contains_key(&canvas) {
            let backdrop = Backdrop::new(self.gl.clone())?;
            let texture = register(backdrop.texture());
            self.canvases.insert(canvas, Sheet { backdrop, texture, painted: None });
        }
        let Some(sheet) = self.canvases.get_mut(&canvas) else {
            return Err(RenderError::OpenGl("a canvas is lost".into()));
        };
        if sheet.painted.as_ref().is_none_or(|(known, of)| (*known, of) != (look, view)) {
            sheet.backdrop.draw(scene, view)?;
            sheet.painted = Some((look, view.clone()));
        }
        Ok(sheet.texture)
    }

    /// Forgets the gallery's pictures while they are not shown.
    pub(crate) fn keep_stage_only(&mut self) {
        self.canvases.retain(|canvas, _| !matches!(canvas, Canvas::Card(_)));
    }
}

/// A painter with its host's list of textures.
pub(crate) struct Hosted<'a> {
    pub(crate) painter: &'a mut Painter,
    pub(crate) register: &'a mut dyn FnMut(glow::Texture) -> TextureId,
}

impl Easel for Hosted<'_> {
    fn paint(&mut self, canvas: Canvas, look: u64, scene: &Scene, view: &View) -> Option<TextureId> {
        match self.painter.paint(canvas, look, scene, view, self.register) {
            Ok(texture) => Some(texture),
            Err(fault) => {
                self.painter.fault.get_or_insert(fault);
                None
            }
        }
    }
}
