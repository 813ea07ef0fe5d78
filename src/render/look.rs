//! What the centres say about each other.

use glam::Vec3;

use super::plane::{Area, Plane, TILE_SIDE};
use crate::{
    aa::{Sample, estimate::Look, levels::levels},
    color::Rgb,
};

/// The centres of a tile and of the pixels around it, encoded; pixels outside of what is known repeat those at its edge.
pub(super) struct Window {
    /// Display levels, channel by channel.
    levels: [Vec<f32>; 3],
    signatures: Vec<u32>,
    around: Area,
}

impl Window {
    /// The window about `tile` of colours and signatures that are found by place.
    pub(super) fn new(tile: &Area, mut at: impl FnMut(i64, i64) -> (Rgb, u32)) -> Self {
        let around = tile.grown(1);
        let channel = || Vec::with_capacity(around.len());
        let (mut channels, mut signatures) =
            ([channel(), channel(), channel()], Vec::with_capacity(around.len()));
        for (x, y) in around.pixels() {
            let (color, signature) = at(x, y);
            let levels = levels(color).to_array();
            channels.iter_mut().zip(levels).for_each(|(channel, level)| channel.push(level));
            signatures.push(signature);
        }
        Self { levels: channels, signatures, around }
    }

    /// The window about `tile` of traced centres.
    pub(super) fn of_centers(tile: &Area, centers: &Plane<Sample>) -> Self {
        Self::new(tile, |x, y| {
            let sample = centers.nearest(x, y);
            (sample.color, sample.signature)
        })
    }

    /// The looks of the tile's pixels, row by row.
    pub(super) fn looks(&self) -> impl Iterator<Item = Look> {
        let (width, height) = (self.around.width(), self.around.height());
        (1..height - 1).flat_map(move |row| {
            let smooth = self.smooth_looks(row);
            smooth.into_iter().take(width - 2).zip(1..).map(move |(look, column)| {
                if look.suspect { self.look(row * width + column) } else { look }
            })
        })
    }

    /// The looks of a row of pixels as if each had but one signature around it, and whether that is so.
    fn smooth_looks(&self, row: usize) -> [Look; TILE_SIDE as usize] {
        let width = self.around.width();
        let (pixels, middle) = (width - 2, row * width);
        let (mut curve, mut slope) = ([0.0; TILE_SIDE as usize], [0.0; TILE_SIDE as usize]);
        for channel in &self.levels {
            let rows = [middle - width, middle, middle + width].map(|at| &channel[at..at + width]);
            let [above, at, below] = rows;
            for k in 0..pixels {
                let (west, here, east) = (at[k], at[k + 1], at[k + 2]);
                let (north, south) = (above[k + 1], below[k + 1]);
                let across = west + east - 2.0 * here;
                let down = north + south - 2.0 * here;
                curve[k] += across * across + down * down;
                slope[k] += (west - east) * (west - east) + (north - south) * (north - south);
            }
        }
        let mut differ = [0; TILE_SIDE as usize];
        for start in [middle - width, middle, middle + width] {
            let signatures = &self.signatures[start..start + width];
            let centers = &self.signatures[middle + 1..];
            for k in 0..pixels {
                let of = |place: usize| signatures[place] ^ centers[k];
                differ[k] |= of(k) | of(k + 1) | of(k + 2);
            }
        }
        std::array::from_fn(|k| Look {
            suspect: differ[k] != 0,
            ..Look::smooth(curve[k] / 3.0, slope[k] / 3.0)
        })
    }

    /// The look of the pixel at a place of the window.
    fn look(&self, middle: usize) -> Look {
        let width = self.around.width();
        let places = [
            middle - width - 1,
            middle - width,
            middle - width + 1,
            middle - 1,
            middle,
            middle + 1,
            middle + width - 1,
            middle + width,
            middle + width + 1,
        ];
        let [red, green, blue] = &self.levels;
        let levels = |place: usize| Vec3::new(red[place], green[place], blue[place]);
        Look::at(&places.map(levels), &places.map(|place| self.signatures[place]))
    }
}

/// The centre's colour with the second-order term of the integral over the pixel: c + (E + W + N + S - 4c)/24.
pub(super) fn corrected(centers: &Plane<Sample>, x: i64, y: i64) -> Rgb {
    let color = |x, y| centers.nearest(x, y).color;
    let center = color(x, y);
    let sides = color(x - 1, y) + color(x + 1, y) + color(x, y - 1) + color(x, y + 1);
    (center + (sides - center * 4.0) / 24.0).max(Rgb::ZERO).min(Rgb::ONE)
}
