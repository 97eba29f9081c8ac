//! A renderer with a frame buffer of its own: the same pixels in a window and without one.

use std::sync::Arc;

use corpuscle_scene::Scene;

use crate::gl::{Framebuffer, Gl};
use crate::{Picture, RenderError, Renderer, View};

pub(crate) struct Canvas {
    gl: Gl,
    renderer: Renderer,
    framebuffer: Option<Framebuffer>,
}

impl Canvas {
    pub(crate) fn new(gl: Arc<glow::Context>) -> Result<Self, RenderError> {
        Ok(Self { renderer: Renderer::new(gl.clone())?, gl, framebuffer: None })
    }

    pub(crate) fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Draws and returns the frame buffer that now holds the picture.
    pub(crate) fn draw(&mut self, scene: &Scene, view: &View) -> Result<&Framebuffer, RenderError> {
        self.renderer.check_size(view.width, view.height)?;
        let size = [view.width, view.height];
        let samples = view.samples_for(view.camera.unwrap_or(scene.camera)).max(1);
        let framebuffer = match self.framebuffer.take() {
            Some(kept) if kept.size() == size && kept.asked() == samples => kept,
            _ => Framebuffer::new(&self.gl, size, samples)?,
        };
        let framebuffer = self.framebuffer.insert(framebuffer);
        framebuffer.bind();
        let view = View { origin: [0, 0], samples: framebuffer.samples(), ..view.clone() };
        self.renderer.draw(scene, &view)?;
        Ok(framebuffer)
    }

    pub(crate) fn picture(&mut self, scene: &Scene, view: &View) -> Result<Picture, RenderError> {
        let rgba = self.draw(scene, view)?.read();
        Ok(Picture { width: view.width, height: view.height, rgba })
    }
}
