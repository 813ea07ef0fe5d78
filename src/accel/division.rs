//! Which primitives go into the tree, and which every ray tests.

use rayon::prelude::*;

use super::{frame::Frame, node::Child};
use crate::geometry::{Bounds, Shape};

/// A primitive this many times as large as the median one may be kept out of the tree.
const GIANT: f64 = 1e3;

/// The most primitives kept out for their size; every ray tests each of them.
const MAX_GIANTS: usize = 8;

/// Which primitives go into the tree, which stay out, and the tree's frame.
pub(super) struct Division {
    /// The primitives in the tree, in ascending order.
    pub(super) inside: Vec<u32>,
    /// Those that every ray tests.
    pub(super) outside: Vec<u32>,
    /// The frame of the tree; `None` if nothing is in it.
    pub(super) frame: Option<Frame>,
    /// The bounds of all.
    pub(super) bounds: Bounds,
}

impl Division {
    /// Divides `shapes`: what is not finite, or so large that the rest would be lost in its frame, stays out.
    pub(super) fn of(shapes: &[Shape]) -> Self {
        let extent = Extent::of(shapes, |_| true);
        let outside = if extent.is_even() { Vec::new() } else { outside(shapes) };
        let within = if outside.is_empty() {
            extent.bounds
        } else {
            Extent::of(shapes, |k| outside.binary_search(&k).is_err()).bounds
        };
        let all = 0..shapes.len() as u32;
        let (frame, bounds) = (Frame::new(&within), extent.bounds);
        if frame.is_none() || shapes.len() == outside.len() || shapes.len() >= Child::LIMIT {
            return Self { inside: Vec::new(), outside: all.collect(), frame: None, bounds };
        }
        let mut inside: Vec<u32> = all.collect();
        if !outside.is_empty() {
            inside.retain(|k| outside.binary_search(k).is_err());
        }
        Self { inside, outside, frame, bounds }
    }
}

/// What can be told of some primitives by looking at each once.
#[derive(Clone, Copy)]
struct Extent {
    bounds: Bounds,
    /// The smallest and the largest size; infinite if any is not a number.
    smallest: f64,
    largest: f64,
}

impl Extent {
    const NONE: Self = Self { bounds: Bounds::EMPTY, smallest: f64::INFINITY, largest: 0.0 };

    /// That of the primitives whose numbers are `wanted`.
    fn of(shapes: &[Shape], wanted: impl Fn(u32) -> bool + Sync) -> Self {
        let add = |extent: Self, (k, shape): (usize, &Shape)| {
            if wanted(k as u32) { extent.with(shape.bounds()) } else { extent }
        };
        shapes.par_iter().enumerate().fold(|| Self::NONE, add).reduce(|| Self::NONE, Self::union)
    }

    fn with(self, bounds: Bounds) -> Self {
        let size = bounds.size();
        let size = if size.is_nan() { f64::INFINITY } else { size };
        self.union(Self { bounds, smallest: size, largest: size })
    }

    fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            smallest: self.smallest.min(other.smallest),
            largest: self.largest.max(other.largest),
        }
    }

    /// Whether all primitives are finite and none can be a giant.
    fn is_even(&self) -> bool {
        self.largest.is_finite() && self.largest <= GIANT * self.smallest
    }
}

/// The primitives that stay out of the tree, in ascending order.
fn outside(shapes: &[Shape]) -> Vec<u32> {
    let sizes: Vec<f64> = shapes.par_iter().map(|s| s.bounds().size()).collect();
    let mut outside = giants(shapes, &sizes);
    outside.extend((0..).zip(&sizes).filter(|(_, s)| !s.is_finite()).map(|(k, _)| k));
    outside.sort_unstable();
    outside
}

/// The few primitives that dwarf the others, if the others alone take a much smaller frame.
fn giants(shapes: &[Shape], sizes: &[f64]) -> Vec<u32> {
    let mut sorted: Vec<f64> = sizes.iter().copied().filter(|s| s.is_finite()).collect();
    if sorted.len() < 3 {
        return Vec::new();
    }
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let is_giant = |size: f64| size.is_finite() && size > GIANT * median;
    let giants: Vec<u32> =
        (0..).zip(sizes).filter(|(_, s)| is_giant(**s)).map(|(k, _)| k).collect();
    if giants.is_empty() || giants.len() > MAX_GIANTS {
        return Vec::new();
    }
    let (all, rest) = shapes
        .par_iter()
        .zip(sizes.par_iter())
        .filter(|(_, s)| s.is_finite())
        .fold(
            || (Bounds::EMPTY, Bounds::EMPTY),
            |(all, rest), (shape, size)| {
                let bounds = shape.bounds();
                (all.union(bounds), if is_giant(*size) { rest } else { rest.union(bounds) })
            },
        )
        .reduce(|| (Bounds::EMPTY, Bounds::EMPTY), |a, b| (a.0.union(b.0), a.1.union(b.1)));
    if rest.size() < all.size() / 4.0 { giants } else { Vec::new() }
}
