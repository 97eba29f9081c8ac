//! Pictures with no window and no screen.

use corpuscle_scene::Scene;

use crate::canvas::Canvas;
use crate::platform::{Offscreen, load};
use crate::projection::Projection;
use crate::{Picture, RenderError, View};

/// The two dialects of OpenGL that the shaders are written for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadingLanguage {
    /// OpenGL 3.3 with GLSL 330.
    #[default]
    Desktop,
    /// OpenGL ES 3.0 with GLSL 300 es.
    Embedded,
}

/// Draws pictures with no window: on EGL devices (a graphics card or Mesa's software renderer) where there are any, on
/// the system's own OpenGL otherwise.
///
/// Stays on the thread that made it, as OpenGL's contexts do.
pub struct Headless {
    canvas: Canvas,
    offscreen: Offscreen,
    size: [u32; 2],
}

impl Headless {
    /// A context for pictures of `width` by `height` pixels.
    ///
    /// # Errors
    /// [`RenderError::Missing`] names the package that is not installed; [`RenderError::Size`] refuses empty and
    /// oversized pictures; [`RenderError::Context`] carries the driver's words.
    pub fn new(width: u32, height: u32) -> Result<Self, RenderError> {
        Self::with_language(width, height, ShadingLanguage::Desktop)
            .or_else(|desktop| Self::with_language(width, height, ShadingLanguage::Embedded).map_err(|_| desktop))
    }

    /// The same for one dialect.
    ///
    /// # Errors
    /// As [`Headless::new`].
    pub fn with_language(width: u32, height: u32, language: ShadingLanguage) -> Result<Self, RenderError> {
        let offscreen = Offscreen::new(language)?;
        let canvas = Canvas::new(load(offscreen.display()))?;
        canvas.renderer().check_size(width, height)?;
        Ok(Self { canvas, offscreen, size: [width, height] })
    }

    /// A view of the size this was made for.
    pub fn view(&self) -> View {
        View::new(self.size[0], self.size[1])
    }

    /// Where the simulation's space appears on a picture.
    pub fn projection(&self, scene: &Scene, view: &View) -> Projection {
        self.canvas.renderer().projection(scene, view)
    }

    /// Draws a scene, in the size that `view` asks for.
    ///
    /// # Errors
    /// As [`crate::Renderer::draw`].
    pub fn picture(&mut self, scene: &Scene, view: &View) -> Result<Picture, RenderError> {
        self.offscreen.make_current()?;
        self.canvas.picture(scene, view)
    }

    /// Draws a scene and waits until it is done, without reading it back: for measuring.
    ///
    /// # Errors
    /// As [`crate::Renderer::draw`].
    pub fn draw(&mut self, scene: &Scene, view: &View) -> Result<(), RenderError> {
        self.offscreen.make_current()?;
        self.canvas.draw(scene, view)?.finish();
        Ok(())
    }
}

impl Drop for Headless {
    fn drop(&mut self) {
        // The canvas goes first and deletes its objects in the current context, which has to be its own. When that
        // fails the driver has lost the context, and its objects with it.
        let _ = self.offscreen.make_current();
    }
}
