//! What the centres say about each other.

use glam::Vec3;

use super::plane::{Area, Plane, TILE_SIDE};
use crate::{
    aa::{
        Sample,
        detail::Detail,
        estimate::{
            Look, NEIGHBOURS, busy_of_noise, curve_error, edge_error, most_noise_error, noise_error,
        },
        levels::levels,
    },
    color::Rgb,
};

/// The most pixels in a row of a window that are judged: the widest tile and one to either side.
const SIDE: usize = TILE_SIDE as usize + 2;

/// The least contrast, in squared levels, of a pixel whose eight neighbours are not all of its own colour to the eye:
/// two levels off on average.
pub(super) const ONE_COLOR: f32 = 8.0 * 4.0;

/// The centres of a tile and of the pixels around it, encoded; pixels outside of what is known repeat those at its
/// edge.
pub(super) struct Window {
    /// Display levels, channel by channel.
    levels: [Vec<f32>; 3],
    signatures: Vec<u32>,
    /// The squared errors of pictures; and 1, or 0 where there is no noise but that of a picture. Empty without pictures.
    details: Vec<f32>,
    guessed: Vec<f32>,
    around: Area,
    /// The pixels between the edges of the tile and of the window.
    margin: usize,
}

/// The noise of 3 × 3 pixels: where a pixel is amid noise it is off by as much as those around, also if its own neighbours are like
/// it by chance. Those do not count whose neighbours met anything else.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Noise {
    /// The sum of the pixels' errors by noise, and the most that it could be.
    error: f32,
    most: f32,
}

impl Noise {
    fn and(self, other: Self) -> Self {
        Self { error: self.error + other.error, most: self.most + other.most }
    }

    /// The squared error of the pixel in the middle, none where it is not busy.
    pub(super) fn error(self) -> f32 {
        self.busy() * self.error / 9.0
    }

    /// How busy it is there.
    pub(super) fn busy(self) -> f32 {
        busy_of_noise(self.error / self.most.max(f32::MIN_POSITIVE))
    }
}

/// A row of pixels of a window.
struct Row {
    /// Where in the window it begins, one pixel before its first, with the rows above and below.
    starts: [usize; 3],
    /// Its pixels.
    count: usize,
}

impl Row {
    /// Its pixels, which are known not to be more than these.
    #[inline(always)]
    fn count(&self) -> usize {
        self.count.min(SIDE)
    }
}

impl Window {
    /// The window `margin` pixels about `tile` of a plane, from whose entries `see` makes colours, signatures and details.
    pub(super) fn new<T>(
        (tile, margin): (&Area, usize),
        plane: &Plane<T>,
        see: impl Fn(&T) -> (Rgb, u32, Detail),
    ) -> Self {
        let around = tile.grown(margin as i64);
        let mut window = Self {
            levels: std::array::from_fn(|_| vec![0.0; around.len()]),
            signatures: vec![0; around.len()],
            details: Vec::new(),
            guessed: Vec::new(),
            around,
            margin,
        };
        let mut place = 0;
        for y in around.y0..around.y1 {
            let row = plane.nearest_row(y);
            for x in around.x0..around.x1 {
                let (color, signature, detail) = see(&row[plane.nearest_column(x)]);
                let levels = levels(color);
                window.levels[0][place] = levels.x;
                window.levels[1][place] = levels.y;
                window.levels[2][place] = levels.z;
                window.signatures[place] = signature;
                if detail != Detail::default() {
                    window.set_detail(place, detail);
                }
                place += 1;
            }
        }
        window
    }

    fn set_detail(&mut self, place: usize, detail: Detail) {
        if self.details.is_empty() {
            self.details = vec![0.0; self.around.len()];
            self.guessed = vec![1.0; self.around.len()];
        }
        self.details[place] = detail.squared_error();
        self.guessed[place] = if detail.is_whole() { 0.0 } else { 1.0 };
    }

    /// The window `margin` pixels about `tile` of traced centres.
    pub(super) fn of_centers(tile: &Area, margin: usize, centers: &Plane<Sample>) -> Self {
        let see = |sample: &Sample| (sample.color, sample.signature, sample.detail);
        Self::new((tile, margin), centers, see)
    }

