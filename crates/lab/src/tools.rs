//! What a person can do on the stage: lay a ruler, a probe, a stopwatch on it, or a hand; and which body lies under the pointer.

use corpuscle_experiments::Action;
use corpuscle_render::Projection;
use corpuscle_scene::{Body, Scene};

use crate::language::Text;
use crate::runner::Snapshot;

/// What the pointer does on the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Moves the view; a click follows a body.
    #[default]
    Hand,
    /// Carries a body to another place.
    Carry,
    /// Gives a body another velocity.
    Throw,
    /// Adds a body.
    Add,
    /// Takes a body away.
    Remove,
    /// Puts a plate across the box.
    Partition,
    /// Gives a wall a temperature.
    Heat,
    /// Pushes the piston.
    Piston,
    /// Measures a distance.
    Ruler,
    /// Measures what is inside a rectangle.
    Probe,
}

impl Tool {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Hand,
        Self::Carry,
        Self::Throw,
        Self::Add,
        Self::Remove,
        Self::Partition,
        Self::Heat,
        Self::Piston,
        Self::Ruler,
        Self::Probe,
    ];

    /// Its name.
    pub fn text(self) -> Text {
        match self {
            Self::Hand => Text::ToolHand,
            Self::Carry => Text::ToolCarry,
            Self::Throw => Text::ToolThrow,
            Self::Add => Text::ToolAdd,
            Self::Remove => Text::ToolRemove,
            Self::Partition => Text::ToolPartition,
            Self::Heat => Text::ToolHeat,
            Self::Piston => Text::ToolPiston,
            Self::Ruler => Text::ToolRuler,
            Self::Probe => Text::ToolProbe,
        }
    }

    /// An action of the kind that it does; none of a tool that only looks.
    pub fn action(self) -> Option<Action> {
        let name = match self {
            Self::Hand | Self::Ruler | Self::Probe => return None,
            Self::Carry => "place",
            Self::Throw => "throw",
            Self::Add => "add",
            Self::Remove => "remove",
            Self::Partition => "put a partition in",
            Self::Heat => "heat a wall",
            Self::Piston => "push the piston",
        };
        Action::EXAMPLES.into_iter().find(|action| action.name() == name)
    }

    /// What it would need that is not here; none where it can be used.
    pub fn refusal(self, seen: &Snapshot) -> Option<&'static str> {
        self.action().and_then(|action| seen.refusal(action))
    }

    /// Whether it changes the system, so that time stands still while it is being used.
    pub fn touches(self) -> bool {
        !matches!(self, Self::Hand | Self::Ruler | Self::Probe)
    }

    /// The next one round that can be used.
    #[must_use]
    pub fn next(self, seen: &Snapshot) -> Self {
        let place = Self::ALL.iter().position(|&tool| tool == self).unwrap_or(0);
        let mut round = Self::ALL.into_iter().cycle().skip(place + 1).take(Self::ALL.len());
        round.find(|tool| tool.refusal(seen).is_none()).unwrap_or_default()
    }
}

/// What tools are set to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Width of the hole in a new plate, over the width of the box.
    pub hole: f64,
    /// Temperature of a wall that is heated; 0 takes its temperature away.
    pub temperature: f64,
    /// Standard deviation of the angles by which velocities are disturbed.
    pub disturbance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { hole: 0.2, temperature: 4.0, disturbance: 1e-6 }
    }
}

/// A touch under way: where it began, and on which body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The body, if there was one.
    pub body: Option<usize>,
    /// The place, in the plane across the line of sight through the body, or through the middle of the view.
    pub from: [f64; 3],
    /// Where the pointer is now, in that plane.
    pub to: [f64; 3],
    /// Whether time passed before.
    pub played: bool,
}

/// The place that appears at a pixel, as far from the eye as `beside`.
pub fn place_beside(projection: &Projection, pixel: [f64; 2], beside: [f64; 3]) -> [f64; 3] {
    let flat = projection.place(pixel);
    if !projection.is_spatial() {
        return [flat[0], flat[1], beside[2]];
    }
    let towards = projection.rotation[2];
    let nearer: f64 = (0..3).map(|k| towards[k] * (beside[k] - projection.centre[k])).sum();
    let part = (projection.distance - nearer) / projection.distance;
    std::array::from_fn(|k| projection.centre[k] + part * (flat[k] - projection.centre[k]) + nearer * towards[k])
}

