//! What stands in the simulation's space, kind by kind: each layer keeps its own program and its own memory.

mod bodies;
mod lines;
mod maps;
mod regions;
mod trails;

pub(crate) use bodies::Bodies;
pub(crate) use lines::Lines;
pub(crate) use maps::Maps;
pub(crate) use regions::Regions;
pub(crate) use trails::Trails;

use corpuscle_scene::{Palette, Scene};

use crate::View;
use crate::gl::Program;
use crate::projection::{Projection, pair, pairs};

/// The part of every shader that knows the simulation's space.
pub(crate) const SPACE: &str = include_str!("../shaders/space.glsl");

/// What all layers are drawn with.
pub(crate) struct Space {
    pub(crate) projection: Projection,
    pub(crate) palette: Palette,
    /// Samples a pixel of the frame buffer.
    pub(crate) samples: u32,
    time: f64,
    frame: [f32; 2],
    point: f32,
}

impl Space {
    pub(crate) fn new(scene: &Scene, view: &View, projection: Projection, samples: u32) -> Self {
        let frame = [view.width as f32, view.height as f32];
        Self { projection, palette: view.palette, samples, time: scene.time, frame, point: view.scale }
    }

    /// Sets the uniforms of `space.glsl`.
    fn enter(&self, program: &Program) {
        self.enter_shifted(program, [0.0; 3]);
    }

    /// The same, for everything drawn so far away from where it is.
    fn enter_shifted(&self, program: &Program, shift: [f64; 3]) {
        program.bind();
        let centre: [f64; 3] = std::array::from_fn(|k| self.projection.centre[k] - shift[k]);
        let [high, low] = pairs(centre);
        program.set("u_centre_high", high);
        program.set("u_centre_low", low);
        // OpenGL takes columns.
        let rows = self.projection.rotation;
        program.set("u_rotation", std::array::from_fn::<[f32; 3], 3, _>(|c| std::array::from_fn(|r| rows[r][c] as f32)));
        program.set("u_distance", self.projection.distance as f32);
        program.set("u_projection", self.projection.matrix());
        program.set("u_frame", self.frame);
        program.set("u_point", self.point);
        program.set("u_time", pair(self.time));
    }
}
