//! Patterns of samples that are the same in every pixel, and what their samples say of the error of their mean.

use glam::Vec3;

use super::{
    Sample,
    estimate::{Spread, by_logarithms, sequence_unseen},
    lines::{Lines, is_even_along_lines},
};

/// A pattern of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pattern {
    /// A grid with so many samples in a row.
    Grid(usize),
    /// So many samples of a sequence.
    Sequence(usize),
}

impl Pattern {
    /// How many samples it has.
    pub fn count(self) -> usize {
        match self {
            Self::Grid(side) => side * side,
            Self::Sequence(count) => count,
        }
    }

    /// The squared error of the mean of samples of these `levels`, whose `spread` is this.
    pub fn error(self, levels: &[Vec3], spread: &Spread) -> f32 {
        let side = match self {
            Self::Sequence(count) => return spread.error(bare_sequence_share(count), 0.0),
            Self::Grid(side) => side,
        };
        // Without any edge it is at most half of what it is at one.
        let part = if spread.kinds() == 1 { 0.5 } else { 1.0 };
        if side == 2 {
            return part * spread.error(GRID_OF_FOUR, 0.0);
        }
        let variance = self.variance(levels.iter().copied());
        part * interleaved_share(side) * variance.element_sum() / 3.0
    }

    /// The squared error of the mean of samples of these `levels`, each of which is off by `detail` on average, squared,
    /// because of pictures finer than it: as of independent ones, or of independent lines of a grid.
    pub fn picture_error(self, levels: &[Vec3], detail: f32) -> f32 {
        match self {
            Self::Grid(side) if is_even_along_lines(side, levels, detail) => detail / side as f32,
            _ => detail / levels.len() as f32,
        }
    }

    /// The share of the neighbours' contrast that may hide between equal samples.
    pub fn unseen(self) -> f32 {
        match self {
            Self::Grid(side) => grid_unseen(side),
            Self::Sequence(count) => sequence_unseen(count as u32),
        }
    }

    /// How many of the parts that [`variance`](Self::variance) compares there are, and which of them a sample is in.
    fn part_of(self, sample: usize) -> (usize, usize) {
        match self {
            Self::Grid(3) => (3, (sample / 3 + sample % 3) % 3),
            Self::Grid(side) => (4, sample / side % 2 * 2 + sample % side % 2),
            Self::Sequence(count) => (count.min(4), sample * count.min(4) / count),
        }
    }

    /// The lines of a grid's samples, given in order.
    pub fn lines(self, samples: &[Sample]) -> Option<Lines<'_>> {
        match self {
            Self::Grid(side) => Lines::of(side, samples),
            Self::Sequence(_) => None,
        }
    }

    /// What parts of the samples, given in order, differ by that are even patterns as well: four grids, three diagonals of 3 × 3
    /// samples, or the quarters of a sequence. For each channel it is the squared error that their mean would have if they were
    /// independent, as those of random samples are. At a single edge the mean of a grid has a third of that.
    pub fn variance(self, samples: impl Iterator<Item = Vec3>) -> Vec3 {
        let (mut sums, mut counts, mut parts) = ([Vec3::ZERO; 4], [0_u32; 4], 1);
        for (k, sample) in samples.enumerate() {
            let (of, part) = self.part_of(k);
            parts = of;
            sums[part] += sample;
            counts[part] += 1;
        }
        let means = || (0..parts).map(|k| sums[k] / counts[k].max(1) as f32);
        let mean = means().sum::<Vec3>() / parts as f32;
        let squares: Vec3 = means().map(|m| (m - mean) * (m - mean)).sum();
        squares / (parts * (parts - 1)).max(1) as f32
    }
}

/// The share of the variance that `points` of the sequence leave by themselves.
fn bare_sequence_share(points: usize) -> f32 {
    const SHARES: [(f32, f32); 4] = [(1.0, 1.0), (4.0, 0.036), (16.0, 0.0070), (64.0, 0.0011)];
    by_logarithms(&SHARES, points.max(1) as f32)
}

/// The share of the variance that a grid of 2 × 2 samples leaves.
const GRID_OF_FOUR: f32 = 0.060;

/// The part of what [parts](Pattern::variance) of a grid of `side` × `side` samples differ by that the whole leaves at an edge.
fn interleaved_share(side: usize) -> f32 {
    by_logarithms(&[(3.0, 0.50), (4.0, 0.28), (6.0, 0.22)], side as f32)
}

/// The share of the neighbours' contrast that may hide between the equal samples of such a grid.
fn grid_unseen(side: usize) -> f32 {
    by_logarithms(&[(2.0, 2.9e-3), (3.0, 4.0e-4), (4.0, 1.5e-4), (6.0, 4e-5)], side as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: by hand. The four interleaved grids of one of 4 × 4 samples are grey 0, 0, 0 and 1: levels 0, 0, 0 and
    /// 255, whose mean squared deviation from 63.75 is 3/16 of 255²; their mean has a third of that.
    #[test]
    fn parts_are_compared() {
        let level = |k: usize| Vec3::splat(if k / 4 % 2 == 1 && k % 2 == 1 { 255.0 } else { 0.0 });
        let levels: Vec<Vec3> = (0..16).map(level).collect();
        let expected = 255.0_f32.powi(2) * 3.0 / 16.0 / 3.0;
        let variance = |side, levels: &[Vec3]| Pattern::Grid(side).variance(levels.iter().copied());
        assert!((variance(4, &levels) / expected - 1.0).abs().max_element() < 1e-4);
        assert_eq!(variance(6, &[levels[5]; 36]), Vec3::ZERO);
        // One diagonal of three is white: levels 255, 0 and 0, by 85 twice and 170 from their mean.
        let levels: Vec<Vec3> =
            (0..9_usize).map(|k| levels[if (k / 3 + k % 3) % 3 == 0 { 5 } else { 0 }]).collect();
        let expected = 85.0_f32.powi(2) * 6.0 / 6.0;
        assert!((variance(3, &levels) / expected - 1.0).abs().max_element() < 1e-4);
        // The last quarter of a sequence is white: 3/16 of 255² again, and a third of that.
        let last = (0..8).map(|k| Vec3::splat(if k > 5 { 255.0 } else { 0.0 }));
        let expected = 255.0_f32.powi(2) * 3.0 / 16.0 / 3.0;
        let variance = Pattern::Sequence(8).variance(last);
        assert!((variance / expected - 1.0).abs().max_element() < 1e-4);
    }
}
