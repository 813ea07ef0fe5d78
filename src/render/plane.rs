//! Rectangles of pixels, which may reach over the picture's edge, and what is known of each pixel in one.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    aa::Sample,
    accel::huge,
    film::{Tile, tiles},
};

/// The side of a tile in pixels: small enough to share the work out evenly, large enough to cost nothing by itself.
pub(super) const TILE_SIDE: u32 = 16;

/// Values that a thread takes at least, where all of a plane's are gone through.
const AT_ONCE: usize = 1 << 14;

/// A rectangle of pixels, half open, in columns and rows of the whole picture; those of its apron are negative, or from
/// width or height on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Area {
    pub(super) x0: i64,
    pub(super) y0: i64,
    pub(super) x1: i64,
    pub(super) y1: i64,
}

impl Area {
    pub(super) fn of(tile: &Tile) -> Self {
        let [x0, y0, x1, y1] = [tile.x0, tile.y0, tile.x1, tile.y1].map(i64::from);
        Self { x0, y0, x1, y1 }
    }

    pub(super) fn width(&self) -> usize {
        (self.x1 - self.x0) as usize
    }

    pub(super) fn height(&self) -> usize {
        (self.y1 - self.y0) as usize
    }

    pub(super) fn len(&self) -> usize {
        self.width() * self.height()
    }

    pub(super) fn contains(&self, x: i64, y: i64) -> bool {
        (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y)
    }

    /// The place of a pixel, counted row by row.
    #[inline]
    pub(super) fn place_of(&self, x: i64, y: i64) -> usize {
        debug_assert!(self.contains(x, y), "({x}, {y}) in {self:?}");
        (y - self.y0) as usize * self.width() + (x - self.x0) as usize
    }

    /// The place where the row that is nearest to `y` begins.
    pub(super) fn nearest_row(&self, y: i64) -> usize {
        self.place_of(self.x0, y.clamp(self.y0, self.y1 - 1))
    }

    /// The place in a row that is nearest to `x`.
    #[inline]
    pub(super) fn nearest_column(&self, x: i64) -> usize {
        (x.clamp(self.x0, self.x1 - 1) - self.x0) as usize
    }

    /// The pixel at a place counted row by row.
    pub(super) fn pixel_at(&self, place: usize) -> (i64, i64) {
        let (row, column) = (place / self.width(), place % self.width());
        (self.x0 + column as i64, self.y0 + row as i64)
    }

    /// The area and `apron` pixels about it.
    pub(super) fn grown(&self, apron: i64) -> Self {
        Self { x0: self.x0 - apron, y0: self.y0 - apron, x1: self.x1 + apron, y1: self.y1 + apron }
    }

    /// The corners of the area's pixels, each named by the pixel to its lower right.
    pub(super) fn corners(&self) -> Self {
        Self { x1: self.x1 + 1, y1: self.y1 + 1, ..*self }
    }

    /// Tiles that cover the area without overlap, in an order that keeps neighbours together.
    pub(super) fn tiles(&self) -> Vec<Self> {
        let shift = |x0: u32, y0: u32| (self.x0 + i64::from(x0), self.y0 + i64::from(y0));
        tiles(self.width() as u32, self.height() as u32, TILE_SIDE)
            .into_iter()
            .map(|tile| {
                let ((x0, y0), (x1, y1)) = (shift(tile.x0, tile.y0), shift(tile.x1, tile.y1));
                Self { x0, y0, x1, y1 }
            })
            .collect()
    }

    /// The columns and rows of these tiles.
    pub(super) fn grid(&self) -> Self {
        let side = TILE_SIDE as usize;
        let (columns, rows) = (self.width().div_ceil(side), self.height().div_ceil(side));
        Self { x0: 0, y0: 0, x1: columns as i64, y1: rows as i64 }
    }

    /// Column and row of the tile that holds a pixel.
    #[inline]
    pub(super) fn tile_of(&self, x: i64, y: i64) -> (i64, i64) {
        debug_assert!(self.contains(x, y), "({x}, {y}) in {self:?}");
        let tile = |place: i64| (place as u64 / u64::from(TILE_SIDE)) as i64;
        (tile(x - self.x0), tile(y - self.y0))
    }

    /// What two areas have in common.
    pub(super) fn common(&self, other: &Self) -> Self {
        Self {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        }
    }

    /// The pixels row by row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (i64, i64)> + use<> {
        let area = *self;
        (area.y0..area.y1).flat_map(move |y| (area.x0..area.x1).map(move |x| (x, y)))
    }
}

/// A value for each pixel of an area, row by row.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Plane<T> {
    area: Area,
    values: Vec<T>,
}

