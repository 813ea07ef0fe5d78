//! Numbers and colours of a description, checked, and notes of what is wrong with it.

use super::{desc::ColorSpace, error::SceneError, format::Place};
use crate::color::{Rgb, from_srgb};

/// What was found wrong with a description, and where.
pub(super) type Found = Vec<(Place, SceneError)>;

/// The value, or a note of why there is none.
pub(super) fn note<T>(
    found: &mut Found,
    place: impl Fn() -> Place,
    result: Result<T, SceneError>,
) -> Option<T> {
    result.map_err(|error| found.push((place(), error))).ok()
}

/// A colour, linear.
pub(super) fn color(
    place: &str,
    name: &'static str,
    channels: [f64; 3],
    space: ColorSpace,
) -> Result<Rgb, SceneError> {
    for value in channels {
        check(place, name, value, "from 0 to 1 in each channel", (0.0..=1.0).contains(&value))?;
    }
    Ok(match space {
        ColorSpace::Srgb => from_srgb(channels),
        ColorSpace::Linear => Rgb::from_array(channels.map(|c| c as f32)),
    })
}

/// Whether the value is at least zero.
pub(super) fn at_least_zero(place: &str, name: &'static str, value: f64) -> Result<(), SceneError> {
    check(place, name, value, "zero or positive, and finite", value >= 0.0 && value.is_finite())
}

/// The error of a value that is not in its range.
pub(super) fn check(
    place: &str,
    name: &'static str,
    value: f64,
    range: &'static str,
    is_in: bool,
) -> Result<(), SceneError> {
    if is_in {
        Ok(())
    } else {
        Err(SceneError::Value { place: place.to_owned(), name, value, range })
    }
}
