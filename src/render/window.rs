//! The centres of a tile among those around them.

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

/// The pixels of a row that are judged together: those of the widest tile and one to either side, in fours. Of a row that has
/// fewer, the others are any.
const LANES: usize = (TILE_SIDE as usize + 2).next_multiple_of(4);

/// The squared differences between a pixel of noise and its eight neighbours, as a multiple of the noise's variance.
const CONTRAST_OF_NOISE: f32 = 16.0;

/// The centres of a tile and of the pixels around it, encoded; pixels outside of what is known repeat those at its
/// edge.
pub(super) struct Window {
    /// Display levels, channel by channel.
    levels: [Vec<f32>; 3],
    signatures: Vec<u32>,
    /// If any are seen.
    pictures: Option<Pictures>,
    around: Area,
    /// The pixels between the edges of the tile and of the window.
    margin: usize,
}

/// What pictures on surfaces tell of the pixels of a window.
struct Pictures {
    /// Their squared errors.
    details: Vec<f32>,
    /// 1, or 0 where there is no noise but that of a picture.
    guessed: Vec<f32>,
}

/// What the centres of a tile say of its pixels, row by row.
pub(super) struct Survey {
    /// The squared errors as if all neighbours had met the same, after the second-order term of the integral over the
    /// pixel was added to the colour.
    pub(super) smooth: Vec<f32>,
    /// The noise about them.
    pub(super) noise: Vec<Noise>,
    /// As [`Window::suspects`].
    pub(super) suspects: Vec<(usize, Look)>,
}

/// The noise of 3 × 3 pixels: where a pixel is amid noise it is off by as much as those around, also if its own neighbours are like
/// it by chance. Those do not count whose neighbours met anything else.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Noise {
    /// The sum of the pixels' errors by noise, and the most that it could be.
    error: f32,
    most: f32,
}

impl Survey {
    /// The contrast of the pixels to their neighbours, row by row.
    pub(super) fn contrasts(&self) -> Vec<f32> {
        let mut contrasts: Vec<f32> = self.noise.iter().map(|noise| noise.contrast()).collect();
        for (place, look) in &self.suspects {
            contrasts[*place] = look.contrast;
        }
        contrasts
    }
}

impl Noise {
    fn and(self, other: Self) -> Self {
        Self { error: self.error + other.error, most: self.most + other.most }
    }

    /// The squared error of the pixel in the middle, none where it is not busy.
    pub(super) fn error(self) -> f32 {
        self.busy() * self.error / 9.0
    }

    /// The squared differences between that pixel and its eight neighbours.
    pub(super) fn contrast(self) -> f32 {
        CONTRAST_OF_NOISE * self.error()
    }

    /// How busy it is there.
    pub(super) fn busy(self) -> f32 {
        busy_of_noise(self.error / self.most.max(f32::MIN_POSITIVE))
    }
}

/// Where in a window a row of pixels begins, one pixel before its first, with the rows above and below.
struct Row {
    starts: [usize; 3],
}

/// The squared second differences of the pixels of a row, and the squared differences of their opposite neighbours: each the
/// mean of the channels, and the sum of horizontal and vertical.
struct Bends {
    curve: [f32; LANES],
    slope: [f32; LANES],
}

/// What there is of the pixels of a row that begins there.
#[inline(always)]
fn lanes<T>(entries: &[T], start: usize) -> &[T] {
    &entries[start..start + LANES]
}

impl Window {
    /// The window `margin` pixels about `tile` of `area`, of whose pixels, counted row by row, `see` tells colour,
    /// signature and detail.
    pub(super) fn new(
        (tile, margin): (&Area, usize),
        area: &Area,
        see: impl Fn(usize) -> (Rgb, u32, Detail),
    ) -> Self {
        let around = tile.grown(margin as i64);
        let (width, len) = (around.width(), around.len() + LANES);
        let mut levels_of = [(); 3].map(|()| vec![0.0; len]);
        let (mut signatures, mut pictures) = (vec![0; len], None);
        let columns: Vec<usize> = (around.x0..around.x1).map(|x| area.nearest_column(x)).collect();
        for (y, start) in (around.y0..around.y1).zip((0..).step_by(width)) {
            let (row, places) = (area.nearest_row(y), start..start + width);
            let [red, green, blue] = levels_of.each_mut().map(|of| &mut of[places.clone()]);
            let signatures = &mut signatures[places];
            for (k, column) in columns.iter().enumerate() {
                let (color, signature, detail) = see(row + column);
                let levels = levels(color);
                (red[k], green[k], blue[k]) = (levels.x, levels.y, levels.z);
                signatures[k] = signature;
                if detail != Detail::default() {
                    pictures.get_or_insert_with(|| Pictures::none(len)).set(start + k, detail);
                }
            }
        }
        Self { levels: levels_of, signatures, pictures, around, margin }
    }

