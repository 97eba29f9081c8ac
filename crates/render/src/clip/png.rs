//! PNG: single pictures, and folders of numbered ones.

use std::path::{Path, PathBuf};

use super::{Encoder, no_picture, write_error};
use crate::{Picture, RenderError};

/// Opaque pictures need no fourth channel: a quarter of the bytes before compression.
pub(super) fn encode(picture: &Picture) -> Result<Vec<u8>, RenderError> {
    let opaque = picture.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let rgb: Vec<u8>;
    let pixels = if opaque {
        rgb = picture.rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        &rgb
    } else {
        &picture.rgba
    };
    let explain = |fault: png::EncodingError| RenderError::Clip { path: PathBuf::from("PNG"), expected: fault.to_string() };
    let mut writer = encoder.write_header().map_err(explain)?;
    writer.write_image_data(pixels).map_err(explain)?;
    writer.finish().map_err(explain)?;
    Ok(bytes)
}

/// One picture.
pub(super) struct Single {
    path: PathBuf,
    written: bool,
}

impl Single {
    pub(super) fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), written: false }
    }
}

impl Encoder for Single {
    fn frame(&mut self, picture: &Picture) -> Result<(), RenderError> {
        if self.written {
            let expected = "one picture is expected: give a folder, .gif or .mp4 for more".into();
            return Err(RenderError::Clip { path: self.path.clone(), expected });
        }
        self.written = true;
        std::fs::write(&self.path, encode(picture)?).map_err(|source| write_error(&self.path, source))
    }

    fn finish(&mut self) -> Result<(), RenderError> {
        if self.written { Ok(()) } else { Err(no_picture(&self.path)) }
    }
}

/// A folder with `00000.png`, `00001.png`, ...
pub(super) struct Numbered {
    folder: PathBuf,
    next: u32,
}

impl Numbered {
    pub(super) fn create(folder: &Path) -> Result<Self, RenderError> {
        // Left over from a run that was killed.
        if folder.is_dir() {
            std::fs::remove_dir_all(folder).map_err(|source| write_error(folder, source))?;
        }
        std::fs::create_dir_all(folder).map_err(|source| write_error(folder, source))?;
        Ok(Self { folder: folder.to_owned(), next: 0 })
    }
}

impl Encoder for Numbered {
    fn frame(&mut self, picture: &Picture) -> Result<(), RenderError> {
        let path = self.folder.join(format!("{:05}.png", self.next));
        self.next += 1;
        std::fs::write(&path, encode(picture)?).map_err(|source| write_error(&path, source))
    }

    fn finish(&mut self) -> Result<(), RenderError> {
        if self.next > 0 { Ok(()) } else { Err(no_picture(&self.folder)) }
    }
}