/// What a touch asks for, once it ends. A drag of the velocity is as long as the way that the body goes in a second of the
/// viewer, `seconds` of physical time.
pub fn deed(tool: Tool, touch: &Touch, settings: Settings, scene: &Scene, seconds: f64) -> Option<Action> {
    let drag: [f64; 3] = std::array::from_fn(|k| touch.to[k] - touch.from[k]);
    let velocity = drag.map(|x| if seconds > 0.0 { x / seconds } else { 0.0 });
    match tool {
        Tool::Hand | Tool::Ruler | Tool::Probe => None,
        Tool::Carry => touch.body.map(|body| Action::Place { body, at: touch.to }),
        Tool::Throw => touch.body.map(|body| Action::Throw { body, velocity }),
        Tool::Add => Some(Action::Add { at: touch.from, velocity, like: scene.bodies.len().checked_sub(1)? }),
        Tool::Remove => touch.body.map(|body| Action::Remove { body }),
        Tool::Piston => Some(Action::Push { velocity }),
        Tool::Partition => {
            let (axis, at) = plate(touch);
            let hole = scene.bounds.filter(|_| settings.hole > 0.0).map(|[lower, upper]| {
                let sides: Vec<f64> = (0..3).map(|k| upper[k] - lower[k]).filter(|&side| side > 0.0).collect();
                settings.hole * sides[(axis + 1) % sides.len()]
            });
            Some(Action::Partition { axis, at, hole })
        }
        Tool::Heat => {
            let (axis, upper) = nearest_face(touch.to, scene.bounds?);
            Some(Action::Heat { axis, upper, temperature: (settings.temperature > 0.0).then_some(settings.temperature) })
        }
    }
}

/// A plate along the drag: upright after a click.
pub fn plate(touch: &Touch) -> (usize, f64) {
    let level = (touch.to[0] - touch.from[0]).abs() > (touch.to[1] - touch.from[1]).abs();
    let axis = usize::from(level);
    (axis, touch.from[axis])
}

/// The face of a box that is nearest to a place.
pub fn nearest_face(place: [f64; 3], [lower, upper]: [[f64; 3]; 2]) -> (usize, bool) {
    let axes = (0..3).filter(|&k| upper[k] > lower[k]);
    let faces = axes.flat_map(|k| [(k, false, (place[k] - lower[k]).abs()), (k, true, (upper[k] - place[k]).abs())]);
    faces.min_by(|a, b| a.2.total_cmp(&b.2)).map_or((0, false), |(axis, upper, _)| (axis, upper))
}

/// Where a body is at the scene's time, and how fast: `x + v dt + g dt^2 / 2`, `v + g dt`.
pub fn state_of(body: &Body, scene: &Scene) -> ([f64; 3], [f64; 3]) {
    state_at(body, scene, scene.time)
}

/// The same at another time of the same flight.
pub fn state_at(body: &Body, scene: &Scene, time: f64) -> ([f64; 3], [f64; 3]) {
    let dt = time - body.time;
    let (x, v, g) = (body.position, body.velocity, scene.field);
    (std::array::from_fn(|k| x[k] + (v[k] + 0.5 * g[k] * dt) * dt), std::array::from_fn(|k| v[k] + g[k] * dt))
}

/// The body under a pixel, the nearest to the eye first; a pointer that misses by up to `reach` pixels still counts.
pub fn pick(scene: &Scene, projection: &Projection, pixel: [f64; 2], reach: f64) -> Option<usize> {
    let mut best: Option<(usize, f64, f64)> = None;
    for (index, body) in scene.bodies.iter().enumerate() {
        let (place, _) = state_of(body, scene);
        let Some([x, y]) = projection.pixel(place) else { continue };
        let radius = pixels_of(body.radius, place, projection).max(f64::from(scene.least_radius));
        let miss = ((x - pixel[0]).hypot(y - pixel[1]) - radius).max(0.0);
        if miss > reach {
            continue;
        }
        let depth = depth(place, projection);
        if best.is_none_or(|(_, m, d)| (miss, depth) < (m, d)) {
            best = Some((index, miss, depth));
        }
    }
    best.map(|(index, ..)| index)
}

/// How far behind the eye's plane a place is, up to a constant.
fn depth(place: [f64; 3], projection: &Projection) -> f64 {
    -projection.rotation[2].iter().zip(place).zip(projection.centre).map(|((r, p), c)| r * (p - c)).sum::<f64>()
}