    /// The estimated squared error of each of the tile's centres, row by row, as if their neighbours had met the same;
    /// `corrected` is whether the second-order term of the box integral is added to its colour.
    pub(super) fn smooth_errors(&self, corrected: bool) -> Vec<f32> {
        let mut errors = Vec::with_capacity(self.around.len());
        for row in self.rows(0) {
            let bends = self.bends(&row);
            let off = self.off(&row, &bends, |curve| curve_error(curve, corrected));
            errors.extend(&off[..row.count()]);
        }
        errors
    }

    /// The noise about each pixel of the tile, row by row. Takes a margin of two pixels.
    pub(super) fn noise_around(&self) -> Vec<Noise> {
        let noise_of = |row: Row| {
            let bends = self.bends(&row);
            let (noise, differing) = (self.off(&row, &bends, |_| 0.0), self.differing(&row));
            let each: [Noise; SIDE] = std::array::from_fn(|k| match differing[k] {
                0 => Noise { error: noise[k], most: most_noise_error(bends.0[k]) },
                _ => Noise::default(),
            });
            each
        };
        let rows: Vec<[Noise; SIDE]> = self.rows(1).map(noise_of).collect();
        let count = self.around.width() - 2 * self.margin;
        let mut around = Vec::with_capacity(self.around.len());
        for three in rows.windows(3) {
            let sum: [Noise; SIDE] =
                std::array::from_fn(|k| three[0][k].and(three[1][k]).and(three[2][k]));
            around.extend((0..count).map(|k| sum[k].and(sum[k + 1]).and(sum[k + 2])));
        }
        around
    }

    /// The squared errors of the pixels of a row with these [`bends`](Self::bends): what `smooth` says of the second
    /// differences, and noise, as far as the pixel's picture does not tell; at least that of the picture.
    #[inline(always)]
    fn off(
        &self,
        row: &Row,
        (curve, slope): &([f32; SIDE], [f32; SIDE]),
        smooth: impl Fn(f32) -> f32,
    ) -> [f32; SIDE] {
        let mut off = std::array::from_fn(|k| smooth(curve[k]) + noise_error(curve[k], slope[k]));
        if !self.details.is_empty() {
            let (first, count) = (row.starts[1] + 1, row.count());
            let details = self.details[first..][..count].iter().zip(&self.guessed[first..]);
            for (k, (detail, guessed)) in details.enumerate() {
                let noise = noise_error(curve[k], slope[k]) * guessed;
                off[k] = (smooth(curve[k]) + noise).max(*detail);
            }
        }
        off
    }

    /// The squared second differences of the pixels of a row, and the squared differences of their opposite neighbours, each the
    /// mean of the channels, horizontal and vertical.
    #[inline(always)]
    fn bends(&self, row: &Row) -> ([f32; SIDE], [f32; SIDE]) {
        let (count, [above, at, below]) = (row.count(), row.starts);
        let (mut curve, mut slope) = ([0.0; SIDE], [0.0; SIDE]);
        for channel in &self.levels {
            let row = |start: usize| &channel[start..start + count];
            let (west, here, east) = (row(at), row(at + 1), row(at + 2));
            let (north, south) = (row(above + 1), row(below + 1));
            for k in 0..count {
                let across = west[k] + east[k] - 2.0 * here[k];
                let down = north[k] + south[k] - 2.0 * here[k];
                let (level, upright) = (west[k] - east[k], north[k] - south[k]);
                curve[k] += across * across + down * down;
                slope[k] += level * level + upright * upright;
            }
        }
        for k in 0..count {
            (curve[k], slope[k]) = (curve[k] / 3.0, slope[k] / 3.0);
        }
        (curve, slope)
    }

    /// The estimated squared error of each of the tile's centres, row by row, as [`Look::center_error`] has it.
    pub(super) fn center_errors(&self) -> Vec<f32> {
        let mut errors = self.smooth_errors(false);
        let width = self.around.width() - 2 * self.margin;
        for (row, errors) in self.rows(0).zip(errors.chunks_mut(width)) {
            if self.differing(&row).iter().all(|differs| *differs == 0) {
                continue;
            }
            for (error, edge) in errors.iter_mut().zip(self.edges(&row)) {
                *error = error.max(edge_error(edge));
            }
        }
        errors
    }

