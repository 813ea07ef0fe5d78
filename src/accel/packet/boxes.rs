//! Which rays of a packet meet a leaf's box.
//!
//! The arithmetic is that of a single ray, in slopes and depths: with u = 2⁻²⁴, where a ray begins is off by 2 u, its
//! slope at the largest depth by 2.3 u, that depth by 4 u, and what they give by 11 u, less than the 32 u of the boxes'
//! pads.

use super::{GROUP, Packet, load, open, walk::Visit};
use crate::{
    accel::{beam::Singles, node::Node, simd::Simd, tree::Tree},
    geometry::lanes::LANES,
};

/// More of the rays of a packet, for the tests of boxes and spheres.
pub(super) struct Prepared {
    /// One over their slopes along the two other axes, and where they begin times that.
    inverse: [Singles; 2],
    offset: [Singles; 2],
    /// The length of the directions, and one over its square.
    pub(super) length: Singles,
    pub(super) inverse_square: Singles,
}

impl Packet {
    /// What the tests of boxes and spheres need.
    #[inline(always)]
    pub(super) fn prepared(&self) -> Prepared {
        let none = [0.0; LANES];
        let (mut inverse, mut offset) = ([none; 2], [none; 2]);
        let (mut length, mut inverse_square) = (none, none);
        let [_, right, up] = self.axis.order;
        for (side, axis) in [right, up].into_iter().enumerate() {
            for k in 0..LANES {
                let slope = self.dir[axis][k];
                let tiny = 1e-30_f32.copysign(slope);
                inverse[side][k] = 1.0 / if slope.abs() < 1e-30 { tiny } else { slope };
                offset[side][k] = self.origin[axis][k] * inverse[side][k];
            }
        }
        for k in 0..LANES {
            let [x, y] = [self.dir[right][k], self.dir[up][k]];
            let square = 1.0 + (x * x + y * y);
            (length[k], inverse_square[k]) = (square.sqrt(), 1.0 / square);
        }
        Prepared { inverse, offset, length, inverse_square }
    }

    /// Which of the rays may meet the box of what is to be visited.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(
        &self,
        simd: S,
        tree: &Tree,
        visit: &Visit,
        prepared: &Prepared,
    ) -> u64 {
        let (Some(Node { planes, .. }), slot) =
            (tree.nodes.get(visit.node as usize), visit.slot as usize)
        else {
            return open(&self.limit);
        };
        let [axis, right, up] = self.axis.order;
        let (_, far) = self.axis.depths(planes[axis][slot], planes[3 + axis][slot]);
        let (near, far) = (simd.splat(visit.enter), simd.splat(far));
        let low = [simd.splat(planes[right][slot]), simd.splat(planes[up][slot])];
        let high = [simd.splat(planes[3 + right][slot]), simd.splat(planes[3 + up][slot])];
        let mut met = 0;
        for start in (0..LANES).step_by(GROUP) {
            #[cfg(feature = "leaf-study")]
            crate::accel::study::count_eight();
            let group = |column: &Singles| load(simd, column, start);
            let (mut enter, mut leave) = (near, simd.min(far, group(&self.limit)));
            for side in 0..2 {
                let (inverse, offset) =
                    (group(&prepared.inverse[side]), group(&prepared.offset[side]));
                let low = simd.mul_sub(low[side], inverse, offset);
                let high = simd.mul_sub(high[side], inverse, offset);
                enter = simd.max(enter, simd.min(low, high));
                leave = simd.min(leave, simd.max(low, high));
            }
            met |= u64::from(simd.le(enter, leave)) << start;
        }
        met
    }
}
