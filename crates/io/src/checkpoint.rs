//! Checkpoints: files from which a run goes on, bit for bit.
//!
//! A file is, in this order, the line `CORPUSCLE CHECKPOINT`, the number of the format and the length of the rest (64 bits
//! each, the lowest byte first), the BLAKE3 sum of the rest (32 bytes), and the rest: a map in MessagePack with the fields
//! `program`, the version that wrote it; `run`, a [`Run`]; and `simulation`, the state of the simulation, every field under
//! its name. A file is written beside the older ones and flushed to the disk before it gets its name, so that whatever has a
//! name is whole; the sum tells what the disk did to it since.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use corpuscle_checkpoint::{Fault, Reader, Writer};
use corpuscle_experiments::Simulation;
use serde::{Deserialize, Serialize};

use crate::write::atomically;
use crate::{VERSION, WriteError};

/// The first line of every checkpoint.
const MAGIC: &[u8] = b"CORPUSCLE CHECKPOINT\n";
/// The number of the format; a change of what stands in the file, or of what it means, raises it.
const FORMAT: u64 = 2;
/// Bytes before the map.
const HEAD: usize = MAGIC.len() + 8 + 8 + blake3::OUT_LEN;
/// Folder of the checkpoints in that of the run, and how their names end.
const FOLDER: &str = "checkpoints";
const EXTENSION: &str = "checkpoint";

/// A run as it was when a checkpoint was written, apart from the simulation itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The scenario, as its file.
    pub scenario: String,
    /// Physical time reached.
    pub time: f64,
    /// Time on the clock spent in the engine, seconds.
    pub wall: f64,
    /// How many of the moments worth a picture have passed.
    pub moments: usize,
    /// Time and caption of the pictures taken, which stand in the folder in their order.
    pub pictures: Vec<(f64, String)>,
    /// When checkpoints are written.
    pub policy: Policy,
    /// The trajectory, as far as it had been written.
    pub trajectory: Option<crate::trajectory::Kept>,
}

/// When checkpoints are written, and how many are kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Policy {
    /// Seconds on the clock between two of them.
    pub wall: Option<f64>,
    /// Physical time between two of them.
    pub time: Option<f64>,
    /// Collisions or steps between two of them.
    pub work: Option<u64>,
    /// The newest so many are kept.
    pub keep: usize,
    /// Whether they stay when the run has finished.
    pub stay: bool,
    /// Whether pictures are taken.
    pub pictures: bool,
}

/// Why a checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The system refuses to read it.
    #[error("cannot be read: {0}")]
    System(#[from] io::Error),
    /// It begins otherwise.
    #[error("is no checkpoint of Corpuscle")]
    Foreign,
    /// It has another format.
    #[error("has the format {0}; this is Corpuscle {VERSION}, which reads format {FORMAT}")]
    Format(u64),
    /// It ends too early.
    #[error("is cut off: {found} of {expected} bytes are there")]
    CutOff {
        /// Bytes there are.
        found: u64,
        /// Bytes there should be.
        expected: u64,
    },
    /// Its contents are not what was written.
    #[error("is damaged: its checksum is another")]
    Damaged,
    /// Another version wrote it, which may compute other bits.
    #[error(
        "was written by Corpuscle {0}; this is {VERSION}, which may compute other bits: use that version, or run the scenario anew"
    )]
    Program(String),
    /// What it holds does not fit.
    #[error("does not fit this program: {0}")]
    Content(#[from] Fault),
}

/// A checkpoint that has been read and found to be whole.
pub struct Checkpoint {
    /// The run it belongs to.
    pub run: Run,
    body: Vec<u8>,
}

