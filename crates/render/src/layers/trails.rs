//! Paths of bodies, as rings of points that stay in the graphics memory.

use std::collections::HashMap;

use corpuscle_scene::{Scene, Trail, TrailPoint};

use super::{SPACE, Space};
use crate::RenderError;
use crate::gl::{Format, Gl, Pass, Program, Strip, Texture, largest_side};
use crate::projection::{pair, pairs};

/// Points in a row of the ring's table: two texels each, within the 1024 that every OpenGL 3.3 offers.
const ROW: usize = 512;

/// All trails of a scene; only the points that are new since the last picture are sent.
pub(crate) struct Trails {
    program: Program,
    strip: Strip,
    rings: HashMap<u32, Ring>,
    most: usize,
}

impl Trails {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        Ok(Self {
            program: Program::new(gl, "trail", &[SPACE, include_str!("../shaders/trail.glsl")])?,
            strip: Strip::new(gl)?,
            rings: HashMap::new(),
            most: ROW * largest_side(gl) as usize,
        })
    }

    pub(crate) fn draw(&mut self, gl: &Gl, space: &Space, scene: &Scene) -> Result<(), RenderError> {
        self.rings.retain(|key, _| scene.trails.iter().any(|trail| trail.key == *key));
        if space.projection.is_spatial() { Pass::Veil } else { Pass::Paint }.begin(gl);
        for trail in &scene.trails {
            let capacity = trail.capacity().min(self.most);
            if self.rings.get(&trail.key).is_none_or(|ring| ring.capacity != capacity) {
                self.rings.insert(trail.key, Ring::new(gl, capacity)?);
            }
            if let Some(ring) = self.rings.get_mut(&trail.key) {
                ring.upload(trail);
                ring.draw(&self.program, &self.strip, space, trail);
            }
        }
        Ok(())
    }
}

/// The newest `capacity` points of one trail; the point with the number `n` lies in the slot `n mod capacity`.
struct Ring {
    texture: Texture,
    capacity: usize,
    /// Points there had ever been when the ring was last brought up to date.
    seen: u64,
    /// The last of them: another one under its number tells that the trail has begun anew.
    last: Option<TrailPoint>,
}

impl Ring {
    fn new(gl: &Gl, capacity: usize) -> Result<Self, RenderError> {
        let texture = Texture::new(gl, Format::Floats, [2 * ROW.min(capacity), capacity.div_ceil(ROW)])?;
        Ok(Self { texture, capacity, seen: 0, last: None })
    }

    /// Points in a row.
    fn row(&self) -> usize {
        self.texture.size()[0] / 2
    }

    fn upload(&mut self, trail: &Trail) {
        if !self.continues(trail) {
            self.seen = 0;
        }
        let kept = trail.points().len() as u64;
        let oldest = trail.total() - kept.min(self.capacity as u64);
        let mut number = self.seen.max(oldest);
        let texels: Vec<[f32; 8]> = trail
            .since(number)
            .map(|point| {
                let [x, y, z] = point.position;
                bytemuck::cast(pairs([x, y, z, point.time]))
            })
            .collect();
        let mut rest = &texels[..];
        while !rest.is_empty() {
            let slot = (number % self.capacity as u64) as usize;
            let column = slot % self.row();
            let length = rest.len().min(self.row() - column).min(self.capacity - slot);
            self.texture.write([2 * column, slot / self.row()], [2 * length, 1], &rest[..length]);
            rest = &rest[length..];
            number += length as u64;
        }
        self.seen = trail.total();
        self.last = trail.points().back().copied();
    }

    /// Whether the last point uploaded is still the trail's under its number (or too old to be kept).
    fn continues(&self, trail: &Trail) -> bool {
        let Some(since) = trail.total().checked_sub(self.seen) else { return false };
        let kept = trail.points().len() as u64;
        since >= kept || trail.points().get((kept - 1 - since) as usize).copied() == self.last
    }

    fn draw(&self, program: &Program, strip: &Strip, space: &Space, trail: &Trail) {
        let points = trail.points().len().min(self.capacity);
        if points < 2 {
            return;
        }
        let oldest = trail.oldest_time().unwrap_or(0.0);
        let first = (trail.total() - points as u64) % self.capacity as u64;
        self.texture.bind();
        space.enter(program);
        program.set("u_ring", 0);
        program.set("u_row", self.row() as i32);
        program.set("u_capacity", self.capacity as i32);
        program.set("u_first", first as i32);
        program.set("u_points", points as i32);
        program.set("u_oldest", pair(oldest));
        program.set("u_half_width", 0.5 * trail.width * space.point + 0.5);
        program.set("u_colour", space.palette.rgba(trail.colour));
        strip.draw(2 * points);
    }
}
