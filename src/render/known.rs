//! What is known of the pixels of a picture that gets better.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    crew::{Crew, Sampler, lock},
    demand::Demand,
    hidden::hidden_error,
    hints::Hint,
    look::{ONE_COLOR, corrected},
    outlook::Outlook,
    patch::{FirstLook, Patch},
    plane::{Area, Plane, Tiled},
    round::{Pixel, Threshold},
    window::Window,
};
use crate::{
    aa::{Sample, estimate::Look, refined::Stage},
    color::Rgb,
};

/// The pixels around a tile or a picture whose centres say something of those in it: the neighbours of each, and theirs.
pub(super) const APRON: usize = 2;

/// Tiles that a thread takes at least, where all are gone through.
const TILES_AT_ONCE: usize = 64;

/// What is known of the pixels of an area.
#[derive(Serialize, Deserialize)]
pub(super) struct Known {
    area: Area,
    /// The squared error from which on pixels may be refined.
    least: f32,
    /// Of each tile.
    patches: Plane<Patch>,
    pub(super) colors: Plane<Rgb>,
    /// The rays through each pixel.
    pub(super) samples: Plane<u32>,
}

/// What may hide in pixels that look alike.
struct Unclear {
    /// Those of one colour with their neighbours, some of which met something else.
    of_one_color: Vec<(i64, i64)>,
    /// The contrast of all pixels to their neighbours, in those tiles in which anything is seen to change.
    contrasts: Tiled<f32>,
}

impl Known {
    /// Nothing.
    pub(super) fn new(area: &Area) -> Self {
        Self {
            area: *area,
            least: f32::INFINITY,
            patches: Plane::new(area.grid(), Patch::default()),
            colors: Plane::new(*area, Rgb::ZERO),
            samples: Plane::new(*area, 0),
        }
    }

