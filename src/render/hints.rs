//! What the scene tells of pixels before any is sampled.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{
    highlights::mark_highlights,
    plane::{Area, Plane},
    thin::mark_thin,
};
use crate::{camera::View, scene::Scene};

/// What is known to be in a pixel, which few samples may miss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hint {
    /// The samples that it gets because of something thin.
    pub least: Least,
    /// The highlights narrower than it.
    pub glint: Glint,
}

/// The levels by which a thing is taken to differ from what is behind it, as long as nothing else is known of it.
const CONTRAST: f32 = 128.0;

/// How many samples a pixel gets at least, unless time is up before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Least {
    /// Whatever they meet.
    pub samples: u32,
    /// As long as all of them met the same; not fewer.
    pub if_alike: u32,
    /// The part of the pixel that is covered by what they are to meet.
    pub part: f32,
}

impl Least {
    /// Whether there is such a number.
    pub(super) fn is_some(self) -> bool {
        self.samples > 0
    }

    /// The squared error if it was not met, times the chance that so many samples did not meet it.
    pub(super) fn unmet_error(self, samples: u32) -> f32 {
        let part = self.part.min(0.5);
        (CONTRAST * part).powi(2) * (1.0 - part).powf(samples as f32)
    }

    /// What is needed for both.
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            samples: self.samples.max(other.samples),
            if_alike: self.if_alike.max(other.if_alike),
            part: self.part.max(other.part),
        }
    }
}

/// Highlights in a pixel that are narrower than it: seen by the camera and not in shadow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Glint {
    /// What they add to its light, in the brightest channel.
    pub light: f32,
    /// So many samples meet them all.
    pub samples: u32,
}

impl Glint {
    /// Both together.
    pub(super) fn and(self, other: Self) -> Self {
        Self { light: self.light + other.light, samples: self.samples.max(other.samples) }
    }
}

/// What the scene tells of a picture.
pub(super) struct Hints {
    /// Of the pixels of an area; none if it tells nothing of any.
    pub(super) pixels: Option<Plane<Hint>>,
    /// Whether there is a glint anywhere, in the area or not.
    pub(super) has_glints: bool,
}

impl Hints {
    /// What the scene tells of the pixels of an area.
    pub(super) fn of(scene: &Scene, view: &View, area: &Area) -> Self {
        let mut marks = Marks { area: *area, pixels: None };
        mark_thin(scene, view, &mut marks);
        let has_glints = mark_highlights(scene, view, &mut marks);
        Self { pixels: marks.pixels, has_glints }
    }
}

/// What is known of pixels so far.
pub(super) struct Marks {
    area: Area,
    pixels: Option<Plane<Hint>>,
}

impl Marks {
    /// Notes something in all pixels that come within `reach` of the way from `a` to `b`, all in pixels.
    pub(super) fn note(&mut self, [a, b]: [DVec2; 2], reach: f64, note: impl Fn(&mut Hint)) {
        let area = self.area;
        let clip = |x: f64, low: i64, high: i64| (x.floor() as i64).clamp(low, high);
        let (low, high) = (a.min(b) - reach, a.max(b) + reach);
        for y in clip(low.y, area.y0, area.y1)..clip(high.y + 1.0, area.y0, area.y1) {
            // The part of the way that comes near the row, and the columns that it crosses there.
            let (top, bottom) = (y as f64 - reach, y as f64 + 1.0 + reach);
            let at = |row: f64| ((row - a.y) / (b.y - a.y)).clamp(0.0, 1.0);
            let (s, t) = if a.y == b.y { (0.0, 1.0) } else { (at(top), at(bottom)) };
            let (p, q) = (a.x + (b.x - a.x) * s, a.x + (b.x - a.x) * t);
            let (left, right) = (p.min(q) - reach, p.max(q) + reach);
            for x in clip(left, area.x0, area.x1)..clip(right + 1.0, area.x0, area.x1) {
                let pixels = self.pixels.get_or_insert_with(|| Plane::new(area, Hint::default()));
                note(pixels.at_mut(x, y));
            }
        }
    }
}

/// A number of samples, at least that; the largest number there is, if that is not enough.
pub(super) fn samples(at_least: f64) -> u32 {
    at_least.ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the distance of each pixel's points to the way, on a fine grid of them.
    #[test]
    fn every_pixel_that_is_touched_is_noted_and_few_others() {
        let area = Area { x0: 0, y0: 0, x1: 20, y1: 16 };
        for (a, b, reach) in [
            (DVec2::new(3.3, 2.2), DVec2::new(3.3, 2.2), 0.3),
            (DVec2::new(1.5, 3.0), DVec2::new(18.2, 3.9), 0.02),
            (DVec2::new(4.1, -3.0), DVec2::new(5.3, 30.0), 0.4),
            (DVec2::new(15.0, 14.0), DVec2::new(2.0, 1.0), 0.1),
        ] {
            let mut marks = Marks { area, pixels: None };
            marks.note([a, b], reach, |known| known.glint.samples += 7);
            let noted = marks.pixels.expect("notes");
            let mut touched = 0;
            for (x, y) in area.pixels() {
                let near = (0..400).any(|k| {
                    let p = DVec2::new(
                        x as f64 + f64::from(k % 20) / 19.0,
                        y as f64 + f64::from(k / 20) / 19.0,
                    );
                    let t =
                        ((p - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
                    p.distance(a + (b - a) * t) < reach
                });
                touched += usize::from(near);
                assert!(!near || noted.at(x, y).glint.samples == 7, "{a} {b}: {x}, {y}");
            }
            let count = noted.values().iter().filter(|known| known.glint.samples > 0).count();
            assert!(count <= 2 * touched + 8, "{count} for {touched}");
        }
    }
}
