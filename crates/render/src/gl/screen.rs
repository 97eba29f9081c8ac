//! A texture that a finished picture is copied to, so that another program's shaders can show it.

use glow::HasContext;

use super::Gl;
use crate::RenderError;

/// A texture of colours with a frame buffer around it.
pub(crate) struct Screen {
    gl: Gl,
    texture: glow::Texture,
    framebuffer: glow::Framebuffer,
    size: [u32; 2],
}

impl Screen {
    /// One texel, not yet of any colour.
    ///
    /// # Errors
    /// [`RenderError::OpenGl`] when the driver refuses.
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        unsafe {
            let texture = gl.create_texture().map_err(RenderError::OpenGl)?;
            gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            for (name, value) in [
                (glow::TEXTURE_MIN_FILTER, glow::LINEAR),
                (glow::TEXTURE_MAG_FILTER, glow::LINEAR),
                (glow::TEXTURE_WRAP_S, glow::CLAMP_TO_EDGE),
                (glow::TEXTURE_WRAP_T, glow::CLAMP_TO_EDGE),
            ] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, name, value as i32);
            }
            let framebuffer = gl.create_framebuffer().map_err(RenderError::OpenGl)?;
            let mut this = Self { gl: gl.clone(), texture, framebuffer, size: [0, 0] };
            this.resize([1, 1]);
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            gl.framebuffer_texture_2d(glow::FRAMEBUFFER, glow::COLOR_ATTACHMENT0, glow::TEXTURE_2D, Some(texture), 0);
            gl.bind_framebuffer(glow::FRAMEBUFFER, None);
            Ok(this)
        }
    }

    /// Takes another size; what was there is lost.
    pub(crate) fn resize(&mut self, size: [u32; 2]) {
        if size == self.size {
            return;
        }
        self.size = size;
        let [width, height] = size.map(|n| n as i32);
        unsafe {
            self.gl.bind_texture(glow::TEXTURE_2D, Some(self.texture));
            let nothing = glow::PixelUnpackData::Slice(None);
            let (layout, component) = (glow::RGBA, glow::UNSIGNED_BYTE);
            self.gl.tex_image_2d(glow::TEXTURE_2D, 0, glow::RGBA8 as i32, width, height, 0, layout, component, nothing);
            self.gl.bind_texture(glow::TEXTURE_2D, None);
        }
    }

    pub(crate) fn texture(&self) -> glow::Texture {
        self.texture
    }

    pub(super) fn framebuffer(&self) -> glow::Framebuffer {
        self.framebuffer
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        unsafe {
            self.gl.delete_framebuffer(self.framebuffer);
            self.gl.delete_texture(self.texture);
        }
    }
}
