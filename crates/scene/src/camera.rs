//! From where a scene is looked at.

/// A view of the scene. The renderer adds the aspect ratio of its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    /// Straight down on the plane `z = 0`, without perspective.
    Plane {
        /// The point in the middle of the picture.
        centre: [f64; 2],
        /// Extent that must be visible: width and height in the simulation's length.
        extent: [f64; 2],
    },
    /// In perspective, on a sphere around a target.
    Orbit {
        /// The point looked at.
        target: [f64; 3],
        /// Distance of the eye.
        distance: f64,
        /// Angle around the vertical (`z`), in radians.
        yaw: f64,
        /// Angle above the horizontal, in radians.
        pitch: f64,
    },
}

impl Default for Camera {
    fn default() -> Self {
        Self::Plane { centre: [0.0; 2], extent: [2.0; 2] }
    }
}

impl Camera {
    /// A view that shows the whole of a box, with a margin of 4 %: from above when it is flat, in perspective otherwise.
    pub fn fit(lower: [f64; 3], upper: [f64; 3]) -> Self {
        let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * (lower[k] + upper[k]));
        let size: [f64; 3] = std::array::from_fn(|k| upper[k] - lower[k]);
        if size[2] == 0.0 {
            return Self::Plane { centre: [centre[0], centre[1]], extent: [1.04 * size[0], 1.04 * size[1]] };
        }
        let diagonal = size.iter().map(|s| s * s).sum::<f64>().sqrt();
        Self::Orbit { target: centre, distance: 1.55 * diagonal, yaw: 0.6, pitch: 0.35 }
    }
}
