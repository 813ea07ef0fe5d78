//! How far a pixel is from its true colour, judged by the samples at hand.
//!
//! All errors are mean squared differences of the three channels in display levels of 255. The constants are shares of
//! what can be seen: of the variance of a pixel's samples, or of the contrast to its neighbours. None depends on the
//! scene.

use glam::Vec3;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use super::levels::squared_distance;

/// The error of a single centre, as a share of its squared differences to neighbours of another signature.
const CENTER_EDGE: f32 = 0.022;
/// The same as a share of the squared second differences, where all neighbours have the centre's signature.
const CENTER_CURVE: f32 = 0.016;
/// And where the second difference was used to correct the colour.
const CORRECTED_CURVE: f32 = 0.008;
/// How much more it is where colours follow no slope: points of noise are off by their variance, and their squared
/// second differences in both directions are twelve times that.
const NOISE: f32 = 4.2;

/// How far, in logarithms, the error of a sequence goes from that of an even pattern to that of random samples in the
/// busiest places.
pub const BUSY: f32 = 0.6;

/// The least of [`Look::busy`] for a pixel between two that differ from it.
const BETWEEN: f32 = 0.75;

/// The error of a centre's colour where the neighbours' rays all met the same, without [that of noise](noise_error), from
/// the squared second differences `curve`, horizontal and vertical; `corrected` is whether the second-order term of the
/// box integral was added.
#[inline(always)]
pub fn curve_error(curve: f32, corrected: bool) -> f32 {
    curve * if corrected { CORRECTED_CURVE } else { CENTER_CURVE }
}

/// The error of a centre's colour if what the neighbours differ by is noise as far as it follows no slope, from the
/// squared second differences `curve` and the squared differences `slope` of opposite neighbours, each horizontal and
/// vertical. Without a branch, for loops over pixels.
///
/// It grows as the second differences outweigh the slope: from nothing for a smooth function to all of a noise's
/// variance.
#[inline(always)]
pub fn noise_error(curve: f32, slope: f32) -> f32 {
    // 3 for noise. A slope of zero gives 1, also without a curve.
    let noise = (curve / (3.0 * slope)).min(1.0);
    most_noise_error(curve) * noise * noise
}

/// The most that it can be.
#[inline(always)]
pub fn most_noise_error(curve: f32) -> f32 {
    curve * (CENTER_CURVE * NOISE)
}

/// How busy it is, from 0 to 1, where noise makes up `part` of the most that it could be: more than at edges and in what is smooth.
pub fn busy_of_noise(part: f32) -> f32 {
    ((part - 0.3) / 0.4).clamp(0.0, 1.0)
}

/// The error of a centre's colour where an edge passes by, from the [squared differences](Look::edge) across it.
#[inline(always)]
pub fn edge_error(edge: f32) -> f32 {
    CENTER_EDGE * edge
}

/// A pixel's centre among its eight neighbours, some of whose rays met other things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
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
    /// How often the signature changes on the way round: 0 where one edge or none passes by, 1 where six or more do.
    /// Where neighbours at opposite sides both differ, which no single edge makes, it is at least 3/4.
    pub busy: f32,
}

/// The neighbours on the way round.
const RING: [usize; 8] = [0, 1, 2, 5, 8, 7, 6, 3];

/// The neighbours in the order of [`Look::at`], and what they count in [`Look::edge`].
pub const NEIGHBOURS: [(usize, f32); 8] =
    [(1, 1.0), (3, 1.0), (5, 1.0), (7, 1.0), (0, 0.5), (2, 0.5), (6, 0.5), (8, 0.5)];

