//! What can go wrong with a picture file.

use std::io;
use std::path::PathBuf;

use super::FileError;

/// A picture could not be read, written or compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file's extension names no picture format.
    #[error("{}: {}; end the name with one of: {known}", path.display(), extension_fault(extension))]
    UnknownExtension {
        /// The file as given.
        path: PathBuf,
        /// Its extension, empty if it has none.
        extension: String,
        /// The extensions there are.
        known: &'static str,
    },
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file cannot be opened or read.
    #[error("{}: the picture cannot be read ({source})", path.display())]
    Read {
        /// The file as given.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is of another kind.
    #[error("{}: not a PNG file, and no other pictures can be compared; write or convert it to PNG", path.display())]
    NotPng {
        /// The file as given.
        path: PathBuf,
    },
    /// The file is a damaged picture.
    #[error("{}: not a valid PNG file ({source})", path.display())]
    Decode {
        /// The file as given.
        path: PathBuf,
        /// What the decoder says.
        source: image::ImageError,
    },
    /// Two pictures of different size have no difference.
    #[error(
        "the pictures are {}x{} and {}x{} pixels; only pictures of the same size can be compared",
        a[0], a[1], b[0], b[1]
    )]
    SizesDiffer {
        /// Width and height of the first.
        a: [u32; 2],
        /// Width and height of the second.
        b: [u32; 2],
    },
    /// A picture without pixels has no errors to average.
    #[error("the pictures have no pixels; compare pictures of at least 1x1")]
    Empty,
}

fn extension_fault(extension: &str) -> String {
    if extension.is_empty() {
        "has no extension that tells the picture format".to_owned()
    } else {
        format!("unknown picture format `.{extension}`")
    }
}
