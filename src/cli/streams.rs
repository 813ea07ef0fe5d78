//! Standard output and standard error, whose readers may have gone away.

use std::env;
use std::io::{self, IsTerminal, Write};

use anyhow::Context;

use super::failure::Failure;

/// Writes text to standard output; a reader that has left does not want the rest, which is no error.
pub(crate) fn print(text: &[u8]) -> Result<(), Failure> {
    match write(|stdout| stdout.write_all(text)) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        done => checked(done),
    }
}

/// Has a result that took work written to standard output; a reader that has left did not get it.
pub(crate) fn to_stdout(
    result: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    checked(write(result))
}

fn write(what: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    what(&mut stdout).and_then(|()| stdout.flush())
}

fn checked(done: io::Result<()>) -> Result<(), Failure> {
    Ok(done.context("standard output could not be written")?)
}

/// Writes a line for the user to standard error; nobody is left to tell if that fails.
pub(crate) fn note(plain: &str) {
    let colored = |word: &str, code: &str| {
        let rest = plain.strip_prefix(word).filter(|_| wants_color())?;
        Some(format!("\x1b[1;{code}m{word}\x1b[0m{rest}"))
    };
    let line = colored("error:", "31").or_else(|| colored("warning:", "33"));
    let line = line.unwrap_or_else(|| plain.to_owned());
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Whether words on standard error are coloured: not if `NO_COLOR` is set; if `CLICOLOR_FORCE` is; else on a terminal
/// that is not `dumb`, unless `CLICOLOR` is 0.
///
/// Source: <https://no-color.org>, <https://bixense.com/clicolors>.
pub(crate) fn wants_color() -> bool {
    let value = |name: &str| env::var_os(name).unwrap_or_default();
    if !value("NO_COLOR").is_empty() {
        return false;
    }
    let forced = value("CLICOLOR_FORCE");
    if !forced.is_empty() && forced != "0" {
        return true;
    }
    value("CLICOLOR") != "0" && value("TERM") != "dumb" && io::stderr().is_terminal()
}
