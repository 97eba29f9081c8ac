//! A picture without a window for a host that paints it itself: a window's panels, drawn where there is no screen.

use std::sync::Arc;

use crate::canvas::Canvas;
use crate::gl::Framebuffer;
use crate::platform::{Offscreen, load};
use crate::{Picture, RenderError};

/// An OpenGL context with a frame buffer of its own and no window.
///
/// Stays on the thread that made it, as OpenGL's contexts do.
pub struct Surface {
    framebuffer: Option<Framebuffer>,
    gl: Arc<glow::Context>,
    offscreen: Offscreen,
    size: [u32; 2],
}

impl Surface {
    /// A surface of `width` by `height` pixels.
    ///
    /// # Errors
    /// As [`crate::Headless::new`].
    pub fn new(width: u32, height: u32) -> Result<Self, RenderError> {
        let offscreen = Offscreen::new(crate::ShadingLanguage::Desktop)
            .or_else(|desktop| Offscreen::new(crate::ShadingLanguage::Embedded).map_err(|_| desktop))?;
        let gl = load(offscreen.display());
        Canvas::new(gl.clone())?.renderer().check_size(width, height)?;
        let framebuffer = Some(Framebuffer::new(&gl, [width, height], 1)?);
        Ok(Self { framebuffer, gl, offscreen, size: [width, height] })
    }

    /// The context's functions, for the host and its painter.
    pub fn gl(&self) -> &Arc<glow::Context> {
        &self.gl
    }

    /// Makes the context current, and directs what is drawn next to the picture.
    ///
    /// # Errors
    /// [`RenderError::Context`] when the driver has lost the context.
    pub fn bind(&self) -> Result<(), RenderError> {
        self.offscreen.make_current()?;
        if let Some(framebuffer) = &self.framebuffer {
            framebuffer.bind();
        }
        Ok(())
    }

    /// What has been drawn.
    pub fn picture(&self) -> Picture {
        let rgba = self.framebuffer.as_ref().map(Framebuffer::read).unwrap_or_default();
        Picture { width: self.size[0], height: self.size[1], rgba }
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // The frame buffer is deleted in its own context; see `Headless`.
        let _ = self.offscreen.make_current();
        self.framebuffer = None;
    }
}
