//! Tests of what is read from files: real models, standard scenes, and broken ones.

mod broken;
#[cfg(feature = "cli")]
mod commands;
mod models;
mod nff;
#[cfg(feature = "cli")]
#[path = "../program/mod.rs"]
mod program;

use std::path::PathBuf;

/// A file of the repository.
fn file(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}
