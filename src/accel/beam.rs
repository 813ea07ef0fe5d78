//! Rays that share a point, seen along the axis that they mostly follow: a ray is a pair of slopes, and how far it has come is its
//! depth. Between the least and the largest slopes lies their beam: which boxes may any of them meet?
//!
//! Eight boxes are tested at once against all of the beam, at the cost of one ray. Its answers are only "perhaps", like those
//! of a single ray, and the pads of the boxes cover the roundings. With u = 2⁻²⁴: no slope is above 5/4 and no depth in the tree
//! above 2.26, so a ray that meets anything begins at coordinates of at most 4, which are off by 2 u; its slopes are off
//! by u, the start's own coordinate by u, the depth of a plane by 2 u, and what they give at a depth by another 4 u:
//! together less than 13 u, and the pad is 32 u. Far from the origin of the world's coordinates pads are larger, for the
//! roundings of the primitives themselves, but always less than 1: depths are then up to 3.25, the roundings here less than
//! 20 u.
//!
//! Source: the idea of tracing the beam instead of the rays is that of Reshetov, Soupikov & Hurley, "Multi-level ray
//! tracing algorithm", *ACM Transactions on Graphics* 24(3) (2005).

use std::ops::RangeInclusive;

use glam::DVec3;

use super::{
    frame::Frame,
    leaf::Spheres,
    node::{Node, Run},
    simd::Simd,
};
use crate::geometry::lanes::LANES;

/// The steepest a ray may be against the axis.
const STEEPEST: f64 = 1.25;

/// How far from the centre, along the axis, rays from afar begin: a little before the tree.
const START: f64 = 1.25;

/// A ray that begins further than this to either side meets nothing.
const ASIDE: f64 = 4.0;

/// Rays from further away than this are traced one by one, for the rounding of their common point.
const FURTHEST: f64 = (1 << 20) as f64;

/// What a direction may be long, in the world and in the tree's frame, to be far from the ends of the numbers.
const LENGTHS: RangeInclusive<f64> = 1e-280..=1e280;

/// A number in single precision for each lane.
pub(super) type Singles = [f32; LANES];

/// The axis that rays from a common point mostly follow, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// The axis, and the others in their cyclic order.
    pub(super) order: [usize; 3],
    /// 1, or -1 if the rays follow it towards smaller coordinates.
    pub(super) forward: f64,
    /// The rays' common point, along the axis and the others.
    pub(super) point: [f64; 3],
    /// How far from there, along the axis, depths begin to count: where the rays begin for the tree, which is a plane shortly before it
    /// if their point is further away.
    pub(super) lead: f64,
    /// The coordinate of that along the axis.
    pub(super) start: f32,
}

/// A ray along an [`Axis`].
pub(super) struct Line {
    /// How far it goes along the axis in one unit of its parameter.
    pub(super) rate: f64,
    /// How far it goes along each of the other axes in one unit of depth.
    pub(super) slopes: [f64; 2],
    /// The coordinates along those where it begins.
    pub(super) begin: [f64; 2],
    /// Whether it follows the axis.
    pub(super) follows: bool,
    /// Whether it may meet the tree.
    pub(super) arrives: bool,
}

impl Axis {
    /// The axis of rays that share `point`, the first of which leads along `dir`; `None` if the point is too far away.
    #[inline(always)]
    pub(super) fn along(point: DVec3, dir: DVec3) -> Option<Self> {
        let axis = dir.abs().max_position();
        let order = [axis, (axis + 1) % 3, (axis + 2) % 3];
        let forward = if dir[axis] < 0.0 { -1.0 } else { 1.0 };
        let is_near = point.to_array().iter().all(|x| x.abs() <= FURTHEST);
        let point = order.map(|axis| point[axis]);
        let lead = (-START - forward * point[0]).max(0.0);
        let start = (point[0] + forward * lead) as f32;
        is_near.then_some(Self { order, forward, point, lead, start })
    }

    /// A ray whose direction has these components along the axis and the others, in the world; without a branch.
    #[inline(always)]
    pub(super) fn line(&self, frame: &Frame, [along, right, up]: [f64; 3]) -> Line {
        let length = along * self.forward;
        let inverse = 1.0 / length;
        let slopes = [right * inverse, up * inverse];
        let [_, x, y] = self.point;
        let begin = [x + slopes[0] * self.lead, y + slopes[1] * self.lead];
        let rate = frame.length(length);
        let is_ordinary = (length >= *LENGTHS.start())
            & (length <= *LENGTHS.end())
            & (rate >= *LENGTHS.start())
            & (rate <= *LENGTHS.end());
        let follows = is_ordinary & (slopes[0].abs() <= STEEPEST) & (slopes[1].abs() <= STEEPEST);
        let arrives = follows & (begin[0].abs() <= ASIDE) & (begin[1].abs() <= ASIDE);
        Line { rate, slopes, begin, follows, arrives }
    }

