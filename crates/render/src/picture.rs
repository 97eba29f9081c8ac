//! A finished picture in memory.

/// Pixels of a picture: red, green, blue and opacity, one byte each, from the upper left corner row by row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `4 width height` bytes.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Red, green, blue and opacity of a pixel; none outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let at = 4 * (y as usize * self.width as usize + x as usize);
        self.rgba.get(at..at + 4)?.try_into().ok()
    }
}
