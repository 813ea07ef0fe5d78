//! Anti-aliasing: which places of a pixel are asked for their colour, what the pixel becomes, and how far off it is.

pub mod detail;
pub mod estimate;
pub mod kinds;
pub mod levels;
pub mod lines;
pub mod pattern;
pub mod refined;
pub mod sobol;

use std::{fmt, str::FromStr};

use glam::DVec2;
use thiserror::Error;

pub use refined::Sample;

/// The largest grid: 64 × 64 rays per pixel.
const LARGEST_SIDE: u32 = 64;
/// The most rays per pixel that `adaptive` may be given.
pub const MOST_RAYS: u32 = 1 << 20;
/// What `adaptive` aims at in each pixel unless told otherwise, in levels of 255.
const DEFAULT_ERROR: f32 = 4.0;
/// The most rays per pixel of `adaptive` unless told otherwise.
const DEFAULT_MOST: u32 = 64;

/// How a pixel is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AntiAliasing {
    /// One ray through the centre.
    None,
    /// Rays through the centres of `side` × `side` cells.
    Grid {
        /// Cells along a side of the pixel, from 1 to 64.
        side: u32,
    },
    /// As many rays in each pixel, at the places of a [sequence](sobol::Sequence) other than that of `Adaptive`: for
    /// references.
    Sequence {
        /// Rays through each pixel, from 1 to 2²⁰; best a power of two.
        count: u32,
    },
    /// Rays where the picture needs them: one through each centre, more where those of neighbours met different things
    /// or differ in colour, until the pixel's estimated error is below `error` or `most` rays are spent.
    Adaptive {
        /// The error of a pixel that is good enough: root mean square of its channels, in levels of 255.
        error: f32,
        /// The most rays through a pixel, from 1 to 2²⁰; 2 or 3 are as 1, since what a pixel gets after its centre is at least
        /// three.
        most: u32,
    },
}

/// Why a text names no anti-aliasing mode.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AaError {
    /// The mode is not known.
    #[error(
        "unknown anti-aliasing mode `{text}` (known: none, grid:N with N from 1 to 64, adaptive, \
         adaptive:ERROR, adaptive:ERROR,MAX; for references, sobol:N with N rays in each pixel)"
    )]
    UnknownMode {
        /// What was read.
        text: String,
    },
    /// The grid is empty, too large or not a number.
    #[error(
        "anti-aliasing mode {} needs a whole number of rays along a pixel's side, from 1 to 64",
        with_number("grid", side)
    )]
    Side {
        /// What was read behind the colon.
        side: String,
    },
    /// The sequence is empty, too long or not a number.
    #[error(
        "anti-aliasing mode {} needs a whole number of rays, from 1 to 1048576",
        with_number("sobol", count)
    )]
    Count {
        /// What was read behind the colon.
        count: String,
    },
    /// The error of a pixel is negative or not a number.
    #[error("anti-aliasing mode `adaptive:{text}` needs an error in levels of 255, zero or more")]
    Error {
        /// What was read behind the colon.
        text: String,
    },
    /// The most rays of a pixel are none, too many or not a number.
    #[error(
        "anti-aliasing mode `adaptive:{text}` needs a whole number of rays per pixel after the comma, from 1 to 1048576"
    )]
    Most {
        /// What was read behind the colon.
        text: String,
    },
}

/// The mode with what was read for its number; with N where there was nothing.
fn with_number(mode: &str, read: &str) -> String {
    format!("`{mode}:{}`", if read.is_empty() { "N" } else { read })
}

impl Default for AntiAliasing {
    /// The adaptive mode.
    fn default() -> Self {
        Self::ADAPTIVE
    }
}

impl AntiAliasing {
    /// The adaptive mode as it is without further numbers: errors of 4 levels, 64 rays per pixel.
    pub const ADAPTIVE: Self = Self::Adaptive { error: DEFAULT_ERROR, most: DEFAULT_MOST };

    /// Whether its numbers are those of a mode.
    ///
    /// # Errors
    /// Those of reading it from text.
    pub fn check(self) -> Result<(), AaError> {
        self.to_string().parse::<Self>().map(|_| ())
    }

    /// The side of what a sample stands for, in pixels: that of the whole pixel where samples are added as they are needed.
    pub(crate) fn side_of_sample(self) -> f64 {
        match self {
            Self::None | Self::Adaptive { .. } => 1.0,
            Self::Grid { side } => 1.0 / f64::from(side),
            Self::Sequence { count } => 1.0 / f64::from(count).sqrt(),
        }
    }
}

/// The places of a grid's samples in the pixel whose upper left corner on the film is `corner`, row by row.
pub fn grid_places(corner: DVec2, side: u32) -> impl Iterator<Item = DVec2> {
    (0..side).flat_map(move |row| {
        (0..side).map(move |column| {
            let cell = DVec2::new(f64::from(column), f64::from(row));
            corner + (cell + 0.5) / f64::from(side)
        })
    })
}

