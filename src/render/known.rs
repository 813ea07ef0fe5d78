//! What is known of the pixels of a picture that gets better.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    crew::{Crew, Sampler, in_turn, lock},
    demand::Demand,
    hidden::hidden_error,
    hints::{Hint, Least},
    look::{ONE_COLOR, corrected, skips_cells},
    outlook::{Outlook, Worth},
    plane::{Area, Plane, Tiled},
    round::{Chosen, Pixel, Threshold, is_picked},
    window::{Survey, Window},
};
use crate::{
    aa::{Sample, estimate::Look, refined::Stage},
    color::Rgb,
};

/// The samples that a pixel gets at least where a pattern's cells are no wider than it: its centre and corners, and
/// those of its neighbours, may all have met the same colour.
const LEAST_IN_CELLS: Least = Least { samples: 8, if_alike: 8, part: 0.5 };

/// The pixels around a tile or a picture whose centres say something of those in it: the neighbours of each, and theirs.
pub(super) const APRON: usize = 2;

/// The squared differences between a pixel of noise and its eight neighbours, as a multiple of the noise's variance.
const CONTRAST_OF_NOISE: f32 = 16.0;

/// Tiles that a thread takes at least, where all are gone through.
const TILES_AT_ONCE: usize = 64;

/// What is known of the pixels of an area.
#[derive(Serialize, Deserialize)]
pub(super) struct Known {
    /// Those of the tiles in which any is suspect or may be refined.
    pub(super) pixels: Tiled<Pixel>,
    /// What more rays are worth to each tile.
    pub(super) outlooks: Plane<Outlook>,
    pub(super) colors: Plane<Rgb>,
    /// The rays through each pixel.
    pub(super) samples: Plane<u32>,
}

impl Known {
    /// Nothing.
    pub(super) fn new(area: &Area) -> Self {
        Self {
            pixels: Tiled::new(*area),
            outlooks: Plane::new(area.grid(), Outlook::default()),
            colors: Plane::new(*area, Rgb::ZERO),
            samples: Plane::new(*area, 0),
        }
    }

