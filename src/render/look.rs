//! What the centres say about each other.

use glam::Vec3;

use super::plane::{Area, Plane};
use crate::{
    aa::{Sample, estimate::Look, levels::levels},
    color::Rgb,
};

/// The centres of a tile and of the pixels around it, encoded; pixels outside of what is known repeat those at its edge.
pub(super) struct Window {
    levels: Vec<Vec3>,
    signatures: Vec<u32>,
    around: Area,
}

impl Window {
    /// The window about `tile` of colours and signatures that are found by place.
    pub(super) fn new(tile: &Area, mut at: impl FnMut(i64, i64) -> (Rgb, u32)) -> Self {
        let around = tile.grown(1);
        let (levels, signatures) = around
            .pixels()
            .map(|(x, y)| {
                let (color, signature) = at(x, y);
                (levels(color), signature)
            })
            .unzip();
        Self { levels, signatures, around }
    }

    /// The window about `tile` of traced centres.
    pub(super) fn of_centers(tile: &Area, centers: &Plane<Sample>) -> Self {
        Self::new(tile, |x, y| {
            let sample = centers.nearest(x, y);
            (sample.color, sample.signature)
        })
    }

    /// The look of a pixel of the tile.
    pub(super) fn look(&self, x: i64, y: i64) -> Look {
        let width = self.around.width();
        let middle = (y - self.around.y0) as usize * width + (x - self.around.x0) as usize;
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
        Look::at(&places.map(|place| self.levels[place]), &places.map(|p| self.signatures[p]))
    }
}

/// The centre's colour with the second-order term of the integral over the pixel: c + (E + W + N + S - 4c)/24.
pub(super) fn corrected(centers: &Plane<Sample>, x: i64, y: i64) -> Rgb {
    let color = |x, y| centers.nearest(x, y).color;
    let center = color(x, y);
    let sides = color(x - 1, y) + color(x + 1, y) + color(x, y - 1) + color(x, y + 1);
    (center + (sides - center * 4.0) / 24.0).max(Rgb::ZERO).min(Rgb::ONE)
}
