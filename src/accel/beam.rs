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
    /// The beam of rays from `origin`, at most 2 from the centre, along `dirs`; `None` if they have no axis in common.
    pub(super) fn around(
        origin: DVec3,
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
        let outward =
            |[least, largest]: [f64; 2]| [below(least).next_down(), above(largest).next_up()];
        let origin = origin.to_array().map(|x| x as f32);
        follow.then(|| Self { axes, backward, origin, slopes: slopes.map(outward) })
    }

    /// How wide the beam is at distance 1.
    pub(super) fn spread(&self) -> f32 {
        self.slopes.iter().map(|[least, largest]| largest - least).sum()
    }

    /// How far along the axis a vector goes.
    pub(super) fn along(&self, v: DVec3) -> f64 {
        if self.backward { -v[self.axes[0]] } else { v[self.axes[0]] }
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
