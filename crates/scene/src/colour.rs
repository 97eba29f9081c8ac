//! Colours by role, in palettes that colour-blind readers can tell apart.

/// A colour by its role; the palette turns it into red, green and blue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Colour {
    /// Foreground of text and axes.
    #[default]
    Ink,
    /// Walls and the edges of a box.
    Wall,
    /// Faint lines: springs, grids, images.
    Faint,
    /// One of the eight colours of Okabe and Ito.
    Accent(u8),
    /// The same, almost transparent: fills behind the bodies.
    Tint(u8),
}

/// How bodies get their colours, and so which legend is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Colouring {
    /// All bodies alike.
    Uniform(Colour),
    /// By species: names in the order of their indices, coloured in the order of [`okabe_ito`].
    Species(Vec<String>),
    /// By speed at the scene's time, from zero to `most`, on viridis.
    Speed {
        /// Speed at the upper end of the scale.
        most: f64,
        /// Unit shown in the legend; empty when reduced.
        unit: String,
    },
    /// By kinetic energy `m v^2 / 2` at the scene's time, from zero to `most`, on viridis; the bodies' `shade` is their mass.
    Energy {
        /// Energy at the upper end of the scale.
        most: f64,
    },
    /// By the coordinate along an axis at the scene's time, on viridis.
    Height {
        /// The axis, 0 to 2.
        axis: usize,
        /// Coordinate at the lower end of the scale.
        least: f64,
        /// Coordinate at the upper end.
        most: f64,
    },
    /// By the bodies' own `shade`, on viridis.
    Value {
        /// Name of the quantity.
        name: String,
        /// Unit shown in the legend; empty when reduced.
        unit: String,
        /// Value at the lower end of the scale.
        least: f64,
        /// Value at the upper end of the scale.
        most: f64,
    },
    /// By the bodies' own `shade`, an angle whose two ends are one direction, on [`hue_circle`].
    Angle {
        /// Name of the quantity.
        name: String,
        /// Unit shown in the legend; empty when reduced.
        unit: String,
        /// Value at the lower end of the circle.
        least: f64,
        /// Value at the upper end, of the same colour.
        most: f64,
    },
}

impl Colouring {
    /// The colour map of a continuous colouring.
    pub fn map(&self) -> fn(f64) -> [f64; 3] {
        if matches!(self, Self::Angle { .. }) { hue_circle } else { viridis }
    }
}

/// What the bodies' `shade` holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shade {
    /// What the experiment's own colouring reads.
    #[default]
    Own,
    /// Index of the species.
    Species,
    /// Mass.
    Mass,
    /// Number of contacts with other bodies since the start.
    Collisions,
}

impl Default for Colouring {
    fn default() -> Self {
        Self::Uniform(Colour::Accent(0))
    }
}

/// The eight colours of Okabe and Ito (2008), "Color Universal Design", as red, green, blue from 0 to 255, in an order
/// that puts the most different first: blue, vermilion, bluish green, reddish purple, sky blue, orange, yellow, black.
pub fn okabe_ito(index: usize) -> [u8; 3] {
    const COLOURS: [[u8; 3]; 8] =
        [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0], [240, 228, 66], [0, 0, 0]];
    COLOURS[index % 8]
}

/// The colour map viridis (van der Walt and Smith 2015) at `0 <= x <= 1`, interpolated between 11 of its entries, as
/// red, green, blue from 0 to 1.
pub fn viridis(x: f64) -> [f64; 3] {
    const KNOTS: [[u8; 3]; 11] = [
        [68, 1, 84],
        [72, 36, 117],
        [65, 68, 135],
        [53, 95, 141],
        [42, 120, 142],
        [33, 145, 140],
        [34, 168, 132],
        [68, 191, 112],
        [122, 209, 81],
        [189, 223, 38],
        [253, 231, 37],
    ];
    between(&KNOTS, x)
}

/// A closed circle of hues at `0 <= x <= 1`, from sand by rose, violet and blue in the middle, by teal and green back to sand: of one
/// chroma, 0.11, in Oklab (Ottosson 2020), with the lightness `0.70 + 0.11 cos(2 pi x)`, so that opposite hues differ in it, too.
pub fn hue_circle(x: f64) -> [f64; 3] {
    const KNOTS: [[u8; 3]; 11] = [
        [235, 183, 108],
        [247, 161, 133],
        [227, 139, 162],
        [184, 123, 183],
        [132, 119, 192],
        [78, 127, 189],
        [3, 146, 176],
        [39, 170, 154],
        [120, 188, 128],
        [189, 193, 107],
        [235, 183, 108],
    ];
    between(&KNOTS, x)
}

fn between(knots: &[[u8; 3]; 11], x: f64) -> [f64; 3] {
    let place = x.clamp(0.0, 1.0) * 10.0;
    let knot = (place as usize).min(9);
    let part = place - knot as f64;
    std::array::from_fn(|c| (f64::from(knots[knot][c]) * (1.0 - part) + f64::from(knots[knot + 1][c]) * part) / 255.0)
}

/// Background and foreground of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// Light ink on a dark ground: for screens.
    #[default]
    Dark,
    /// Dark ink on white: for print and projectors.
    Light,
}

impl Palette {
    /// Red, green, blue and opacity of a role, each from 0 to 1.
    pub fn rgba(self, colour: Colour) -> [f32; 4] {
        let bytes = |rgb: [u8; 3], alpha: f32| {
            let [r, g, b] = rgb.map(|c| f32::from(c) / 255.0);
            [r, g, b, alpha]
        };
        match (colour, self) {
            (Colour::Ink, Self::Dark) => bytes([232, 236, 241], 1.0),
            (Colour::Ink, Self::Light) => bytes([24, 28, 34], 1.0),
            (Colour::Wall, Self::Dark) => bytes([170, 180, 194], 1.0),
            (Colour::Wall, Self::Light) => bytes([70, 78, 90], 1.0),
            (Colour::Faint, Self::Dark) => bytes([110, 122, 140], 0.6),
            (Colour::Faint, Self::Light) => bytes([140, 148, 160], 0.7),
            // Black disappears on a dark ground: white takes its place.
            (Colour::Accent(index), Self::Dark) if index % 8 == 7 => bytes([245, 245, 245], 1.0),
            (Colour::Accent(index), _) => bytes(self.accent(index), 1.0),
            (Colour::Tint(index), _) => bytes(self.accent(index), 0.10),
        }
    }

    /// The two blues change places on a dark ground, where the deeper one is hard to see.
    fn accent(self, index: u8) -> [u8; 3] {
        okabe_ito(match (self, index % 8) {
            (Self::Dark, 0) => 4,
            (Self::Dark, 4) => 0,
            (_, index) => usize::from(index),
        })
    }

    /// Red, green, blue of the ground, each from 0 to 1.
    pub fn ground(self) -> [f32; 3] {
        match self {
            Self::Dark => [0.055, 0.067, 0.086],
            Self::Light => [1.0, 1.0, 1.0],
        }
    }
}
