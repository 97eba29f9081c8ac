//! How a scene is to be looked at: everything about a picture that is not part of the scene.

use corpuscle_scene::{Camera, Palette};

/// Size, camera, colours and trimmings of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Lower left corner within the frame buffer, in pixels; not zero when the picture is a part of a window.
    pub origin: [i32; 2],
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Pixels in a point (1/96 inch): texts and lines grow with it.
    pub scale: f32,
    /// Camera instead of the scene's own: the viewer has moved.
    pub camera: Option<Camera>,
    /// Background and foreground.
    pub palette: Palette,
    /// Samples a pixel for the edges of spheres, 1 for none. Discs, lines and texts are antialiased exactly without.
    /// When drawing with a [`crate::Renderer`] directly this is the number that the bound frame buffer has.
    pub samples: u32,
    /// Whether title, caption, time, legend and scale bar are drawn.
    pub overlay: bool,
    /// A card in the middle, of rows with a key and its meaning: the help of a window. None when empty.
    pub card: &'static [(&'static str, &'static str)],
}

impl View {
    /// A picture of the given size with everything on it.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            origin: [0, 0],
            width,
            height,
            scale: 1.0,
            camera: None,
            palette: Palette::default(),
            samples: 4,
            overlay: true,
            card: &[],
        }
    }

    /// The same in another palette.
    #[must_use]
    pub fn palette(mut self, palette: Palette) -> Self {
        self.palette = palette;
        self
    }

    /// Samples the frame buffer needs for this camera: in the plane every edge is antialiased without.
    pub(crate) fn samples_for(&self, camera: Camera) -> u32 {
        match camera {
            Camera::Plane { .. } => 1,
            Camera::Orbit { .. } => self.samples,
        }
    }
}