impl<T: Clone + Send + Sync> Plane<T> {
    /// The same value everywhere. All threads write it, because pages of memory take their time when they are first
    /// written to.
    pub(super) fn new(area: Area, value: T) -> Self {
        let mut values = huge::vec_with_capacity(area.len());
        let places = (0..area.len()).into_par_iter().with_min_len(AT_ONCE);
        places.map(|_| value.clone()).collect_into_vec(&mut values);
        Self { area, values }
    }
}

impl<T> Plane<T> {
    /// The values that `of` has for the area's pixels.
    #[cfg(test)]
    pub(super) fn from_fn(area: Area, of: impl FnMut((i64, i64)) -> T) -> Self {
        Self { area, values: area.pixels().map(of).collect() }
    }

    pub(super) fn area(&self) -> &Area {
        &self.area
    }

    #[inline]
    pub(super) fn at(&self, x: i64, y: i64) -> &T {
        &self.values[self.area.place_of(x, y)]
    }

    #[inline]
    pub(super) fn at_mut(&mut self, x: i64, y: i64) -> &mut T {
        let index = self.area.place_of(x, y);
        &mut self.values[index]
    }

    /// The value of the pixel of the area that is nearest to a place in it or around.
    #[inline]
    pub(super) fn nearest(&self, x: i64, y: i64) -> &T {
        self.at(x.clamp(self.area.x0, self.area.x1 - 1), y.clamp(self.area.y0, self.area.y1 - 1))
    }

    /// The row `y` of the area.
    pub(super) fn row(&self, y: i64) -> &[T] {
        let start = self.area.place_of(self.area.x0, y);
        &self.values[start..start + self.area.width()]
    }

    /// The places in a row of the columns of `part`, which is within the area.
    pub(super) fn columns(&self, part: &Area) -> std::ops::Range<usize> {
        (part.x0 - self.area.x0) as usize..(part.x1 - self.area.x0) as usize
    }

    pub(super) fn values(&self) -> &[T] {
        &self.values
    }

    pub(super) fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    pub(super) fn into_values(self) -> Vec<T> {
        self.values
    }

    /// Moves the values of `tile`, row by row, into their places.
    pub(super) fn put(&mut self, tile: &Area, mut values: Vec<T>) {
        for (y, row) in (tile.y0..tile.y1).zip(values.chunks_mut(tile.width())) {
            let start = self.area.place_of(tile.x0, y);
            self.values[start..start + row.len()].swap_with_slice(row);
        }
    }
}

/// A value for each pixel of those tiles of an area of which any are known.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Tiled<T> {
    area: Area,
    /// Row by row; empty if none are known.
    tiles: Plane<Vec<T>>,
}

impl<T: Clone + Send + Sync> Tiled<T> {
    /// Nothing known.
    pub(super) fn new(area: Area) -> Self {
        Self { area, tiles: Plane::new(area.grid(), Vec::new()) }
    }
}

impl<T> Tiled<T> {
    pub(super) fn area(&self) -> &Area {
        &self.area
    }

    /// The values of a tile, row by row.
    pub(super) fn of(&self, tile: &Area) -> &[T] {
        let (column, row) = self.area.tile_of(tile.x0, tile.y0);
        self.tiles.at(column, row)
    }

    /// The values of a tile, row by row, to be replaced.
    pub(super) fn of_mut(&mut self, tile: &Area) -> &mut Vec<T> {
        let (column, row) = self.area.tile_of(tile.x0, tile.y0);
        self.tiles.at_mut(column, row)
    }

    /// The value of a pixel; outside of the area none is known.
    #[inline]
    pub(super) fn get(&self, x: i64, y: i64) -> Option<&T> {
        if !self.area.contains(x, y) {
            return None;
        }
        let (column, row) = self.area.tile_of(x, y);
        self.tiles.at(column, row).get(self.tile(column, row).place_of(x, y))
    }

    /// The tile in a column and row of tiles.
    #[inline]
    fn tile(&self, column: i64, row: i64) -> Area {
        let side = i64::from(TILE_SIDE);
        let (x0, y0) = (self.area.x0 + column * side, self.area.y0 + row * side);
        Area { x0, y0, x1: x0 + side, y1: y0 + side }.common(&self.area)
    }
}

impl<T: Copy> Plane<T> {
    /// The values of `part`, which is within the area, row by row.
    pub(super) fn part(&self, part: &Area) -> Vec<T> {
        let mut values = Vec::with_capacity(part.len());
        for y in part.y0..part.y1 {
            values.extend_from_slice(&self.row(y)[self.columns(part)]);
        }
        values
    }
}

impl Plane<Sample> {
    /// Whether all samples of a tile have their rays.
    pub(super) fn is_traced(&self, tile: &Area) -> bool {
        tile.pixels().all(|(x, y)| self.at(x, y).rays > 0)
    }
}
