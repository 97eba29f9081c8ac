//! Where the text of a scenario comes from: a file, a pipe or standard input. Never more than 16 MiB are read, and nobody waits for
//! ever for a pipe that nobody writes into.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use corpuscle_core::Invalid;

/// Longest scenario read, in bytes: far more than any list of particles written by hand.
pub(super) const LONGEST: u64 = 16 << 20;
/// So long may a pipe with a name take, from opening it to its end.
const PATIENCE: Duration = Duration::from_secs(10);

/// The text of a file, or of what has a file's name: a named pipe, `/dev/stdin`, a shell's `<(command)`.
///
/// # Errors
/// When it cannot be read, is no text, too long, or takes too long.
pub(super) fn read(path: &Path) -> Result<String, Invalid> {
    let metadata = path.metadata().map_err(|error| unreadable(&error))?;
    if metadata.is_dir() {
        return Err(refuse("a folder", "a scenario file"));
    }
    if metadata.is_file() {
        return text(File::open(path));
    }
    // Opening a pipe takes until somebody writes into it; one that is given up ends with the program.
    let (sender, receiver) = mpsc::channel();
    let path = path.to_owned();
    thread::spawn(move || sender.send(text(File::open(path))));
    receiver.recv_timeout(PATIENCE).unwrap_or_else(|_| {
        let (found, seconds) = ("no regular file, and it has not come to an end", PATIENCE.as_secs());
        Err(refuse(found, &format!("a file, or a pipe that somebody writes into within {seconds} seconds; `-` is standard input")))
    })
}

/// The text of standard input, for which whoever has typed `-` waits.
///
/// # Errors
/// When it cannot be read, is no text, or too long.
pub(super) fn read_standard_input() -> Result<String, Invalid> {
    text(Ok(io::stdin()))
}

fn text(source: io::Result<impl Read>) -> Result<String, Invalid> {
    let mut bytes = vec![];
    source.and_then(|source| source.take(LONGEST + 1).read_to_end(&mut bytes)).map_err(|error| unreadable(&error))?;
    if bytes.len() as u64 > LONGEST {
        return Err(refuse(format!("more than {LONGEST} bytes"), "a scenario file of at most 16 MiB"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let byte = error.utf8_error().valid_up_to();
        refuse(format!("byte {byte} is not UTF-8"), "a scenario file, which is text in UTF-8")
    })
}

fn unreadable(error: &io::Error) -> Invalid {
    refuse(error, "a scenario file that can be read")
}

fn refuse(found: impl ToString, expected: &str) -> Invalid {
    Invalid::new("file", found, expected)
}
