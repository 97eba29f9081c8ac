//! Standard output and standard error.

use std::io::{self, ErrorKind, Write};

/// Prints a text. A reader that has gone away (`| head`) is no error: what is left to do may still be worth doing.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    unless_gone(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Success when nobody is left to read.
pub(crate) fn unless_gone(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// Prints a line to standard error, where nothing can be done if that fails.
pub(crate) fn complain(line: &str) {
    let _ = writeln!(io::stderr(), "corpuscle: {line}");
}