impl Look {
    /// The look of the middle one of 3 × 3 centres, given row by row as display levels and signatures.
    pub fn at(levels: &[Vec3; 9], signatures: &[u32; 9]) -> Self {
        let (center, signature) = (levels[4], signatures[4]);
        let bend =
            |a: usize, b: usize| (levels[a] + levels[b] - 2.0 * center).length_squared() / 3.0;
        let (mut edge, mut contrast) = (0.0, 0.0);
        for (place, weight) in NEIGHBOURS {
            let square = squared_distance(levels[place], center);
            contrast += square;
            if signatures[place] != signature {
                edge += weight * square;
            }
        }
        let changes = (0..8).filter(|&k| signatures[RING[k]] != signatures[RING[(k + 1) % 8]]);
        let changes = changes.count() as f32;
        let between = [(0, 8), (1, 7), (2, 6), (3, 5)]
            .iter()
            .any(|&(a, b)| signatures[a] != signature && signatures[b] != signature);
        let busy = ((changes - 2.0) / 4.0).clamp(0.0, 1.0);
        Self {
            inner: [1, 3, 5, 7].iter().all(|&place| signatures[place] == signature),
            edge,
            contrast,
            curve: bend(3, 5) + bend(1, 7),
            slope: squared_distance(levels[3], levels[5]) + squared_distance(levels[1], levels[7]),
            busy: if between { busy.max(BETWEEN) } else { busy },
        }
    }

    /// The error of the centre's colour.
    pub fn center_error(&self) -> f32 {
        let smooth = curve_error(self.curve, false) + noise_error(self.curve, self.slope);
        edge_error(self.edge).max(smooth)
    }
}

/// More kinds of things in a pixel than this are as many: each sample is compared with one of each.
const MOST_KINDS: usize = 256;

/// The mean and spread of a pixel's samples, and how many different things they met.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Spread {
    /// The display levels that the deviations are from, so that their squares stay small.
    origin: Vec3,
    deviation: Vec3,
    square: f32,
    count: u32,
    /// One of each; mostly few.
    signatures: SmallVec<[u32; 8]>,
}

impl Spread {
    /// Nothing sampled yet; colours are expected near `origin`, in display levels.
    pub fn about(origin: Vec3) -> Self {
        Self { origin, ..Self::default() }
    }

    /// The same again.
    pub fn restart(&mut self, origin: Vec3) {
        let mut signatures = std::mem::take(&mut self.signatures);
        signatures.clear();
        *self = Self { origin, signatures, ..Self::default() };
    }

    /// Takes in a sample by its display levels.
    pub fn add(&mut self, levels: Vec3, signature: u32) {
        let deviation = levels - self.origin;
        self.deviation += deviation;
        self.square += deviation.length_squared() / 3.0;
        self.count += 1;
        if self.signatures.len() < MOST_KINDS && !self.signatures.contains(&signature) {
            self.signatures.push(signature);
        }
    }

    /// How many samples there are.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The number of different signatures, up to 256.
    pub fn kinds(&self) -> usize {
        self.signatures.len()
    }

