//! Trajectories: a file to which a run adds a frame at equal intervals of physical time.
//!
//! What has been flushed is whole frames and stays so, whatever kills the program. A run that goes on from a checkpoint cuts off
//! what was written since, and ends with the same bytes as one that nothing disturbed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use corpuscle_core::Invalid;
use corpuscle_experiments::Frame;
use serde::{Deserialize, Serialize};

pub use crate::columns::{ReadError, Snapshot};
use crate::{WriteError, columns, dump, gsd, xyz};

/// Frames a trajectory may have.
const MOST_FRAMES: f64 = 1e6;
/// What has been written is flushed at checkpoints, at the end, and otherwise after so long.
const FLUSH: Duration = Duration::from_secs(10);

/// The file beside a scenario that starts from a trajectory.
pub(crate) const START: &str = "start.xyz";

/// Format of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Extended XYZ.
    Xyz,
    /// LAMMPS dump.
    Dump,
    /// GSD: single precision, written but not read.
    Gsd,
}

impl Format {
    /// The format that a file's name ends with.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "xyz" | "extxyz" => Some(Self::Xyz),
            "dump" | "lammpstrj" => Some(Self::Dump),
            "gsd" => Some(Self::Gsd),
            _ => None,
        }
    }

    /// Writes one frame as a file of its own.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn write(self, file: &mut File, frame: &Frame) -> io::Result<()> {
        let mut sink = Sink::begin(self, file)?;
        sink.add(file, frame, 0)?;
        sink.flush(file)
    }

    /// Reads a frame: that of this number, counted from 0, or the last whole one.
    ///
    /// # Errors
    /// When there is no such frame, or it cannot be read.
    pub fn read(self, input: impl io::BufRead + Seek, frame: Option<u64>) -> Result<Snapshot, ReadError> {
        match self {
            Self::Xyz => columns::read(input, xyz::head, frame),
            Self::Dump => columns::read(input, dump::head, frame),
            Self::Gsd => Err(io::Error::new(io::ErrorKind::Unsupported, "GSD has single precision only").into()),
        }
    }
}

/// Opens a trajectory and reads a frame of it.
///
/// # Errors
/// When there is no such frame, or it cannot be read; a file must be a regular one.
pub fn read(path: &Path, frame: Option<u64>) -> Result<Snapshot, ReadError> {
    let format = Format::of(path).ok_or_else(|| io::Error::new(io::ErrorKind::Unsupported, EXPECTED))?;
    // Asked before it is opened: opening a pipe may take for ever.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no file").into());
    }
    format.read(BufReader::new(File::open(path)?), frame)
}

/// What the name of a trajectory looks like.
pub const EXPECTED: &str = "a name that ends in .xyz, .extxyz, .dump, .lammpstrj or .gsd";

/// A trajectory that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Name of the file, in the folder of the run.
    pub file: String,
    /// Physical time from frame to frame.
    pub every: f64,
}

/// A trajectory so far: what a checkpoint keeps of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    file: String,
    every: f64,
    frames: u64,
    bytes: u64,
    gsd: Option<gsd::Layout>,
}

/// A trajectory being written.
#[derive(Debug)]
pub struct Trajectory {
    path: PathBuf,
    file: File,
    sink: Sink,
    plan: Plan,
    frames: u64,
    flushed: Instant,
}

impl Plan {
    /// A trajectory in `file` with a frame each `every` until `end`.
    ///
    /// # Errors
    /// When the file is not a plain name, or the frames are too many.
    pub fn new(file: &str, every: f64, end: f64) -> Result<Self, Invalid> {
        format(file)?;
        if !(every > 0.0 && every.is_finite() && end / every <= MOST_FRAMES) {
            let least = end / MOST_FRAMES;
            return Err(Invalid::new("every", every, format!("a time of at least {least:e}: a million frames in all")));
        }
        Ok(Self { file: file.into(), every })
    }
}

/// Checks that a file's name is that of a trajectory and leads nowhere.
fn format(file: &str) -> Result<Format, Invalid> {
    let refuse = |expected: &str| Invalid::new("trajectory", file, expected);
    let path = Path::new(file);
    if path.file_name() != Some(path.as_os_str()) || file.contains(['/', '\\', ':']) || file.starts_with('.') {
        return Err(refuse("the name of a file, which is written into the folder of the run"));
    }
    if file.eq_ignore_ascii_case(START) {
        return Err(refuse("another name: this one is that of the frame a run started from"));
    }
    Format::of(path).ok_or_else(|| refuse(EXPECTED))
}

