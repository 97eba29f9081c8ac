//! Pictures in files: single, in folders, and moving.
//!
//! Everything is written under a temporary name beside its place and renamed when it is finished, so that no half-written
//! file is ever found under the name asked for.

mod gif;
mod mp4;
mod png;

use std::path::{Path, PathBuf};

use crate::{Picture, RenderError};

/// A film in the making, or a single picture.
///
/// What is dropped before [`Clip::finish`] is removed.
pub struct Clip {
    encoder: Box<dyn Encoder>,
    path: PathBuf,
    partial: PathBuf,
    size: [u32; 2],
    finished: bool,
}

/// One file format: takes pictures of one size, one after the other.
trait Encoder {
    fn frame(&mut self, picture: &Picture) -> Result<(), RenderError>;
    fn finish(&mut self) -> Result<(), RenderError>;
}

impl Clip {
    /// Opens a clip whose format follows from the path: `.mp4` (H.264), `.gif`, `.png` (one picture), or a folder of
    /// numbered pictures where there is no extension.
    ///
    /// `fps` is the number of pictures in a second of the film.
    ///
    /// # Errors
    /// [`RenderError::Clip`] for an unknown extension, a rate that is not positive, an odd size where H.264 wants even
    /// sides, or a folder that already holds files; [`RenderError::Write`] when the system refuses.
    pub fn create(path: impl AsRef<Path>, width: u32, height: u32, fps: f64) -> Result<Self, RenderError> {
        let path = path.as_ref().to_owned();
        let refuse = |expected: &str| Err(RenderError::Clip { path: path.clone(), expected: expected.into() });
        if !(fps.is_finite() && fps > 0.0 && fps <= 1000.0) {
            return refuse("the pictures a second are to be above 0 and at most 1000");
        }
        let folder = path.to_string_lossy().ends_with(std::path::is_separator);
        let extension = if folder { None } else { path.extension().map(|e| e.to_string_lossy().to_lowercase()) };
        let Some(name) = path.file_name() else { return refuse("a name of a file or a folder is expected") };
        let partial = path.with_file_name(format!(".{}.partial", name.to_string_lossy()));
        let encoder: Box<dyn Encoder> = match extension.as_deref() {
            Some("mp4") if width % 2 == 1 || height % 2 == 1 => return refuse("H.264 wants an even width and height"),
            Some("mp4") => Box::new(mp4::Mp4::create(&partial, [width, height], fps)?),
            Some("gif") => Box::new(gif::Gif::create(&partial, [width, height], fps)?),
            Some("png") => Box::new(png::Single::new(&partial)),
            None if path.read_dir().is_ok_and(|mut entries| entries.next().is_some()) => {
                return refuse("a new or an empty folder is expected");
            }
            None => Box::new(png::Numbered::create(&partial)?),
            Some(_) => return refuse("a name that ends in .mp4, .gif or .png is expected, or a folder"),
        };
        Ok(Self { encoder, path, partial, size: [width, height], finished: false })
    }

    /// Adds the next picture.
    ///
    /// # Errors
    /// [`RenderError::Clip`] for a picture of another size, or a second one in a `.png`; [`RenderError::Write`].
    pub fn frame(&mut self, picture: &Picture) -> Result<(), RenderError> {
        let [width, height] = self.size;
        if [picture.width, picture.height] != self.size || picture.rgba.len() != 4 * width as usize * height as usize {
            let expected = format!("pictures of {width} x {height} pixels are expected");
            return Err(RenderError::Clip { path: self.path.clone(), expected });
        }
        self.encoder.frame(picture)
    }

    /// Completes the file and puts it in its place, where it replaces an older one.
    ///
    /// # Errors
    /// [`RenderError::Clip`] when there was no picture; [`RenderError::Write`].
    pub fn finish(mut self) -> Result<(), RenderError> {
        self.encoder.finish()?;
        if self.partial.is_dir() {
            // Renaming over an empty folder is not allowed everywhere; `create` has seen that it is empty.
            let _ = std::fs::remove_dir(&self.path);
        }
        std::fs::rename(&self.partial, &self.path).map_err(|source| write_error(&self.path, source))?;
        self.finished = true;
        Ok(())
    }
}

impl Drop for Clip {
    fn drop(&mut self) {
        if !self.finished {
            // Best effort: what cannot be removed is at least not under the name asked for.
            let _ =
                if self.partial.is_dir() { std::fs::remove_dir_all(&self.partial) } else { std::fs::remove_file(&self.partial) };
        }
    }
}

impl Picture {
    /// Writes the picture as a PNG file.
    ///
    /// # Errors
    /// [`RenderError::Write`] when the system refuses.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), RenderError> {
        let path = path.as_ref();
        let bytes = self.to_png()?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let partial = path.with_file_name(format!(".{name}.partial"));
        std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, path)).map_err(|source| write_error(path, source))
    }

    /// The picture as the bytes of a PNG file.
    ///
    /// # Errors
    /// [`RenderError::Clip`] for a picture whose size and bytes disagree.
    pub fn to_png(&self) -> Result<Vec<u8>, RenderError> {
        png::encode(self)
    }
}

fn write_error(path: &Path, source: std::io::Error) -> RenderError {
    RenderError::Write { path: path.to_owned(), source }
}

fn no_picture(path: &Path) -> RenderError {
    RenderError::Clip { path: path.to_owned(), expected: "at least one picture is expected".into() }
}
