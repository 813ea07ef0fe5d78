//! What rays may still gain in each tile, so that a pass over the picture goes only where it changes something.

use serde::{Deserialize, Serialize};

use super::{
    look::ONE_COLOR,
    round::{Pixel, Threshold},
};
use crate::aa::{Sample, refined::Stage};

/// Rays that the corners of a suspect pixel cost, most being shared or not traced; and those of one that is not
/// suspect.
const SHARED_CORNERS: f32 = 0.6;
const OWN_CORNERS: f32 = 1.5;

/// The part of the thin things that are expected to show, before any sample met them: others are hidden, or like what is
/// behind them.
const SHOWN: f32 = 0.25;

/// What more rays are worth to a pixel.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Worth {
    /// Its squared error if it may get more rays, else 0; infinite if it is to get them whatever its error.
    pub(super) error: f32,
    /// The same, but never infinite: what it goes by where there may not be time for all that are to get rays.
    pub(super) if_short: f32,
    /// The rays of all kinds that its next stage is taken to cost.
    pub(super) rays: f32,
    /// What it adds to the picture's squared error.
    pub(super) expected: f32,
}

impl Worth {
    /// The worth of a pixel whose centre is `center` and which adds `expected` to the picture's error.
    pub(super) fn of(pixel: &Pixel, expected: f32, stages: &[Stage], center: &Sample) -> Self {
        let Some(next) = stages.get(usize::from(pixel.stage)) else {
            return Self { expected, ..Self::default() };
        };
        let camera_rays = match pixel.stage {
            0 if pixel.suspect => SHARED_CORNERS,
            0 => OWN_CORNERS,
            _ => (next.points - pixel.points()) as f32,
        };
        let rays = camera_rays * center.rays as f32;
        if pixel.is_due() {
            // Where neighbours differ in colour, the error tells.
            let is_told = pixel.suspect && pixel.contrast >= ONE_COLOR;
            let after = 1 + pixel.points();
            let unmet = if is_told { 0.0 } else { pixel.least.unmet_error(after) };
            let (if_short, expected) = (pixel.error.max(unmet), expected + SHOWN * unmet);
            return Self { error: f32::INFINITY, if_short, rays, expected };
        }
        Self { error: pixel.error, if_short: pixel.error, rays, expected }
    }

    /// The worth of a pixel that was off by `error` where all is smooth, and may get more rays.
    #[inline]
    pub(super) fn of_smooth(error: f32, expected: f32, center: &Sample) -> Self {
        Self { error, if_short: error, rays: OWN_CORNERS * center.rays as f32, expected }
    }

    /// Whether the pixel is above the threshold and may get more rays.
    #[inline]
    pub(super) fn exceeds(&self, threshold: Threshold) -> bool {
        let (error, limit) = match threshold {
            Threshold::Error(limit) => (self.error, limit),
            Threshold::PerRay(limit) => (self.error, limit * self.rays),
            Threshold::PerRayOfSome(limit, ..) => (self.if_short, limit * self.rays),
        };
        (error > 0.0) & (error >= limit)
    }
}

/// What is known of the pixels of a tile.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Outlook {
    /// The largest error that more rays may lessen, and the largest for each ray.
    error: f32,
    per_ray: f32,
    /// The latter where there may not be time for all.
    if_short: f32,
    /// What the pixels add to the picture's squared error.
    pub(super) expected: f64,
}

impl Outlook {
    /// The outlook of pixels of these worths, and of others that add so much to the picture's squared error.
    pub(super) fn of(settled: f64, worths: impl Iterator<Item = Worth>) -> Self {
        let settled = Self { expected: settled, ..Self::default() };
        worths.fold(settled, |outlook, worth| {
            let per_ray = |error: f32| if error > 0.0 { error / worth.rays } else { 0.0 };
            Self {
                error: outlook.error.max(worth.error),
                per_ray: outlook.per_ray.max(per_ray(worth.error)),
                if_short: outlook.if_short.max(per_ray(worth.if_short)),
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
                Threshold::PerRay(limit) => self.per_ray * ROUNDING >= limit,
                Threshold::PerRayOfSome(limit, ..) => self.if_short * ROUNDING >= limit,
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{aa::refined::stages, render::Least};

    #[test]
    fn pixels_to_be_sampled_come_first_unless_time_is_short() {
        let (stages, center) = (stages(64), Sample { rays: 3, ..Sample::default() });
        let worth = |samples: u32, error: f32| {
            let least = Least { samples, if_alike: 8 * samples, part: 1.0 / 32.0 };
            let pixel = Pixel { error, least, ..Pixel::default() };
            let worth = Worth::of(&pixel, error, &stages, &center);
            (worth, Outlook::of(0.0, [worth].into_iter()))
        };
        let late = |limit: f32| Threshold::PerRayOfSome(limit, 1.0, 7);
        let per_ray = 3.0 * OWN_CORNERS;
        for (samples, error, limit) in [(0, 45.0, 10.0), (4, 45.0, 10.0), (4, 1.0, 15.5 / per_ray)]
        {
            let (worth, outlook) = worth(samples, error);
            assert_eq!(outlook.is_due(), samples > 0);
            for (threshold, exceeds) in [
                (Threshold::Error(1e6), samples > 0),
                (Threshold::PerRay(1e6), samples > 0),
                (late(0.99 * limit), true),
                (late(1.01 * limit), false),
            ] {
                assert_eq!(worth.exceeds(threshold), exceeds, "{samples} {error} {threshold:?}");
                assert_eq!(
                    outlook.may_exceed(threshold),
                    exceeds,
                    "{samples} {error} {threshold:?}"
                );
            }
        }
    }

    /// Where a pixel skips cells of a pattern, those around it may all show the same colour by chance.
    #[test]
    fn a_pixel_of_its_neighbours_colour_is_sampled_also_if_time_is_short() {
        let (stages, center) = (stages(64), Sample { rays: 3, ..Sample::default() });
        let least = Least { samples: 8, if_alike: 8, part: 0.5 };
        let if_short = |contrast: f32| {
            let pixel = Pixel { suspect: true, contrast, error: 0.1, least, ..Pixel::default() };
            Worth::of(&pixel, 0.1, &stages, &center).if_short
        };
        assert!(if_short(0.0) > 1000.0);
        assert_eq!(if_short(1e4), 0.1);
    }
}
