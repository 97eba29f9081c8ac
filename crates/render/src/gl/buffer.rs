//! Arrays in the graphics memory, drawn as instanced quads.

use std::marker::PhantomData;

use glow::HasContext;

use super::{Cost, Gl};
use crate::RenderError;

/// What one quad is made from. The attributes of the shader have the locations 0, 1, 2, ... in the order of the fields.
pub(crate) trait Vertex: bytemuck::Pod {
    /// Number of floats (1 to 4) of each field; together they fill the whole struct.
    const FIELDS: &'static [i32];
}

/// A growing array of `T` in the graphics memory; each element is drawn as one quad.
pub(crate) struct VertexBuffer<T> {
    gl: Gl,
    array: glow::VertexArray,
    buffer: glow::Buffer,
    capacity: usize,
    length: usize,
    element: PhantomData<T>,
}

impl<T: Vertex> VertexBuffer<T> {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        debug_assert_eq!(4 * T::FIELDS.iter().sum::<i32>() as usize, size_of::<T>());
        unsafe {
            let array = gl.create_vertex_array().map_err(RenderError::OpenGl)?;
            let buffer = gl.create_buffer().map_err(RenderError::OpenGl)?;
            gl.bind_vertex_array(Some(array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(buffer));
            let mut offset = 0;
            for (location, &floats) in (0..).zip(T::FIELDS) {
                gl.enable_vertex_attrib_array(location);
                gl.vertex_attrib_pointer_f32(location, floats, glow::FLOAT, false, size_of::<T>() as i32, offset);
                gl.vertex_attrib_divisor(location, 1);
                offset += 4 * floats;
            }
            gl.bind_vertex_array(None);
            Ok(Self { gl: gl.clone(), array, buffer, capacity: 0, length: 0, element: PhantomData })
        }
    }

    /// Replaces the whole content.
    pub(crate) fn replace(&mut self, elements: &[T]) {
        self.length = elements.len();
        unsafe {
            self.gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.buffer));
            if self.length > self.capacity {
                self.capacity = self.length.next_power_of_two();
                let bytes = (self.capacity * size_of::<T>()) as i32;
                self.gl.buffer_data_size(glow::ARRAY_BUFFER, bytes, glow::DYNAMIC_DRAW);
            }
        }
        self.write(0, elements);
    }

    /// Overwrites the elements from `first` on, which must exist.
    pub(crate) fn write(&mut self, first: usize, elements: &[T]) {
        debug_assert!(first + elements.len() <= self.length);
        let offset = (first * size_of::<T>()) as i32;
        Cost::sent(size_of_val(elements));
        unsafe {
            self.gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.buffer));
            self.gl.buffer_sub_data_u8_slice(glow::ARRAY_BUFFER, offset, bytemuck::cast_slice(elements));
        }
    }

    /// Draws one quad an element; the shader knows its corner by `gl_VertexID`.
    pub(crate) fn draw(&self) {
        if self.length > 0 {
            Cost::drawn();
            unsafe {
                self.gl.bind_vertex_array(Some(self.array));
                self.gl.draw_arrays_instanced(glow::TRIANGLE_STRIP, 0, 4, self.length as i32);
                self.gl.bind_vertex_array(None);
            }
        }
    }
}

/// A strip of triangles that the shader makes from nothing but `gl_VertexID`.
pub(crate) struct Strip {
    gl: Gl,
    array: glow::VertexArray,
}

impl Strip {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        let array = unsafe { gl.create_vertex_array() }.map_err(RenderError::OpenGl)?;
        Ok(Self { gl: gl.clone(), array })
    }

    pub(crate) fn draw(&self, vertices: usize) {
        Cost::drawn();
        unsafe {
            // The core profile draws nothing without a vertex array, be it empty.
            self.gl.bind_vertex_array(Some(self.array));
            self.gl.draw_arrays(glow::TRIANGLE_STRIP, 0, vertices as i32);
            self.gl.bind_vertex_array(None);
        }
    }
}

impl Drop for Strip {
    fn drop(&mut self) {
        unsafe { self.gl.delete_vertex_array(self.array) };
    }
}

impl<T> Drop for VertexBuffer<T> {
    fn drop(&mut self) {
        unsafe {
            self.gl.delete_vertex_array(self.array);
            self.gl.delete_buffer(self.buffer);
        }
    }
}