fn pixels_of(length: f64, place: [f64; 3], projection: &Projection) -> f64 {
    if projection.is_spatial() {
        length * projection.focal() / (projection.distance + depth(place, projection))
    } else {
        length * projection.scale
    }
}

/// What a probe found in its rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Bodies whose centres are inside.
    pub bodies: usize,
    /// Bodies for each unit of area.
    pub density: f64,
    /// Mean velocity `u`: the flow.
    pub flow: [f64; 2],
    /// Pressure `n <m (v - u)^2> / d` of particles without interaction, with the error of the temperature: the kinetic part, to
    /// which collisions add theirs in a dense gas. Of masses 1, where the scene does not tell them.
    pub pressure: Option<(f64, f64)>,
    /// `k_B T / m = <(v - u)^2> / (d (1 - 1/n))`, from the velocities' scatter about their mean, with its standard error
    /// `sqrt(2 / (d (n - 1)))` relative for normal velocities; none with fewer than two bodies.
    pub temperature: Option<(f64, f64)>,
}

/// Reads a probe over the rectangle between two corners of a flat scene.
pub fn probe(scene: &Scene, corners: [[f64; 2]; 2]) -> Reading {
    let [a, b] = corners;
    let lower = [a[0].min(b[0]), a[1].min(b[1])];
    let upper = [a[0].max(b[0]), a[1].max(b[1])];
    let inside: Vec<[f64; 3]> = scene
        .bodies
        .iter()
        .map(|body| state_of(body, scene))
        .filter(|(x, _)| (0..2).all(|k| (lower[k]..upper[k]).contains(&x[k])))
        .map(|(_, v)| v)
        .collect();
    let n = inside.len() as f64;
    let flow: [f64; 2] =
        std::array::from_fn(|k| if inside.is_empty() { 0.0 } else { inside.iter().map(|v| v[k]).sum::<f64>() / n });
    let temperature = (inside.len() > 1).then(|| {
        let squares: f64 = inside.iter().flat_map(|v| (0..2).map(|k| (v[k] - flow[k]).powi(2))).sum();
        let freedom = 2.0 * (n - 1.0);
        let mean = squares / freedom;
        (mean, mean * (2.0 / freedom).sqrt())
    });
    let area = (upper[0] - lower[0]) * (upper[1] - lower[1]);
    let pressure = temperature.map(|(mean, error)| (n / area * mean, n / area * error));
    Reading { bodies: inside.len(), density: n / area, flow, pressure, temperature }
}

/// A stopwatch of physical time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Stopwatch {
    /// Not in use.
    #[default]
    Off,
    /// Running since a time.
    Running(f64),
    /// Stopped: from a time to another.
    Stopped(f64, f64),
}

impl Stopwatch {
    /// Starts, stops, clears, in turn.
    #[must_use]
    pub fn pressed(self, now: f64) -> Self {
        match self {
            Self::Off => Self::Running(now),
            Self::Running(since) => Self::Stopped(since, now),
            Self::Stopped(..) => Self::Off,
        }
    }

