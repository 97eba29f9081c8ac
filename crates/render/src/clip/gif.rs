//! GIF: small films for pages and mails.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::{Encoder, no_picture, write_error};
use crate::{Picture, RenderError};

/// A film that repeats for ever, with a palette of its own for each picture.
pub(super) struct Gif {
    path: PathBuf,
    encoder: Option<gif::Encoder<BufWriter<File>>>,
    fps: f64,
    frames: u32,
    /// Hundredths of a second that the pictures so far have lasted.
    elapsed: u32,
    before: Vec<u8>,
}

impl Gif {
    pub(super) fn create(path: &Path, [width, height]: [u32; 2], fps: f64) -> Result<Self, RenderError> {
        let refuse = |expected: &str| RenderError::Clip { path: path.to_owned(), expected: expected.into() };
        let (Ok(width), Ok(height)) = (u16::try_from(width), u16::try_from(height)) else {
            return Err(refuse("GIF allows sides of at most 65535 pixels"));
        };
        if fps > 50.0 {
            return Err(refuse("GIF shows at most 50 pictures a second"));
        }
        let file = File::create(path).map_err(|source| write_error(path, source))?;
        let explain = |fault| encoding_error(path, fault);
        let mut encoder = gif::Encoder::new(BufWriter::new(file), width, height, &[]).map_err(explain)?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(explain)?;
        let before = Vec::new();
        Ok(Self { path: path.to_owned(), encoder: Some(encoder), fps, frames: 0, elapsed: 0, before })
    }
}

impl Encoder for Gif {
    fn frame(&mut self, picture: &Picture) -> Result<(), RenderError> {
        // Only the rectangle that differs from the picture before is written.
        let area = Area::changed(&self.before, picture);
        let mut pixels = area.cut(picture);
        let mut frame = gif::Frame::from_rgba_speed(area.size[0], area.size[1], &mut pixels, 10);
        [frame.left, frame.top] = area.corner;
        frame.dispose = gif::DisposalMethod::Keep;
        // Delays are whole hundredths of a second: each ends at the nearest to its exact time, so that no drift builds up.
        self.frames += 1;
        let end = (f64::from(self.frames) * 100.0 / self.fps).round() as u32;
        frame.delay = (end - self.elapsed).min(u32::from(u16::MAX)) as u16;
        self.elapsed = end;
        self.before.clone_from(&picture.rgba);
        match &mut self.encoder {
            Some(encoder) => encoder.write_frame(&frame).map_err(|fault| encoding_error(&self.path, fault)),
            None => Ok(()),
        }
    }

    fn finish(&mut self) -> Result<(), RenderError> {
        if self.frames == 0 {
            return Err(no_picture(&self.path));
        }
        let Some(encoder) = self.encoder.take() else { return Ok(()) };
        let mut file = encoder.into_inner().map_err(|fault| encoding_error(&self.path, fault))?;
        file.flush().map_err(|source| write_error(&self.path, source))
    }
}

/// A rectangle of a picture.
struct Area {
    corner: [u16; 2],
    size: [u16; 2],
}

impl Area {
    /// The smallest that holds every pixel that differs from `before`; one pixel when none does, all when there is no
    /// picture before.
    fn changed(before: &[u8], picture: &Picture) -> Self {
        let whole = Self { corner: [0, 0], size: [picture.width as u16, picture.height as u16] };
        if before.len() != picture.rgba.len() {
            return whole;
        }
        let row = 4 * picture.width as usize;
        let (mut left, mut right, mut top, mut bottom) = (usize::MAX, 0, usize::MAX, 0);
        for (y, (old, new)) in before.chunks_exact(row).zip(picture.rgba.chunks_exact(row)).enumerate() {
            if old == new {
                continue;
            }
            (top, bottom) = (top.min(y), y);
            let differs = |x: &usize| old[4 * x..4 * x + 4] != new[4 * x..4 * x + 4];
            left = (0..row / 4).find(differs).unwrap_or(0).min(left);
            right = (0..row / 4).rev().find(differs).unwrap_or(0).max(right);
        }
        if top == usize::MAX {
            return Self { corner: [0, 0], size: [1, 1] };
        }
        Self { corner: [left as u16, top as u16], size: [(right - left + 1) as u16, (bottom - top + 1) as u16] }
    }

    fn cut(&self, picture: &Picture) -> Vec<u8> {
        let [left, top] = self.corner.map(usize::from);
        let [width, height] = self.size.map(usize::from);
        let row = 4 * picture.width as usize;
        (top..top + height).flat_map(|y| &picture.rgba[y * row + 4 * left..y * row + 4 * (left + width)]).copied().collect()
    }
}

fn encoding_error(path: &Path, fault: gif::EncodingError) -> RenderError {
    match fault {
        gif::EncodingError::Io(source) => write_error(path, source),
        fault => RenderError::Clip { path: path.to_owned(), expected: fault.to_string() },
    }
}
