//! Writing: a file is either whole or not there, and nothing that exists is overwritten unasked.

mod lock;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::Checkpoints;
use lock::Lock;

/// A file or folder that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The folder holds something already.
    #[error("{}: the folder is not empty: choose another with --out, or overwrite its files with --force", .0.display())]
    NotEmpty(PathBuf),
    /// The place is taken by something that is not a folder, or by a link that could lead out of one.
    #[error("{}: expected a folder, but this is a file or a link", .0.display())]
    NotAFolder(PathBuf),
    /// Another process writes into the folder.
    #[error("{}: in use by {owner}: wait for it, or choose another folder", .path.display())]
    Taken {
        /// The folder.
        path: PathBuf,
        /// Who has it.
        owner: String,
    },
    /// The system refused.
    #[error("cannot write {}: {source}", .path.display())]
    System {
        /// What was to be written.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

impl WriteError {
    fn system(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::System { path: path.into(), source }
    }
}

/// The folders in that of a run.
const BELOW: [&str; 2] = ["checkpoints", "pictures"];

/// The folder a run writes into; no other process can have it at the same time.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    _lock: Lock,
}

impl Folder {
    /// The folder at `path`, created with its parents when it is not there.
    ///
    /// # Errors
    /// When it holds something already and `force` is not set, when it is a file, and when the system refuses.
    pub fn at(path: &Path, force: bool) -> Result<Self, WriteError> {
        match fs::read_dir(path) {
            Ok(mut entries) => {
                if !force && entries.next().is_some() {
                    return Err(WriteError::NotEmpty(path.into()));
                }
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                fs::create_dir_all(path).map_err(WriteError::system(path))?;
            }
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => return Err(WriteError::NotAFolder(path.into())),
            Err(error) => return Err(WriteError::system(path)(error)),
        }
        Self::take(path)
    }

    /// Takes a folder, of which a stranger may have made parts links to somewhere else.
    fn take(path: &Path) -> Result<Self, WriteError> {
        let lock = Lock::take(path)?;
        for below in BELOW.map(|name| path.join(name)) {
            if fs::symlink_metadata(&below).is_ok_and(|there| !there.is_dir()) {
                return Err(WriteError::NotAFolder(below));
            }
        }
        Ok(Self { path: path.into(), _lock: lock })
    }

    /// A new folder `parent/name`, or `parent/name-2`, `parent/name-3`, ... when that exists. The system creates it or
    /// says that it is there, in one step: two runs at the same time never get the same folder.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn fresh(parent: &Path, name: &str) -> Result<Self, WriteError> {
        fs::create_dir_all(parent).map_err(WriteError::system(parent))?;
        let mut path = parent.join(name);
        for number in 2u64.. {
            match fs::create_dir(&path) {
                Ok(()) => break,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => path = parent.join(format!("{name}-{number}")),
                Err(error) => return Err(WriteError::system(&path)(error)),
            }
        }
        Self::take(&path)
    }

    /// A folder that a run has written into before, and goes on to. What that run was writing when it ended is removed.
    ///
    /// # Errors
    /// When it is not there.
    pub fn again(path: &Path) -> Result<Self, WriteError> {
        let here = fs::read_dir(path).map_err(WriteError::system(path))?;
        let taken = Self::take(path)?;
        let below = BELOW.into_iter().filter_map(|name| fs::read_dir(path.join(name)).ok());
        for entry in below.chain([here]).flatten().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if name.starts_with(PREFIX) && name.ends_with(SUFFIX) {
                // A leftover does no harm.
                let _ = fs::remove_file(entry.path());
            }
        }
        Ok(taken)
    }

    /// Removes what an earlier run left here that could be taken for the results of the next one, or for its state.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn clear(&self) -> Result<(), WriteError> {
        Checkpoints::of(&self.path).clear();
        for name in ["summary.json", "report.html"] {
            let path = self.path.join(name);
            match fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(WriteError::system(&path)(error)),
                _ => {}
            }
        }
        Ok(())
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file into the folder, whole or not at all.
    ///
    /// # Errors
    /// When the system refuses; a folder that has vanished is not made anew.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), WriteError> {
        let path = self.path.join(name);
        if let Some(parent) = path.parent().filter(|&parent| parent != self.path) {
            match fs::create_dir(parent) {
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(WriteError::system(parent)(error)),
                _ => {}
            }
        }
        atomically(&path, bytes)
    }
}

/// How temporary files are called.
const PREFIX: &str = ".corpuscle-";
const SUFFIX: &str = ".tmp";

/// Writes a file, whole or not at all: into a temporary file beside it, flushed to the disk, then renamed, and the name
/// flushed as well.
///
/// # Errors
/// When the system refuses; what stood there before then still does.
pub fn atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let write = || -> io::Result<()> {
        let mut file = readable_by_others(tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX))
            .tempfile_in(folder)
            .map_err(without_the_temporary_name)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        // Elsewhere a folder cannot be opened; its file system keeps names in order by itself.
        #[cfg(unix)]
        fs::File::open(folder)?.sync_all()?;
        Ok(())
    };
    write().map_err(WriteError::system(path))
}

/// What the system said, without a name the user never gave.
fn without_the_temporary_name(error: io::Error) -> io::Error {
    let words = error.to_string();
    match words.split_once(" at path ") {
        Some((cause, _)) => io::Error::new(error.kind(), cause),
        None => error,
    }
}

/// Temporary files are private unless told otherwise; a report is to be shared as far as the user's mask allows.
#[cfg(unix)]
fn readable_by_others<'a, 'b>(builder: &'a mut tempfile::Builder<'b, 'b>) -> &'a mut tempfile::Builder<'b, 'b> {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn readable_by_others<'a, 'b>(builder: &'a mut tempfile::Builder<'b, 'b>) -> &'a mut tempfile::Builder<'b, 'b> {
    builder
}

/// A name that is safe as a file's on any system: letters, digits, hyphens and underscores, never a path.
pub fn file_stem(name: &str) -> String {
    let stem: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '-' }).take(100).collect();
    if stem.is_empty() { "unnamed".into() } else { stem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fresh_folder_never_is_an_old_one() {
        let parent = tempfile::tempdir().unwrap();
        let names = ["wave", "wave-2", "wave-3"];
        for name in names {
            assert_eq!(Folder::fresh(parent.path(), "wave").unwrap().path(), parent.path().join(name));
        }
    }

    #[test]
    fn what_exists_is_overwritten_only_by_force_and_leaves_no_rubbish() {
        let folder = tempfile::tempdir().unwrap();
        let first = Folder::at(folder.path(), false).unwrap();
        first.write("pictures/a.png", b"old").unwrap();
        drop(first);
        assert!(matches!(Folder::at(folder.path(), false), Err(WriteError::NotEmpty(_))));
        Folder::at(folder.path(), true).unwrap().write("pictures/a.png", b"new").unwrap();
        assert_eq!(fs::read(folder.path().join("pictures/a.png")).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path().join("pictures")).unwrap().count(), 1);
        assert!(matches!(Folder::at(&folder.path().join("pictures/a.png"), true), Err(WriteError::NotAFolder(_))));
    }

    #[test]
    fn names_cannot_leave_the_folder() {
        for name in ["../../etc/passwd", "a/b", "C:\\x", ""] {
            let stem = file_stem(name);
            assert!(!stem.is_empty() && !stem.contains(['/', '\\', '.', ':']), "{stem}");
        }
    }
}