    /// The signature, if all samples share it.
    pub fn only_signature(&self) -> Option<u32> {
        match self.signatures.as_slice() {
            [signature] => Some(*signature),
            _ => None,
        }
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
    /// More kinds of surfaces mean more edges, which even patterns deal with less well; so do changes all around, where
    /// edges of two kinds may be many: `busy` is how far, in logarithms, the error goes to that of random samples. But
    /// no mean is worse than that of random samples.
    pub fn error(&self, kappa: f32, busy: f32) -> f32 {
        self.share(kappa, busy) * self.variance()
    }

    /// The share of the variance that is left of it there.
    pub fn share(&self, kappa: f32, busy: f32) -> f32 {
        let edges = self.kinds().max(2) as f32 - 1.0;
        let random = 1.0 / self.count.max(1) as f32;
        let share = (kappa * edges.powf(0.45)).min(random);
        if busy > 0.0 { share * (random / share).powf(busy) } else { share }
    }
}

/// `y` at `x` by straight lines between the points of `table` in logarithms of both; straight on beyond its ends.
pub(super) fn by_logarithms(table: &[(f32, f32)], x: f32) -> f32 {
    let last = table.len() - 1;
    let place = table.iter().skip(1).take(last - 1).take_while(|(from, _)| *from < x).count();
    let ((x0, y0), (x1, y1)) = (table[place], table[place + 1]);
    y0 * (y1 / y0).powf((x / x0).ln() / (x1 / x0).ln())
}

/// The share of the variance that `points` of the [`Sequence`](super::sobol::Sequence) leave, with centre and corners;
/// 0 is centre and corners alone.
pub fn sequence_share(points: u32) -> f32 {
    const SHARES: [(f32, f32); 6] =
        [(1.0, 0.078), (4.0, 0.030), (8.0, 0.017), (16.0, 0.0070), (32.0, 0.0027), (64.0, 0.0011)];
    by_logarithms(&SHARES, points.max(1) as f32)
}

/// The share of the neighbours' contrast that may hide between equal samples of a suspect pixel.
pub fn sequence_unseen(points: u32) -> f32 {
    const SHARES: [(f32, f32); 6] =
        [(1.0, 3e-4), (4.0, 7e-5), (8.0, 2.2e-5), (16.0, 5e-6), (32.0, 1e-6), (64.0, 2e-7)];
    by_logarithms(&SHARES, points.max(1) as f32)
}

/// The part of what quarters of a sequence's `points` differ by that the whole is off by at least.
///
/// Each quarter is an even pattern as well. Were the samples random, the variance of the quarters' mean would be the
/// whole error; at a single edge it is two to four times the error, because the whole is more even than its quarters.
pub fn quarters_share(points: u32) -> f32 {
    by_logarithms(&[(8.0, 0.16), (16.0, 0.23), (32.0, 0.33), (64.0, 0.43)], points.max(8) as f32)
        .min(1.0)
}

/// The squared error of a mean of `count` samples in a busy place that all met the same, as a share of the neighbours'
/// mean squared difference: the expected square of the part not seen, if any part was as likely before.
pub fn all_alike(count: u32) -> f32 {
    let n = count as f32;
    2.0 / ((n + 2.0) * (n + 3.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the points of the tables, and straight lines in logarithms between and beyond them.
    #[test]
    fn shares_go_through_their_points() {
        for (points, share) in [(0, 0.078), (1, 0.078), (4, 0.030), (16, 0.007), (64, 0.0011)] {
            assert!((sequence_share(points) / share - 1.0).abs() < 1e-5, "{points}");
        }
        assert!((sequence_share(128) / (0.0011 * 0.0011 / 0.0027) - 1.0).abs() < 1e-5);
        assert!((1..4096).all(|points| sequence_unseen(points + 1) < sequence_unseen(points)));
    }

    #[test]
    fn an_edge_is_not_busy_and_noise_is() {
        let pixel = |signatures: [u32; 9]| Look::at(&[Vec3::ZERO; 9], &signatures);
        assert_eq!(pixel([1, 1, 2, 1, 1, 2, 1, 1, 2]).busy, 0.0);
        assert_eq!(pixel([1, 2, 1, 2, 1, 2, 1, 2, 1]).busy, 1.0);
        assert!(
            pixel([1, 2, 1, 2, 2, 2, 1, 2, 1]).inner && !pixel([1, 1, 1, 2, 2, 2, 1, 2, 1]).inner
        );
    }

    /// Oracle: the variance of a handful of numbers, worked by hand; grey 0 is level 0, grey 1 is level 255.
    #[test]
    fn spread_is_the_unbiased_variance() {
        let mut spread = Spread::about(Vec3::splat(100.0));
        for (grey, signature) in [(0.0, 5), (1.0, 6), (1.0, 6), (0.0, 5)] {
            spread.add(Vec3::splat(255.0 * grey), signature);
        }
        let expected = 4.0 * 127.5_f32.powi(2) / 3.0;
        assert!((spread.variance() / expected - 1.0).abs() < 1e-4, "{}", spread.variance());
        assert_eq!((spread.kinds(), spread.count(), spread.only_signature()), (2, 4, None));
    }

    /// A pixel may get 2²⁰ samples that all met something else.
    #[test]
    fn kinds_are_counted_up_to_some_number() {
        let mut spread = Spread::about(Vec3::ZERO);
        for signature in 0..1 << 20 {
            spread.add(Vec3::ONE, signature);
            assert_eq!(spread.kinds(), (signature as usize + 1).min(MOST_KINDS));
        }
    }
}
