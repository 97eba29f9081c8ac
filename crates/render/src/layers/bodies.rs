//! Discs in the plane and spheres in space.

use corpuscle_scene::{Body, Colour, Colouring, Scene};

use super::{SPACE, Space};
use crate::RenderError;
use crate::gl::{Gl, Pass, Program, Vertex, VertexBuffer};
use crate::projection::pairs;

const BODY: &str = include_str!("../shaders/body.glsl");

/// Changed bodies so near each other in the list are sent together, where few have changed and where many have.
const NEAR: usize = 4;
const FAR: usize = 64;
/// Few: one in so many.
const SPARSE: usize = 16;
/// Opacity of an image in a periodic box.
const FAINT: f32 = 0.2;
/// Bodies beyond this number are drawn without images, which cost as much again as the bodies, each of eight.
const MOST_IMAGED: usize = 20_000;

/// A body as the shader takes it: 52 bytes.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct BodyVertex {
    high: [f32; 4],
    low: [f32; 4],
    velocity: [f32; 3],
    form: [f32; 2],
}

impl Vertex for BodyVertex {
    const FIELDS: &'static [i32] = &[4, 4, 3, 2];
}

impl From<&Body> for BodyVertex {
    fn from(body: &Body) -> Self {
        let [x, y, z] = body.position;
        let [high, low] = pairs([x, y, z, body.time]);
        Self { high, low, velocity: body.velocity.map(|v| v as f32), form: [body.radius as f32, body.shade as f32] }
    }
}

/// All bodies of a scene, in the graphics memory.
///
/// What is uploaded depends on neither the camera nor the time of the picture (see [`crate::projection::pair`]), so that
/// a body is sent again only after it has changed: with an event-driven engine, after it has collided.
pub(crate) struct Bodies {
    disc: Program,
    sphere: Program,
    buffer: VertexBuffer<BodyVertex>,
    /// The bodies as they were when they were uploaded.
    uploaded: Vec<Body>,
    /// Kept between frames to save their allocation.
    changed: Vec<usize>,
    scratch: Vec<BodyVertex>,
}

impl Bodies {
    pub(crate) fn new(gl: &Gl) -> Result<Self, RenderError> {
        Ok(Self {
            disc: Program::new(gl, "disc", &[SPACE, BODY, include_str!("../shaders/disc.glsl")])?,
            sphere: Program::new(gl, "sphere", &[SPACE, BODY, include_str!("../shaders/sphere.glsl")])?,
            buffer: VertexBuffer::new(gl)?,
            uploaded: Vec::new(),
            changed: Vec::new(),
            scratch: Vec::new(),
        })
    }

    pub(crate) fn draw(&mut self, gl: &Gl, space: &Space, scene: &Scene) {
        if displacement_is_fine(space, scene) {
            self.upload(&scene.bodies);
        } else {
            let settled: Vec<Body> = scene.bodies.iter().map(|body| settled(body, scene.time, scene.field)).collect();
            self.upload(&settled);
        }
        let program = if space.projection.is_spatial() {
            Pass::Solid.begin(gl);
            self.light(space);
            &self.sphere
        } else {
            Pass::Paint.begin(gl);
            self.disc.set("u_scale", space.projection.scale as f32);
            self.disc.set("u_ground", space.palette.ground());
            let [r, g, b, _] = space.palette.rgba(Colour::Ink);
            self.disc.set("u_ink", [r, g, b]);
            &self.disc
        };
        program.set("u_field", scene.field.map(|g| g as f32));
        program.set("u_least_radius", scene.least_radius);
        colour(program, &scene.colouring, space);
        if space.projection.is_spatial() {
            space.enter(program);
        } else {
            self.images(space, scene);
            self.disc.set("u_opacity", 1.0f32);
            space.enter(program);
        }
        self.buffer.draw();
    }

    /// The neighbouring images of a periodic box, in the plane: the same bodies once more for each, nothing is sent.
    fn images(&self, space: &Space, scene: &Scene) {
        if scene.bodies.len() > MOST_IMAGED {
            return;
        }
        self.disc.set("u_opacity", FAINT);
        let turns = |axis: usize| if scene.period[axis] > 0.0 { -1..=1 } else { 0..=0 };
        for (x, y) in turns(0).flat_map(|x| turns(1).map(move |y| (x, y))).filter(|&image| image != (0, 0)) {
            let shift = [f64::from(x) * scene.period[0], f64::from(y) * scene.period[1], 0.0];
            space.enter_shifted(&self.disc, shift);
            self.buffer.draw();
        }
    }

