//! What of a picture is finer than the rays that meet it.

use std::ops::Range;

use glam::Vec3A;

use super::image::{Beyond, Image};

/// For squares of 2 × 2, 4 × 4, ... texels of a picture, how far colours in them are from the mean of their light.
///
/// A ray that stands for such a square is off by that, wherever in the picture it falls. A slope from side to side does
/// not count: it is the same on both sides of a ray through the middle.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    grids: Vec<Grid<Off>>,
}

/// Places are in so many parts of a texel or square: a power of two.
const PARTS: i64 = 256;

/// Something about each square of one size, row by row from the top.
#[derive(Clone, Debug)]
struct Grid<T> {
    size: [usize; 2],
    cells: Vec<T>,
}

/// The root mean square of what is in a square: a number of levels of 255, as sixteen times its square root, so that small
/// ones are told apart as well.
#[derive(Clone, Copy, Debug)]
struct Off(u8);

impl Off {
    #[inline(always)]
    fn of_square(square: f32) -> Self {
        Self((16.0 * square.max(0.0).sqrt().sqrt() + 0.5) as u8)
    }

    #[inline(always)]
    fn square(self) -> f32 {
        let root = f32::from(self.0) / 16.0;
        (root * root) * (root * root)
    }
}

/// Means over a square, channel by channel.
#[derive(Clone, Copy)]
struct Mean {
    levels: Vec3A,
    /// Of the squared levels, between the texels as well.
    squares: Vec3A,
    /// Of the squared levels of the texels alone: of light, of which levels are taken to be the root, and which is bilinear
    /// between them.
    light: Vec3A,
}

impl Mean {
    /// That of the square between the middles of four texels, where colours are bilinear. From a to b the mean square is
    /// that of the two, less a sixth of their squared difference.
    #[inline(always)]
    fn between([a, b, c, d]: [Vec3A; 4]) -> Self {
        let [above, below, left, right] = [a - b, c - d, a - c, b - d];
        let (level, upright) = (above * above + below * below, left * left + right * right);
        let twisted = (above - below) * (above - below);
        let light = (a * a + b * b + c * c + d * d) * 0.25;
        let squares = light - (level + upright) / 12.0 + twisted / 36.0;
        Self { levels: (a + b + c + d) * 0.25, squares, light }
    }

    /// That of four squares.
    #[inline(always)]
    fn of([a, b, c, d]: [&Self; 4]) -> Self {
        Self {
            levels: (a.levels + b.levels + c.levels + d.levels) * 0.25,
            squares: (a.squares + b.squares + c.squares + d.squares) * 0.25,
            light: (a.light + b.light + c.light + d.light) * 0.25,
        }
    }

    /// By how much the levels in the square are off from that of its mean light, if a plane makes so much of their variance.
    #[inline(always)]
    fn off(&self, sloped: Vec3A) -> Off {
        let apart = self.squares + self.light - 2.0 * self.levels * self.light.sqrt();
        let [red, green, blue] = (apart - sloped).to_array();
        Off::of_square((red + green + blue) / 3.0)
    }
}

impl Pyramid {
    pub(super) fn of(image: &Image) -> Self {
        let size = halved(image.size());
        let mut fine = Grid { size, cells: Vec::with_capacity(size[0] * size[1]) };
        let mut wide = Grid { size: halved(size), cells: Vec::new() };
        let mut grids = [size, wide.size].map(|size| Grid { size, cells: Vec::new() });
        // Four rows of squares between texels at a time, of which there may be very many: two rows of the next, one of those
        // beyond.
        for row in (0..size[1]).step_by(2) {
            let squares = Grid::between_texels(image, 2 * row..2 * row + 4);
            let two = squares.joined([size[0], (size[1] - row).min(2)]);
            grids[0].cells.extend(two.off(|place| sloped::<2>(place, |at| squares.at(at).levels)));
            fine.cells.extend(two.cells.iter().map(|mean| mean.levels));
            if row / 2 < wide.size[1] {
                let one = two.joined([wide.size[0], 1]);
                let off = one.off(|place| sloped::<4>(place, |at| squares.at(at).levels));
                grids[1].cells.extend(off);
                wide.cells.extend(one.cells);
            }
        }
        let mut grids = Vec::from(grids);
        if size == [1, 1] {
            grids.pop();
        }
        while wide.size != [1, 1] {
            let wider = wide.joined(halved(wide.size));
            let off = wider.off(|place| sloped::<4>(place, |at| *fine.at(at)));
            grids.push(Grid { size: wider.size, cells: off.collect() });
            let levels = wide.cells.iter().map(|mean| mean.levels);
            fine = Grid { size: wide.size, cells: levels.collect() };
            wide = wider;
        }
        Self { grids }
    }

