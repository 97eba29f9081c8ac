//! What pictures of chains share: the part of the plane they show, and beads strung on springs.

use corpuscle_scene::{Body, Camera, Colour, Colouring, Line, Scene};

use super::chain::{Chain, Ends};

/// Height of a picture over the length of the chain.
pub(super) const HEIGHT: f64 = 0.52;

/// An empty scene about a chain of this length; the labels name what is to be told apart: no legend takes room from the chain.
pub(super) fn stage(scene: &mut Scene, length: f64, time: f64) {
    scene.clear();
    scene.time = time;
    scene.camera = Camera::Plane { centre: [0.5 * length, 0.0], extent: [1.08 * length, 1.08 * HEIGHT * length] };
    scene.colouring = Colouring::Species(vec![]);
}

/// Beads where `height` puts their displacements, of these radii and shades, and the springs between them and to the walls.
pub(super) fn string(
    scene: &mut Scene,
    chain: &Chain,
    height: impl Fn(f64) -> f64,
    radius: impl Fn(usize) -> f64,
    shade: impl Fn(usize) -> f64,
) {
    let design = chain.design();
    let count = design.count();
    let mut points: Vec<[f64; 3]> = (0..count).map(|n| [design.place(n), height(chain.displacement(n)), 0.0]).collect();
    scene.bodies.extend(points.iter().enumerate().map(|(n, &position)| Body {
        position,
        velocity: [0.0, chain.velocity(n), 0.0],
        time: chain.time(),
        radius: radius(n),
        shade: shade(n),
    }));
    points.extend(chain.anchors().map(|(x, u)| [x, height(u), 0.0]));
    if design.ends == Ends::Ring {
        let seam = 0.5 * (points[0][1] + points[count - 1][1]);
        points.extend([0.0, design.length()].map(|x| [x, seam, 0.0]));
    }
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let spring = |pair: &[[f64; 3]]| Line { from: pair[0], to: pair[1], width: 1.2, colour: Colour::Faint };
    scene.lines.extend(points.windows(2).map(spring));
}
