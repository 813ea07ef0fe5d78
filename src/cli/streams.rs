//! Standard output and standard error, whose readers may have gone away.

use std::io::{self, Write};

use anyhow::Context;

use super::failure::Failure;

/// Writes all of `bytes` to standard output; a reader that has left does not want the rest, which
/// is no error.
pub(crate) fn write_stdout(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output could not be written")?
        }
        _ => Ok(()),
    }
}

/// Writes a line for the user to standard error; nobody is left to tell if that fails.
pub(crate) fn note(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}
