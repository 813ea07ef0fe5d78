//! Whether a picture file is there already.

use std::fs::File;

use whitted::film::{Label, read_label};

use super::target::Picture;

/// Whether the file holds the whole picture that `label` describes.
pub(crate) fn is_finished(picture: &Picture, label: &Label) -> bool {
    let Some(file) = picture.path().and_then(|path| File::open(path).ok()) else { return false };
    read_label(file).is_ok_and(|found| found.as_ref() == Some(label))
}
