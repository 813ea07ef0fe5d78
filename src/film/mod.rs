//! The film: what a render fills tile by tile, and how it becomes a file.
//!
//! [`Film`] holds linear colours; sRGB appears only in [`encode`], at the very end. [`save`] puts a
//! picture on disk whole or not at all, with a [`Label`] that says what it is; [`merge()`] joins parts;
//! [`metrics`] measures how far two pictures are apart.

pub mod encode;
mod error;
mod exr;
pub mod heatmap;
mod label;
mod merge;
pub mod metrics;
mod png;
mod ppm;
pub mod save;
mod share;
mod similarity;
mod tile;
pub mod whole_file;

pub use self::exr::write_exr;
pub use self::png::{write_png, write_rgb8};
pub use error::ImageError;
pub use label::{Label, Share};
pub use merge::{MergeError, merge, read_label};
pub use metrics::Difference;
pub use ppm::write_ppm;
pub use save::{Format, OutputFile};
pub use share::{ShareError, share};
pub use tile::{Tile, tiles};
pub use whole_file::{FileError, WholeFile};

use crate::Rgb;

/// A picture in linear light, row by row from the top left, with the camera rays each pixel took.
///
/// A pixel holds the average of its camera rays, each clamped to `[0, 1]` before averaging.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Rgb>,
    samples: Vec<u32>,
}

impl Film {
    /// A black film of `width` x `height` pixels that took no rays yet.
    ///
    /// # Panics
    ///
    /// If the film needs more memory than can be addressed. If it needs more than the machine can give, the program is
    /// aborted; [`Film::memory_bytes`] tells first.
    pub fn new(width: u32, height: u32) -> Self {
        let count = usize::try_from(u64::from(width) * u64::from(height))
            .expect("a film that memory can address");
        // Zeroed by the system: pages that are never written to cost nothing.
        Self { width, height, pixels: bytemuck::zeroed_vec(count), samples: vec![0; count] }
    }

    /// A film of finished pixels and the rays that each took, row by row from the top left.
    ///
    /// # Panics
    ///
    /// If a list is not as long as the film has pixels.
    pub fn from_parts(width: u32, height: u32, pixels: Vec<Rgb>, samples: Vec<u32>) -> Self {
        let count = u64::from(width) * u64::from(height);
        assert_eq!(pixels.len() as u64, count, "colours of a film {width} x {height}");
        assert_eq!(samples.len() as u64, count, "samples of a film {width} x {height}");
        Self { width, height, pixels, samples }
    }

    /// Bytes a film of `width` x `height` pixels occupies; cannot overflow.
    pub fn memory_bytes(width: u32, height: u32) -> u128 {
        u128::from(width) * u128::from(height) * (size_of::<Rgb>() + size_of::<u32>()) as u128
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All colours, row by row from the top left, linear.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// Camera rays of each pixel, in the order of [`Film::pixels`].
    pub fn samples(&self) -> &[u32] {
        &self.samples
    }

    /// The colour of the pixel in column `x` and row `y`, both from 0 at the top left.
    ///
    /// # Panics
    ///
    /// If the pixel lies outside the film.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        assert!(x < self.width, "column {x} of a film {} wide", self.width);
        self.pixels[self.index(x, y)]
    }

    /// The colours of a row.
    fn row(&self, y: u32) -> &[Rgb] {
        &self.pixels[self.index(0, y)..][..self.width as usize]
    }

    /// The camera rays of the pixels of a row; a pixel without any is not rendered yet.
    fn row_samples(&self, y: u32) -> &[u32] {
        &self.samples[self.index(0, y)..][..self.width as usize]
    }

    /// How many pixels are not rendered yet.
    pub fn missing(&self) -> u64 {
        self.samples.iter().filter(|count| **count == 0).count() as u64
    }

    /// Takes a finished tile into its place, as [`Film::blit`], without a copy if it is all of the film.
    ///
    /// # Panics
    ///
    /// As [`Film::blit`].
    pub fn put(&mut self, tile: &Tile, pixels: Vec<Rgb>, samples: Vec<u32>) {
        let [width, height] = [self.width, self.height];
        if *tile == (Tile { x0: 0, y0: 0, x1: width, y1: height }) {
            *self = Self::from_parts(width, height, pixels, samples);
        } else {
            self.blit(tile, &pixels, &samples);
        }
    }

    /// Copies a finished tile into its place; `pixels` and `samples` run row by row over the tile.
    ///
    /// # Panics
    ///
    /// If the tile sticks out of the film or a slice is not as long as the tile has pixels.
    pub fn blit(&mut self, tile: &Tile, pixels: &[Rgb], samples: &[u32]) {
        assert!(tile.x1 <= self.width && tile.y1 <= self.height, "{tile:?} sticks out of the film");
        let width = tile.width() as usize;
        let count = width * tile.height() as usize;
        assert_eq!(pixels.len(), count, "colours of {tile:?}");
        assert_eq!(samples.len(), count, "samples of {tile:?}");
        if count == 0 {
            return;
        }
        for (y, (pixels, samples)) in
            (tile.y0..tile.y1).zip(pixels.chunks_exact(width).zip(samples.chunks_exact(width)))
        {
            let start = self.index(tile.x0, y);
            self.pixels[start..start + width].copy_from_slice(pixels);
            self.samples[start..start + width].copy_from_slice(samples);
        }
    }

