//! Point lights.

use glam::DVec3;

use crate::color::Rgb;

/// A light at a point, as bright near as far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it is, in the coordinates of what it belongs to: once a [`Scene`](crate::scene::Scene) holds it, the
    /// scene's own.
    pub position: DVec3,
    /// The light that arrives at any point that sees it.
    pub intensity: Rgb,
}
