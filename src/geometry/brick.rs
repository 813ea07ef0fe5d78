//! Boxes of any orientation, about things that are long or flat.

use glam::DVec3;

/// A box: its middle, and half of its edges, which are at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Brick {
    pub(crate) middle: DVec3,
    pub(crate) halves: [DVec3; 3],
}

impl Brick {
    /// The brick about a cylinder, one of whose sides is along a line of sight.
    pub(crate) fn about([from, to]: [DVec3; 2], radius: f64, sight: DVec3) -> Self {
        let half = (to - from) / 2.0;
        let direction = half.normalize_or(DVec3::X);
        let across = direction.cross(sight);
        let across =
            across.try_normalize().unwrap_or_else(|| direction.any_orthonormal_vector()) * radius;
        Self { middle: from + half, halves: [half, across, direction.cross(across)] }
    }

    /// The corners; bit k of a corner's place says on which side it is of the edge k.
    pub(crate) fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|place| {
            let side = |k: usize| self.halves[k] * if place >> k & 1 == 0 { -1.0 } else { 1.0 };
            self.middle + side(0) + side(1) + side(2)
        })
    }
}