    /// How far along the axis from the start what is between two coordinates is.
    #[inline(always)]
    pub(super) fn depths(&self, low: f32, high: f32) -> (f32, f32) {
        if self.forward < 0.0 {
            (self.start - high, self.start - low)
        } else {
            (low - self.start, high - self.start)
        }
    }
}

/// A beam in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    axis: Axis,
    /// The least and the largest coordinate along each of the two other axes where it begins.
    begin: [[f32; 2]; 2],
    /// The least and the largest slope along each of them.
    slopes: [[f32; 2]; 2],
}

impl Beam {
    /// The beam about the rays of some lanes, of which there is one.
    #[inline(always)]
    pub(super) fn around(
        axis: Axis,
        begin: &[Singles; 2],
        slopes: &[Singles; 2],
        some: u64,
    ) -> Self {
        let range = |column: &Singles| range(column, some);
        Self {
            axis,
            begin: [range(&begin[0]), range(&begin[1])],
            slopes: [range(&slopes[0]), range(&slopes[1])],
        }
    }

    /// How wide the beam is in the middle of the tree, or at distance 1 if it starts closer to that.
    pub(super) fn spread(&self) -> f32 {
        let slopes: f32 = self.slopes.iter().map(|[least, largest]| largest - least).sum();
        slopes * (1.0 + self.axis.lead as f32)
    }

    /// The lanes with slopes in the lower half of the side along which the beam is wider.
    pub(super) fn half(&self, slopes: &[Singles; 2]) -> u64 {
        let width = |side: usize| self.slopes[side][1] - self.slopes[side][0];
        let side = usize::from(width(1) > width(0));
        let [least, largest] = self.slopes[side];
        let middle = f32::midpoint(least, largest);
        (0..LANES).fold(0, |all, k| all | u64::from(slopes[side][k] < middle) << k)
    }

    /// Which children of `node` the beam may meet within `limit` along its axis, and where it enters each.
    #[inline(always)]
    pub(super) fn test<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, S::F) {
        let planes =
            |axis: usize| (simd.load(&node.planes[axis]), simd.load(&node.planes[3 + axis]));
        self.boxes(simd, planes, limit)
    }

    /// Which of the spheres of a leaf the beam may meet within `limit` along its axis, judged by their boxes. What a
    /// radius is enlarged by is twice a pad.
    #[inline(always)]
    pub(super) fn spheres<S: Simd>(&self, simd: S, spheres: &Spheres, run: Run, limit: f32) -> u32 {
        let leaf = spheres.rows.leaf(run);
        let radius = simd.add(leaf.row(simd, 3), simd.splat(spheres.margin));
        let planes = |axis: usize| {
            let center = leaf.row(simd, axis);
            (simd.sub(center, radius), simd.add(center, radius))
        };
        leaf.all() & self.boxes(simd, planes, limit).0
    }

    /// Which of eight boxes with these `planes` along each axis the beam may meet, and where it enters each.
    #[inline(always)]
    fn boxes<S: Simd>(
        &self,
        simd: S,
        planes: impl Fn(usize) -> (S::F, S::F),
        limit: f32,
    ) -> (u32, S::F) {
        let Axis { order, forward, start, .. } = self.axis;
        let (zero, start) = (simd.splat(0.0), simd.splat(start));
        let (low, high) = planes(order[0]);
        let (near, far) = if forward < 0.0 {
            (simd.sub(start, high), simd.sub(start, low))
        } else {
            (simd.sub(low, start), simd.sub(high, start))
        };
        let (near, far) = (simd.max(near, zero), simd.min(far, simd.splat(limit)));
        let mut met = simd.le(near, far);
        for k in 0..2 {
            let (low, high) = planes(order[1 + k]);
            let (least, largest) = (simd.splat(self.slopes[k][0]), simd.splat(self.slopes[k][1]));
            let (from, to) = (simd.splat(self.begin[k][0]), simd.splat(self.begin[k][1]));
            let from = simd.min(simd.mul_add(least, near, from), simd.mul_add(least, far, from));
            let to = simd.max(simd.mul_add(largest, near, to), simd.mul_add(largest, far, to));
            met &= simd.le(from, high) & simd.le(low, to);
        }
        (met, near)
    }
}

/// The least and the largest number in some lanes.
#[inline(always)]
fn range(column: &Singles, some: u64) -> [f32; 2] {
    // In eight parts, each a lane of vectors.
    let (mut least, mut largest) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
    for start in (0..LANES).step_by(8) {
        for part in 0..8 {
            let (x, is_one) = (column[start + part], some >> (start + part) & 1 != 0);
            least[part] = if is_one & (x < least[part]) { x } else { least[part] };
            largest[part] = if is_one & (x > largest[part]) { x } else { largest[part] };
        }
    }
    [
        least.into_iter().fold(f32::INFINITY, f32::min),
        largest.into_iter().fold(f32::NEG_INFINITY, f32::max),
    ]
}
