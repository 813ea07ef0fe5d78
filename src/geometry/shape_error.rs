//! What makes a shape invalid.

use glam::DVec3;
use thiserror::Error;

use crate::math::scale;

/// Why a shape cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A coordinate is infinite or not a number.
    #[error("`{name}` is ({value}), but must be finite")]
    NotFinite {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// A length is zero, negative, infinite or not a number.
    #[error("`{name}` is {value}, but must be positive and finite")]
    NotPositive {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The two ends of an axis are the same point.
    #[error("`{from}` and `{to}` are both ({at}), but must be apart")]
    NoAxis {
        /// One end.
        from: &'static str,
        /// The other.
        to: &'static str,
        /// Where both are.
        at: DVec3,
    },
    /// A flat shape has no area.
    #[error("the corners lie on one line, but must span an area")]
    NoArea,
    /// The parts of a polygon that crosses itself cancel out.
    #[error("the outline crosses itself and its sides cancel out; give the corners in order")]
    NoSide,
    /// A polygon has fewer than three corners.
    #[error("the polygon has {count} corners, but needs at least 3")]
    TooFewVertices {
        /// How many it has.
        count: usize,
    },
    /// A polygon's corners are not in one plane.
    #[error("corner {index} of the polygon is off the plane of the others (corners count from 0)")]
    NotFlat {
        /// The corner, counted from 0.
        index: usize,
    },
    /// A polygon's outline is that of a star.
    #[error("the outline of the polygon goes round more than once; give the corners in order")]
    TurnsTwice,
    /// A polygon is not convex.
    #[error("the polygon is not convex at corner {index} (corners count from 0)")]
    NotConvex {
        /// The corner, counted from 0.
        index: usize,
    },
}

impl ShapeError {
    pub(super) fn check_point(name: &'static str, value: DVec3) -> Result<(), Self> {
        if value.is_finite() { Ok(()) } else { Err(Self::NotFinite { name, value }) }
    }

    pub(super) fn check_length(name: &'static str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotPositive { name, value })
        }
    }

    /// The unit vector from one end of an axis to the other, and their distance.
    pub(super) fn check_axis(
        (from, p): (&'static str, DVec3),
        (to, q): (&'static str, DVec3),
    ) -> Result<(DVec3, f64), Self> {
        Self::check_point(from, p)?;
        Self::check_point(to, q)?;
        let (axis, e) = scale::normalized(q - p);
        let length = axis.length();
        if !(length > 0.0) {
            return Err(Self::NoAxis { from, to, at: p });
        }
        let distance = scale::scaled(DVec3::splat(length), -e).x;
        Self::check_length("height", distance)?;
        Ok((axis / length, distance))
    }
}