    /// The window `margin` pixels about `tile` of traced centres.
    pub(super) fn of_centers(tile: &Area, margin: usize, centers: &Plane<Sample>) -> Self {
        let samples = centers.values();
        Self::new((tile, margin), centers.area(), |place| {
            let Sample { color, signature, detail, .. } = samples[place];
            (color, signature, detail)
        })
    }

    /// What the centres say of the tile's pixels. Takes a margin of two pixels.
    pub(super) fn survey(&self) -> Survey {
        let [width, height] = self.tile_size();
        let mut smooth = Vec::with_capacity(width * height);
        let mut suspects = Vec::new();
        let mut noise_of_rows = Vec::with_capacity(height + 2);
        for (number, row) in self.rows(1).enumerate() {
            let (bends, differing) = (self.bends(&row), self.differing(&row));
            if (1..=height).contains(&number) {
                let off = self.off(&row, &bends, |curve| curve_error(curve, true));
                smooth.extend_from_slice(&off[1..=width]);
                let place = (number - 1) * width;
                suspects.extend(self.looks(&differing[1..=width], row.starts[1] + 2, place));
            }
            let off = self.off(&row, &bends, |_| 0.0);
            let of_noise = |k: usize| match differing[k] {
                0 => Noise { error: off[k], most: most_noise_error(bends.curve[k]) },
                _ => Noise::default(),
            };
            let noise: [Noise; LANES] = std::array::from_fn(of_noise);
            noise_of_rows.push(noise);
        }
        let mut noise = Vec::with_capacity(width * height);
        for three in noise_of_rows.windows(3) {
            let sum: [Noise; LANES] =
                std::array::from_fn(|k| three[0][k].and(three[1][k]).and(three[2][k]));
            noise.extend((0..width).map(|k| sum[k].and(sum[k + 1]).and(sum[k + 2])));
        }
        Survey { smooth, noise, suspects }
    }

    /// The squared errors of the pixels of a row with these [`bends`](Self::bends): what `smooth` says of the second
    /// differences, and noise, as far as the pixel's picture does not tell; at least that of the picture.
    #[inline(always)]
    fn off(&self, row: &Row, bends: &Bends, smooth: impl Fn(f32) -> f32) -> [f32; LANES] {
        let Bends { curve, slope } = bends;
        let noise = |k: usize| noise_error(curve[k], slope[k]);
        match &self.pictures {
            None => std::array::from_fn(|k| smooth(curve[k]) + noise(k)),
            Some(pictures) => {
                let first = row.starts[1] + 1;
                let [details, guessed] =
                    [&pictures.details, &pictures.guessed].map(|of| lanes(of, first));
                std::array::from_fn(|k| (smooth(curve[k]) + noise(k) * guessed[k]).max(details[k]))
            }
        }
    }

    #[inline(always)]
    fn bends(&self, row: &Row) -> Bends {
        let [above, at, below] = row.starts;
        let (mut curve, mut slope) = ([0.0; LANES], [0.0; LANES]);
        for channel in &self.levels {
            let [west, here, east] = [at, at + 1, at + 2].map(|start| lanes(channel, start));
            let [north, south] = [above + 1, below + 1].map(|start| lanes(channel, start));
            for k in 0..LANES {
                let across = west[k] + east[k] - 2.0 * here[k];
                let down = north[k] + south[k] - 2.0 * here[k];
                let (level, upright) = (west[k] - east[k], north[k] - south[k]);
                curve[k] += across * across + down * down;
                slope[k] += level * level + upright * upright;
            }
        }
        Bends { curve: curve.map(|sum| sum / 3.0), slope: slope.map(|sum| sum / 3.0) }
    }

    /// The estimated squared error of each of the tile's centres, row by row, as [`Look::center_error`] has it.
    pub(super) fn center_errors(&self) -> Vec<f32> {
        let [width, height] = self.tile_size();
        let mut errors = Vec::with_capacity(width * height);
        for row in self.rows(0) {
            let mut off = self.off(&row, &self.bends(&row), |curve| curve_error(curve, false));
            if self.differing(&row)[..width].iter().any(|differs| *differs != 0) {
                for (error, edge) in off.iter_mut().zip(self.edges(&row)) {
                    *error = error.max(edge_error(edge));
                }
            }
            errors.extend_from_slice(&off[..width]);
        }
        errors
    }

