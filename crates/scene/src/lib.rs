//! What is to be drawn, as plain data. An experiment fills a [`Scene`]; the renderer turns it into pixels; neither knows
//! the other. Lengths are the simulation's own; the renderer works relative to the camera, in double precision until then.

mod camera;
mod colour;
mod trail;

pub use camera::Camera;
pub use colour::{Colour, Colouring, Palette, Shade, hue_circle, okabe_ito, viridis};
pub use trail::{Trail, TrailPoint};

/// A disc (sphere) with its own clock: the renderer moves it along `position + velocity (t - time) + field (t - time)^2 / 2`
/// to the scene's time, so that an event-driven engine hands over its particles untouched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// Position of the centre at `time`.
    pub position: [f64; 3],
    /// Velocity at `time`.
    pub velocity: [f64; 3],
    /// The body's own time.
    pub time: f64,
    /// Radius, in the simulation's length.
    pub radius: f64,
    /// What the colouring reads: an index of a species for [`Colouring::Species`], a value for [`Colouring::Value`] and
    /// [`Colouring::Angle`], a mass for [`Colouring::Energy`]; [`Colouring::Speed`] and [`Colouring::Height`] take velocity and position instead.
    pub shade: f64,
}

/// A straight line of constant width on the screen: a spring, a wall, an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// One end.
    pub from: [f64; 3],
    /// The other end.
    pub to: [f64; 3],
    /// Width in points of the screen (1/96 inch), not of the simulation.
    pub width: f32,
    /// Role, from which the palette chooses the colour.
    pub colour: Colour,
}

/// A filled rectangle in the plane `z = 0`, drawn behind everything: halves of a box, probe regions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Lower corner.
    pub lower: [f64; 2],
    /// Upper corner.
    pub upper: [f64; 2],
    /// Colour, usually faint.
    pub colour: Colour,
}

/// A rectangle in the plane `z = 0` divided into equal cells, drawn behind everything: what happens to each start, say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Lower corner.
    pub lower: [f64; 2],
    /// Upper corner.
    pub upper: [f64; 2],
    /// Number of cells in a row; their number is a multiple of it.
    pub columns: usize,
    /// The cells, row by row from the lowest.
    pub cells: Vec<Cell>,
}

/// A cell of a [`Map`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Index of a species, coloured as [`Colouring::Species`] does.
    pub species: u8,
    /// How much of that colour is mixed into the ground, from 0 (none) to 255 (nothing else).
    pub strength: u8,
}

/// A short text fixed to a place in the simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Where the text is centred.
    pub at: [f64; 3],
    /// The text; one line.
    pub text: String,
    /// Colour of the text.
    pub colour: Colour,
}

/// Everything in one picture.
///
/// A scene may be kept from frame to frame: bodies, lines, regions and labels are replaced, trails grow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Physical time of the picture.
    pub time: f64,
    /// Title, top left; usually the experiment's.
    pub title: String,
    /// One line below the title: the state of things in words and numbers.
    pub caption: String,
    /// From where the scene is looked at, unless the viewer has moved.
    pub camera: Camera,
    /// Discs or spheres.
    pub bodies: Vec<Body>,
    /// Uniform acceleration that all bodies feel between their own time and the scene's.
    pub field: [f64; 3],
    /// Straight lines.
    pub lines: Vec<Line>,
    /// A map behind everything else.
    pub map: Option<Map>,
    /// Filled rectangles behind everything but the map.
    pub regions: Vec<Region>,
    /// Paths of chosen bodies.
    pub trails: Vec<Trail>,
    /// Texts in the simulation's space.
    pub labels: Vec<Label>,
    /// How bodies get their colour, and the legend.
    pub colouring: Colouring,
    /// What the viewer wants the bodies' `shade` to hold. It outlives a [`clear`](Self::clear).
    pub wanted: Shade,
    /// What it holds: what is wanted where that is known, the experiment's own choice elsewhere.
    pub shaded: Shade,
    /// Sides of the box along its periodic axes, zero along others: bodies are drawn faintly again so far away.
    pub period: [f64; 3],
    /// Lower and upper corner of the box, where there is one.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Smallest radius drawn, in points of the screen: bodies of a thin gas in a large box would otherwise be invisible. Zero for
    /// true size, faint below a pixel.
    pub least_radius: f32,
}

impl Scene {
    /// Empties everything but the trails, which persist from frame to frame, and what the viewer wants.
    pub fn clear(&mut self) {
        self.bodies.clear();
        self.lines.clear();
        self.regions.clear();
        self.map = None;
        self.labels.clear();
        (self.shaded, self.period, self.bounds) = (Shade::Own, [0.0; 3], None);
    }

    /// The trail with this key, created empty when there is none yet.
    ///
    /// `capacity` is the number of points kept; `colour` that of its newest end.
    pub fn trail(&mut self, key: u32, capacity: usize, colour: Colour) -> &mut Trail {
        let place = self.trails.iter().position(|trail| trail.key == key).unwrap_or_else(|| {
            self.trails.push(Trail::new(key, capacity, colour));
            self.trails.len() - 1
        });
        &mut self.trails[place]
    }

    /// Adds the outline of a rectangle (the edges of a box in 3-D, when the corners differ in `z`).
    pub fn add_box(&mut self, lower: [f64; 3], upper: [f64; 3], width: f32, colour: Colour) {
        let corner = |bits: usize| std::array::from_fn(|k| if bits >> k & 1 == 1 { upper[k] } else { lower[k] });
        let flat = lower[2] == upper[2];
        for bits in 0..8usize {
            for axis in 0..3 {
                let other = bits | 1 << axis;
                if other != bits && !(flat && (axis == 2 || bits & 4 != 0)) {
                    self.lines.push(Line { from: corner(bits), to: corner(other), width, colour });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_box_has_four_edges_and_a_full_one_twelve() {
        let mut scene = Scene::default();
        scene.add_box([0.0; 3], [1.0, 1.0, 0.0], 1.0, Colour::Wall);
        assert_eq!(scene.lines.len(), 4);
        scene.clear();
        scene.add_box([0.0; 3], [1.0; 3], 1.0, Colour::Wall);
        assert_eq!(scene.lines.len(), 12);
    }

    #[test]
    fn trails_outlive_a_clear() {
        let mut scene = Scene::default();
        scene.trail(3, 10, Colour::Accent(0)).push(TrailPoint { position: [0.0; 3], time: 0.0 });
        scene.clear();
        assert_eq!(scene.trail(3, 10, Colour::Accent(0)).total(), 1);
    }
}
