//! What leaves hold of their primitives, packed: a leaf of five takes no more memory than five.

use super::{
    huge,
    node::{Run, WIDTH},
    simd::Simd,
};

/// Numbers in a line of the cache.
const LINE: usize = 16;

/// Leaves filled by one thread.
const CHUNK: usize = 1024;

/// `N` numbers for each primitive, leaf after leaf: in each the first numbers of its primitives side by side, then the
/// second ones, and so on.
#[derive(Debug)]
pub(super) struct Rows<const N: usize> {
    numbers: Vec<f32>,
    /// The place of the first primitive.
    pub(super) base: u32,
}

impl<const N: usize> Rows<N> {
    /// The rows of the leaves `runs`, one behind the other, whose primitives have these numbers by their places.
    pub(super) fn new(runs: &[Run], numbers_of: impl Fn(u32) -> [f32; N] + Sync) -> Self {
        let base = runs.first().map_or(0, |run| run.first);
        let count = runs.last().map_or(0, |run| run.places().end - base as usize);
        // Eight numbers are read from where any row starts.
        let mut numbers = vec![0.0; N * (count + WIDTH)];
        huge::advise(&numbers);
        fill(&mut numbers, runs, &numbers_of);
        Self { numbers, base }
    }

    /// The memory of all, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice())
    }

    /// Asks for the memory of a leaf.
    #[inline(always)]
    pub(super) fn prefetch<S: Simd>(&self, simd: S, run: Run) {
        let start = N * (run.first - self.base) as usize;
        for k in (0..N * run.count as usize).step_by(LINE) {
            simd.prefetch(&self.numbers[start + k]);
        }
    }

    /// The rows of a leaf.
    #[inline(always)]
    pub(super) fn leaf(&self, run: Run) -> Leaf<'_> {
        let numbers = &self.numbers[N * (run.first - self.base) as usize..][..N * WIDTH];
        Leaf { numbers, count: run.count as usize }
    }
}

fn fill<const N: usize>(
    numbers: &mut [f32],
    runs: &[Run],
    numbers_of: &(impl Fn(u32) -> [f32; N] + Sync),
) {
    if runs.len() > CHUNK {
        let (left, right) = runs.split_at(runs.len() / 2);
        let middle = N * (right[0].first - left[0].first) as usize;
        let (first, second) = numbers.split_at_mut(middle);
        rayon::join(|| fill(first, left, numbers_of), || fill(second, right, numbers_of));
        return;
    }
    let mut rest = numbers;
    for run in runs {
        let count = run.count as usize;
        let (leaf, others) = rest.split_at_mut(N * count);
        for (lane, place) in (run.first..).take(count).enumerate() {
            for (row, x) in leaf.chunks_exact_mut(count).zip(numbers_of(place)) {
                row[lane] = x;
            }
        }
        rest = others;
    }
}

/// The rows of a leaf.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a> {
    numbers: &'a [f32],
    count: usize,
}

impl Leaf<'_> {
    /// A row; in the lanes beyond the last primitive is anything.
    #[inline(always)]
    pub(super) fn row<S: Simd>(&self, simd: S, k: usize) -> S::F {
        match self.numbers[k * self.count..].first_chunk() {
            Some(row) => simd.load(row),
            None => simd.splat(f32::NAN),
        }
    }

    /// Three rows from that on.
    #[inline(always)]
    pub(super) fn rows<S: Simd>(&self, simd: S, k: usize) -> [S::F; 3] {
        [self.row(simd, k), self.row(simd, k + 1), self.row(simd, k + 2)]
    }

    /// A bit for each primitive.
    #[inline(always)]
    pub(super) fn all(&self) -> u32 {
        (1 << self.count) - 1
    }
}
