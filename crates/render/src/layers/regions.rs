//! Filled rectangles in the plane.

use corpuscle_scene::Scene;

use super::{SPACE, Space};
use crate::RenderError;
use crate::gl::{Gl, Pass, Program, Vertex, VertexBuffer};
use crate::projection::pairs;

#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct RegionVertex {
    corners: [[f32; 4]; 2],
    colour: [f32; 4],
}

impl Vertex for RegionVertex {
    const FIELDS: &'static [i32] = &[4, 4, 4];
}

/// Halves of a box, probe regions.
pub(crate) struct Regions {
    program: Program,
    buffer: VertexBuffer<RegionVertex>,
}

impl Regions {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        let program = Program::new(gl, "region", &[SPACE, include_str!("../shaders/region.glsl")])?;
        Ok(Self { program, buffer: VertexBuffer::new(gl)? })
    }

    pub(crate) fn draw(&mut self, gl: &Gl, space: &Space, scene: &Scene) {
        let vertices: Vec<_> = scene
            .regions
            .iter()
            .map(|region| RegionVertex {
                corners: pairs([region.lower[0], region.lower[1], region.upper[0], region.upper[1]]),
                colour: space.palette.rgba(region.colour),
            })
            .collect();
        self.buffer.replace(&vertices);
        if space.projection.is_spatial() { Pass::Veil } else { Pass::Paint }.begin(gl);
        space.enter(&self.program);
        self.buffer.draw();
    }
}
