//! Whether a picture file is there already.

use std::fs::File;

use whitted::film::{Label, read_label};

use super::target::Picture;

/// What the file says of itself, if it holds the whole picture that `label` describes; it may have missed its goal.
pub(crate) fn find(picture: &Picture, label: &Label) -> Option<Label> {
    let found = read_label(File::open(picture.path()?).ok()?).ok()??;
    (Label { warning: None, ..found.clone() } == *label).then_some(found)
}
