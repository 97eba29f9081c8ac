//! Scenes drawn into a texture, for a host that shows them as a part of its own window.

use std::sync::Arc;

use corpuscle_scene::Scene;

use crate::canvas::Canvas;
use crate::gl::{Gl, Screen};
use crate::{RenderError, View};

/// A texture that shows a scene. Its name stays the same whatever its size; its first row is the lowest.
///
/// The host's context has to be current in every call, also when this is dropped, and afterwards no frame buffer of the
/// host's is bound any more.
pub struct Backdrop {
    canvas: Canvas,
    screen: Screen,
}

impl Backdrop {
    /// An empty texture in the host's context.
    ///
    /// # Errors
    /// [`RenderError::Shader`] or [`RenderError::OpenGl`] when the driver refuses.
    pub fn new(gl: Arc<glow::Context>) -> Result<Self, RenderError> {
        let screen = Screen::new(&(gl.clone() as Gl))?;
        Ok(Self { canvas: Canvas::new(gl)?, screen })
    }

    /// Draws a scene, in the size that `view` asks for.
    ///
    /// # Errors
    /// As [`crate::Renderer::draw`].
    pub fn draw(&mut self, scene: &Scene, view: &View) -> Result<(), RenderError> {
        self.screen.resize([view.width, view.height]);
        self.canvas.draw(scene, view)?.show_on(&self.screen);
        Ok(())
    }

    /// The texture.
    pub fn texture(&self) -> glow::Texture {
        self.screen.texture()
    }
}
