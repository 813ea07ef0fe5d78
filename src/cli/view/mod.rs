//! `whitted view`: a window to look around in; and the window of `render --preview`.

#[cfg(feature = "view")]
mod camera_text;
#[cfg(feature = "view")]
mod controls;
#[cfg(feature = "view")]
mod pane;
#[cfg(feature = "view")]
mod preview;
#[cfg(feature = "view")]
mod text;
#[cfg(feature = "view")]
mod viewer;
#[cfg(feature = "view")]
mod window;
#[cfg(feature = "view")]
mod work;

#[cfg(feature = "view")]
pub(crate) use preview::PreviewWindow;

use super::args::ViewArgs;
use super::failure::Failure;
#[cfg(not(feature = "view"))]
use super::{warnings::Warnings, watch::Course};
#[cfg(not(feature = "view"))]
use whitted::checkpoint::Job;

/// Opens the window, and ends when it is closed.
#[cfg(feature = "view")]
pub(crate) fn run(args: &ViewArgs) -> Result<(), Failure> {
    let events = window::open_display()?;
    let loaded = args.seen.load(None)?;
    super::failure::warn(&loaded.warnings, args.strict, args.quiet)?;
    window::run(events, viewer::Viewer::new(loaded.scene, args))
}

/// A program without windows says how to get one that has them.
#[cfg(not(feature = "view"))]
pub(crate) fn run(_args: &ViewArgs) -> Result<(), Failure> {
    let message = "this program was built without windows; `cargo install --path . --features view` builds one that has them";
    Err(anyhow::anyhow!(message).into())
}

/// A program without windows has none to show.
#[cfg(not(feature = "view"))]
pub(crate) enum PreviewWindow {}

#[cfg(not(feature = "view"))]
impl PreviewWindow {
    pub(crate) fn open() -> Option<Self> {
        None
    }

    pub(crate) fn show(&mut self, _: &Job, _: &Course, _: &Warnings) {
        match *self {}
    }
}
