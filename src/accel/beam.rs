//! A beam of rays that share a point: which boxes may any of them meet?
//!
//! Along the axis that all rays mostly follow, a ray is a pair of slopes; between the least and the largest slopes lies
//! the beam. Eight boxes are tested at once against all of it, at the cost of one ray. Its answers are only "perhaps",
//! like those of a single ray, and the pads of the boxes cover its roundings: the origin is off by 2 u, a slope by
//! none (they are rounded outward), and what they give at a distance of at most 4 by 4 u, together 2⁻²¹, a quarter
//! of a pad.
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

/// A beam in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// The axis that the rays mostly follow, and the two others.
    axes: [usize; 3],
    /// Whether they follow it towards smaller coordinates.
    backward: bool,
    origin: [f32; 3],
    /// The least and the largest slope along each of the two other axes.
    slopes: [[f32; 2]; 2],
}

impl Beam {
    /// The beam of the lanes in use, whose rays share `origin`, at most 2 from the centre, and go away from there along `toward` (1 or
    /// -1) times their directions; `None` if these have no axis in common.
    #[inline(always)]
    pub(super) fn around(origin: DVec3, rays: &RayLanes, toward: f64) -> Option<Self> {
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
        let slopes = [0, 1].map(|side| {
            let low = least[side].into_iter().fold(f64::INFINITY, f64::min);
            let high = largest[side].into_iter().fold(f64::NEG_INFINITY, f64::max);
            [below(low).next_down(), above(high).next_up()]
        });
        let origin = origin.to_array().map(|x| x as f32);
        follow.then_some(Self { axes, backward, origin, slopes })
    }

    /// How wide the beam is at distance 1.
    pub(super) fn spread(&self) -> f32 {
        self.slopes.iter().map(|[least, largest]| largest - least).sum()
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
        let [axis, ..] = self.axes;
        let zero = simd.splat(0.0);
        let (low, high) = self.planes(simd, node, axis);
        let (near, far) =
            if self.backward { (simd.sub(zero, high), simd.sub(zero, low)) } else { (low, high) };
        let (near, far) = (simd.max(near, zero), simd.min(far, simd.splat(limit)));
        let mut met = simd.le(near, far);
        for k in 0..2 {
            let (axis, [least, largest]) = (self.axes[1 + k], self.slopes[k]);
            let (low, high) = self.planes(simd, node, axis);
            let (least, largest) = (simd.splat(least), simd.splat(largest));
            let from = simd.min(simd.mul(least, near), simd.mul(least, far));
            let to = simd.max(simd.mul(largest, near), simd.mul(largest, far));
            met &= simd.le(from, high) & simd.le(low, to);
        }
        (met, near)
    }

    /// The planes of a node's boxes along an axis, seen from the origin.
    #[inline(always)]
    fn planes<S: Simd>(&self, simd: S, node: &Node, axis: usize) -> (S::F, S::F) {
        let origin = simd.splat(self.origin[axis]);
        let (low, high) = (simd.load(&node.planes[axis]), simd.load(&node.planes[3 + axis]));
        (simd.sub(low, origin), simd.sub(high, origin))
    }
}