    /// The pixels of the tile whose neighbours' rays met anything else: where in it they are, counted row by row, and
    /// their looks.
    pub(super) fn suspects(&self) -> Vec<(usize, Look)> {
        let [width, _] = self.tile_size();
        let mut suspects = Vec::new();
        for (y, row) in self.rows(0).enumerate() {
            let differing = self.differing(&row);
            suspects.extend(self.looks(&differing[..width], row.starts[1] + 1, y * width));
        }
        suspects
    }

    /// Those of a row of pixels, from place `middle` of the window and place `place` of the tile, that are `differing`, and
    /// their looks.
    fn looks(
        &self,
        differing: &[u32],
        middle: usize,
        place: usize,
    ) -> impl Iterator<Item = (usize, Look)> {
        let others = differing.iter().enumerate().filter(|(_, differs)| **differs != 0);
        others.map(move |(k, _)| (place + k, self.look(middle + k)))
    }

    /// Zero for those pixels of a row whose neighbours' rays all met the same.
    #[inline(always)]
    fn differing(&self, row: &Row) -> [u32; LANES] {
        let mut differing = [0; LANES];
        let centers = lanes(&self.signatures, row.starts[1] + 1);
        for start in row.starts.into_iter().flat_map(|start| start..start + 3) {
            let others = lanes(&self.signatures, start);
            for k in 0..LANES {
                differing[k] |= others[k] ^ centers[k];
            }
        }
        differing
    }

    /// [`Look::edge`] of the pixels of a row.
    fn edges(&self, row: &Row) -> [f32; LANES] {
        let mut edges = [0.0; LANES];
        let middle = row.starts[1] + 1;
        for (place, weight) in NEIGHBOURS {
            let other = row.starts[place / 3] + place % 3;
            let mut squares = [0.0; LANES];
            for channel in &self.levels {
                let [here, there] = [middle, other].map(|start| lanes(channel, start));
                for k in 0..LANES {
                    squares[k] += (there[k] - here[k]) * (there[k] - here[k]);
                }
            }
            let [here, there] = [middle, other].map(|start| lanes(&self.signatures, start));
            for k in 0..LANES {
                edges[k] += if here[k] == there[k] { 0.0 } else { weight / 3.0 * squares[k] };
            }
        }
        edges
    }

    /// Columns and rows of the tile.
    fn tile_size(&self) -> [usize; 2] {
        [self.around.width(), self.around.height()].map(|side| side - 2 * self.margin)
    }

    /// The rows of the tile, and of `ring` pixels about it, fewer than the margin.
    fn rows(&self, ring: usize) -> impl Iterator<Item = Row> + use<> {
        let (width, outside) = (self.around.width(), self.margin - ring);
        (outside..self.around.height() - outside).map(move |row| {
            let starts = [row - 1, row, row + 1].map(|row| row * width + outside - 1);
            Row { starts }
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

impl Pictures {
    /// No picture, in so many pixels.
    fn none(len: usize) -> Self {
        Self { details: vec![0.0; len], guessed: vec![1.0; len] }
    }

    fn set(&mut self, place: usize, detail: Detail) {
        self.details[place] = detail.squared_error();
        self.guessed[place] = if detail.is_whole() { 0.0 } else { 1.0 };
    }
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
            let mut looks = Vec::new();
            for (x, y) in tile.pixels() {
                let around: [Sample; 9] = std::array::from_fn(|k| {
                    *centers.nearest(x + k as i64 % 3 - 1, y + k as i64 / 3 - 1)
                });
                looks.push(Look::at(
                    &around.map(|sample| levels(sample.color)),
                    &around.map(|sample| sample.signature),
                ));
            }
            let errors = window.center_errors();
            assert_eq!(errors.len(), looks.len());
            for (error, look) in errors.iter().zip(&looks) {
                let expected = look.center_error();
                assert!((error - expected).abs() <= 1e-5 * expected, "{error}, {expected}");
            }
            let is_suspect = |k: &usize| looks[*k].busy > 0.0 || looks[*k].edge > 0.0;
            let survey = Window::of_centers(&tile, 2, &centers).survey();
            assert_eq!((survey.smooth.len(), survey.noise.len()), (looks.len(), looks.len()));
            for suspects in [window.suspects(), survey.suspects] {
                assert!(suspects.iter().map(|(k, _)| *k).eq((0..looks.len()).filter(is_suspect)));
                assert!(suspects.iter().all(|(k, look)| *look == looks[*k]));
            }
        }
    }
}
