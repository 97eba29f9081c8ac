//! Straight lines of constant width on the screen.

use corpuscle_scene::{Line, Palette, Scene};

use super::{SPACE, Space};
use crate::RenderError;
use crate::gl::{Gl, Pass, Program, Vertex, VertexBuffer};
use crate::projection::pairs;

#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct LineVertex {
    from: [[f32; 3]; 2],
    to: [[f32; 3]; 2],
    width: f32,
    colour: [f32; 4],
}

impl Vertex for LineVertex {
    const FIELDS: &'static [i32] = &[3, 3, 3, 3, 1, 4];
}

impl LineVertex {
    fn new(line: &Line, palette: Palette) -> Self {
        Self { from: pairs(line.from), to: pairs(line.to), width: line.width, colour: palette.rgba(line.colour) }
    }
}

/// Springs, walls, edges of boxes.
pub(crate) struct Lines {
    program: Program,
    buffer: VertexBuffer<LineVertex>,
    scratch: Vec<LineVertex>,
}

impl Lines {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        let program = Program::new(gl, "line", &[SPACE, include_str!("../shaders/line.glsl")])?;
        Ok(Self { program, buffer: VertexBuffer::new(gl)?, scratch: Vec::new() })
    }

    pub(crate) fn draw(&mut self, gl: &Gl, space: &Space, scene: &Scene) {
        self.scratch.clear();
        self.scratch.extend(scene.lines.iter().map(|line| LineVertex::new(line, space.palette)));
        self.buffer.replace(&self.scratch);
        if space.projection.is_spatial() { Pass::Veil } else { Pass::Paint }.begin(gl);
        space.enter(&self.program);
        // Without perspective nothing is behind the eye.
        let near = if space.projection.is_spatial() { space.projection.near() as f32 } else { f32::MIN };
        self.program.set("u_near", near);
        self.buffer.draw();
    }
}