    fn light(&self, space: &Space) {
        let distance = space.projection.distance as f32;
        self.sphere.set("u_focal", space.projection.focal() as f32);
        self.sphere.set("u_multisampled", i32::from(space.samples > 1));
        self.sphere.set("u_ground", space.palette.ground());
        self.sphere.set("u_haze", [0.8 * distance, 1.0 / (0.8 * distance)]);
    }

    /// Sends what differs from what is there.
    fn upload(&mut self, bodies: &[Body]) {
        if bodies.len() != self.uploaded.len() {
            self.scratch.clear();
            self.scratch.extend(bodies.iter().map(BodyVertex::from));
            self.buffer.replace(&self.scratch);
            self.uploaded.clear();
            self.uploaded.extend_from_slice(bodies);
            return;
        }
        self.changed.clear();
        self.changed.extend((0..bodies.len()).filter(|&i| bodies[i] != self.uploaded[i]));
        // Few that are far apart are sent one by one; of many, calls would cost more than the bodies between them.
        let gap = if SPARSE * self.changed.len() <= bodies.len() { NEAR } else { FAR };
        for piece in self.changed.chunk_by(|a, b| b - a <= gap) {
            let range = piece[0]..piece[piece.len() - 1] + 1;
            self.scratch.clear();
            self.scratch.extend(bodies[range.clone()].iter().map(BodyVertex::from));
            self.buffer.write(range.start, &self.scratch);
            self.uploaded[range.clone()].copy_from_slice(&bodies[range]);
        }
    }
}

/// The body at another time on the same free flight, in double precision.
fn settled(body: &Body, time: f64, g: [f64; 3]) -> Body {
    let dt = time - body.time;
    let (x, v) = (body.position, body.velocity);
    Body {
        position: std::array::from_fn(|k| x[k] + (v[k] + 0.5 * dt * g[k]) * dt),
        velocity: std::array::from_fn(|k| v[k] + g[k] * dt),
        time,
        ..*body
    }
}

/// Whether the shader's `v dt + g dt^2 / 2` in single precision is right within a quarter of a pixel for every body.
/// It is but under a deep zoom on bodies that have come a long way; those are moved in double precision.
fn displacement_is_fine(space: &Space, scene: &Scene) -> bool {
    // Three roundings of a displacement of at most `reach` pixels.
    let most = 0.25 / (3.0 * f64::from(f32::EPSILON)) / space.projection.scale;
    let norm2 = |v: [f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let g = norm2(scene.field).sqrt();
    scene.bodies.iter().all(|body| {
        let dt = (scene.time - body.time).abs();
        (norm2(body.velocity).sqrt() + 0.5 * g * dt) * dt <= most
    })
}

/// Sets the uniforms from which `body.glsl` takes its colours.
fn colour(program: &Program, colouring: &Colouring, space: &Space) {
    let plain = |colour| {
        let [r, g, b, _] = space.palette.rgba(colour);
        [r, g, b]
    };
    let (map, range, reading): (Vec<[f32; 3]>, Option<[f64; 2]>, i32) = match colouring {
        // One colour for all: whatever the shade is, its remainder is 0.
        Colouring::Uniform(colour) => (vec![plain(*colour)], None, 0),
        Colouring::Species(_) => ((0..8).map(|index| plain(Colour::Accent(index))).collect(), None, 0),
        Colouring::Speed { most, .. } => (knots(colouring), Some([0.0, *most]), 1),
        Colouring::Energy { most } => (knots(colouring), Some([0.0, *most]), 2),
        Colouring::Height { least, most, .. } => (knots(colouring), Some([*least, *most]), 3),
        Colouring::Value { least, most, .. } | Colouring::Angle { least, most, .. } => (knots(colouring), Some([*least, *most]), 0),
    };
    program.set("u_map", &map[..]);
    program.set("u_colours", map.len() as i32);
    program.set("u_reading", reading);
    program.set("u_continuous", i32::from(range.is_some()));
    if let Colouring::Height { axis, .. } = colouring {
        let up: [f32; 3] = std::array::from_fn(|k| f32::from(u8::from(k == *axis)));
        program.set("u_up", up);
    }
    if let Some([least, most]) = range {
        let per_extent = if most > least { 1.0 / (most - least) } else { 0.0 };
        program.set("u_range", [least as f32, per_extent as f32]);
    }
}

fn knots(colouring: &Colouring) -> Vec<[f32; 3]> {
    (0..=10).map(|knot| colouring.map()(f64::from(knot) / 10.0).map(|c| c as f32)).collect()
}
