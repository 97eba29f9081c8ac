//! What several experiments draw alike: particles of either engine, the box and what stands in it.

use corpuscle_core::{Axis, Boundary, Engine, Particles, Piston};
use corpuscle_event::EventDriven;
use corpuscle_scene::{Body, Camera, Colour, Label, Line, Scene, Shade};

use crate::tally::Tally;

/// Width of a wall on the screen, in points.
const WALL: f32 = 2.5;
/// Width of a periodic face, which is no wall: faint and thin.
const FACE: f32 = 1.0;

/// Colour of walls with a temperature.
const WARM: Colour = Colour::Accent(1);
/// Colour of the coldest of them.
const COLD: Colour = Colour::Accent(0);
/// Distance of the temperature from its wall, as a part of the box.
const INSET: f64 = 0.06;
/// Corners of a circle that looks round.
const CORNERS: usize = 48;

/// Smallest radius of a particle of a gas on the screen, in points: thin gases need large boxes.
const SPECK: f32 = 2.2;

/// Hands the particles of an event-driven engine over untouched, each with its own clock; the renderer moves them to the
/// scene's time. The scene counts time from `start` on the engine's clock. `shade(i)` is what the experiment's own colouring
/// reads of particle `i`.
pub(crate) fn add_event_driven<const D: usize>(
    scene: &mut Scene,
    engine: &EventDriven<D>,
    tally: &Tally,
    start: f64,
    shade: impl Fn(usize) -> f64,
) {
    let uncounted = scene.wanted == Shade::Collisions && tally.is_empty();
    scene.shaded = if uncounted { Shade::Own } else { scene.wanted };
    let shade = |i: usize| match scene.shaded {
        Shade::Own => shade(i),
        Shade::Species => f64::from(engine.species(i)),
        Shade::Mass => engine.mass(i),
        Shade::Collisions => f64::from(tally.count(i)),
    };
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
    add_boundary(scene, engine.boundary(), engine.time());
    if let Some(piston) = engine.piston() {
        add_piston(scene, engine.boundary(), piston);
    }
}

/// Adds particles that are all as of `time`, shaded by species unless something else is wanted.
pub(crate) fn add_particles<const D: usize>(scene: &mut Scene, time: f64, particles: &Particles<D>, radius: impl Fn(usize) -> f64) {
    // Soft particles do not collide: there is nothing to count.
    scene.shaded = if scene.wanted == Shade::Collisions { Shade::Own } else { scene.wanted };
    let by_mass = scene.shaded == Shade::Mass;
    let shade = |i: usize| if by_mass { particles.mass[i] } else { f64::from(particles.species[i]) };
    scene.bodies.extend((0..particles.len()).map(|i| Body {
        position: particles.position[i].to_three(),
        velocity: particles.velocity[i].to_three(),
        time,
        radius: radius(i),
        shade: shade(i),
    }));
}

