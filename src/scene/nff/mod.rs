//! Scenes in the Neutral File Format of the Standard Procedural Databases.
//!
//! Source: Haines, "A Proposal for Standard Graphics Environments", *IEEE CG&A* 7(11) (1987).

mod build;
mod read;
mod soup;

use std::path::Path;

use thiserror::Error;

use super::{
    parts::Parts,
    text::{self, TextError, decode::LARGEST_FILE},
    warning::Warning,
};

/// Why there is no scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NffError {
    /// The file is not read at all.
    #[error("{path}: {source}")]
    Text {
        /// The file.
        path: String,
        /// The reason.
        source: TextError,
    },
    /// An entity that cannot be right.
    #[error("{path}:{line}: {reason}")]
    Line {
        /// The file.
        path: String,
        /// The line, from 1.
        line: u32,
        /// What is wrong.
        reason: String,
    },
    /// Something is missing in the whole file.
    #[error("{path}: {reason}")]
    Missing {
        /// The file.
        path: String,
        /// What is missing.
        reason: String,
    },
}

/// What an NFF file holds, entity by entity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NffCounts {
    /// Spheres.
    pub spheres: u32,
    /// Cones, cut ones included.
    pub cones: u32,
    /// Cylinders.
    pub cylinders: u32,
    /// Polygons.
    pub polygons: u32,
    /// Polygonal patches.
    pub patches: u32,
    /// Corners of the largest polygon or patch.
    pub max_corners: u32,
    /// Lights.
    pub lights: u32,
    /// Surfaces (`f`).
    pub surfaces: u32,
}

/// A scene of an NFF file.
#[derive(Debug)]
pub struct NffScene {
    /// Its parts.
    pub parts: Parts,
    /// What the file holds.
    pub counts: NffCounts,
    /// What was odd about it.
    pub warnings: Vec<Warning>,
}

/// Reads a scene; its field of view reaches to the centres of the outermost of `rows` pixel rows, or as many as the
/// file says.
///
/// # Errors
/// The file cannot be read, or an entity in it cannot be right.
pub fn load_nff(path: &Path, rows: Option<u32>) -> Result<NffScene, NffError> {
    let shown = path.display().to_string();
    let not_read = |source| NffError::Text { path: shown.clone(), source };
    let bytes = text::read_limited(path, LARGEST_FILE).map_err(not_read)?;
    let text = text::decode(&bytes).map_err(not_read)?;
    parse_nff(&shown, &text, rows)
}

/// Whether a text is meant as NFF: it begins with an entity, and not with a key of TOML.
#[must_use]
pub fn is_nff(text: &[u8]) -> bool {
    let mut reader = read::Reader::new(text);
    let is_entity = |word: &String| build::ENTITIES.contains(&word.as_str());
    reader.keyword().is_some_and(|word| is_entity(&word))
        && reader.keyword().is_none_or(|word| word != "=")
}

/// As [`load_nff`], from the text of the file `path`.
///
/// # Errors
/// An entity that cannot be right.
pub fn parse_nff(path: &str, text: &[u8], rows: Option<u32>) -> Result<NffScene, NffError> {
    let mut builder = build::Builder::default();
    let mut reader = read::Reader::new(text);
    while let Some(keyword) = reader.keyword() {
        builder.entity(&mut reader, &keyword).map_err(|reason| NffError::Line {
            path: path.to_owned(),
            line: reader.line(),
            reason,
        })?;
    }
    builder.finish(path, rows)
}
