//! What rays may still gain in each tile, so that a pass over the picture goes only where it changes something.

use serde::{Deserialize, Serialize};

use super::{
    plane::{Area, Plane, TILE_SIDE},
    round::{Pixel, Threshold, next_rays},
};
use crate::aa::{Sample, refined::Stage};

/// What is known of the pixels of a tile.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Outlook {
    /// The largest squared error of a pixel that may get more rays; infinite if one is to get them whatever its error.
    error: f32,
    /// The largest for each ray of a pixel's next stage.
    per_ray: f32,
    /// What the pixels add to the picture's squared error.
    pub(super) expected: f64,
}

impl Outlook {
    /// The outlook of a tile's pixels.
    pub(super) fn of(
        tile: &Area,
        pixels: &[Pixel],
        stages: &[Stage],
        centers: &Plane<Sample>,
    ) -> Self {
        let mut outlook = Self::default();
        for ((x, y), pixel) in tile.pixels().zip(pixels) {
            outlook.expected += f64::from(pixel.expected);
            if let Some(rays) = next_rays(stages, pixel, centers.at(x, y)) {
                let error = if pixel.is_due() { f32::INFINITY } else { pixel.error };
                outlook.error = outlook.error.max(error);
                outlook.per_ray = outlook.per_ray.max(error / rays);
            }
        }
        outlook
    }

    /// Whether any pixel that is off may get more rays.
    pub(super) fn can_improve(&self) -> bool {
        self.error > 0.0
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

/// Room for the outlooks of the tiles of `area`.
pub(super) fn outlooks(area: &Area) -> Plane<Outlook> {
    let side = TILE_SIDE as usize;
    let (columns, rows) = (area.width().div_ceil(side), area.height().div_ceil(side));
    let tiles = Area { x0: 0, y0: 0, x1: columns as i64, y1: rows as i64 };
    Plane::new(tiles, Outlook::default())
}

/// Column and row of the tile of `area` that holds a pixel.
pub(super) fn tile_of(area: &Area, x: i64, y: i64) -> (i64, i64) {
    ((x - area.x0) / i64::from(TILE_SIDE), (y - area.y0) / i64::from(TILE_SIDE))
}
