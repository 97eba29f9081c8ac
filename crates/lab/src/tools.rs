//! What a person can lay on the stage: a ruler, a probe, a stopwatch; and which body lies under the pointer.

use corpuscle_render::Projection;
use corpuscle_scene::{Body, Scene};

use crate::language::Text;

/// What the pointer does on the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Moves the view; a click follows a body.
    #[default]
    Hand,
    /// Measures a distance.
    Ruler,
    /// Measures what is inside a rectangle.
    Probe,
}

impl Tool {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Hand, Self::Ruler, Self::Probe];

    /// Its name.
    pub fn text(self) -> Text {
        match self {
            Self::Hand => Text::ToolHand,
            Self::Ruler => Text::ToolRuler,
            Self::Probe => Text::ToolProbe,
        }
    }

    /// The next one round.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Hand => Self::Ruler,
            Self::Ruler => Self::Probe,
            Self::Probe => Self::Hand,
        }
    }
}

/// Where a body is at the scene's time, and how fast: `x + v dt + g dt^2 / 2`, `v + g dt`.
pub fn state_of(body: &Body, scene: &Scene) -> ([f64; 3], [f64; 3]) {
    let dt = scene.time - body.time;
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
    Reading { bodies: inside.len(), density: n / area, flow, temperature }
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

    #[test]
    fn an_empty_probe_claims_nothing() {
        let reading = probe(&Scene::default(), [[0.0; 2], [1.0; 2]]);
        assert_eq!((reading.bodies, reading.density, reading.temperature), (0, 0.0, None));
    }
}
