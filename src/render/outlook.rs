//! What rays may still gain in each tile, so that a pass over the picture goes only where it changes something.

use serde::{Deserialize, Serialize};

use super::round::{Pixel, Threshold};
use crate::aa::{Sample, refined::Stage};

/// Rays that the corners of a suspect pixel cost, most being shared or not traced; and those of one that is not
/// suspect.
const SHARED_CORNERS: f32 = 0.6;
const OWN_CORNERS: f32 = 1.5;

/// What more rays are worth to a pixel.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Worth {
    /// Its squared error if it may get more rays, else 0; infinite if it is to get them whatever its error.
    pub(super) error: f32,
    /// The rays of all kinds that its next stage is taken to cost.
    pub(super) rays: f32,
    /// What it adds to the picture's squared error.
    pub(super) expected: f32,
}

impl Worth {
    /// The worth of a pixel whose centre is `center` and which adds `expected` to the picture's error.
    pub(super) fn of(pixel: &Pixel, expected: f32, stages: &[Stage], center: &Sample) -> Self {
        let Some(next) = stages.get(usize::from(pixel.stage)) else {
            return Self { error: 0.0, rays: 0.0, expected };
        };
        let camera_rays = match pixel.stage {
            0 if pixel.suspect => SHARED_CORNERS,
            0 => OWN_CORNERS,
            _ => (next.points - pixel.points()) as f32,
        };
        let error = if pixel.is_due() { f32::INFINITY } else { pixel.error };
        Self { error, rays: camera_rays * center.rays as f32, expected }
    }

    /// Whether the pixel is above the threshold and may get more rays.
    #[inline]
    pub(super) fn exceeds(&self, threshold: Threshold) -> bool {
        let limit = match threshold {
            Threshold::Error(limit) => limit,
            Threshold::PerRay(limit) | Threshold::PerRayOfSome(limit, ..) => limit * self.rays,
        };
        (self.error > 0.0) & (self.error >= limit)
    }
}

/// What is known of the pixels of a tile.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Outlook {
    /// The largest error that more rays may lessen, and the largest for each ray.
    error: f32,
    per_ray: f32,
    /// What the pixels add to the picture's squared error.
    pub(super) expected: f64,
}

impl Outlook {
    /// The outlook of a tile's pixels, row by row.
    pub(super) fn of(pixels: &[Pixel]) -> Self {
        pixels.iter().fold(Self::default(), |outlook, Pixel { worth, .. }| {
            let (error, rays) = (worth.error, worth.rays);
            let per_ray = if error > 0.0 { error / rays } else { 0.0 };
            Self {
                error: outlook.error.max(error),
                per_ray: outlook.per_ray.max(per_ray),
                expected: outlook.expected + f64::from(worth.expected),
            }
        })
    }

    /// Whether any pixel that is off may get more rays.
    pub(super) fn can_improve(&self) -> bool {
        self.error > 0.0
    }

    /// Whether a pixel is to get more rays whatever its error.
    pub(super) fn is_due(&self) -> bool {
        self.error == f32::INFINITY
    }

    /// Whether a pixel may be above the threshold; never false if one is.
    pub(super) fn may_exceed(&self, threshold: Threshold) -> bool {
        // A quotient and a product may be rounded to different sides.
        const ROUNDING: f32 = 1.0 + 1e-5;
        self.can_improve()
            && match threshold {
                Threshold::Error(limit) => self.error >= limit,
                Threshold::PerRay(limit) | Threshold::PerRayOfSome(limit, ..) => {
                    self.per_ray * ROUNDING >= limit
                }
            }
    }
}
