//! One process a folder.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::WriteError;

/// Its file in the folder, with the number of the process that has it.
const FILE: &str = ".corpuscle-lock";

/// A folder that is this process's. The system lets go of it when the process ends, in whatever way: a lock of the dead holds
/// nobody.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Takes the folder.
    pub(super) fn take(folder: &Path) -> Result<Self, WriteError> {
        let path = folder.join(FILE);
        loop {
            let file = open(&path).map_err(WriteError::system(&path))?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    let mut text = String::new();
                    // Elsewhere than on Unix what is locked cannot be read.
                    let _ = file.take(20).read_to_string(&mut text);
                    let number = text.trim().parse::<u32>().ok();
                    let owner = number.map_or_else(|| "another process".into(), |number| format!("process {number}"));
                    return Err(WriteError::Taken { path: folder.into(), owner });
                }
                Err(TryLockError::Error(error)) if error.kind() != io::ErrorKind::Unsupported => {
                    return Err(WriteError::system(&path)(error));
                }
                // Some file systems have no locks.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            // Whoever had it may have removed the file after it was opened here.
            if is_at(&file, &path) {
                // A lock without a name is a lock; and elsewhere than on Unix nobody writes what is locked.
                let _ = fs::write(&path, format!("{}\n", std::process::id()));
                return Ok(Self { path, _file: file });
            }
        }
    }
}

/// Opens the file, which a stranger's folder may have as a link to somewhere else. It is kept open for reading only: what is open for
/// writing would keep its disk from being made read-only.
fn open(path: &Path) -> io::Result<File> {
    if fs::symlink_metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no file"));
    }
    OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
    File::open(path)
}

/// Whether the open file is the one that has this name.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => identity(open) == identity(named),
        _ => false,
    }
}

/// Elsewhere a file that is open keeps its name.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still locked; a leftover does no harm.
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test that cannot go on has failed

    use super::*;

    #[test]
    fn a_folder_is_had_once_and_let_go_of() {
        let folder = tempfile::tempdir().unwrap();
        let lock = Lock::take(folder.path()).unwrap();
        let refused = Lock::take(folder.path()).unwrap_err().to_string();
        assert!(refused.contains(&format!("in use by process {}", std::process::id())), "{refused}");
        drop(lock);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        drop(Lock::take(folder.path()).unwrap());
        // Of a process that died.
        fs::write(folder.path().join(FILE), "1\n").unwrap();
        drop(Lock::take(folder.path()).unwrap());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_leads_nowhere() {
        let folder = tempfile::tempdir().unwrap();
        let outside = tempfile::NamedTempFile::new().unwrap();
        fs::write(outside.path(), "precious").unwrap();
        std::os::unix::fs::symlink(outside.path(), folder.path().join(FILE)).unwrap();
        assert!(Lock::take(folder.path()).unwrap_err().to_string().contains("it is no file"));
        assert_eq!(fs::read_to_string(outside.path()).unwrap(), "precious");
    }
}