/// Adds the faces of the box as they are at a time, walls strong, warm ones coloured and with their temperature, periodic
/// and open faces faint; partitions with their holes; obstacles. Fits the camera to the whole box.
pub(crate) fn add_boundary<const D: usize>(scene: &mut Scene, boundary: &Boundary<D>, time: f64) {
    let (lower, upper) = (boundary.lower.to_three(), boundary.upper.to_three());
    scene.camera = Camera::fit(lower, upper);
    for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Periodic) {
        scene.period[k] = upper[k] - lower[k];
    }
    let (mut low, mut high) = (lower, upper);
    for k in (0..D).filter(|&k| boundary.axes[k] == Axis::Walls) {
        (low[k], high[k]) = (boundary.face_at(k, false, time).0, boundary.face_at(k, true, time).0);
    }
    scene.bounds = Some([low, high]);
    let start = scene.lines.len();
    scene.add_box(low, high, WALL, Colour::Wall);
    for line in &mut scene.lines[start..] {
        // An edge belongs to the faces across the axes it does not run along; it is a wall when one of those is.
        let along = (0..3).find(|&k| line.from[k] != line.to[k]);
        let faces = (0..D).filter(|&k| Some(k) != along).map(|k| (k, line.from[k] == high[k]));
        let walls: Vec<_> = faces.filter(|&(k, upper)| stands(boundary, k, upper, time)).collect();
        if walls.is_empty() {
            (line.width, line.colour) = (FACE, Colour::Faint);
        } else if let Some(colour) = walls.iter().find_map(|&(k, upper)| warmth(boundary, k, upper)) {
            line.colour = colour;
        }
    }
    for (k, upper) in (0..D).flat_map(|k| [(k, false), (k, true)]) {
        if let (Some(temperature), Some(colour)) = (boundary.faces[k][usize::from(upper)].temperature, warmth(boundary, k, upper))
            && stands(boundary, k, upper, time)
        {
            // Inside, where there is always room: a wall may be at the edge of the picture.
            let share = if k == 0 { INSET } else { 0.5 * INSET };
            let mut at: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
            at[k] = if upper { high[k] - share * (high[k] - low[k]) } else { low[k] + share * (high[k] - low[k]) };
            scene.labels.push(Label { at, text: format!("kT = {temperature}"), colour });
        }
    }
    for plate in boundary.partitions.iter().filter(|plate| plate.stands_at(time)) {
        let (mut low, mut high) = (low, high);
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
            add_plate(scene, from, to, WALL);
        }
    }
    for obstacle in &boundary.obstacles {
        add_round(scene, obstacle.centre.to_three(), obstacle.radius, D);
    }
}

/// Whether there is a wall across an axis at a time.
fn stands<const D: usize>(boundary: &Boundary<D>, axis: usize, upper: bool, time: f64) -> bool {
    boundary.axes[axis] == Axis::Walls && boundary.faces[axis][usize::from(upper)].stands_at(time)
}

/// Colour of a wall with a temperature: that of cold for the coldest, if others are warmer.
fn warmth<const D: usize>(boundary: &Boundary<D>, axis: usize, upper: bool) -> Option<Colour> {
    let temperature = boundary.faces[axis][usize::from(upper)].temperature?;
    let warmer = |other: f64| other > temperature;
    let colder = |other: f64| other < temperature;
    let others = || boundary.faces.iter().flatten().filter_map(|face| face.temperature);
    Some(if others().any(warmer) && !others().any(colder) { COLD } else { WARM })
}

/// A piston where it is now: a plate twice as thick as a wall.
fn add_piston<const D: usize>(scene: &mut Scene, boundary: &Boundary<D>, piston: Piston) {
    let (mut low, mut high) = (boundary.lower.to_three(), boundary.upper.to_three());
    (low[piston.axis], high[piston.axis]) = (piston.position, piston.position);
    add_plate(scene, low, high, 2.0 * WALL);
}

/// A round body: its outline in the plane, three great circles in space.
fn add_round(scene: &mut Scene, centre: [f64; 3], radius: f64, dimension: usize) {
    let planes: &[[usize; 2]] = if dimension == 2 { &[[0, 1]] } else { &[[0, 1], [1, 2], [2, 0]] };
    for &[first, second] in planes {
        let point = |corner: usize| {
            let (sine, cosine) = (std::f64::consts::TAU * corner as f64 / CORNERS as f64).sin_cos();
            let mut point = centre;
            point[first] += radius * cosine;
            point[second] += radius * sine;
            point
        };
        scene.lines.extend((0..CORNERS).map(|corner| Line {
            from: point(corner),
            to: point(corner + 1),
            width: WALL,
            colour: Colour::Wall,
        }));
    }
}

/// A plate: a line in the plane, the outline of a rectangle in space.
fn add_plate(scene: &mut Scene, from: [f64; 3], to: [f64; 3], width: f32) {
    let spans: Vec<usize> = (0..3).filter(|&k| from[k] != to[k]).collect();
    let mut edge = |a: [f64; 3], b: [f64; 3]| scene.lines.push(Line { from: a, to: b, width, colour: Colour::Wall });
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
