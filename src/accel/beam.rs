//! A beam of rays that share a point: which boxes may any of them meet?
//!
//! Along the axis that all rays mostly follow, a ray is a pair of slopes; between the least and the largest slopes lies
//! the beam. Eight boxes are tested at once against all of it, at the cost of one ray. Its answers are only "perhaps",
//! like those of a single ray, and the pads of the boxes cover its roundings: what it begins with and its slopes are rounded
//! outward, the coordinate where it starts is off by 2 u, and what they give at a distance of at most 4 by 8 u, together less
//! than 2⁻²⁰, half a pad.
//!
//! Source: the idea of tracing the beam instead of the rays is that of Reshetov, Soupikov & Hurley, "Multi-level ray
//! tracing algorithm", *ACM Transactions on Graphics* 24(3) (2005).

use glam::DVec3;

use super::{
    frame::{above, below},
    node::Node,
    simd::Simd,
};
use crate::geometry::lanes::{LANES, RayLanes};

/// The steepest a ray may be against the axis of its beam.
const STEEPEST: f64 = 2.0;

/// How far from the centre, along the axis, a beam from afar starts: a little before the tree.
const START: f64 = 1.25;

/// Rays from further away than this are traced one by one, for the rounding of their common point.
const FURTHEST: f64 = (1 << 20) as f64;

/// A beam in the tree's frame.
///
/// It starts where its rays do, or, if that is before the tree, in a plane shortly before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// The axis that the rays mostly follow, and the two others.
    axes: [usize; 3],
    /// Whether they follow it towards smaller coordinates.
    backward: bool,
    /// The coordinate along the axis where the beam starts.
    start: f32,
    /// How far along the axis that is from the rays' common point.
    pub(super) lead: f64,
    /// The least and the largest coordinate along each of the two other axes at the start.
    begin: [[f32; 2]; 2],
    /// The least and the largest slope along each of them.
    slopes: [[f32; 2]; 2],
}

impl Beam {
    /// The beam of the lanes in use, whose rays share `point` and go away from there along `toward` (1 or -1) times their directions;
    /// `None` if these have no axis in common or the point is too far away.
    #[inline(always)]
    pub(super) fn around(point: DVec3, rays: &RayLanes, toward: f64) -> Option<Self> {
        let first = rays.dir.get(rays.used.trailing_zeros() as usize % LANES) * toward;
        let axis = first.abs().max_position();
        let axes = [axis, (axis + 1) % 3, (axis + 2) % 3];
        let backward = first[axis] < 0.0;
        let sign = if backward { -toward } else { toward };
        let [along, right, up] = axes.map(|axis| rays.dir.axis(axis));
        // In eight parts, each a lane of vectors.
        let mut least = [[f64::INFINITY; 8]; 3];
        let mut largest = [[f64::NEG_INFINITY; 8]; 2];
        for start in (0..LANES).step_by(8) {
            for part in 0..8 {
                let k = start + part;
                let is_used = rays.used >> k & 1 != 0;
                let length = along[k] * sign;
                let slopes = [right[k] * toward / length, up[k] * toward / length];
                let lesser = |a: f64, b: f64| if is_used & !(a >= b) { a } else { b };
                let greater = |a: f64, b: f64| if is_used & !(a <= b) { a } else { b };
                least[2][part] = lesser(length, least[2][part]);
                for side in 0..2 {
                    least[side][part] = lesser(slopes[side], least[side][part]);
                    largest[side][part] = greater(slopes[side], largest[side][part]);
                }
            }
        }
        // A NaN is kept by the comparisons above, and refused here.
        let is_all = |parts: &[f64; 8], test: &dyn Fn(f64) -> bool| parts.iter().all(|x| test(*x));
        let follow = is_all(&least[2], &|length| length > 0.0)
            && (0..2).all(|side| {
                is_all(&least[side], &|slope| slope >= -STEEPEST)
                    && is_all(&largest[side], &|slope| slope <= STEEPEST)
            });
        let is_near = point.to_array().iter().all(|x| x.abs() <= FURTHEST);
        if !(follow && is_near) {
            return None;
        }
        let forward = if backward { -1.0 } else { 1.0 };
        let lead = (-START - forward * point[axis]).max(0.0);
        let outward = |low: f64, high: f64| [below(low).next_down(), above(high).next_up()];
        let (mut begin, mut slopes) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
        for side in 0..2 {
            let low = least[side].into_iter().fold(f64::INFINITY, f64::min);
            let high = largest[side].into_iter().fold(f64::NEG_INFINITY, f64::max);
            let from = point[axes[1 + side]];
            begin[side] = outward(from + low * lead, from + high * lead);
            slopes[side] = outward(low, high);
        }
        let start = (point[axis] + forward * lead) as f32;
        Some(Self { axes, backward, start, lead, begin, slopes })
    }

    /// How wide the beam is in the middle of the tree, or at distance 1 if it starts closer to that.
    pub(super) fn spread(&self) -> f32 {
        let slopes: f32 = self.slopes.iter().map(|[least, largest]| largest - least).sum();
        slopes * (1.0 + self.lead as f32)
    }

    /// How far along the axis from the start a point is.
    #[inline(always)]
    pub(super) fn depth(&self, p: [f32; 3]) -> f32 {
        let [axis, ..] = self.axes;
        if self.backward { self.start - p[axis] } else { p[axis] - self.start }
    }

    /// How far along the axis a vector goes.
    #[inline(always)]
    pub(super) fn along(&self, v: [f32; 3]) -> f32 {
        let [axis, ..] = self.axes;
        if self.backward { -v[axis] } else { v[axis] }
    }

    /// As [`Beam::along`].
    #[inline(always)]
    pub(super) fn along_axis(&self, v: DVec3) -> f64 {
        let [axis, ..] = self.axes;
        if self.backward { -v[axis] } else { v[axis] }
    }

    /// Which children of `node` the beam may meet within `limit` along its axis, and where it enters each.
    #[inline(always)]
    pub(super) fn test<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, S::F) {
        let (zero, start) = (simd.splat(0.0), simd.splat(self.start));
        let (low, high) = planes(simd, node, self.axes[0]);
        let (near, far) = if self.backward {
            (simd.sub(start, high), simd.sub(start, low))
        } else {
            (simd.sub(low, start), simd.sub(high, start))
        };
        let (near, far) = (simd.max(near, zero), simd.min(far, simd.splat(limit)));
        let mut met = simd.le(near, far);
        for k in 0..2 {
            let (low, high) = planes(simd, node, self.axes[1 + k]);
            let (least, largest) = (simd.splat(self.slopes[k][0]), simd.splat(self.slopes[k][1]));
            let (from, to) = (simd.splat(self.begin[k][0]), simd.splat(self.begin[k][1]));
            let from = simd.min(simd.mul_add(least, near, from), simd.mul_add(least, far, from));
            let to = simd.max(simd.mul_add(largest, near, to), simd.mul_add(largest, far, to));
            met &= simd.le(from, high) & simd.le(low, to);
        }
        (met, near)
    }
}

/// The planes of a node's boxes along an axis.
#[inline(always)]
fn planes<S: Simd>(simd: S, node: &Node, axis: usize) -> (S::F, S::F) {
    (simd.load(&node.planes[axis]), simd.load(&node.planes[3 + axis]))
}