impl Trajectory {
    /// Begins a trajectory in the folder of a run, in place of an older one of its name.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn begin(folder: &Path, plan: Plan) -> Result<Self, WriteError> {
        let path = folder.join(&plan.file);
        let open = || -> io::Result<(File, Sink)> {
            match fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
            let mut file = OpenOptions::new().read(true).write(true).create_new(true).open(&path)?;
            let format = format(&plan.file).map_err(io::Error::other)?;
            let sink = Sink::begin(format, &mut file)?;
            Ok((file, sink))
        };
        let (file, sink) = open().map_err(|source| WriteError::System { path: path.clone(), source })?;
        Ok(Self { path, file, sink, plan, frames: 0, flushed: Instant::now() })
    }

    /// Goes on with a trajectory where a checkpoint left it; what has been written since is cut off.
    ///
    /// # Errors
    /// When the file is not there, or is shorter than it was.
    pub fn again(folder: &Path, kept: Kept) -> Result<Self, Invalid> {
        let Kept { file: name, every, frames, bytes, gsd } = kept;
        let format = format(&name)?;
        let plan = Plan::new(&name, every, 0.0)?;
        let path = folder.join(&name);
        let refuse = |found: String| {
            let expected = format!("the {bytes} bytes of the checkpoint: put it back, or go on with --no-trajectory");
            Invalid::new(format!("trajectory {}", path.display()), found, expected)
        };
        let refused = |error: io::Error| refuse(error.to_string());
        // A link could lead out of the folder.
        if !fs::symlink_metadata(&path).map_err(refused)?.is_file() {
            return Err(refuse("something that is no file".into()));
        }
        let mut file = OpenOptions::new().read(true).write(true).open(&path).map_err(refused)?;
        let length = file.metadata().map_err(refused)?.len();
        if length < bytes {
            return Err(refuse(format!("{length} bytes")));
        }
        let sink = match (format, gsd) {
            (Format::Gsd, Some(layout)) if layout.is_possible() && layout.end() == bytes => {
                Sink::Gsd(gsd::Writer::again(&mut file, layout).map_err(refused)?)
            }
            (Format::Xyz | Format::Dump, None) => {
                file.set_len(bytes).map_err(refused)?;
                Sink::Text { format, bytes }
            }
            _ => return Err(refuse("a checkpoint that says otherwise".into())),
        };
        Ok(Self { path, file, sink, plan, frames, flushed: Instant::now() })
    }

    /// The physical time of the next frame.
    pub fn next_time(&self) -> f64 {
        self.plan.every * self.frames as f64
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// When the system refuses: the frames before are still whole.
    pub fn add(&mut self, frame: &Frame) -> Result<(), WriteError> {
        let written = self.sink.add(&mut self.file, frame, self.frames);
        written.map_err(|source| WriteError::System { path: self.path.clone(), source })?;
        self.frames += 1;
        if self.flushed.elapsed() > FLUSH { self.flush() } else { Ok(()) }
    }

    /// Puts what has been written onto the disk.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.flushed = Instant::now();
        self.sink.flush(&mut self.file).map_err(|source| WriteError::System { path: self.path.clone(), source })
    }

    /// What a checkpoint keeps, once it has been flushed.
    pub fn kept(&self) -> Kept {
        let Plan { file, every } = self.plan.clone();
        let (bytes, gsd) = match &self.sink {
            Sink::Text { bytes, .. } => (*bytes, None),
            Sink::Gsd(writer) => (writer.layout().end(), Some(writer.layout())),
        };
        Kept { file, every, frames: self.frames, bytes, gsd }
    }
}

/// How frames become bytes.
#[derive(Debug)]
enum Sink {
    Text { format: Format, bytes: u64 },
    Gsd(gsd::Writer),
}

impl Sink {
    fn begin(format: Format, file: &mut File) -> io::Result<Self> {
        Ok(match format {
            Format::Xyz | Format::Dump => Self::Text { format, bytes: 0 },
            Format::Gsd => Self::Gsd(gsd::Writer::begin(file)?),
        })
    }

    fn add(&mut self, file: &mut File, frame: &Frame, number: u64) -> io::Result<()> {
        match self {
            Self::Text { format, bytes } => {
                let text = if *format == Format::Dump { dump::frame(frame, number) } else { xyz::frame(frame) };
                file.seek(SeekFrom::Start(*bytes))?;
                let written = file.write_all(text.as_bytes());
                if written.is_err() {
                    // A full disk: half a frame is of no use, and cutting it off needs no room.
                    let _ = file.set_len(*bytes);
                }
                written?;
                *bytes += text.len() as u64;
                Ok(())
            }
            Self::Gsd(writer) => writer.add(file, frame),
        }
    }

    fn flush(&mut self, file: &mut File) -> io::Result<()> {
        match self {
            Self::Text { .. } => file.sync_data(),
            Self::Gsd(writer) => writer.flush(file),
        }
    }
}

/// A name as one word of a file whose columns are parted by blanks.
pub(crate) fn word(name: &str) -> String {
    let word: String = name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).take(60).collect();
    if word.is_empty() { "X".into() } else { word }
}

#[cfg(test)]
mod tests;
