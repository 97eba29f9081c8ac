//! Textures: tables that shaders read.

use glow::HasContext;

use super::{Cost, Gl};
use crate::RenderError;

/// What one texel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// One byte: how much of the texel is covered.
    Mask,
    /// Four bytes: red, green, blue, opacity.
    Colours,
    /// Four floats.
    Floats,
}

impl Format {
    const fn bytes(self) -> usize {
        match self {
            Self::Mask => 1,
            Self::Colours => 4,
            Self::Floats => 16,
        }
    }

    const fn names(self) -> (u32, u32, u32) {
        match self {
            Self::Mask => (glow::R8, glow::RED, glow::UNSIGNED_BYTE),
            Self::Colours => (glow::RGBA8, glow::RGBA, glow::UNSIGNED_BYTE),
            Self::Floats => (glow::RGBA32F, glow::RGBA, glow::FLOAT),
        }
    }
}

/// A rectangular table, read texel by texel, without interpolation.
pub(crate) struct Texture {
    gl: Gl,
    handle: glow::Texture,
    format: Format,
    size: [usize; 2],
}

impl Texture {
    /// A table of `width` by `height` texels, all zero.
    pub(crate) fn new(gl: &Gl, format: Format, size: [usize; 2]) -> Result<Self, RenderError> {
        let (internal, layout, component) = format.names();
        let zeros = vec![0; size[0] * size[1] * format.bytes()];
        unsafe {
            let texture = gl.create_texture().map_err(RenderError::OpenGl)?;
            gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            for (name, value) in [
                (glow::TEXTURE_MIN_FILTER, glow::NEAREST),
                (glow::TEXTURE_MAG_FILTER, glow::NEAREST),
                (glow::TEXTURE_WRAP_S, glow::CLAMP_TO_EDGE),
                (glow::TEXTURE_WRAP_T, glow::CLAMP_TO_EDGE),
            ] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, name, value as i32);
            }
            gl.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
            gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                internal as i32,
                size[0] as i32,
                size[1] as i32,
                0,
                layout,
                component,
                glow::PixelUnpackData::Slice(Some(&zeros)),
            );
            Ok(Self { gl: gl.clone(), handle: texture, format, size })
        }
    }

    /// Width and height in texels.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Overwrites the rectangle with its lower corner at `at`.
    pub(crate) fn write<T: bytemuck::Pod>(&mut self, at: [usize; 2], size: [usize; 2], texels: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(texels);
        debug_assert_eq!(bytes.len(), size[0] * size[1] * self.format.bytes());
        debug_assert!(at[0] + size[0] <= self.size[0] && at[1] + size[1] <= self.size[1]);
        let (_, layout, component) = self.format.names();
        Cost::sent(bytes.len());
        unsafe {
            self.gl.bind_texture(glow::TEXTURE_2D, Some(self.handle));
            self.gl.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
            self.gl.tex_sub_image_2d(
                glow::TEXTURE_2D,
                0,
                at[0] as i32,
                at[1] as i32,
                size[0] as i32,
                size[1] as i32,
                layout,
                component,
                glow::PixelUnpackData::Slice(Some(bytes)),
            );
        }
    }

    /// Makes this the table that the sampler with the value 0 reads.
    pub(crate) fn bind(&self) {
        unsafe {
            self.gl.active_texture(glow::TEXTURE0);
            self.gl.bind_texture(glow::TEXTURE_2D, Some(self.handle));
        }
    }
}

impl Drop for Texture {
    fn drop(&mut self) {
        unsafe { self.gl.delete_texture(self.handle) };
    }
}