    /// What the `centers` say of each pixel; those with a squared error from `least` on may be refined.
    pub(super) fn look<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        stages: &[Stage],
        centers: &Plane<Sample>,
        least: f32,
    ) {
        self.least = least;
        let (area, contrasts) = (self.area, Tiled::new(self.area));
        let unclear = Mutex::new(Unclear { of_one_color: Vec::new(), contrasts });
        let known = Mutex::new(&mut *self);
        crew.run(&area, |sampler, tile| {
            let survey = &Window::of_centers(tile, APRON, centers).survey();
            let own = &centers.part(tile);
            let hint = |x: i64, y: i64| sampler.hint(x as u32, y as u32);
            let is_hinted =
                crew.has_hints && tile.pixels().any(|(x, y)| hint(x, y) != Hint::default());
            let hint = is_hinted.then_some(hint);
            let look = FirstLook { tile, survey, own, centers, hint, stages, least };
            let calm = look.calm();
            if calm.is_none() {
                let alike = survey.suspects.iter().filter(|(_, look)| look.contrast < ONE_COLOR);
                let alike = alike.map(|(place, _)| tile.pixel_at(*place));
                let contrasts = survey.contrasts();
                let mut unclear = lock(&unclear);
                unclear.of_one_color.extend(alike);
                *unclear.contrasts.of_mut(tile) = contrasts;
            }
            let patch = calm.unwrap_or_else(|| look.patch());
            let colors = colors_of(tile, &survey.suspects, centers);
            let mut samples = Vec::with_capacity(tile.len());
            samples.extend(own.iter().map(|center| u32::from(center.rays > 0)));
            let mut known = lock(&known);
            *known.patch_mut(tile.x0, tile.y0) = patch;
            known.colors.put(tile, colors);
            known.samples.put(tile, samples);
        });
        self.expect_hidden(unclear.into_inner().unwrap_or_else(PoisonError::into_inner));
    }

    /// The squared error from which on pixels may be refined.
    pub(super) fn least(&self) -> f32 {
        self.least
    }

    /// The same as [`Known::look`] for a smaller `least`, after some pixels were refined, which stay as they are.
    pub(super) fn look_closer<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        stages: &[Stage],
        centers: &Plane<Sample>,
        least: f32,
    ) {
        let before = self.take_patches();
        self.look(crew, stages, centers, least);
        let mut patches = self.take_patches();
        for (patch, before) in patches.values_mut().iter_mut().zip(before.into_values()) {
            // In the same order, and none is missing.
            let mut refined = before.pixels.into_iter().filter(|pixel| pixel.stage > 0).peekable();
            for pixel in &mut patch.pixels {
                let is_same = |other: &Pixel| (other.x, other.y) == (pixel.x, pixel.y);
                if let Some(refined) = refined.next_if(is_same) {
                    *pixel = Pixel { has_changed: true, ..refined };
                }
            }
            self.show(&mut patch.pixels, centers);
            *patch = std::mem::take(patch).looked_over();
        }
        self.patches = patches;
    }

    fn take_patches(&mut self) -> Plane<Patch> {
        let none = Plane::new(self.area.grid(), Patch::default());
        std::mem::replace(&mut self.patches, none)
    }

    /// Adds what may hide to what the picture is expected to be off by.
    fn expect_hidden(&mut self, Unclear { mut of_one_color, contrasts }: Unclear) {
        // Sums depend on their order, which that of the tiles must not.
        of_one_color.sort_unstable_by_key(|&(x, y)| (y, x));
        let contrast_at = |x, y| contrasts.get(x, y).copied().unwrap_or(0.0);
        for (x, y) in of_one_color {
            self.patch_mut(x, y).expect(x, y, hidden_error(contrast_at, x, y));
        }
    }

    /// What is known of the tile that holds a pixel.
    fn patch(&self, x: i64, y: i64) -> &Patch {
        let (column, row) = self.area.tile_of(x, y);
        self.patches.at(column, row)
    }

    fn patch_mut(&mut self, x: i64, y: i64) -> &mut Patch {
        let (column, row) = self.area.tile_of(x, y);
        self.patches.at_mut(column, row)
    }

    /// The outlook of the tile that holds a pixel.
    pub(super) fn outlook(&self, x: i64, y: i64) -> &Outlook {
        &self.patch(x, y).outlook
    }

    /// The outlooks of all tiles.
    pub(super) fn outlooks(&self) -> impl Iterator<Item = &Outlook> {
        self.patches.values().iter().map(|patch| &patch.outlook)
    }

    /// The pixels that may be refined, or were.
    pub(super) fn pixels(&self) -> impl Iterator<Item = &Pixel> {
        self.patches.values().iter().flat_map(|patch| &patch.pixels)
    }

    /// The pixels of a part of the area that are above the threshold, tile by tile.
    pub(super) fn above(&self, part: &Area, threshold: Threshold) -> impl Iterator<Item = &Pixel> {
        let ((left, top), (right, bottom)) =
            (self.area.tile_of(part.x0, part.y0), self.area.tile_of(part.x1 - 1, part.y1 - 1));
        let tiles = Area { x0: left, y0: top, x1: right + 1, y1: bottom + 1 };
        let part = *part;
        tiles
            .pixels()
            .flat_map(|(column, row)| &self.patches.at(column, row).pixels)
            .filter(move |pixel| part.contains(pixel.x, pixel.y) && pixel.is_above(threshold))
    }

    /// Takes out the pixels of a tile if any may be above the threshold.
    pub(super) fn take(&mut self, tile: &Area, threshold: Threshold) -> Vec<Pixel> {
        let patch = self.patch_mut(tile.x0, tile.y0);
        if patch.outlook.may_exceed(threshold) {
            std::mem::take(&mut patch.pixels)
        } else {
            Vec::new()
        }
    }

    /// Takes over the colours of those that got samples.
    pub(super) fn show(&mut self, pixels: &mut [Pixel], centers: &Plane<Sample>) {
        for pixel in pixels.iter_mut().filter(|pixel| pixel.has_changed) {
            pixel.has_changed = false;
            let Some(refined) = &pixel.refined else { continue };
            let (x, y) = (pixel.x, pixel.y);
            *self.colors.at_mut(x, y) = refined.color();
            // Corners that only neighbours wanted do not count, or it would depend on whether those are rendered.
            let own = pixel.needs_corner(centers, x, y);
            *self.samples.at_mut(x, y) = 1 + u32::from(own) + refined.points();
        }
    }

    /// Puts them back.
    pub(super) fn put_back(&mut self, tile: &Area, pixels: Vec<Pixel>) {
        let patch = self.patch_mut(tile.x0, tile.y0);
        *patch = Patch { pixels, ..std::mem::take(patch) }.looked_over();
    }

    /// What the next stages of all pixels are worth, and take; `is_short` as for [`Demand::of`].
    pub(super) fn demand(&self, is_short: bool) -> Demand {
        let of_some = |patches: &[Patch]| {
            let mut demand = Demand::of(0, is_short);
            for Patch { pixels, settled, .. } in patches {
                demand.settle(*settled);
                for pixel in pixels {
                    demand.add(&pixel.worth);
                }
            }
            demand
        };
        let parts: Vec<Demand> =
            self.patches.values().par_chunks(TILES_AT_ONCE).map(of_some).collect();
        // In the order of the tiles, on which sums depend.
        parts.iter().fold(Demand::of(self.area.len(), is_short), Demand::and)
    }
}

/// Their colours, corrected where the neighbours at the sides met the same.
fn colors_of(tile: &Area, suspects: &[(usize, Look)], centers: &Plane<Sample>) -> Vec<Rgb> {
    let mut colors = corrected(tile, centers);
    for (place, _) in suspects.iter().filter(|(_, look)| !look.inner) {
        let (x, y) = tile.pixel_at(*place);
        colors[*place] = centers.at(x, y).color;
    }
    colors
}
