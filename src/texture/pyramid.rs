//! What of a picture is finer than the rays that meet it.

use super::image::{Beyond, Image};
use crate::color::Rgb;

/// For squares of 2 × 2, 4 × 4, ... texels of a picture, how far colours in them are from the mean of their light.
///
/// A ray that stands for such a square is off by that, wherever in the picture it falls. A slope from side to side does
/// not count: it is the same on both sides of a ray through the middle.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    grids: Vec<Grid>,
}

/// Places are in so many parts of a texel or square: a power of two.
const PARTS: i64 = 256;

/// The squares of one size.
#[derive(Clone, Debug)]
struct Grid {
    size: [usize; 2],
    /// Root mean squares, row by row from the top.
    off: Vec<Off>,
}

/// A number of levels of 255, as sixteen times its square root, so that small ones are told apart as well.
#[derive(Clone, Copy, Debug)]
struct Off(u8);

impl Off {
    fn of_square(square: f32) -> Self {
        Self((16.0 * square.max(0.0).sqrt().sqrt() + 0.5) as u8)
    }

    fn square(self) -> f32 {
        let root = f32::from(self.0) / 16.0;
        (root * root) * (root * root)
    }
}

/// Means over each square of one size.
struct Means {
    size: [usize; 2],
    cells: Vec<Mean>,
}

/// Means over a square, channel by channel.
#[derive(Clone, Copy)]
struct Mean {
    levels: Rgb,
    /// Of the squared levels, between the texels as well.
    squares: Rgb,
    /// Of the squared levels of the texels alone: of light, of which levels are taken to be the root, and which is bilinear
    /// between them.
    light: Rgb,
}

impl Mean {
    /// That of the square between the middles of four texels, where colours are bilinear. From a to b the mean square is
    /// that of the two, less a sixth of their squared difference.
    fn between([a, b, c, d]: [Rgb; 4]) -> Self {
        let [above, below, left, right] = [a - b, c - d, a - c, b - d];
        let (level, upright) = (above * above + below * below, left * left + right * right);
        let twisted = (above - below) * (above - below);
        let light = (a * a + b * b + c * c + d * d) * 0.25;
        let squares = light - (level + upright) / 12.0 + twisted / 36.0;
        Self { levels: (a + b + c + d) * 0.25, squares, light }
    }

    /// That of four squares.
    fn of([a, b, c, d]: [Self; 4]) -> Self {
        Self {
            levels: (a.levels + b.levels + c.levels + d.levels) * 0.25,
            squares: (a.squares + b.squares + c.squares + d.squares) * 0.25,
            light: (a.light + b.light + c.light + d.light) * 0.25,
        }
    }

    /// By how much the levels in the square are off from that of its mean light, if a plane makes so much of their variance.
    fn off(&self, sloped: Rgb) -> Off {
        let apart = self.squares + self.light - 2.0 * self.levels * self.light.map(f32::sqrt);
        Off::of_square((apart - sloped).element_sum() / 3.0)
    }
}

impl Pyramid {
    pub(super) fn of(image: &Image) -> Self {
        // Means of texels are made when they are asked for: there may be very many.
        let texels = Texels(image);
        let mut fine = Means::joined(image.size(), |place| texels.mean(place));
        let mut grids =
            vec![Grid::of(&fine, |place| sloped::<2>(place, |part| texels.levels(part)))];
        if fine.size == [1, 1] {
            return Self { grids };
        }
        let mut wide = Means::joined(fine.size, |place| *fine.at(place));
        grids.push(Grid::of(&wide, |place| sloped::<4>(place, |part| texels.levels(part))));
        while wide.size != [1, 1] {
            let wider = Means::joined(wide.size, |place| *wide.at(place));
            grids.push(Grid::of(&wider, |place| sloped::<4>(place, |part| fine.at(part).levels)));
            (fine, wide) = (wide, wider);
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
            grid.map_or(0.0, |grid| grid.at(place.map(|x| x >> doublings), beyond))
        };
        let part = (side / width(doublings) - 1.0) as f32;
        of(doublings) * (1.0 - part) + of(doublings + 1) * part
    }
}

/// The squares between the middles of four texels each, to the right of and below each texel.
struct Texels<'a>(&'a Image);

impl Texels<'_> {
    #[inline(always)]
    fn mean(&self, place: [usize; 2]) -> Mean {
        Mean::between(self.corners(place))
    }

    /// [`Mean::levels`].
    #[inline(always)]
    fn levels(&self, place: [usize; 2]) -> Rgb {
        let [a, b, c, d] = self.corners(place);
        (a + b + c + d) * 0.25
    }

    #[inline(always)]
    fn corners(&self, [x, y]: [usize; 2]) -> [Rgb; 4] {
        let ([width, height], texels) = (self.0.size(), self.0.texels());
        let (left, right) = (x.min(width - 1), (x + 1).min(width - 1));
        let (above, below) = (y.min(height - 1) * width, (y + 1).min(height - 1) * width);
        [above + left, above + right, below + left, below + right]
            .map(|at| Rgb::from_array(texels[at].map(f32::from)))
    }
}

impl Means {
    /// The squares twice as wide as those of a grid of this size. The last row or column of an odd number is left out.
    fn joined(size: [usize; 2], mean: impl Fn([usize; 2]) -> Mean) -> Self {
        let size = size.map(|count| (count / 2).max(1));
        let cells = places(size).map(|[x, y]| {
            let (x, y) = (2 * x, 2 * y);
            Mean::of([[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(&mean))
        });
        Self { size, cells: cells.collect() }
    }

    /// The square of a column and row; the last one goes on beyond.
    #[inline(always)]
    fn at(&self, [x, y]: [usize; 2]) -> &Mean {
        let [width, height] = self.size;
        &self.cells[y.min(height - 1) * width + x.min(width - 1)]
    }
}

/// What the plane that is nearest to the `levels` of N × N squares makes of the variance of the one that they are together, in
/// this column and row of such: a little more than of that of their means.
#[inline(always)]
fn sloped<const N: usize>([x, y]: [usize; 2], levels: impl Fn([usize; 2]) -> Rgb) -> Rgb {
    let from_middle = |k: usize| k as f32 - (N as f32 - 1.0) / 2.0;
    let (mut across, mut down, mut squares) = (Rgb::ZERO, Rgb::ZERO, 0.0);
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

/// The columns and rows of a grid, row by row.
fn places([width, height]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    (0..height).flat_map(move |row| (0..width).map(move |column| [column, row]))
}

impl Grid {
    fn of(means: &Means, sloped: impl Fn([usize; 2]) -> Rgb) -> Self {
        let off = means.cells.iter().zip(places(means.size));
        Self { size: means.size, off: off.map(|(mean, place)| mean.off(sloped(place))).collect() }
    }

    /// The squared error at a place in [`PARTS`] of squares from the upper left corner, bilinear between their middles.
    fn at(&self, [x, y]: [i64; 2], beyond: Beyond) -> f32 {
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
        let square = |column: usize, row: usize| self.off[row * self.size[0] + column].square();
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
