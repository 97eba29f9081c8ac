//! Where a clip or a picture goes: asked before any work is done, so that a slip costs no waiting and leaves nothing.

use std::path::Path;

use corpuscle_core::Invalid;
use corpuscle_io::{Origin, Refusal};

/// Refuses the value of an argument.
pub(super) fn refuse(key: &str, value: impl ToString, expected: impl Into<String>) -> Refusal {
    Refusal::new(Origin::CommandLine, Invalid::new(key, value, expected))
}

/// Whether a file can be put there: its folder exists, and nothing is overwritten unasked.
pub(super) fn vacant(key: &str, path: &Path, force: bool) -> Result<(), Refusal> {
    let refuse = |expected: &str| Err(refuse(key, path.display(), expected));
    if path.file_name().is_none() {
        return refuse("the name of a file or a folder");
    }
    if path.parent().is_some_and(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
        return refuse("a place in a folder that exists");
    }
    if path.is_file() && !force {
        return refuse("a new file, or --force to overwrite this one");
    }
    Ok(())
}

/// The extension in lower case; none for `folder/`.
pub(super) fn extension(path: &Path) -> Option<String> {
    let folder = path.to_string_lossy().ends_with(std::path::is_separator);
    path.extension().filter(|_| !folder).map(|extension| extension.to_string_lossy().to_lowercase())
}