impl Checkpoint {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// When it is no checkpoint, or one that cannot be used.
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        // Asked before it is opened: opening a pipe may take for ever.
        if !fs::metadata(path)?.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no file").into());
        }
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        let mut head = [0; HEAD];
        let wanted = length.min(HEAD as u64) as usize;
        file.read_exact(&mut head[..wanted])?;
        if !head.starts_with(&MAGIC[..wanted.min(MAGIC.len())]) {
            return Err(CheckpointError::Foreign);
        }
        if wanted < HEAD {
            return Err(CheckpointError::CutOff { found: length, expected: HEAD as u64 });
        }
        let (numbers, sum) = head[MAGIC.len()..].split_at(16);
        let number = |at: usize| u64::from_le_bytes(std::array::from_fn(|k| numbers[at + k]));
        if number(0) != FORMAT {
            return Err(CheckpointError::Format(number(0)));
        }
        let expected = number(8).saturating_add(HEAD as u64);
        if length != expected {
            return Err(CheckpointError::CutOff { found: length, expected });
        }
        // As much memory as there are bytes, whatever the file says of itself.
        let mut body = vec![];
        file.take(length).read_to_end(&mut body)?;
        if blake3::hash(&body).as_bytes() != sum {
            return Err(CheckpointError::Damaged);
        }
        let run = Self::beginning(&mut Reader::new(&body))?;
        Ok(Self { run, body })
    }

    fn beginning(reader: &mut Reader<'_>) -> Result<Run, CheckpointError> {
        reader.fields(3)?;
        let program: String = reader.value("program")?;
        if program != VERSION {
            return Err(CheckpointError::Program(program));
        }
        Ok(reader.value("run")?)
    }

    /// A fingerprint of the simulation's state: the same bits have the same, and others another.
    ///
    /// # Errors
    /// When the run cannot be written down, which was written down before.
    pub fn digest(&self) -> Result<String, CheckpointError> {
        let mut beginning = Writer::new();
        begin(&mut beginning, &self.run)?;
        Ok(blake3::hash(&self.body[beginning.finish().len()..]).to_string())
    }

    /// Puts a simulation that was started alike where the checkpoint left it.
    ///
    /// # Errors
    /// When it is another simulation; it is then of no use.
    pub fn load(&self, simulation: &mut dyn Simulation) -> Result<(), CheckpointError> {
        let mut reader = Reader::new(&self.body);
        Self::beginning(&mut reader)?;
        let state = simulation.state_mut().ok_or_else(|| Fault::new("this experiment cannot be taken up again"))?;
        reader.part("simulation", state)?;
        Ok(reader.end()?)
    }
}

/// A checkpoint as bytes.
///
/// # Errors
/// When the simulation has no state to write down.
pub fn bytes(run: &Run, simulation: &dyn Simulation) -> Result<Vec<u8>, Fault> {
    let state = simulation.state().ok_or_else(|| Fault::new("this experiment cannot be taken up again"))?;
    let mut out = Writer::new();
    begin(&mut out, run)?;
    out.part("simulation", state)?;
    Ok(seal(&out.finish()))
}

fn begin(out: &mut Writer, run: &Run) -> Result<(), Fault> {
    out.fields(3)?;
    out.value("program", VERSION)?;
    out.value("run", run)
}

/// A map with what stands before it.
fn seal(body: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + body.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend(FORMAT.to_le_bytes());
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend_from_slice(blake3::hash(body).as_bytes());
    bytes.extend_from_slice(body);
    bytes
}

/// The checkpoints of a run.
#[derive(Debug)]
pub struct Checkpoints {
    folder: PathBuf,
}

impl Checkpoints {
    /// Those in the folder of a run, if there are any yet.
    pub fn of(run: &Path) -> Self {
        Self { folder: run.join(FOLDER) }
    }

    /// Their files, the newest first.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<(u64, PathBuf)> = fs::read_dir(&self.folder)
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
            .filter_map(|path| Some((number(&path)?, path)))
            .collect();
        files.sort_by_key(|file| std::cmp::Reverse(file.0));
        files.into_iter().map(|file| file.1).collect()
    }

    /// Writes the next one, and then removes all but the newest `keep`.
    ///
    /// # Errors
    /// When the system refuses; the older ones are then as they were.
    pub fn write(&self, bytes: &[u8], keep: usize) -> Result<(), WriteError> {
        match fs::create_dir(&self.folder) {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
                return Err(WriteError::System { path: self.folder.clone(), source: error });
            }
            _ => {}
        }
        let next = self.files().first().and_then(|newest| number(newest)).unwrap_or(0).saturating_add(1);
        atomically(&self.folder.join(format!("{next:06}.{EXTENSION}")), bytes)?;
        for old in self.files().iter().skip(keep.max(1)) {
            // One too many does no harm.
            let _ = fs::remove_file(old);
        }
        Ok(())
    }

    /// Removes them all: the run has finished.
    pub fn clear(&self) {
        for file in self.files() {
            let _ = fs::remove_file(file);
        }
        let _ = fs::remove_dir(&self.folder);
    }
}

/// The number in the name of a checkpoint; none of other files.
fn number(path: &Path) -> Option<u64> {
    (path.extension()? == EXTENSION).then(|| path.file_stem()?.to_str()?.parse().ok()).flatten()
}

#[cfg(test)]
mod tests;