    /// The squared error, in levels, of the colour at (`x`, `y`), in texels from the upper left corner, as the mean of a
    /// square whose sides are so many texels, more than one. Texels by themselves have none.
    pub(super) fn at(&self, place: [f64; 2], side: f64, beyond: Beyond) -> f32 {
        let width = |doublings: usize| (1_u64 << doublings) as f64;
        let side = side.min(width(self.grids.len()));
        let doublings = side.log2() as usize;
        // The squares are between the middles of texels.
        let place = place.map(|x| ((x - 0.5) * PARTS as f64) as i64);
        let of = |doublings: usize| {
            let grid = doublings.checked_sub(1).and_then(|k| self.grids.get(k));
            grid.map_or(0.0, |grid| grid.square_at(place.map(|x| x >> doublings), beyond))
        };
        let part = (side / width(doublings) - 1.0) as f32;
        of(doublings) * (1.0 - part) + of(doublings + 1) * part
    }
}

/// The columns and rows of squares twice as wide. The last row or column of an odd number is left out.
fn halved(size: [usize; 2]) -> [usize; 2] {
    size.map(|count| (count / 2).max(1))
}

/// The columns and rows of a grid, row by row.
fn places([width, height]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    (0..height).flat_map(move |row| (0..width).map(move |column| [column, row]))
}

/// What the plane that is nearest to the `levels` of N × N squares makes of the variance of the one that they are together, in
/// this column and row of such: a little more than of that of their means.
#[inline(always)]
fn sloped<const N: usize>([x, y]: [usize; 2], levels: impl Fn([usize; 2]) -> Vec3A) -> Vec3A {
    let from_middle = |k: usize| k as f32 - (N as f32 - 1.0) / 2.0;
    let (mut across, mut down, mut squares) = (Vec3A::ZERO, Vec3A::ZERO, 0.0);
    for j in 0..N {
        for i in 0..N {
            let levels = levels([N * x + i, N * y + j]);
            across += levels * from_middle(i);
            down += levels * from_middle(j);
            squares += from_middle(i) * from_middle(i);
        }
    }
    (across * across + down * down) / (squares * (N * N - 1) as f32)
}

impl<T> Grid<T> {
    /// What there is in a column and row; the last one goes on beyond.
    #[inline(always)]
    fn at(&self, [x, y]: [usize; 2]) -> &T {
        let [width, height] = self.size;
        &self.cells[y.min(height - 1) * width + x.min(width - 1)]
    }
}

impl Grid<Mean> {
    /// Some rows of the squares between the middles of four texels each, to the right of and below each texel.
    fn between_texels(image: &Image, rows: Range<usize>) -> Self {
        let [width, height] = image.size();
        let row = |y: usize| {
            let row = &image.texels()[y.min(height - 1) * width..][..width];
            let levels = |texel: &[u8; 3]| Vec3A::from_array(texel.map(f32::from));
            row.iter().chain(row.last()).map(levels).collect::<Vec<Vec3A>>()
        };
        let size = [width, rows.len()];
        let mut cells = Vec::with_capacity(width * rows.len());
        let mut above = row(rows.start);
        for y in rows {
            let below = row(y + 1);
            let pairs = above.windows(2).zip(below.windows(2));
            cells.extend(pairs.map(|(a, c)| Mean::between([a[0], a[1], c[0], c[1]])));
            above = below;
        }
        Self { size, cells }
    }