    /// The pixels of the tile whose neighbours' rays met anything else: where in it they are, counted row by row, and
    /// their looks.
    pub(super) fn suspects(&self) -> Vec<(usize, Look)> {
        let mut suspects = Vec::new();
        for (y, row) in self.rows(0).enumerate() {
            let differing = self.differing(&row);
            let others = (0..row.count()).filter(|&k| differing[k] != 0);
            let first = row.starts[1] + 1;
            suspects.extend(others.map(|k| (y * row.count() + k, self.look(first + k))));
        }
        suspects
    }

    /// Zero for those pixels of a row whose neighbours' rays all met the same.
    fn differing(&self, row: &Row) -> [u32; SIDE] {
        let mut differing = [0; SIDE];
        let (count, starts) = (row.count(), row.starts);
        let row = |start: usize| &self.signatures[start..start + count];
        let centers = row(starts[1] + 1);
        for start in starts.into_iter().flat_map(|start| start..start + 3) {
            let signatures = row(start);
            for k in 0..count {
                differing[k] |= signatures[k] ^ centers[k];
            }
        }
        differing
    }

    /// [`Look::edge`] of the pixels of a row.
    fn edges(&self, row: &Row) -> [f32; SIDE] {
        let mut edges = [0.0; SIDE];
        let (count, starts) = (row.count(), row.starts);
        let middle = starts[1] + 1;
        for (place, weight) in NEIGHBOURS {
            let other = starts[place / 3] + place % 3;
            let mut squares = [0.0; SIDE];
            for channel in &self.levels {
                let (here, there) = (&channel[middle..][..count], &channel[other..][..count]);
                for k in 0..count {
                    squares[k] += (there[k] - here[k]) * (there[k] - here[k]);
                }
            }
            let (here, there) =
                (&self.signatures[middle..][..count], &self.signatures[other..][..count]);
            for k in 0..count {
                edges[k] += if here[k] == there[k] { 0.0 } else { weight / 3.0 * squares[k] };
            }
        }
        edges
    }

    /// The rows of the tile, and of `ring` pixels about it, fewer than the margin.
    fn rows(&self, ring: usize) -> impl Iterator<Item = Row> + use<> {
        let (width, outside) = (self.around.width(), self.margin - ring);
        let count = width - 2 * outside;
        (outside..self.around.height() - outside).map(move |row| {
            let starts = [row - 1, row, row + 1].map(|row| row * width + outside - 1);
            Row { starts, count }
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
        let [above, row, below] = [y - 1, y, y + 1].map(|y| centers.nearest_row(y));
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
    use crate::math::random::SplitMix64;

    /// Oracle: the looks of the pixels, one by one.
    #[test]
    fn centers_judged_row_by_row_are_those_judged_alone() {
        let mut random = SplitMix64::new(3);
        let sample = |_| {
            let color = Rgb::splat(random.uniform() as f32) * Rgb::new(1.0, 0.5, 0.2);
            let signature = u32::from(random.uniform() < 0.1);
            Sample { color, signature, ..Sample::default() }
        };
        let centers = Plane::from_fn(Area { x0: 0, y0: 0, x1: 50, y1: 40 }, sample);
        for tile in [
            Area { x0: 0, y0: 0, x1: 16, y1: 16 },
            Area { x0: 47, y0: 33, x1: 50, y1: 40 },
            Area { x0: 16, y0: 16, x1: 17, y1: 18 },
        ] {
            let window = Window::of_centers(&tile, 1, &centers);
            let mut expected = window.smooth_errors(false);
            for (place, look) in window.suspects() {
                expected[place] = look.center_error();
            }
            let errors = window.center_errors();
            assert_eq!(errors.len(), expected.len());
            for (error, expected) in errors.iter().zip(&expected) {
                assert!((error - expected).abs() <= 1e-5 * expected, "{error}, {expected}");
            }
        }
    }

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
