//! `whitted scenes`: what can be rendered without a file.

use std::fmt::Write;

use whitted::scene::builtin::builtin;
use whitted::scene::builtins;
use whitted::scene::format::schema;

use super::args::ScenesArgs;
use super::failure::Failure;
use super::streams;

pub(crate) fn run(args: &ScenesArgs) -> Result<(), Failure> {
    if args.schema {
        return streams::print(schema().as_bytes());
    }
    if let Some(name) = &args.show {
        return streams::print(builtin(name)?.text().as_bytes());
    }
    let width = builtins().iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    let mut lines = String::new();
    for scene in builtins() {
        writeln!(lines, "{:width$}  {}", scene.name, scene.description)?;
    }
    streams::print(lines.as_bytes())
}