    /// What it shows.
    pub fn reading(self, now: f64) -> Option<f64> {
        match self {
            Self::Off => None,
            Self::Running(since) => Some(now - since),
            Self::Stopped(since, until) => Some(until - since),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_core::Random;
    use corpuscle_render::Rectangle;
    use corpuscle_scene::Camera;

    fn body(x: f64, y: f64, z: f64) -> Body {
        Body { position: [x, y, z], radius: 0.1, ..Body::default() }
    }

    const STAGE: Rectangle = Rectangle { left: 0.0, top: 0.0, width: 200.0, height: 200.0 };

    #[test]
    fn the_body_under_the_pointer_is_found_where_it_is_now() {
        let camera = Camera::Plane { centre: [0.0; 2], extent: [2.0; 2] };
        let projection = Projection::new(camera, [200.0, 200.0], STAGE);
        let moving = Body { velocity: [1.0, 0.0, 0.0], ..body(-0.5, 0.0, 0.0) };
        let scene = Scene { time: 1.0, bodies: vec![body(0.0, 0.5, 0.0), moving], ..Scene::default() };
        assert_eq!(pick(&scene, &projection, [150.0, 100.0], 2.0), Some(1));
        assert_eq!(pick(&scene, &projection, [100.0, 50.0], 2.0), Some(0));
        assert_eq!(pick(&scene, &projection, [100.0, 150.0], 2.0), None);
    }

    #[test]
    fn what_is_in_front_is_picked_first() {
        let camera = Camera::Orbit { target: [0.0; 3], distance: 5.0, yaw: 0.0, pitch: 0.0 };
        let projection = Projection::new(camera, [200.0, 200.0], STAGE);
        // Yaw 0 looks along +y: the body with the smaller y is nearer.
        let scene = Scene { bodies: vec![body(0.0, 1.0, 0.0), body(0.0, -1.0, 0.0)], ..Scene::default() };
        assert_eq!(pick(&scene, &projection, [100.0, 100.0], 2.0), Some(1));
    }

    #[test]
    fn a_probe_reads_flow_and_temperature_within_their_errors() {
        let scores: Vec<f64> = (0..400)
            .map(|seed| {
                let mut random = Random::new(seed, 90);
                let mut one = || Body {
                    velocity: [3.0 + 2.0 * random.normal(), -1.0 + 2.0 * random.normal(), 0.0],
                    ..body(random.uniform(), random.uniform(), 0.0)
                };
                let scene = Scene { bodies: (0..500).map(|_| one()).collect(), ..Scene::default() };
                let reading = probe(&scene, [[2.0, 2.0], [-1.0, -1.0]]);
                assert_eq!((reading.bodies, reading.density), (500, 500.0 / 9.0));
                let (mean, error) = reading.temperature.unwrap();
                (mean - 4.0) / error
            })
            .collect();
        let n = scores.len() as f64;
        let mean = scores.iter().sum::<f64>() / n;
        let variance = scores.iter().map(|z| z * z).sum::<f64>() / n;
        assert!((mean * n.sqrt()).abs() < 4.0, "mean score {mean}");
        assert!(((variance - 1.0) / (2.0 / n).sqrt()).abs() < 4.0, "variance of the score {variance}");
    }

    fn touch(from: [f64; 3], to: [f64; 3]) -> Touch {
        Touch { body: Some(2), from, to, played: false }
    }

    #[test]
    fn a_pointer_has_a_place_beside_a_body() {
        let camera = Camera::Orbit { target: [1.0, 2.0, 0.5], distance: 7.0, yaw: 0.4, pitch: 0.2 };
        let projection = Projection::new(camera, [200.0, 200.0], STAGE);
        let body = [2.0, 1.0, 1.5];
        let pixel = projection.pixel(body).unwrap();
        let place = place_beside(&projection, pixel, body);
        assert!((0..3).all(|k| (place[k] - body[k]).abs() < 1e-9), "{place:?}");
        let beside = place_beside(&projection, [pixel[0] + 10.0, pixel[1]], body);
        let again = projection.pixel(beside).unwrap();
        assert!((again[0] - pixel[0] - 10.0).abs() < 1e-9 && (again[1] - pixel[1]).abs() < 1e-9);
    }

    #[test]
    fn touches_become_deeds() {
        let scene = Scene { bodies: vec![Body::default(); 3], bounds: Some([[0.0; 3], [10.0, 5.0, 0.0]]), ..Scene::default() };
        let of = |tool, touch: Touch| deed(tool, &touch, Settings { hole: 0.2, temperature: 3.0, disturbance: 1.0 }, &scene, 0.5);
        let drag = touch([1.0, 1.0, 0.0], [1.5, 3.0, 0.0]);
        assert_eq!(of(Tool::Carry, drag), Some(Action::Place { body: 2, at: [1.5, 3.0, 0.0] }));
        assert_eq!(of(Tool::Throw, drag), Some(Action::Throw { body: 2, velocity: [1.0, 4.0, 0.0] }));
        assert_eq!(of(Tool::Partition, drag), Some(Action::Partition { axis: 0, at: 1.0, hole: Some(1.0) }));
        let level = touch([1.0, 1.0, 0.0], [4.0, 1.5, 0.0]);
        assert_eq!(of(Tool::Partition, level), Some(Action::Partition { axis: 1, at: 1.0, hole: Some(2.0) }));
        let right = touch([9.5, 2.0, 0.0], [9.5, 2.0, 0.0]);
        assert_eq!(of(Tool::Heat, right), Some(Action::Heat { axis: 0, upper: true, temperature: Some(3.0) }));
        assert_eq!(of(Tool::Throw, Touch { body: None, ..drag }), None);
        assert_eq!(of(Tool::Ruler, drag), None);
    }

    #[test]
    fn an_empty_probe_claims_nothing() {
        let reading = probe(&Scene::default(), [[0.0; 2], [1.0; 2]]);
        assert_eq!((reading.bodies, reading.density, reading.temperature), (0, 0.0, None));
    }
}
