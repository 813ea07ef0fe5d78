//! `whitted scenes`: what can be rendered without a file.

use std::fmt::Write;

use whitted::scene::builtins;

use super::failure::Failure;
use super::streams;

pub(crate) fn run() -> Result<(), Failure> {
    let width = builtins().iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    let mut lines = String::new();
    for scene in builtins() {
        writeln!(lines, "{:width$}  {}", scene.name, scene.description)?;
    }
    streams::write_stdout(lines.as_bytes())
}
