//! Files from strangers: whatever the bytes, each reader answers with what it read or with what is wrong, soon and in little
//! memory. What has been tried by hand, and what has once been trouble, stands in `tests/corpus`, a file each; the rest is noise,
//! and good files with mistakes.

#![allow(clippy::unwrap_used)] // in the helpers too: a test that cannot be set up has failed

mod checkpoints;
mod scenarios;
mod trajectories;

use std::path::{Path, PathBuf};

use proptest::prelude::*;

/// Names and bytes of the corpus of this kind.
fn corpus(kind: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(kind);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.into_iter().map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(path).unwrap())).collect()
}

/// So many cases of each kind; `make fuzz` asks for more.
fn cases() -> u32 {
    std::env::var("FUZZ_CASES").ok().and_then(|count| count.parse().ok()).unwrap_or(2000)
}

/// Bytes with some of them cut out, and others put in.
fn spoilt(files: Vec<Vec<u8>>, pieces: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![prop::sample::select(pieces), prop::collection::vec(any::<u8>(), 0..9)];
    let edits = prop::collection::vec((any::<prop::sample::Index>(), piece, 0usize..12), 1..6);
    (prop::sample::select(files), edits).prop_map(|(mut bytes, edits)| {
        for (at, piece, cut) in edits {
            let at = at.index(bytes.len() + 1);
            let end = (at + cut).min(bytes.len());
            bytes.splice(at..end, piece);
        }
        bytes
    })
}
