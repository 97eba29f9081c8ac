//! The switches of OpenGL's state, set together and never one by one.

use glow::HasContext;

use super::Gl;

/// How the fragments of a draw meet what is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Painted over it in the order of drawing, by opacity.
    Paint,
    /// Hidden by what is nearer, but hiding nothing: transparent things in space.
    Veil,
    /// Hidden by what is nearer and hiding what is farther; opacity chooses among the samples of a pixel.
    Solid,
}

/// The rectangle of the frame buffer that a picture fills, in pixels, from the lower left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Viewport {
    pub(crate) origin: [i32; 2],
    pub(crate) size: [u32; 2],
}

/// Directs drawing to `viewport` and nowhere else, and empties it.
pub(crate) fn begin_frame(gl: &Gl, viewport: Viewport, ground: [f32; 3]) {
    let [x, y] = viewport.origin;
    let [width, height] = viewport.size.map(|n| n as i32);
    let [red, green, blue] = ground;
    unsafe {
        gl.viewport(x, y, width, height);
        gl.enable(glow::SCISSOR_TEST);
        gl.scissor(x, y, width, height);
        gl.disable(glow::CULL_FACE);
        gl.disable(glow::STENCIL_TEST);
        gl.disable(glow::DITHER);
        gl.color_mask(true, true, true, true);
        gl.depth_mask(true);
        gl.clear_color(red, green, blue, 1.0);
        gl.clear_depth_f32(1.0);
        gl.clear(glow::COLOR_BUFFER_BIT | glow::DEPTH_BUFFER_BIT);
        // The picture stays opaque, whatever is painted on it.
        gl.color_mask(true, true, true, false);
    }
}

/// Leaves the state as a fresh context has it, for whoever draws next.
pub(crate) fn end_frame(gl: &Gl) {
    unsafe {
        gl.disable(glow::SCISSOR_TEST);
        gl.disable(glow::SAMPLE_ALPHA_TO_COVERAGE);
        gl.disable(glow::DEPTH_TEST);
        gl.disable(glow::BLEND);
        gl.depth_mask(true);
        gl.color_mask(true, true, true, true);
        gl.use_program(None);
    }
}

impl Pass {
    /// Sets the state for the draws to come.
    pub(crate) fn begin(self, gl: &Gl) {
        let switch = |capability, on| unsafe { if on { gl.enable(capability) } else { gl.disable(capability) } };
        switch(glow::DEPTH_TEST, self != Self::Paint);
        switch(glow::BLEND, self != Self::Solid);
        switch(glow::SAMPLE_ALPHA_TO_COVERAGE, self == Self::Solid);
        unsafe {
            gl.depth_mask(self == Self::Solid);
            gl.depth_func(glow::LEQUAL);
            gl.blend_equation(glow::FUNC_ADD);
            gl.blend_func(glow::SRC_ALPHA, glow::ONE_MINUS_SRC_ALPHA);
        }
    }
}

/// Longest side of a picture that this context can draw, in pixels.
pub(crate) fn largest_side(gl: &Gl) -> u32 {
    let limit = unsafe { gl.get_parameter_i32(glow::MAX_RENDERBUFFER_SIZE).min(gl.get_parameter_i32(glow::MAX_TEXTURE_SIZE)) };
    limit.max(0) as u32
}
