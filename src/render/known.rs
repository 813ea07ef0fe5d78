//! What is known of the pixels of a picture that gets better.

use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::{
    crew::{Crew, Least, Sampler, in_turn, lock},
    hidden::hidden_error,
    look::{ONE_COLOR, Window, corrected, skips_cells},
    outlook::{Outlook, Worth, outlooks, tile_of},
    plane::{Area, Plane},
    round::{Chosen, Pixel, Threshold, is_disputed, is_picked},
};
use crate::{
    aa::{Sample, refined::Stage},
    color::Rgb,
};

/// The samples that a pixel gets at least where a pattern's cells are no wider than it: its centre and corners, and
/// those of its neighbours, may all have met the same colour.
const LEAST_IN_CELLS: Least = Least { samples: 8, if_alike: 8 };

/// What is known of the pixels of an area.
#[derive(Serialize, Deserialize)]
pub(super) struct Known {
    pub(super) pixels: Plane<Pixel>,
    pub(super) colors: Plane<Rgb>,
    /// The rays through each pixel.
    pub(super) samples: Plane<u32>,
    /// What more rays are worth to each pixel.
    pub(super) worths: Plane<Worth>,
    /// The same by tile.
    pub(super) outlooks: Plane<Outlook>,
}

impl Known {
    /// Nothing.
    pub(super) fn new(area: &Area) -> Self {
        Self {
            pixels: Plane::new(*area, Pixel::default()),
            colors: Plane::new(*area, Rgb::ZERO),
            samples: Plane::new(*area, 0),
            worths: Plane::new(*area, Worth::default()),
            outlooks: outlooks(area),
        }
    }

    /// What the `centers` say of each pixel.
    pub(super) fn look<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        stages: &[Stage],
        centers: &Plane<Sample>,
    ) {
        let area = *self.pixels.area();
        let has_thin = (crew.new_sampler)().has_thin();
        let of_one_color = Mutex::new(Vec::new());
        let known = Mutex::new(&mut *self);
        let never = || false;
        crew.run(&area, false, never, |sampler, _, tile| {
            let least = |x: i64, y: i64| {
                if has_thin { sampler.least_samples(x as u32, y as u32) } else { Least::default() }
            };
            let looks = Window::of_centers(tile, centers).looks();
            let (count, columns) = (tile.len(), centers.columns(tile));
            let (mut pixels, mut worths) = (Vec::with_capacity(count), Vec::with_capacity(count));
            let (mut colors, mut samples) = (Vec::with_capacity(count), Vec::with_capacity(count));
            for (y, looks) in (tile.y0..tile.y1).zip(looks.chunks(tile.width())) {
                let rows = [y - 1, y, y + 1].map(|y| centers.nearest_row(y));
                for ((x, place), look) in (tile.x0..tile.x1).zip(columns.clone()).zip(looks) {
                    let center = &rows[1][place];
                    let skips = look.suspect && skips_cells(centers, x, y, look.contrast);
                    let cells = if skips { LEAST_IN_CELLS } else { Least::default() };
                    let error = look.center_error(look.inner);
                    let thin = least(x, y);
                    let pixel = Pixel {
                        suspect: look.suspect,
                        error,
                        is_thin: thin.is_some(),
                        least: thin.max(cells),
                        contrast: look.contrast,
                        busy: look.busy,
                        ..Pixel::default()
                    };
                    colors.push(if look.inner { corrected(&rows, place) } else { center.color });
                    samples.push(u32::from(center.rays > 0));
                    worths.push(Worth::of(&pixel, error, stages, center));
                    pixels.push(pixel);
                }
            }
            let outlook = Outlook::of(worths.iter());
            let is_of_one_color = |pixel: &Pixel| pixel.suspect && pixel.contrast < ONE_COLOR;
            if pixels.iter().any(is_of_one_color) {
                let found = tile.pixels().zip(&pixels).filter(|(_, pixel)| is_of_one_color(pixel));
                lock(&of_one_color).extend(found.map(|(place, _)| place));
            }
            let mut known = lock(&known);
            known.pixels.put(tile, pixels);
            known.colors.put(tile, colors);
            known.samples.put(tile, samples);
            known.worths.put(tile, worths);
            let (column, row) = tile_of(&area, tile.x0, tile.y0);
            *known.outlooks.at_mut(column, row) = outlook;
        });
        self.expect_hidden(of_one_color.into_inner().unwrap_or_else(PoisonError::into_inner));
    }

    /// Adds what may hide at these places to what the picture is expected to be off by.
    fn expect_hidden(&mut self, mut places: Vec<(i64, i64)>) {
        let area = *self.pixels.area();
        // Sums depend on their order, which that of the tiles must not.
        places.sort_unstable_by_key(|&(x, y)| (y, x));
        for (x, y) in places {
            let hidden = hidden_error(&area, &self.pixels, x, y);
            self.worths.at_mut(x, y).expected += hidden;
            let (column, row) = tile_of(&area, x, y);
            self.outlooks.at_mut(column, row).expected += f64::from(hidden);
        }
    }

    /// The pixels of a part that are above the threshold, row by row.
    pub(super) fn above(
        &self,
        part: &Area,
        threshold: Threshold,
    ) -> impl Iterator<Item = (i64, i64)> {
        let (first, columns) = (part.x0, self.worths.columns(part));
        (part.y0..part.y1).flat_map(move |y| {
            let row = self.worths.nearest_row(y)[columns.clone()].iter().enumerate();
            row.filter(move |(_, worth)| worth.exceeds(threshold))
                .map(move |(column, _)| (first + column as i64, y))
        })
    }

    /// Takes out the pixels of a tile that are above the threshold, so that those close together are close in the list.
    pub(super) fn choose(&mut self, tile: &Area, threshold: Threshold) -> Vec<Chosen> {
        let (column, row) = tile_of(self.pixels.area(), tile.x0, tile.y0);
        let mut chosen = Vec::new();
        if !self.outlooks.at(column, row).may_exceed(threshold) {
            return chosen;
        }
        for (x, y) in in_turn(tile) {
            let worth = *self.worths.at(x, y);
            if worth.exceeds(threshold) && is_picked(threshold, x, y) {
                let pixel = std::mem::take(self.pixels.at_mut(x, y));
                chosen.push(Chosen { x, y, pixel, worth, has_changed: false });
            }
        }
        chosen
    }

    /// Puts them back, with what became of them by the `threshold`.
    pub(super) fn put_back(
        &mut self,
        tile: &Area,
        chosen: Vec<Chosen>,
        centers: &Plane<Sample>,
        threshold: Threshold,
    ) {
        for Chosen { x, y, mut pixel, worth, has_changed } in chosen {
            if let (true, Some(refined)) = (has_changed, &pixel.refined) {
                *self.colors.at_mut(x, y) = refined.color();
                // Corners that only neighbours wanted do not count, or it would depend on whether those are rendered.
                let own = !pixel.suspect || is_disputed(centers, x, y);
                *self.samples.at_mut(x, y) = 1 + u32::from(own) + refined.points();
            }
            if threshold.is_final() {
                pixel.refined = None;
            }
            *self.worths.at_mut(x, y) = worth;
            *self.pixels.at_mut(x, y) = pixel;
        }
        let columns = self.worths.columns(tile);
        let rows = (tile.y0..tile.y1).map(|y| &self.worths.nearest_row(y)[columns.clone()]);
        let outlook = Outlook::of(rows.flatten());
        let (column, row) = tile_of(self.pixels.area(), tile.x0, tile.y0);
        *self.outlooks.at_mut(column, row) = outlook;
    }
}
