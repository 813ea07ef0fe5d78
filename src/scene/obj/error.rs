//! Why a model cannot be used.

use thiserror::Error;

use crate::{geometry::MeshError, scene::text::TextError};

/// Why there is no model.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file is not read at all.
    #[error("{path}: {source}")]
    Text {
        /// The file.
        path: String,
        /// The reason.
        source: TextError,
    },
    /// A statement that cannot be right.
    #[error("{path}:{line}: {reason}")]
    Line {
        /// The file.
        path: String,
        /// The line, from 1.
        line: u32,
        /// What is wrong.
        reason: String,
    },
    /// There is nothing to see.
    #[error("{path}: contains no face{hint}")]
    NoFace {
        /// The file.
        path: String,
        /// What it holds instead, if that is known.
        hint: String,
    },
    /// Faces, but none with an area.
    #[error("{path}: all faces are degenerate")]
    NoArea {
        /// The file.
        path: String,
    },
    /// The mesh cannot be built.
    #[error("{path}: {source}")]
    Mesh {
        /// The file.
        path: String,
        /// The reason.
        source: MeshError,
    },
}
