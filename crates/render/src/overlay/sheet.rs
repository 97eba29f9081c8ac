//! A sheet of glass over the picture, on which texts, swatches and bars are laid.

use super::font::{Glyph, Style, Typeface};
use crate::RenderError;
use crate::gl::{Gl, Pass, Program, Vertex, VertexBuffer};
use crate::projection::Rectangle;

/// A colour with its opacity, each from 0 to 1.
pub(crate) type Rgba = [f32; 4];

#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct FlatVertex {
    frame: [f32; 4],
    atlas: [f32; 4],
    colour: Rgba,
}

impl Vertex for FlatVertex {
    const FIELDS: &'static [i32] = &[4, 4, 4];
}

/// Where a text stands with respect to the point it is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Middle,
    Right,
}

/// Collects rectangles and letters, and draws them at once in the order they came.
pub(crate) struct Sheet {
    program: Program,
    buffer: VertexBuffer<FlatVertex>,
    vertices: Vec<FlatVertex>,
    pub(crate) typeface: Typeface,
}

impl Sheet {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        Ok(Self {
            program: Program::new(gl, "flat", &[include_str!("../shaders/flat.glsl")])?,
            buffer: VertexBuffer::new(gl)?,
            vertices: Vec::new(),
            typeface: Typeface::new(gl)?,
        })
    }

    /// Starts an empty sheet.
    pub(crate) fn begin(&mut self) {
        self.vertices.clear();
        self.typeface.begin();
    }

    /// A filled rectangle with its edges on whole pixels.
    pub(crate) fn fill(&mut self, area: Rectangle, colour: Rgba) {
        let (right, bottom) = (area.left + area.width, area.top + area.height);
        let frame = [area.left, area.top, right, bottom].map(|x| x.round() as f32);
        self.vertices.push(FlatVertex { frame, atlas: [0.5; 4], colour });
    }

    /// A filled circle.
    pub(crate) fn disc(&mut self, centre: [f64; 2], radius: f64, colour: Rgba) {
        let glyph = self.typeface.disc(radius);
        let corner = [centre[0].round() as f32 + glyph.offset[0], centre[1].round() as f32 + glyph.offset[1]];
        self.push(corner, glyph, colour);
    }

    /// One line of text; `at` is on its baseline.
    pub(crate) fn text(&mut self, text: &str, style: Style, at: [f64; 2], align: Align, colour: Rgba) {
        let width = self.typeface.width(text, style);
        let left = match align {
            Align::Left => at[0],
            Align::Middle => at[0] - 0.5 * width,
            Align::Right => at[0] - width,
        };
        for (corner, glyph) in self.typeface.lay(text, style, [left, at[1]]) {
            self.push(corner, glyph, colour);
        }
    }

    fn push(&mut self, [left, top]: [f32; 2], glyph: Glyph, colour: Rgba) {
        let [u0, v0, u1, v1] = glyph.texels;
        let frame = [left, top, left + u1 - u0, top + v1 - v0];
        self.vertices.push(FlatVertex { frame, atlas: glyph.texels, colour });
    }

    /// Draws what was collected.
    pub(crate) fn draw(&mut self, gl: &Gl, frame: [u32; 2]) {
        Pass::Paint.begin(gl);
        self.buffer.replace(&self.vertices);
        self.typeface.texture().bind();
        self.program.bind();
        self.program.set("u_frame", frame.map(|n| n as f32));
        self.program.set("u_atlas", 0);
        self.buffer.draw();
    }
}
