//! Shader programs from one source for desktop OpenGL 3.3 and OpenGL ES 3.0.

use std::collections::HashMap;

use glow::HasContext;

use super::Gl;
use crate::RenderError;

/// A linked program. Its stages are parts of one text: `VERTEX` is defined in the first, and `varying` is the way from
/// one to the other.
pub(crate) struct Program {
    gl: Gl,
    handle: glow::Program,
    uniforms: HashMap<String, glow::UniformLocation>,
}

impl Program {
    /// Compiles the text made of `parts` in their order.
    ///
    /// # Errors
    /// [`RenderError::Shader`] with the compiler's words.
    pub(crate) fn new(gl: &Gl, name: &'static str, parts: &[&str]) -> Result<Self, RenderError> {
        let fault = |log: String| RenderError::Shader { name, log };
        unsafe {
            let program = gl.create_program().map_err(RenderError::OpenGl)?;
            let this = Self { gl: gl.clone(), handle: program, uniforms: HashMap::new() };
            for (stage, define) in
                [(glow::VERTEX_SHADER, "#define VERTEX\n#define varying out\n"), (glow::FRAGMENT_SHADER, "#define varying in\n")]
            {
                let shader = gl.create_shader(stage).map_err(RenderError::OpenGl)?;
                gl.shader_source(shader, &[version_header(gl), define, &parts.concat()].concat());
                gl.compile_shader(shader);
                gl.attach_shader(program, shader);
                let compiled = gl.get_shader_compile_status(shader);
                let log = gl.get_shader_info_log(shader);
                gl.delete_shader(shader); // lives on as long as the program holds it
                if !compiled {
                    return Err(fault(log));
                }
            }
            gl.link_program(program);
            if !gl.get_program_link_status(program) {
                return Err(fault(gl.get_program_info_log(program)));
            }
            Ok(this.with_uniforms())
        }
    }

    fn with_uniforms(mut self) -> Self {
        unsafe {
            for index in 0..self.gl.get_active_uniforms(self.handle) {
                if let Some(uniform) = self.gl.get_active_uniform(self.handle, index)
                    && let Some(place) = self.gl.get_uniform_location(self.handle, &uniform.name)
                {
                    self.uniforms.insert(uniform.name.trim_end_matches("[0]").to_owned(), place);
                }
            }
        }
        self
    }

    /// Sets a uniform for the draws to come; one the compiler has removed is passed over.
    pub(crate) fn set(&self, name: &str, value: impl Uniform) {
        if let Some(&place) = self.uniforms.get(name) {
            unsafe {
                self.gl.use_program(Some(self.handle));
                value.send(&self.gl, place);
            }
        }
    }

    /// Makes this the program of the draws to come.
    pub(crate) fn bind(&self) {
        unsafe { self.gl.use_program(Some(self.handle)) };
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        unsafe { self.gl.delete_program(self.handle) };
    }
}

/// The lines that differ between the two languages.
fn version_header(gl: &Gl) -> &'static str {
    if gl.version().is_embedded {
        "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
    } else {
        "#version 330 core\n"
    }
}

/// A value that a shader can be given.
pub(crate) trait Uniform {
    /// # Safety
    /// The program of `place` is in use in the current context.
    unsafe fn send(self, gl: &Gl, place: glow::UniformLocation);
}

macro_rules! uniform {
    ($type:ty, $value:ident, $gl:ident, $place:ident => $call:expr) => {
        impl Uniform for $type {
            unsafe fn send(self, $gl: &Gl, $place: glow::UniformLocation) {
                let $value = self;
                unsafe { $call };
            }
        }
    };
}
uniform!(i32, v, gl, place => gl.uniform_1_i32(Some(&place), v));
uniform!(f32, v, gl, place => gl.uniform_1_f32(Some(&place), v));
uniform!([f32; 2], v, gl, place => gl.uniform_2_f32_slice(Some(&place), &v));
uniform!([f32; 3], v, gl, place => gl.uniform_3_f32_slice(Some(&place), &v));
uniform!([f32; 4], v, gl, place => gl.uniform_4_f32_slice(Some(&place), &v));
uniform!(&[[f32; 3]], v, gl, place => gl.uniform_3_f32_slice(Some(&place), v.as_flattened()));
uniform!([[f32; 3]; 3], v, gl, place => gl.uniform_matrix_3_f32_slice(Some(&place), false, v.as_flattened()));
uniform!([[f32; 4]; 4], v, gl, place => gl.uniform_matrix_4_f32_slice(Some(&place), false, v.as_flattened()));
