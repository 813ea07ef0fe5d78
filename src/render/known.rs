//! What is known of the pixels of a picture that gets better.

use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::{
    crew::{Crew, Sampler, lock},
    look::{Window, corrected, skips_cells},
    outlook::{Outlook, outlooks, tile_of},
    plane::{Area, Plane},
    round::Pixel,
};
use crate::{
    aa::{Sample, refined::Stage},
    color::Rgb,
};

/// The samples that a pixel gets at least where a pattern's cells are no wider than it: its centre and corners, and those of its
/// neighbours, may all have met the same colour.
const LEAST_IN_CELLS: u32 = 8;

/// What is known of the pixels of an area.
#[derive(Serialize, Deserialize)]
pub(super) struct Known {
    pub(super) pixels: Plane<Pixel>,
    pub(super) colors: Plane<Rgb>,
    /// The rays through each pixel.
    pub(super) samples: Plane<u32>,
    /// By tile.
    pub(super) outlooks: Plane<Outlook>,
}

impl Known {
    /// Nothing.
    pub(super) fn new(area: &Area) -> Self {
        Self {
            pixels: Plane::new(*area, Pixel::default()),
            colors: Plane::new(*area, Rgb::ZERO),
            samples: Plane::new(*area, 0),
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
        let known = Mutex::new(self);
        let never = || false;
        crew.run(&area, false, never, |sampler, _, tile| {
            let least = |x: i64, y: i64| {
                if has_thin { sampler.least_samples(x as u32, y as u32) } else { 0 }
            };
            let looks = Window::of_centers(tile, centers).looks();
            let (pixels, colors): (Vec<_>, Vec<_>) = tile
                .pixels()
                .zip(looks)
                .map(|((x, y), look)| {
                    let color =
                        if look.inner { corrected(centers, x, y) } else { centers.at(x, y).color };
                    let skips = look.suspect && skips_cells(centers, x, y);
                    let cells = if skips { LEAST_IN_CELLS } else { 0 };
                    let error = look.center_error(look.inner);
                    let pixel = Pixel {
                        suspect: look.suspect,
                        error,
                        expected: error,
                        least: least(x, y).max(cells),
                        contrast: look.contrast,
                        busy: look.busy,
                        ..Pixel::default()
                    };
                    (pixel, color)
                })
                .unzip();
            let outlook = Outlook::of(tile, &pixels, stages, centers);
            let samples = tile.pixels().map(|(x, y)| u32::from(centers.at(x, y).rays > 0));
            let mut known = lock(&known);
            known.pixels.put(tile, pixels);
            known.colors.put(tile, colors);
            known.samples.put(tile, samples);
            let (column, row) = tile_of(&area, tile.x0, tile.y0);
            *known.outlooks.at_mut(column, row) = outlook;
        });
    }
}