    /// A copy of the colours and rays of `tile`, row by row.
    ///
    /// # Panics
    ///
    /// If the tile sticks out of the film.
    pub fn cut(&self, tile: &Tile) -> (Vec<Rgb>, Vec<u32>) {
        assert!(tile.x1 <= self.width && tile.y1 <= self.height, "{tile:?} sticks out of the film");
        let columns = tile.x0 as usize..tile.x1 as usize;
        let rows = tile.y0..tile.y1;
        let colors = rows.clone().flat_map(|y| self.row(y)[columns.clone()].iter().copied());
        let samples = rows.flat_map(|y| self.row_samples(y)[columns.clone()].iter().copied());
        (colors.collect(), samples.collect())
    }

    /// The film with another number of pixels, each the nearest one of this film.
    #[must_use]
    pub fn resampled(&self, [width, height]: [u32; 2]) -> Self {
        let from = |k: u32, to: u32, of: u32| {
            // The middle of the pixel, in halves of pixels.
            ((2 * u64::from(k) + 1) * u64::from(of) / (2 * u64::from(to))) as u32
        };
        let mut film = Self::new(width, height);
        if self.pixels.is_empty() {
            return film;
        }
        for y in 0..height {
            for x in 0..width {
                let (to, at) = (
                    film.index(x, y),
                    self.index(from(x, width, self.width), from(y, height, self.height)),
                );
                (film.pixels[to], film.samples[to]) = (self.pixels[at], self.samples[at]);
            }
        }
        film
    }

    fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: each pixel's colour and count name the pixel, so a misplaced one shows.
    #[test]
    fn blitted_tiles_put_every_pixel_in_its_place() {
        for (width, height, side) in [(1, 1, 8), (7, 5, 2), (33, 20, 8), (5, 64, 64)] {
            let mut film = Film::new(width, height);
            for tile in tiles(width, height, side) {
                let places: Vec<(u32, u32)> = (tile.y0..tile.y1)
                    .flat_map(|y| (tile.x0..tile.x1).map(move |x| (x, y)))
                    .collect();
                let pixels: Vec<Rgb> =
                    places.iter().map(|&(x, y)| Rgb::new(x as f32, y as f32, 1.0)).collect();
                let samples: Vec<u32> = places.iter().map(|&(x, y)| 1 + x + 1000 * y).collect();
                film.blit(&tile, &pixels, &samples);
            }
            for y in 0..height {
                for x in 0..width {
                    assert_eq!(film.pixel(x, y), Rgb::new(x as f32, y as f32, 1.0));
                    assert_eq!(film.samples()[(y * width + x) as usize], 1 + x + 1000 * y);
                }
            }
        }
    }

    /// Oracle: the copy.
    #[test]
    fn a_tile_that_is_all_of_the_film_becomes_it() {
        let pixels: Vec<Rgb> = (0..6).map(|k| Rgb::splat(k as f32)).collect();
        let samples: Vec<u32> = (1..7).collect();
        for tile in [Tile { x0: 0, y0: 0, x1: 3, y1: 2 }, Tile { x0: 1, y0: 1, x1: 4, y1: 3 }] {
            let mut films = [Film::new(tile.x1, tile.y1), Film::new(tile.x1, tile.y1)];
            films[0].blit(&tile, &pixels, &samples);
            films[1].put(&tile, pixels.clone(), samples.clone());
            assert_eq!(films[0], films[1]);
        }
    }

    #[test]
    fn resampled_pixels_are_the_nearest() {
        let pixels: Vec<Rgb> = (0..6).map(|k| Rgb::splat(k as f32)).collect();
        let film = Film::from_parts(3, 2, pixels, (1..7).collect());
        assert_eq!(film.resampled([3, 2]), film);
        let large = film.resampled([9, 4]);
        for (x, y) in (0..9).flat_map(|x| (0..4).map(move |y| (x, y))) {
            assert_eq!(large.pixel(x, y), film.pixel(x / 3, y / 2), "{x}, {y}");
        }
        assert_eq!(large.resampled([3, 2]), film);
        assert_eq!(film.resampled([1, 1]).pixel(0, 0), film.pixel(1, 1));
    }

    #[test]
    fn memory_is_that_of_the_two_buffers() {
        let film = Film::new(11, 7);
        let held = size_of_val(film.pixels()) + size_of_val(film.samples());
        assert_eq!(Film::memory_bytes(11, 7), held as u128);
        let pixels = u128::from(u32::MAX) * u128::from(u32::MAX);
        assert_eq!(Film::memory_bytes(u32::MAX, u32::MAX), pixels * 16);
        assert_eq!(Film::memory_bytes(0, u32::MAX), 0);
    }
}
