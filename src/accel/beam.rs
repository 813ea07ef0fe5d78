//! A beam of rays that share a point: which boxes may any of them meet?
//!
//! Along the axis that all rays mostly follow, a ray is a pair of slopes; between the least and the largest slopes lies
//! the beam. Eight boxes are tested at once against all of it, at the cost of one ray. Its answers are only "perhaps",
//! like those of a single ray, and the pads of the boxes cover its roundings: what it begins with and its slopes are rounded
//! outward, the coordinate where it starts is off by 2 u, and what they give at a distance of at most 4 by 8 u, together less than
//! 2⁻²⁰, half a pad.
//!
//! Source: the idea of tracing the beam instead of the rays is that of Reshetov, Soupikov & Hurley, "Multi-level ray
//! tracing algorithm", *ACM Transactions on Graphics* 24(3) (2005).

use glam::DVec3;

use super::{
    frame::{above, below},
    node::Node,
    simd::Simd,
};

/// Rays from further away than this are traced one by one, for the rounding of their own tests.
const FURTHEST: f64 = (1 << 20) as f64;

/// The steepest a ray may be against the axis of its beam.
const STEEPEST: f64 = 2.0;

/// How far from the centre, along the axis, a beam from afar starts: a little before the tree.
const START: f64 = 1.25;

/// A beam in the tree's frame.
///
/// It starts where its rays begin, or, if that is far away, in a plane shortly before the tree that they reach together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// The axis that the rays mostly follow, and the two others.
    axes: [usize; 3],
    /// Whether they follow it towards smaller coordinates.
    backward: bool,
    /// The coordinate along the axis where the beam starts.
    start: f64,
    /// How far along the axis that is from the rays' common point.
    pub(super) lead: f64,
    /// The least and the largest coordinate along each of the two other axes at the start.
    begin: [[f32; 2]; 2],
    /// The least and the largest slope along each of them.
    slopes: [[f32; 2]; 2],
}

impl Beam {
    /// The beam of rays from `point` along `dirs`; `None` if they have no axis in common.
    pub(super) fn around(
        point: DVec3,
        mut dirs: impl Iterator<Item = DVec3> + Clone,
    ) -> Option<Self> {
        let first = dirs.clone().next()?;
        let axis = first.abs().max_position();
        let axes = [axis, (axis + 1) % 3, (axis + 2) % 3];
        let backward = first[axis] < 0.0;
        let mut slopes = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let follow = dirs.all(|dir| {
            let along = if backward { -dir[axis] } else { dir[axis] };
            along > 0.0
                && slopes.iter_mut().zip(&axes[1..]).all(|(range, axis)| {
                    let slope = dir[*axis] / along;
                    *range = [range[0].min(slope), range[1].max(slope)];
                    slope.abs() <= STEEPEST
                })
        });
        if !(follow && point.abs().max_element() <= FURTHEST) {
            return None;
        }
        let forward = if backward { -1.0 } else { 1.0 };
        let lead = (-START - forward * point[axis]).max(0.0);
        let start = point[axis] + forward * lead;
        let outward =
            |[least, largest]: [f64; 2]| [below(least).next_down(), above(largest).next_up()];
        let begin =
            [0, 1].map(|k| outward(slopes[k].map(|slope| slope.mul_add(lead, point[axes[1 + k]]))));
        Some(Self { axes, backward, start, lead, begin, slopes: slopes.map(outward) })
    }

    /// How wide the beam is at the tree.
    pub(super) fn spread(&self) -> f32 {
        let slopes: f32 = self.slopes.iter().map(|[least, largest]| largest - least).sum();
        slopes * (1.0 + self.lead as f32)
    }

    /// How far along the axis a vector goes.
    pub(super) fn along(&self, v: DVec3) -> f64 {
        if self.backward { -v[self.axes[0]] } else { v[self.axes[0]] }
    }

    /// How far along the axis from the start a point is.
    pub(super) fn depth(&self, p: DVec3) -> f64 {
        if self.backward { self.start - p[self.axes[0]] } else { p[self.axes[0]] - self.start }
    }

    /// Which children of `node` the beam may meet within `limit` along its axis, and where it enters each.
    #[inline(always)]
    pub(super) fn test<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, S::F) {
        let (zero, start) = (simd.splat(0.0), simd.splat(self.start as f32));
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
            let ([least, largest], [from, to]) = (self.slopes[k], self.begin[k]);
            let (least, largest) = (simd.splat(least), simd.splat(largest));
            let (from, to) = (simd.splat(from), simd.splat(to));
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
