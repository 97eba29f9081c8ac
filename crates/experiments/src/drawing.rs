//! What several experiments draw alike: particles of either engine, the box and its partitions.

use corpuscle_core::{Axis, Boundary, Engine, Particles};
use corpuscle_event::EventDriven;
use corpuscle_scene::{Body, Camera, Colour, Line, Scene};

/// Width of a wall on the screen, in points.
const WALL: f32 = 2.5;
/// Width of a periodic face, which is no wall: faint and thin.
const FACE: f32 = 1.0;

/// Smallest radius of a particle of a gas on the screen, in points: thin gases need large boxes.
const SPECK: f32 = 2.2;

/// Hands the particles of an event-driven engine over untouched, each with its own clock; the renderer moves them to the
/// scene's time. The scene counts time from `start` on the engine's clock. `shade(i)` is what the colouring reads of
/// particle `i`.
pub(crate) fn add_event_driven<const D: usize>(
    scene: &mut Scene,
    engine: &EventDriven<D>,
    start: f64,
    shade: impl Fn(usize) -> f64,
) {
    scene.time = engine.time() - start;
    scene.least_radius = SPECK;
    scene.field = engine.rules().field.to_three();
    scene.bodies.extend((0..engine.particle_count()).map(|i| {
        let lazy = engine.lazy(i);
        Body {
            position: lazy.position.to_three(),
            velocity: lazy.velocity.to_three(),
            time: lazy.time - start,
            radius: engine.radius(i),
            shade: shade(i),
        }
    }));
    add_boundary(scene, engine.boundary());
}

/// Adds particles that are all as of `time`.
pub(crate) fn add_particles<const D: usize>(
    scene: &mut Scene,
    time: f64,
    particles: &Particles<D>,
    radius: impl Fn(usize) -> f64,
    shade: impl Fn(usize) -> f64,
) {
    scene.bodies.extend((0..particles.len()).map(|i| Body {
        position: particles.position[i].to_three(),
        velocity: particles.velocity[i].to_three(),
        time,
        radius: radius(i),
        shade: shade(i),
    }));
}

/// Adds the faces of the box, walls strong and periodic faces faint, and the partitions with their holes; fits the camera.
pub(crate) fn add_boundary<const D: usize>(scene: &mut Scene, boundary: &Boundary<D>) {
    let (lower, upper) = (boundary.lower.to_three(), boundary.upper.to_three());
    scene.camera = Camera::fit(lower, upper);
    let start = scene.lines.len();
    scene.add_box(lower, upper, WALL, Colour::Wall);
    for line in &mut scene.lines[start..] {
        // An edge belongs to the faces across the axes it does not run along; it is a wall when one of those is.
        let along = (0..3).find(|&k| line.from[k] != line.to[k]);
        if !(0..D).any(|k| Some(k) != along && boundary.axes[k] == Axis::Walls) {
            (line.width, line.colour) = (FACE, Colour::Faint);
        }
    }
    for plate in &boundary.partitions {
        let (mut low, mut high) = (lower, upper);
        (low[plate.axis], high[plate.axis]) = (plate.position, plate.position);
        let strips = match plate.hole {
            None => vec![(low, high)],
            Some(hole) => {
                let (mut below, mut above) = ((low, high), (low, high));
                below.1[hole.along] = hole.from;
                above.0[hole.along] = hole.to;
                vec![below, above]
            }
        };
        for (from, to) in strips {
            add_plate(scene, from, to);
        }
    }
}

/// A plate: a line in the plane, the outline of a rectangle in space.
fn add_plate(scene: &mut Scene, from: [f64; 3], to: [f64; 3]) {
    let spans: Vec<usize> = (0..3).filter(|&k| from[k] != to[k]).collect();
    let mut edge = |a: [f64; 3], b: [f64; 3]| scene.lines.push(Line { from: a, to: b, width: WALL, colour: Colour::Wall });
    if let [first, second] = spans[..] {
        let (mut along_first, mut along_second) = (from, from);
        along_first[first] = to[first];
        along_second[second] = to[second];
        for (a, b) in [(from, along_first), (along_first, to), (to, along_second), (along_second, from)] {
            edge(a, b);
        }
    } else {
        edge(from, to);
    }
}
