//! How far a pixel is from its true colour, judged by the samples at hand.
//!
//! All errors are mean squared differences of the three channels in display levels of 255. The constants are shares of
//! what can be seen: of the variance of a pixel's samples, or of the contrast to its neighbours. None depends on the scene.

use glam::Vec3;

use super::levels::{levels, squared_distance};
use crate::color::Rgb;

/// The error of a single centre, as a share of its squared differences to neighbours of another signature.
const CENTER_EDGE: f32 = 0.030;
/// The same as a share of the squared second differences, where all neighbours have the centre's signature.
const CENTER_CURVE: f32 = 0.016;
/// And where the second difference was used to correct the colour.
const CORRECTED_CURVE: f32 = 0.008;
/// How much more it is where colours follow no slope: points of noise are off by their variance, and their squared second
/// differences in both directions are twelve times that.
const NOISE: f32 = 4.2;

/// A pixel's centre among its eight neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Whether a neighbour's ray met anything else.
    pub suspect: bool,
    /// Whether the four neighbours at the sides have the centre's signature.
    pub inner: bool,
    /// Squared differences to neighbours of another signature, those at the corners counted half.
    pub edge: f32,
    /// Squared differences to all neighbours.
    pub contrast: f32,
    /// Squared second differences, horizontal and vertical.
    pub curve: f32,
    /// Squared differences of opposite neighbours, horizontal and vertical.
    pub slope: f32,
}

/// The neighbours in the order of [`Look::at`], and what they count in [`Look::edge`].
const NEIGHBOURS: [(usize, f32); 8] =
    [(1, 1.0), (3, 1.0), (5, 1.0), (7, 1.0), (0, 0.5), (2, 0.5), (6, 0.5), (8, 0.5)];

impl Look {
    /// The look of the middle one of 3 × 3 centres, given row by row as display levels and signatures.
    pub fn at(levels: &[Vec3; 9], signatures: &[u32; 9]) -> Self {
        let (center, signature) = (levels[4], signatures[4]);
        let (mut edge, mut contrast) = (0.0, 0.0);
        for (place, weight) in NEIGHBOURS {
            let square = squared_distance(levels[place], center);
            contrast += square;
            if signatures[place] != signature {
                edge += weight * square;
            }
        }
        let bend =
            |a: usize, b: usize| (levels[a] + levels[b] - 2.0 * center).length_squared() / 3.0;
        Self {
            suspect: signatures.iter().any(|s| *s != signature),
            inner: [1, 3, 5, 7].iter().all(|&place| signatures[place] == signature),
            edge,
            contrast,
            curve: bend(3, 5) + bend(1, 7),
            slope: squared_distance(levels[3], levels[5]) + squared_distance(levels[1], levels[7]),
        }
    }

    /// The error of the centre's colour; `corrected` is whether the second-order term of the box integral was added.
    pub fn center_error(&self, corrected: bool) -> f32 {
        if self.suspect {
            return (CENTER_EDGE * self.edge).max(self.texture_error(CENTER_CURVE));
        }
        self.texture_error(if corrected { CORRECTED_CURVE } else { CENTER_CURVE })
    }

    /// The share of the second differences grows as they outweigh the slope: from what is left of a smooth function to all
    /// of a noise's variance.
    fn texture_error(&self, share: f32) -> f32 {
        if self.curve <= 0.0 {
            return 0.0;
        }
        let noise = (self.curve / (3.0 * self.slope)).min(1.0); // 3 for noise; a slope of zero gives 1
        self.curve * (share + CENTER_CURVE * NOISE * noise * noise)
    }
}

/// The mean and spread of a pixel's samples, and how many different things they met.
#[derive(Clone, Debug, Default)]
pub struct Spread {
    /// The display levels that the deviations are from, so that their squares stay small.
    origin: Vec3,
    deviation: Vec3,
    square: f32,
    count: u32,
    signatures: Vec<u32>,
}

impl Spread {
    /// Nothing sampled yet; colours are expected near `origin`, in display levels.
    pub fn about(origin: Vec3) -> Self {
        Self { origin, ..Self::default() }
    }