    /// Squares twice as wide, of so many columns and rows.
    fn joined(&self, size: [usize; 2]) -> Self {
        let mean = |[x, y]: [usize; 2]| {
            let (x, y) = (2 * x, 2 * y);
            Mean::of([[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(|part| self.at(part)))
        };
        Self { size, cells: places(size).map(mean).collect() }
    }

    /// [`Mean::off`] of each, by what is sloped in its column and row.
    fn off(&self, sloped: impl Fn([usize; 2]) -> Vec3A) -> impl Iterator<Item = Off> {
        self.cells.iter().zip(places(self.size)).map(move |(mean, place)| mean.off(sloped(place)))
    }
}

impl Grid<Off> {
    /// The squared error at a place in [`PARTS`] of squares from the upper left corner, bilinear between their middles.
    fn square_at(&self, [x, y]: [i64; 2], beyond: Beyond) -> f32 {
        let between = |x: i64, count: usize| {
            let x = x - PARTS / 2;
            let part = (x & (PARTS - 1)) as f32 / PARTS as f32;
            let entry = |x: i64| match beyond {
                Beyond::Edge => x.clamp(0, count as i64 - 1) as usize,
                Beyond::Again => x.rem_euclid(count as i64) as usize,
            };
            let first = x.div_euclid(PARTS);
            (entry(first), entry(first + 1), part)
        };
        let ((x0, x1, p), (y0, y1, q)) = (between(x, self.size[0]), between(y, self.size[1]));
        let square = |column: usize, row: usize| self.at([column, row]).square();
        let upper = square(x0, y0) * (1.0 - p) + square(x1, y0) * p;
        let lower = square(x0, y1) * (1.0 - p) + square(x1, y1) * p;
        upper * (1.0 - q) + lower * q
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::{
        aa::levels::{levels, squared_distance},
        color::Rgb,
        math::random::SplitMix64,
    };

    const SIDE: usize = 64;

    fn detail(image: &Image, place: [f64; 2], side: f64, beyond: Beyond) -> f32 {
        Pyramid::of(image).at(place, side, beyond)
    }

    fn picture(texel: impl FnMut([usize; 2]) -> u8) -> Image {
        let bytes: Vec<u8> = places([SIDE, SIDE]).map(texel).flat_map(|byte| [byte; 3]).collect();
        Image::from_levels([SIDE, SIDE], &bytes)
    }

    /// The mean squared difference, in levels, of a place and a square of `side` texels about it; and what is said of it.
    fn measured_and_said(image: &Image, side: f64) -> [f32; 2] {
        const PLACES: usize = 2000;
        let fine = (4.0 * side).ceil().max(8.0) as usize;
        let (pyramid, mut random) = (Pyramid::of(image), SplitMix64::new(1));
        let mut place = || side / 2.0 + 1.0 + (SIDE as f64 - side - 2.0) * random.uniform();
        let mut sums = [0.0; 2];
        for [x, y] in std::iter::repeat_with(|| [place(), place()]).take(PLACES) {
            let color =
                |x: f64, y: f64| image.sample(DVec2::new(x / SIDE as f64, 1.0 - y / SIDE as f64));
            let from_middle = |k: usize| ((k as f64 + 0.5) / fine as f64 - 0.5) * side;
            let beside = |[i, j]: [usize; 2]| color(x + from_middle(i), y + from_middle(j));
            let mean = places([fine, fine]).map(beside).sum::<Rgb>() / fine.pow(2) as f32;
            sums[0] += squared_distance(levels(color(x, y)), levels(mean));
            sums[1] += pyramid.at([x, y], side, Beyond::Edge);
        }
        sums.map(|sum| sum / PLACES as f32)
    }

    /// Oracle: means over squares at random places. A step is taken for a slope in part, by which it is told from noise.
    #[test]
    fn what_is_said_is_what_rays_are_off_by() {
        let mut random = SplitMix64::new(5);
        let greys = picture(|_| (random.uniform() * 256.0) as u8);
        let bits = picture(|[x, y]| if (x / 2 * 37 + y / 2 * 101) % 11 < 5 { 0 } else { 255 });
        let lines = picture(|[x, _]| if x % 8 == 3 { 255 } else { 0 });
        let waves =
            picture(|[x, y]| (127.5 + 120.0 * (0.7 * x as f64 + 0.4 * y as f64).cos()) as u8);
        for (name, image) in [("greys", greys), ("bits", bits), ("lines", lines), ("waves", waves)]
        {
            for side in [1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 16.0] {
                let [off, said] = measured_and_said(&image, side);
                assert!((0.55..1.6).contains(&(said / off)), "{name}, {side}: {said} for {off}");
            }
        }
    }

    #[test]
    fn slopes_and_plain_colours_have_little_detail() {
        let slope = picture(|[x, y]| (100 + x + y) as u8);
        for side in [2.0, 4.0, 8.0, 16.0] {
            let variance = side * side / 6.0;
            let at = |[x, y]: [usize; 2]| detail(&slope, [x as f64, y as f64], side, Beyond::Edge);
            let most = [[20, 20], [33, 40], [50, 15]].map(at).into_iter().fold(0.0, f32::max);
            assert!(f64::from(most) < 0.2 * variance, "{side}: {most}");
        }
        let plain = picture(|_| 77);
        assert_eq!(detail(&plain, [20.0, 20.0], 32.0, Beyond::Edge), 0.0);
    }

    /// Oracle: where the one white texel is.
    #[test]
    fn detail_is_where_it_is() {
        let image = picture(|place| if place == [50, 10] { 255 } else { 0 });
        assert!(detail(&image, [50.5, 10.5], 4.0, Beyond::Edge) > 1000.0);
        assert_eq!(detail(&image, [20.5, 40.5], 4.0, Beyond::Edge), 0.0);
        // Seen from the other side of the edge, if the picture is repeated.
        let image = picture(|place| if place == [63, 10] { 255 } else { 0 });
        let beside = |beyond| detail(&image, [0.5, 10.5], 4.0, beyond);
        assert!(beside(Beyond::Again) > 100.0 && beside(Beyond::Edge) == 0.0);
    }

    /// Pictures of any size have details of all sizes.
    #[test]
    fn odd_and_narrow_pictures_are_no_exception() {
        for size in [[1, 1], [1, 9], [7, 1], [3, 2], [451, 300]] {
            let image = Image::from_levels(size, &vec![9; 3 * size[0] * size[1]]);
            assert_eq!(detail(&image, [0.3, 0.2], 1e9, Beyond::Again), 0.0, "{size:?}");
        }
        let barcode: Vec<u8> =
            (0..64).flat_map(|x| [if x % 2 == 0 { 255_u8 } else { 0 }; 3]).collect();
        let barcode = Image::from_levels([64, 1], &barcode);
        assert!(detail(&barcode, [32.0, 0.5], 8.0, Beyond::Edge) > 8_000.0);
    }
}
