//! How a viewer looks at a system: what the colours tell, and whether velocities are drawn as arrows.

use corpuscle_experiments::Simulation;
use corpuscle_scene::{Camera, Colour, Line, Scene};

use super::paint::Paint;
use crate::tools::state_of;

/// Bodies beyond this number have no arrows: nobody could tell them apart.
const MOST_ARROWS: usize = 5000;
/// Length of the arrow of a body of the root mean square speed, over the distance of neighbours.
const LENGTH: f64 = 0.8;
/// Length of an arrow's head over its own.
const HEAD: f64 = 0.28;
/// Width of an arrow on the screen, in points.
const WIDTH: f32 = 1.3;

/// A way of looking, and the scales found at the first look.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sight {
    paint: Paint,
    arrows: bool,
    ends: Option<[f64; 2]>,
    /// Length of an arrow over the speed.
    reach: Option<f64>,
}

impl Sight {
    /// Lets the colours tell something else.
    pub(crate) fn set_paint(&mut self, paint: Paint) {
        if paint != self.paint {
            (self.paint, self.ends) = (paint, None);
        }
    }

    /// Draws velocities, or not.
    pub(crate) fn set_arrows(&mut self, on: bool) {
        self.arrows = on;
    }

    /// Another run: scales are found anew.
    pub(crate) fn begin(&mut self) {
        (self.ends, self.reach) = (None, None);
    }

    /// Brings a scene up to date.
    pub(crate) fn look(&mut self, simulation: &dyn Simulation, scene: &mut Scene) {
        scene.wanted = self.paint.wanted();
        simulation.draw(scene);
        self.paint.apply(scene, &mut self.ends);
        if self.arrows && scene.bodies.len() <= MOST_ARROWS {
            let reach = *self.reach.get_or_insert_with(|| reach(scene));
            add_arrows(scene, reach);
        }
    }
}

/// Time in which a body of the root mean square speed would come about as far as the next one is away.
fn reach(scene: &Scene) -> f64 {
    let count = scene.bodies.len().max(1) as f64;
    let squares: f64 = scene.bodies.iter().map(|body| state_of(body, scene).1.iter().map(|v| v * v).sum::<f64>()).sum();
    let speed = (squares / count).sqrt();
    let (area, dimension) = match (scene.bounds, scene.camera) {
        (Some([lower, upper]), camera) => {
            let sides = (0..3).map(|k| upper[k] - lower[k]).filter(|&side| side > 0.0);
            (sides.product(), if matches!(camera, Camera::Plane { .. }) { 2.0 } else { 3.0 })
        }
        (None, Camera::Plane { extent, .. }) => (extent[0] * extent[1], 2.0),
        (None, Camera::Orbit { distance, .. }) => (distance.powi(3), 3.0),
    };
    // Few bodies far from each other would have arrows across the whole picture.
    let spacing = (area / count).powf(1.0 / dimension).min(0.15 * area.powf(1.0 / dimension));
    if speed > 0.0 { LENGTH * spacing / speed } else { 0.0 }
}

/// An arrow of three lines from each body's centre.
fn add_arrows(scene: &mut Scene, reach: f64) {
    let mut lines = vec![];
    for body in &scene.bodies {
        let (from, velocity) = state_of(body, scene);
        let arrow = velocity.map(|v| reach * v);
        let length = arrow.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        let tip: [f64; 3] = std::array::from_fn(|k| from[k] + arrow[k]);
        // Across the arrow, in the plane; in space level, or any way where the arrow itself is upright.
        let across = if arrow[0] == 0.0 && arrow[1] == 0.0 { [length, 0.0, 0.0] } else { [-arrow[1], arrow[0], 0.0] };
        let width = length / across.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut line = |to: [f64; 3], end: [f64; 3]| lines.push(Line { from: to, to: end, width: WIDTH, colour: Colour::Ink });
        line(from, tip);
        for side in [-0.5, 0.5] {
            line(tip, std::array::from_fn(|k| tip[k] - HEAD * (arrow[k] + side * 1.2 * width * across[k])));
        }
    }
    scene.lines.extend(lines);
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_scene::Body;

    #[test]
    fn an_arrow_points_where_its_body_goes() {
        let body = Body { position: [1.0, 2.0, 0.0], velocity: [3.0, -4.0, 0.0], ..Body::default() };
        let mut scene = Scene { bodies: vec![body, Body::default()], ..Scene::default() };
        add_arrows(&mut scene, 0.1);
        assert_eq!(scene.lines.len(), 3, "a body at rest has none");
        assert_eq!((scene.lines[0].from, scene.lines[0].to), ([1.0, 2.0, 0.0], [1.3, 1.6, 0.0]));
        for head in &scene.lines[1..] {
            let back: f64 = (0..2).map(|k| (head.to[k] - head.from[k]) * [3.0, -4.0][k]).sum();
            assert!(back < 0.0);
        }
    }
}