    /// Takes in a sample.
    pub fn add(&mut self, color: Rgb, signature: u32) {
        let deviation = levels(color) - self.origin;
        self.deviation += deviation;
        self.square += deviation.length_squared() / 3.0;
        self.count += 1;
        if !self.signatures.contains(&signature) {
            self.signatures.push(signature);
        }
    }

    /// How many samples there are.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The number of different signatures.
    pub fn kinds(&self) -> usize {
        self.signatures.len()
    }

    /// The signature, if all samples share it.
    pub fn only_signature(&self) -> Option<u32> {
        match *self.signatures {
            [signature] => Some(signature),
            _ => None,
        }
    }

    /// The mean in display levels.
    pub fn mean(&self) -> Vec3 {
        self.origin + self.deviation / self.count.max(1) as f32
    }

    /// The unbiased variance.
    pub fn variance(&self) -> f32 {
        if self.count < 2 {
            return 0.0;
        }
        let n = self.count as f32;
        ((self.square - self.deviation.length_squared() / (3.0 * n)) / (n - 1.0)).max(0.0)
    }

    /// The error of the mean of samples whose pattern leaves the share `kappa` of the variance at a single edge.
    ///
    /// More kinds of surfaces mean more edges, which even patterns deal with less well; but no mean is worse than that of
    /// random samples.
    pub fn error(&self, kappa: f32) -> f32 {
        let edges = self.kinds().max(2) as f32 - 1.0;
        let share = (kappa * edges.powf(0.45)).min(1.0 / self.count.max(1) as f32);
        share * self.variance()
    }
}

/// `y` at `x` by straight lines between the points of `table` in logarithms of both; straight on beyond its ends.
fn by_logarithms(table: &[(f32, f32)], x: f32) -> f32 {
    let last = table.len() - 1;
    let place = table.iter().skip(1).take(last - 1).take_while(|(from, _)| *from < x).count();
    let ((x0, y0), (x1, y1)) = (table[place], table[place + 1]);
    y0 * (y1 / y0).powf((x / x0).ln() / (x1 / x0).ln())
}

/// The share of the variance that `points` of the [`Sequence`](super::sobol::Sequence) leave, with centre and corners; 0 is
/// centre and corners alone.
pub fn sequence_share(points: u32) -> f32 {
    const SHARES: [(f32, f32); 6] =
        [(1.0, 0.078), (4.0, 0.036), (8.0, 0.018), (16.0, 0.0070), (32.0, 0.0027), (64.0, 0.0011)];
    by_logarithms(&SHARES, points.max(1) as f32)
}

/// The share of the neighbours' contrast that may hide between equal samples of a suspect pixel.
pub fn sequence_unseen(points: u32) -> f32 {
    const SHARES: [(f32, f32); 6] =
        [(1.0, 3e-4), (4.0, 7e-5), (8.0, 2.2e-5), (16.0, 5e-6), (32.0, 1e-6), (64.0, 2e-7)];
    by_logarithms(&SHARES, points.max(1) as f32)
}

/// The share of the variance that `points` of the sequence leave by themselves.
pub fn bare_sequence_share(points: u32) -> f32 {
    const SHARES: [(f32, f32); 4] = [(1.0, 1.0), (4.0, 0.036), (16.0, 0.0070), (64.0, 0.0011)];
    by_logarithms(&SHARES, points.max(1) as f32)
}

/// The share of the variance that a grid of `side` × `side` samples leaves.
pub fn grid_share(side: u32) -> f32 {
    by_logarithms(&[(2.0, 0.062), (3.0, 0.021), (4.0, 0.011), (6.0, 0.004)], side as f32)
}

/// The share of the neighbours' contrast that may hide between the equal samples of such a grid.
pub fn grid_unseen(side: u32) -> f32 {
    by_logarithms(&[(2.0, 2.9e-3), (3.0, 7.3e-4), (4.0, 2.5e-4), (6.0, 7e-5)], side as f32)
}
