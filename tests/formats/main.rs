//! Tests of what is read from files: real models, standard scenes, and broken ones.

mod broken;
mod models;
mod nff;
mod program;

use std::path::PathBuf;

/// A file of the repository.
fn file(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}