impl fmt::Display for AntiAliasing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => write!(f, "none"),
            Self::Grid { side } => write!(f, "grid:{side}"),
            Self::Sequence { count } => write!(f, "sobol:{count}"),
            Self::Adaptive { error, most } => write!(f, "adaptive:{error},{most}"),
        }
    }
}

impl FromStr for AntiAliasing {
    type Err = AaError;

    fn from_str(text: &str) -> Result<Self, AaError> {
        match text.split_once(':') {
            None if text == "none" => Ok(Self::None),
            None if text == "adaptive" => Ok(Self::ADAPTIVE),
            Some(("grid", side)) => match side.parse() {
                Ok(side @ 1..=LARGEST_SIDE) => Ok(Self::Grid { side }),
                _ => Err(AaError::Side { side: side.to_owned() }),
            },
            Some(("sobol", count)) => match count.parse() {
                Ok(count @ 1..=MOST_RAYS) => Ok(Self::Sequence { count }),
                _ => Err(AaError::Count { count: count.to_owned() }),
            },
            Some(("adaptive", numbers)) => adaptive(numbers),
            _ if text == "sobol" => Err(AaError::Count { count: String::new() }),
            _ if text == "grid" => Err(AaError::Side { side: String::new() }),
            _ => Err(AaError::UnknownMode { text: text.to_owned() }),
        }
    }
}

/// `ERROR` or `ERROR,MAX`.
fn adaptive(numbers: &str) -> Result<AntiAliasing, AaError> {
    let (error, most) = match numbers.split_once(',') {
        Some((error, most)) => (error, Some(most)),
        None => (numbers, None),
    };
    let error = match error.parse::<f32>() {
        Ok(value) if value >= 0.0 && value.is_finite() => value.abs(), // -0 is 0
        _ => return Err(AaError::Error { text: numbers.to_owned() }),
    };
    let most = match most.map(str::parse) {
        None => DEFAULT_MOST,
        Some(Ok(most @ 1..=MOST_RAYS)) => most,
        Some(_) => return Err(AaError::Most { text: numbers.to_owned() }),
    };
    Ok(AntiAliasing::Adaptive { error, most })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the places a, b in {(k + 0.5)/2} of the scene's description.
    #[test]
    fn two_by_two_rays_go_through_quarters() {
        let places: Vec<_> = grid_places(DVec2::new(10.0, 20.0), 2).map(|p| (p.x, p.y)).collect();
        assert_eq!(places, [(10.25, 20.25), (10.75, 20.25), (10.25, 20.75), (10.75, 20.75)]);
    }

    #[test]
    fn modes_are_read_as_they_are_written() {
        for text in
            ["none", "grid:1", "grid:2", "grid:64", "adaptive:4,64", "adaptive:0.5,1", "sobol:1024"]
        {
            assert_eq!(text.parse::<AntiAliasing>().expect(text).to_string(), text);
        }
        assert_eq!("adaptive".parse(), Ok(AntiAliasing::ADAPTIVE));
        assert_eq!("adaptive:2".parse(), Ok(AntiAliasing::Adaptive { error: 2.0, most: 64 }));
        for text in
            ["grid:0", "grid:65", "grid:", "grid", "grid:-1", "grid:2.5", "grid:99999999999"]
        {
            assert!(matches!(text.parse::<AntiAliasing>(), Err(AaError::Side { .. })), "{text}");
        }
        let message = |text: &str| text.parse::<AntiAliasing>().expect_err(text).to_string();
        assert!(message("grid").starts_with("anti-aliasing mode `grid:N` needs a whole number"));
        assert!(message("grid:x").starts_with("anti-aliasing mode `grid:x` needs a whole number"));
        let is_taken = |most: u32| format!("adaptive:0,{most}").parse::<AntiAliasing>().is_ok();
        assert!(is_taken(1_048_576) && !is_taken(1_048_577));
        for text in ["sobol", "sobol:", "sobol:0", "sobol:-1", "sobol:1.5"] {
            assert!(matches!(text.parse::<AntiAliasing>(), Err(AaError::Count { .. })), "{text}");
        }
        for text in [
            "adaptive:",
            "adaptive:-1",
            "adaptive:nan",
            "adaptive:inf",
            "adaptive:x,3",
            "adaptive:,3",
        ] {
            assert!(matches!(text.parse::<AntiAliasing>(), Err(AaError::Error { .. })), "{text}");
        }
        for text in
            ["adaptive:1,", "adaptive:1,0", "adaptive:1,-3", "adaptive:1,2,3", "adaptive:1,1.5"]
        {
            assert!(matches!(text.parse::<AntiAliasing>(), Err(AaError::Most { .. })), "{text}");
        }
        for text in ["", "None", "adaptiv", "none:3", "grit:2", "adaptive=3"] {
            assert!(
                matches!(text.parse::<AntiAliasing>(), Err(AaError::UnknownMode { .. })),
                "{text}"
            );
        }
    }
}
