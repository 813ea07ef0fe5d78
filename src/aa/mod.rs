//! Anti-aliasing: which places of a pixel are asked for their colour, and what the pixel becomes.

use std::{fmt, str::FromStr};

use glam::DVec2;
use thiserror::Error;

use crate::color::Rgb;

/// The largest grid: 64 × 64 rays per pixel.
const LARGEST_SIDE: u32 = 64;

/// How a pixel is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AntiAliasing {
    /// One ray through the centre.
    None,
    /// Rays through the centres of `side` × `side` cells.
    Grid {
        /// Cells along a side of the pixel; from 1 to 64 in what is read from text.
        side: u32,
    },
}

/// Why a text names no anti-aliasing mode.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AaError {
    /// The mode is not known.
    #[error("unknown anti-aliasing mode `{text}` (known: none, grid:N with N from 1 to 64)")]
    UnknownMode {
        /// What was read.
        text: String,
    },
    /// The grid is empty, too large or not a number.
    #[error(
        "anti-aliasing mode `grid:{side}` needs a whole number of rays along a pixel's side, from 1 to 64"
    )]
    Side {
        /// What was read behind the colon.
        side: String,
    },
}

impl Default for AntiAliasing {
    /// Four rays per pixel, on a grid.
    fn default() -> Self {
        Self::Grid { side: 2 }
    }
}

impl AntiAliasing {
    /// The places in a pixel that are asked for their colour, in pixels from its upper left corner, row by row.
    pub fn places(self) -> Vec<DVec2> {
        let side = match self {
            Self::None => 1,
            Self::Grid { side } => side,
        };
        let along = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
        (0..side * side).map(|k| DVec2::new(along(k % side), along(k / side))).collect()
    }
}

/// The colour of a pixel from its samples: their mean, each clamped to `[0, 1]`, in linear light.
pub fn average(samples: &[Rgb]) -> Rgb {
    // A NaN, which no valid scene has, would be black.
    let sum: Rgb = samples.iter().map(|sample| sample.max(Rgb::ZERO).min(Rgb::ONE)).sum();
    sum / samples.len() as f32
}

impl fmt::Display for AntiAliasing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => write!(f, "none"),
            Self::Grid { side } => write!(f, "grid:{side}"),
        }
    }
}

impl FromStr for AntiAliasing {
    type Err = AaError;

    fn from_str(text: &str) -> Result<Self, AaError> {
        match text.split_once(':') {
            None if text == "none" => Ok(Self::None),
            Some(("grid", side)) => match side.parse() {
                Ok(side @ 1..=LARGEST_SIDE) => Ok(Self::Grid { side }),
                _ => Err(AaError::Side { side: side.to_owned() }),
            },
            _ if text == "grid" => Err(AaError::Side { side: String::new() }),
            _ => Err(AaError::UnknownMode { text: text.to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: an edge x < k covers exactly k of a pixel, so an n × n grid is off by at most 1/(2n).
    #[test]
    fn a_grid_is_off_by_half_a_cell_at_most() {
        for side in [1, 2, 3, 4, 16] {
            let places = AntiAliasing::Grid { side }.places();
            assert_eq!(places.len() as u32, side * side);
            for k in 0..=100 {
                let k = f64::from(k) / 100.0;
                let edge = |p: &DVec2| if p.x < k { Rgb::ONE } else { Rgb::ZERO };
                let pixel = average(&places.iter().map(edge).collect::<Vec<_>>());
                assert!(
                    (f64::from(pixel.x) - k).abs() <= 0.5 / f64::from(side) + 1e-7,
                    "{side}, {k}"
                );
            }
        }
    }

    /// Oracle: the places a, b in {(k + 0.5)/2} of the scene's description.
    #[test]
    fn two_by_two_rays_go_through_quarters() {
        let places: Vec<_> = AntiAliasing::default().places().iter().map(|p| (p.x, p.y)).collect();
        assert_eq!(places, [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]);
        assert_eq!(AntiAliasing::None.places(), [DVec2::splat(0.5)]);
    }

    #[test]
    fn samples_are_clamped_before_they_are_averaged() {
        assert_eq!(average(&[Rgb::splat(9.0), Rgb::ZERO]), Rgb::splat(0.5));
    }

    #[test]
    fn modes_are_read_as_they_are_written() {
        for text in ["none", "grid:1", "grid:2", "grid:64"] {
            assert_eq!(text.parse::<AntiAliasing>().expect(text).to_string(), text);
        }
        for text in
            ["grid:0", "grid:65", "grid:", "grid", "grid:-1", "grid:2.5", "grid:99999999999"]
        {
            assert!(matches!(text.parse::<AntiAliasing>(), Err(AaError::Side { .. })), "{text}");
        }
        for text in ["", "None", "adaptive", "none:3", "grit:2"] {
            assert!(
                matches!(text.parse::<AntiAliasing>(), Err(AaError::UnknownMode { .. })),
                "{text}"
            );
        }
    }
}
