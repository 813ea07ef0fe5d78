//! What the centres say about each other.

use glam::Vec3;

use super::plane::{Area, Plane, TILE_SIDE};
use crate::{
    aa::{Sample, estimate::Look, levels::levels},
    color::Rgb,
};

/// The widest tile.
const SIDE: usize = TILE_SIDE as usize;

/// The least contrast, in squared levels, of a pixel whose eight neighbours are not all of its own colour to the eye:
/// two levels off on average.
pub(super) const ONE_COLOR: f32 = 8.0 * 4.0;

/// The centres of a tile and of the pixels around it, encoded; pixels outside of what is known repeat those at its
/// edge.
pub(super) struct Window {
    /// Display levels, channel by channel.
    levels: [Vec<f32>; 3],
    signatures: Vec<u32>,
    around: Area,
}

impl Window {
    /// The window about `tile` of a plane, from whose entries `see` makes colours and signatures.
    pub(super) fn new<T>(tile: &Area, plane: &Plane<T>, see: impl Fn(&T) -> (Rgb, u32)) -> Self {
        let around = tile.grown(1);
        let mut window = Self {
            levels: std::array::from_fn(|_| vec![0.0; around.len()]),
            signatures: vec![0; around.len()],
            around,
        };
        let mut place = 0;
        for y in around.y0..around.y1 {
            let row = plane.nearest_row(y);
            for x in around.x0..around.x1 {
                let (color, signature) = see(&row[plane.nearest_column(x)]);
                let levels = levels(color);
                window.levels[0][place] = levels.x;
                window.levels[1][place] = levels.y;
                window.levels[2][place] = levels.z;
                window.signatures[place] = signature;
                place += 1;
            }
        }
        window
    }

    /// The window about `tile` of traced centres.
    pub(super) fn of_centers(tile: &Area, centers: &Plane<Sample>) -> Self {
        Self::new(tile, centers, |sample| (sample.color, sample.signature))
    }

    /// The looks of the tile's pixels, row by row.
    pub(super) fn looks(&self) -> Vec<Look> {
        let (width, height) = (self.around.width(), self.around.height());
        let mut looks = Vec::with_capacity((width - 2) * (height - 2));
        for row in 1..height - 1 {
            self.add_row(row * width, &mut looks);
        }
        looks
    }

    /// Adds the looks of the row whose first place in the window is `middle`.
    fn add_row(&self, middle: usize, looks: &mut Vec<Look>) {
        let width = self.around.width();
        let pixels = (width - 2).min(SIDE);
        let (mut curve, mut slope) = ([0.0; SIDE], [0.0; SIDE]);
        let rows = [middle - width, middle, middle + width].map(|start| start..start + width);
        for channel in &self.levels {
            let [above, at, below] = rows.clone().map(|row| &channel[row]);
            for k in 0..pixels {
                let (west, here, east) = (at[k], at[k + 1], at[k + 2]);
                let (north, south) = (above[k + 1], below[k + 1]);
                let across = west + east - 2.0 * here;
                let down = north + south - 2.0 * here;
                curve[k] += across * across + down * down;
                slope[k] += (west - east) * (west - east) + (north - south) * (north - south);
            }
        }
        let mut differ = [0; SIDE];
        let centers = &self.signatures[middle + 1..];
        for row in rows {
            let signatures = &self.signatures[row];
            for k in 0..pixels {
                let of = |place: usize| signatures[place] ^ centers[k];
                differ[k] |= of(k) | of(k + 1) | of(k + 2);
            }
        }
        looks.extend((0..pixels).map(|k| {
            if differ[k] == 0 {
                Look::smooth(curve[k] / 3.0, slope[k] / 3.0)
            } else {
                self.look(middle + 1 + k)
            }
        }));
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

/// Whether a suspect pixel of one colour with its neighbours is about as wide as the cells of the pattern in it, so that
/// some may lie unseen between the centres about it; `contrast` is its [`Look`]'s. Where colours differ, they tell.
///
/// So it is where all neighbours but two at most met other cells than its own; where cells are wider, no more than five
/// do. So it is too where one at a side did: where two cells meet their colours differ, so there is another one on the
/// way.
pub(super) fn skips_cells(centers: &Plane<Sample>, x: i64, y: i64, contrast: f32) -> bool {
    const MOST_ALIKE: usize = 2;
    let cell = centers.at(x, y).cell;
    if cell == 0 {
        return false;
    }
    let is_own = |dx: i64, dy: i64| centers.nearest(x + dx, y + dy).cell == cell;
    let alike = |dy: i64| (-1..=1).filter(move |dx| is_own(*dx, dy)).count();
    contrast < ONE_COLOR
        && ((-1..=1).map(alike).sum::<usize>() <= MOST_ALIKE + 1
            || ![(-1, 0), (1, 0), (0, -1), (0, 1)].iter().all(|&(dx, dy)| is_own(dx, dy)))
}

/// The colour of the centre at a place in the middle one of three rows, in all of which it has neighbours, with the
/// second-order term of the integral over the pixel: c + (E + W + N + S - 4c)/24.
#[inline]
pub(super) fn corrected([above, row, below]: &[&[Sample]; 3], place: usize) -> Rgb {
    let center = row[place].color;
    let (west, east) = (row[place - 1].color, row[place + 1].color);
    let sides = west + east + above[place].color + below[place].color;
    (center + (sides - center * 4.0) / 24.0).max(Rgb::ZERO).min(Rgb::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: rows of cells of which every second one is skipped look alike, but are not one cell.
    #[test]
    fn cells_between_those_of_one_colour_are_noticed() {
        let area = Area { x0: 0, y0: 0, x1: 3, y1: 3 };
        let skips = |cell_of: fn(i64, i64) -> i64, contrast: f32| {
            let sample = |(x, y)| Sample { cell: cell_of(x, y) as u32, ..Sample::default() };
            skips_cells(&Plane::from_fn(area, sample), 1, 1, contrast)
        };
        assert!(skips(|_, y| 1 + y / 2, 1.0) && skips(|x, _| 1 + (x + 1) / 2, 1.0));
        // An edge between two cells, one cell, and no pattern.
        assert!(!skips(|_, y| 1 + y / 2, 1e4));
        assert!(!skips(|_, _| 5, 1.0) && !skips(|_, _| 0, 1.0));
        // Cells narrower than a pixel, of one colour by chance or not.
        assert!(skips(|x, y| 1 + x + 3 * y, 1.0) && !skips(|x, y| 1 + x + 3 * y, 1e4));
    }
}
