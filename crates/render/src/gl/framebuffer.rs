//! Pictures in the graphics memory that can be drawn to and read back.

use glow::HasContext;

use super::Gl;
use crate::RenderError;

/// A picture with a depth for each pixel; with several samples a pixel when asked for and possible.
pub(crate) struct Framebuffer {
    gl: Gl,
    size: [u32; 2],
    asked: u32,
    samples: u32,
    drawn: Target,
    /// Where the samples are averaged; absent when there is one a pixel.
    resolved: Option<Target>,
}

impl Framebuffer {
    /// A picture of `size` pixels with at most `samples` samples each.
    ///
    /// # Errors
    /// [`RenderError::OpenGl`] when the driver cannot make one of this size.
    pub(crate) fn new(gl: &Gl, size: [u32; 2], samples: u32) -> Result<Self, RenderError> {
        let most = unsafe { gl.get_parameter_i32(glow::MAX_SAMPLES) }.max(0) as u32;
        let asked = samples;
        let samples = if samples > 1 { samples.min(most) } else { 0 };
        let drawn = Target::new(gl, size, samples, true)?;
        let resolved = if samples > 0 { Some(Target::new(gl, size, 0, false)?) } else { None };
        Ok(Self { gl: gl.clone(), size, asked, samples, drawn, resolved })
    }

    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Samples a pixel, 1 when there is no multisampling.
    pub(crate) fn samples(&self) -> u32 {
        self.samples.max(1)
    }

    /// Samples a pixel that were asked for.
    pub(crate) fn asked(&self) -> u32 {
        self.asked
    }

    /// Directs what is drawn next to this picture.
    pub(crate) fn bind(&self) {
        unsafe { self.gl.bind_framebuffer(glow::FRAMEBUFFER, Some(self.drawn.framebuffer)) };
    }

    /// Waits until everything asked for is drawn.
    pub(crate) fn finish(&self) {
        unsafe { self.gl.finish() };
    }

    /// Red, green, blue and opacity of each pixel, the top row first.
    pub(crate) fn read(&self) -> Vec<u8> {
        let [width, height] = self.size.map(|n| n as usize);
        let mut bytes = vec![0; 4 * width * height];
        let source = self.resolve();
        unsafe {
            self.gl.bind_framebuffer(glow::FRAMEBUFFER, Some(source));
            self.gl.pixel_store_i32(glow::PACK_ALIGNMENT, 1);
            let into = glow::PixelPackData::Slice(Some(&mut bytes));
            self.gl.read_pixels(0, 0, width as i32, height as i32, glow::RGBA, glow::UNSIGNED_BYTE, into);
        }
        // OpenGL's first row is the lowest.
        for row in 0..height / 2 {
            let (upper, lower) = bytes.split_at_mut(4 * width * (height - 1 - row));
            upper[4 * width * row..4 * width * (row + 1)].swap_with_slice(&mut lower[..4 * width]);
        }
        bytes
    }

    /// Copies the picture to the window.
    #[cfg(feature = "window")]
    pub(crate) fn show(&self) {
        self.copy(self.resolve(), None);
        unsafe { self.gl.bind_framebuffer(glow::FRAMEBUFFER, None) };
    }

    /// Copies the picture to a texture of its size; no frame buffer is bound afterwards.
    pub(crate) fn show_on(&self, screen: &super::Screen) {
        self.copy(self.resolve(), Some(screen.framebuffer()));
        unsafe { self.gl.bind_framebuffer(glow::FRAMEBUFFER, None) };
    }

    fn resolve(&self) -> glow::Framebuffer {
        let Some(resolved) = &self.resolved else { return self.drawn.framebuffer };
        self.copy(self.drawn.framebuffer, Some(resolved.framebuffer));
        resolved.framebuffer
    }

    fn copy(&self, from: glow::Framebuffer, to: Option<glow::Framebuffer>) {
        let [w, h] = self.size.map(|n| n as i32);
        unsafe {
            self.gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(from));
            self.gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, to);
            self.gl.blit_framebuffer(0, 0, w, h, 0, 0, w, h, glow::COLOR_BUFFER_BIT, glow::NEAREST);
        }
    }
}

/// One OpenGL frame buffer with its own memory.
struct Target {
    gl: Gl,
    framebuffer: glow::Framebuffer,
    colour: glow::Renderbuffer,
    depth: Option<glow::Renderbuffer>,
}

impl Target {
    fn new(gl: &Gl, size: [u32; 2], samples: u32, with_depth: bool) -> Result<Self, RenderError> {
        let [width, height] = size.map(|n| n as i32);
        let storage = |attachment, format| unsafe {
            let buffer = gl.create_renderbuffer().map_err(RenderError::OpenGl)?;
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(buffer));
            gl.renderbuffer_storage_multisample(glow::RENDERBUFFER, samples as i32, format, width, height);
            gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, attachment, glow::RENDERBUFFER, Some(buffer));
            Ok::<_, RenderError>(buffer)
        };
        unsafe {
            let framebuffer = gl.create_framebuffer().map_err(RenderError::OpenGl)?;
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            let colour = storage(glow::COLOR_ATTACHMENT0, glow::RGBA8)?;
            let depth = if with_depth { Some(storage(glow::DEPTH_ATTACHMENT, glow::DEPTH_COMPONENT24)?) } else { None };
            let this = Self { gl: gl.clone(), framebuffer, colour, depth };
            match gl.check_framebuffer_status(glow::FRAMEBUFFER) {
                glow::FRAMEBUFFER_COMPLETE => Ok(this),
                status => Err(RenderError::OpenGl(format!("a frame buffer of {width} x {height} pixels is refused ({status:#x})"))),
            }
        }
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        unsafe {
            self.gl.delete_framebuffer(self.framebuffer);
            self.gl.delete_renderbuffer(self.colour);
            if let Some(depth) = self.depth {
                self.gl.delete_renderbuffer(depth);
            }
        }
    }
}