    /// What the `centers` say of each pixel; thresholds to refine by go down to `least`.
    pub(super) fn look<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        stages: &[Stage],
        centers: &Plane<Sample>,
        least: Threshold,
    ) {
        let area = *self.pixels.area();
        let has_hints = crew.has_hints;
        let of_one_color = Mutex::new(Vec::new());
        let known = Mutex::new(&mut *self);
        crew.run(&area, |sampler, tile| {
            let survey = Window::of_centers(tile, APRON, centers).survey();
            let own = centers.part(tile);
            let hint = |(x, y): (i64, i64)| sampler.hint(x as u32, y as u32);
            let has_hints = has_hints && tile.pixels().any(|at| hint(at) != Hint::default());
            let may_be_calm = survey.suspects.is_empty() && !stages.is_empty();
            let is_calm = |outlook: &Outlook| may_be_calm && !outlook.may_exceed(least);
            let smooth = (may_be_calm && !has_hints).then(|| smooth_outlook(&survey, &own));
            let (outlook, pixels) = if let Some(calm) = smooth.filter(is_calm) {
                (calm, Vec::new())
            } else {
                let mut pixels = pixels_of(tile, &survey, &own, centers);
                for ((pixel, center), at) in pixels.iter_mut().zip(&own).zip(tile.pixels()) {
                    let mut expected = pixel.worth.expected;
                    if has_hints {
                        expected += pixel.heed(hint(at), center.color);
                    }
                    pixel.worth = Worth::of(pixel, expected, stages, center);
                }
                (Outlook::of(pixels.iter().map(|pixel| pixel.worth)), pixels)
            };
            let alike = survey.suspects.iter().filter(|(_, look)| look.contrast < ONE_COLOR);
            lock(&of_one_color).extend(alike.map(|(place, _)| tile.pixel_at(*place)));
            let colors = colors_of(tile, &survey.suspects, centers);
            let mut samples = Vec::with_capacity(tile.len());
            samples.extend(own.iter().map(|center| u32::from(center.rays > 0)));
            let mut known = lock(&known);
            *known.outlook_mut(tile.x0, tile.y0) = outlook;
            known.colors.put(tile, colors);
            known.samples.put(tile, samples);
            // Also where some were known of a tile whose centres were not all traced.
            *known.pixels.of_mut(tile) = if is_calm(&outlook) { Vec::new() } else { pixels };
        });
        self.expect_hidden(of_one_color.into_inner().unwrap_or_else(PoisonError::into_inner));
    }

    /// Adds what may hide at these places to what the picture is expected to be off by.
    fn expect_hidden(&mut self, mut places: Vec<(i64, i64)>) {
        // Sums depend on their order, which that of the tiles must not.
        places.sort_unstable_by_key(|&(x, y)| (y, x));
        for (x, y) in places {
            let contrast_at = |x, y| self.pixels.get(x, y).map_or(0.0, |pixel| pixel.contrast);
            let hidden = hidden_error(contrast_at, x, y);
            if let Some(pixel) = self.pixels.get_mut(x, y) {
                pixel.worth.expected += hidden;
            }
            self.outlook_mut(x, y).expected += f64::from(hidden);
        }
    }

    /// The outlook of the tile that holds a pixel.
    pub(super) fn outlook(&self, x: i64, y: i64) -> &Outlook {
        let (column, row) = self.pixels.area().tile_of(x, y);
        self.outlooks.at(column, row)
    }

    fn outlook_mut(&mut self, x: i64, y: i64) -> &mut Outlook {
        let (column, row) = self.pixels.area().tile_of(x, y);
        self.outlooks.at_mut(column, row)
    }

    /// The pixels of a part that are above the threshold, tile by tile.
    pub(super) fn above(
        &self,
        part: &Area,
        threshold: Threshold,
    ) -> impl Iterator<Item = ((i64, i64), &Pixel)> {
        self.pixels.within(part).filter(move |(_, pixel)| pixel.worth.exceeds(threshold))
    }

    /// Takes the pixels of a tile that are above the threshold to the end of the list `chosen`, so that those close
    /// together are close there.
    pub(super) fn choose(&mut self, tile: &Area, threshold: Threshold, chosen: &mut Vec<Chosen>) {
        if !self.outlook(tile.x0, tile.y0).may_exceed(threshold) {
            return;
        }
        let pixels = self.pixels.of_mut(tile);
        for (x, y) in in_turn(tile) {
            let pixel = &mut pixels[tile.place_of(x, y)];
            if pixel.worth.exceeds(threshold) && is_picked(threshold, x, y) {
                chosen.push(Chosen { x, y, pixel: std::mem::take(pixel), has_changed: false });
            }
        }
    }

    /// Puts them back, with what became of them by the `threshold`.
    pub(super) fn put_back(
        &mut self,
        tile: &Area,
        chosen: impl Iterator<Item = Chosen>,
        centers: &Plane<Sample>,
        threshold: Threshold,
    ) {
        let pixels = self.pixels.of_mut(tile);
        for Chosen { x, y, mut pixel, has_changed } in chosen {
            if let (true, Some(refined)) = (has_changed, &pixel.refined) {
                *self.colors.at_mut(x, y) = refined.color();
                // Corners that only neighbours wanted do not count, or it would depend on whether those are rendered.
                let own = pixel.needs_corner(centers, x, y);
                *self.samples.at_mut(x, y) = 1 + u32::from(own) + refined.points();
            }
            if threshold.is_final() {
                pixel.refined = None;
            }
            pixels[tile.place_of(x, y)] = pixel;
        }
        let worths = self.pixels.of(tile).iter().map(|pixel| pixel.worth);
        *self.outlook_mut(tile.x0, tile.y0) = Outlook::of(worths);
    }

    /// What the next stages of all pixels are worth, and take; `is_short` as for [`Demand::of`].
    pub(super) fn demand(&self, is_short: bool) -> Demand {
        let tiles = self.pixels.tiles().par_chunks(TILES_AT_ONCE);
        let outlooks = self.outlooks.values().par_chunks(TILES_AT_ONCE);
        let of_some = |(tiles, outlooks): (&[Vec<Pixel>], &[Outlook])| {
            let mut demand = Demand::of(0, is_short);
            for (pixels, outlook) in tiles.iter().zip(outlooks) {
                match pixels.as_slice() {
                    [] => demand.settle(outlook.expected),
                    pixels => pixels.iter().for_each(|pixel| demand.add(&pixel.worth)),
                }
            }
            demand
        };
        let parts: Vec<Demand> = tiles.zip(outlooks).map(of_some).collect();
        // In the order of the tiles, on which sums depend.
        parts.iter().fold(Demand::of(self.pixels.area().len(), is_short), Demand::and)
    }
}

/// The outlook of a tile if all is smooth in it and its pixels may be refined.
fn smooth_outlook(survey: &Survey, centers: &[Sample]) -> Outlook {
    let pixels = survey.smooth.iter().zip(&survey.noise).zip(centers);
    Outlook::of(pixels.map(|((smooth, noise), center)| {
        Worth::of_smooth(smooth.max(noise.error()), *smooth, center)
    }))
}

/// The pixels of a tile, row by row, as their `own` centres and the looks of those that are suspect tell.
fn pixels_of(tile: &Area, survey: &Survey, own: &[Sample], centers: &Plane<Sample>) -> Vec<Pixel> {
    let smooth = survey.smooth.iter().zip(&survey.noise).zip(own);
    let mut pixels = Vec::with_capacity(tile.len());
    pixels.extend(smooth.map(|((smooth, noise), center)| Pixel {
        error: smooth.max(noise.error()),
        // What the neighbours of each say is right on average.
        worth: Worth { expected: *smooth, ..Worth::default() },
        contrast: CONTRAST_OF_NOISE * noise.error(),
        busy: noise.busy(),
        detail: center.detail,
        ..Pixel::default()
    }));
    for (place, look) in &survey.suspects {
        let (x, y) = tile.pixel_at(*place);
        let skips = skips_cells(centers, x, y, look.contrast);
        let detail = own[*place].detail;
        let error = look.center_error().max(detail.squared_error());
        pixels[*place] = Pixel {
            suspect: true,
            error,
            worth: Worth { expected: error, ..Worth::default() },
            least: if skips { LEAST_IN_CELLS } else { Least::default() },
            contrast: look.contrast,
            busy: look.busy,
            detail,
            ..Pixel::default()
        };
    }
    pixels
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
