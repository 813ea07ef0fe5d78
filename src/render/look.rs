//! What centres say of a pixel beside the errors of their [`Window`](super::window::Window).

use super::plane::{Area, Plane};
use crate::{aa::Sample, color::Rgb};

/// The least contrast, in squared levels, of a pixel whose eight neighbours are not all of its own colour to the eye:
/// two levels off on average.
pub(super) const ONE_COLOR: f32 = 8.0 * 4.0;

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

/// The colours of the tile's centres, row by row, with the second-order term of the integral over the pixel: c + (E + W +
/// N + S - 4c)/24.
pub(super) fn corrected(tile: &Area, centers: &Plane<Sample>) -> Vec<Rgb> {
    let mut colors = Vec::with_capacity(tile.len());
    for y in tile.y0..tile.y1 {
        let [above, row, below] = [y - 1, y, y + 1].map(|y| centers.row(y));
        colors.extend(centers.columns(tile).map(|place| {
            let center = row[place].color;
            let (west, east) = (row[place - 1].color, row[place + 1].color);
            let sides = west + east + above[place].color + below[place].color;
            (center + (sides - center * 4.0) / 24.0).max(Rgb::ZERO).min(Rgb::ONE)
        }));
    }
    colors
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
