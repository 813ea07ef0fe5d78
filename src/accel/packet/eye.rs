//! The triangles of a leaf as they are seen from the point that the rays of a packet share.
//!
//! With a corner c away from that point, edges e₁ and e₂ from there and n = e₁ × e₂, a ray along d is at the depth n·c / n·d in
//! the plane, at the point c + v e₁ + w e₂ where v n·d = (e₂ × c)·d and w n·d = (c × e₁)·d. What these vectors are does not depend on
//! the ray, nor on which side of the plane the point is: once for each triangle. A ray then takes four products with its two slopes,
//! and of eight rays at once whether any may be inside follows from their least and largest slopes.
//!
//! The bounds, with u = 2⁻²⁴, the longest edge e and nothing further from the point than r: c is off by 2 u r, so e₂ × c and
//! c × e₁ by less than 6 u e r each, n by 5 u e² and, as e is at most 2 r, what they leave of n by less than 24 u e r; the
//! direction is at most 2.03 long and off by 1.5 u; so v, w and 1 − v − w, times n·d, are off by less than 60 u e r (96 is
//! taken), n·c by 12 u e² r and n·d by 20 u e². The slopes of eight rays being those that they have, and roundings
//! monotonic, what is said of all eight has no other error than what is said of one.
//!
//! Source for the test: Möller & Trumbore, "Fast, minimum storage ray/triangle intersection", *Journal of Graphics Tools* 2(1),
//! 1997.

use glam::DVec3;

use super::{GROUP, Packet, Searches, load};
use crate::{
    accel::{
        beam::{Axis, Singles},
        frame::{above, below},
        leaf::{Candidates, cross, dot, splat, sub},
        node::Run,
        simd::{Lanes, Simd, bits},
        tree::Tree,
    },
    geometry::lanes::{LANES, lanes},
};

const U: f32 = f32::EPSILON / 2.0;

/// How far the point may be from the centre of the tree, for the errors that grow with it.
const FURTHEST: f64 = 16.0;

/// How many times eight rays a packet has.
const GROUPS: usize = LANES / GROUP;

/// The common point of the rays of a packet, and what they have in common.
pub(super) struct Eye {
    /// The point, along the axis and the two others.
    point: [f32; 3],
    axis: Axis,
    /// How far from the point any corner may be.
    reach: f32,
    /// The depth of the point before the start, rounded down and up.
    lead: [f32; 2],
    /// The largest and the least slopes of each group, along each of the two other axes.
    slopes: [[Lanes; 2]; 2],
}

/// Some triangles, side by side: the three vectors whose products with a direction are positive inside, the normal, which is not turned
/// away, and the volume n·c, which is not negative.
struct Seen {
    edges: [[Lanes; 3]; 3],
    normal: [Lanes; 3],
    volume: Lanes,
    /// The longest edges.
    size: Lanes,
    /// The triangles whose plane holds the point, or may do so; the rest means nothing for them.
    edge_on: u32,
    all: u32,
}

impl Eye {
    /// Whether there are triangles to be seen and the common point is not too far away.
    #[inline(always)]
    pub(super) fn is_for(tree: &Tree, axis: &Axis) -> bool {
        tree.has_triangles() && DVec3::from_array(axis.point).length() <= FURTHEST
    }

    /// The common point of the rays.
    #[inline(always)]
    pub(super) fn of(packet: &Packet) -> Self {
        let Axis { point, lead, .. } = packet.axis;
        Self {
            point: point.map(|x| x as f32),
            axis: packet.axis,
            reach: above(DVec3::from_array(point).length() + 1.75),
            lead: [below(lead), above(lead)],
            slopes: packet.slopes().map(|column| ranges(column, &packet.limit)),
        }
    }

    /// Has `searches` take the triangles of a leaf for the rays of the lanes `met` that may meet them.
    #[inline(always)]
    pub(super) fn leaf<S: Simd>(
        &self,
        simd: S,
        tree: &Tree,
        packet: &mut Packet,
        searches: &mut impl Searches<S>,
        run: Run,
        met: u64,
    ) {
        #[cfg(feature = "leaf-study")]
        crate::accel::study::count_eye();
        let seen = self.see(simd, tree, run);
        // The pairs of a triangle and a group, a bit for each.
        let mut pairs = 0;
        for lane in bits(seen.all & !seen.edge_on) {
            pairs |= u64::from(self.groups(simd, &seen, lane)) << (lane * GROUPS);
        }
        for pair in lanes(pairs) {
            let (lane, start) = (pair / GROUPS, pair % GROUPS * GROUP);
            let Candidates { maybe, certain, from, to } =
                self.meet(simd, &seen, lane, packet, start);
            for part in bits(maybe & (met >> start) as u32) {
                let bounds = [from.0[part], to.0[part]];
                let certain = (certain >> part & 1 != 0).then_some(bounds);
                searches.take(simd, packet, start + part, run.first + lane as u32, certain);
            }
        }
        if seen.edge_on != 0 {
            for k in lanes(met) {
                for lane in bits(seen.edge_on) {
                    searches.take(simd, packet, k, run.first + lane as u32, None);
                }
            }
        }
    }

    #[inline(always)]
    fn see<S: Simd>(&self, simd: S, tree: &Tree, run: Run) -> Seen {
        let leaf = tree.triangles.rows.leaf(run);
        let [x, y, z] = self.axis.order;
        let corner = [leaf.row(simd, x), leaf.row(simd, y), leaf.row(simd, z)];
        let edge1 = [leaf.row(simd, 3 + x), leaf.row(simd, 3 + y), leaf.row(simd, 3 + z)];
        let edge2 = [leaf.row(simd, 6 + x), leaf.row(simd, 6 + y), leaf.row(simd, 6 + z)];
        let size = leaf.row(simd, 9);
        let c = sub(simd, corner, splat(simd, self.point));
        let n = cross(simd, edge1, edge2);
        let v = cross(simd, edge2, c);
        let w = cross(simd, c, edge1);
        let rest = sub(simd, sub(simd, n, v), w);
        let signed = dot(simd, n, c);
        let volume = simd.toggle_sign(signed, signed);
        let error = simd.mul(simd.mul(size, size), simd.splat(12.0 * U * self.reach));
        // Along the axis a direction goes by 1 or -1.
        let side = simd.mul(signed, simd.splat(self.axis.forward as f32));
        Seen {
            edges: [
                turned(simd, v, side, signed),
                turned(simd, w, side, signed),
                turned(simd, rest, side, signed),
            ],
            normal: turned(simd, n, side, signed),
            volume: simd.store(volume),
            size: simd.store(size),
            edge_on: leaf.all() & simd.le(volume, error),
            all: leaf.all(),
        }
    }

    /// The groups of which a ray may be inside a triangle.
    #[inline(always)]
    fn groups<S: Simd>(&self, simd: S, seen: &Seen, lane: usize) -> u32 {
        let error = simd.splat(-96.0 * U * self.reach * seen.size.0[lane]);
        let mut met = u32::MAX;
        for edge in &seen.edges {
            let is_negative = edge.each_ref().map(|x| (x.0[lane].to_bits() >> 31) as usize);
            let rights = simd.load(&self.slopes[0][is_negative[1]].0);
            let ups = simd.load(&self.slopes[1][is_negative[2]].0);
            met &= simd.le(error, product(simd, edge, lane, rights, ups));
        }
        met
    }

    /// Which of the rays of eight lanes may meet a triangle.
    #[inline(always)]
    fn meet<S: Simd>(
        &self,
        simd: S,
        seen: &Seen,
        lane: usize,
        packet: &Packet,
        start: usize,
    ) -> Candidates {
        #[cfg(feature = "leaf-study")]
        crate::accel::study::count_seen();
        let [rights, ups] = packet.slopes();
        let (rights, ups) = (load(simd, rights, start), load(simd, ups, start));
        let v = product(simd, &seen.edges[0], lane, rights, ups);
        let w = product(simd, &seen.edges[1], lane, rights, ups);
        let rest = product(simd, &seen.edges[2], lane, rights, ups);
        let den = product(simd, &seen.normal, lane, rights, ups);
        let inside = simd.min(simd.min(v, w), rest);
        let size = seen.size.0[lane];
        let (volume, zero) = (simd.splat(seen.volume.0[lane]), simd.splat(0.0));
        let error = 96.0 * U * self.reach * size;
        let volume_error = U * self.reach * size * size;
        let limit = load(simd, &packet.limit, start);
        let reach = simd.add(limit, simd.splat(self.lead[1]));
        let reach = simd.min(reach, simd.splat(self.reach));
        let last = simd.mul_add(reach, den, simd.splat(40.0 * volume_error));
        let maybe =
            simd.le(zero, limit) & simd.le(simd.splat(-error), inside) & simd.le(volume, last);
        if maybe == 0 {
            return Candidates::NONE;
        }
        let volume_error = simd.splat(16.0 * volume_error);
        let den_error = simd.splat(24.0 * U * size * size);
        let from = simd.div(simd.sub(volume, volume_error), simd.add(den, den_error));
        let to = simd.div(simd.add(volume, volume_error), simd.sub(den, den_error));
        let from = simd.sub(from, simd.splat(self.lead[1]));
        let to = simd.sub(to, simd.splat(self.lead[0]));
        let certain = maybe
            & simd.le(simd.splat(error), inside)
            & simd.le(simd.add(den_error, den_error), den)
            & simd.le(to, load(simd, &packet.end, start));
        Candidates { maybe, certain, from: simd.store(from), to: simd.store(to) }
    }
}

/// A vector with another sign, along the axis where that of `side` is negative, and along the others where that of `signed` is.
#[inline(always)]
fn turned<S: Simd>(simd: S, [x, y, z]: [S::F; 3], side: S::F, signed: S::F) -> [Lanes; 3] {
    [
        simd.store(simd.toggle_sign(x, side)),
        simd.store(simd.toggle_sign(y, signed)),
        simd.store(simd.toggle_sign(z, signed)),
    ]
}

/// The products of one of eight vectors with directions of these slopes.
#[inline(always)]
fn product<S: Simd>(
    simd: S,
    [along, right, up]: &[Lanes; 3],
    lane: usize,
    rights: S::F,
    ups: S::F,
) -> S::F {
    let right = simd.mul_add(rights, simd.splat(right.0[lane]), simd.splat(along.0[lane]));
    simd.mul_add(ups, simd.splat(up.0[lane]), right)
}

/// The largest and the least numbers of each group in the lanes that are open; none is both.
#[inline(always)]
fn ranges(column: &Singles, limit: &Singles) -> [Lanes; 2] {
    let (mut least, mut largest) = ([0.0; LANES], [0.0; LANES]);
    for k in 0..LANES {
        least[k] = if limit[k] >= 0.0 { column[k] } else { f32::INFINITY };
        largest[k] = if limit[k] >= 0.0 { column[k] } else { f32::NEG_INFINITY };
    }
    let lesser = |a, b| if a < b { a } else { b };
    let greater = |a, b| if a > b { a } else { b };
    [Lanes(in_groups(&largest, greater)), Lanes(in_groups(&least, lesser))]
}

/// The best number of each group.
#[inline(always)]
fn in_groups(column: &Singles, better: impl Fn(f32, f32) -> f32) -> [f32; GROUPS] {
    let (mut pairs, mut fours, mut all) = ([0.0; LANES / 2], [0.0; LANES / 4], [0.0; GROUPS]);
    for k in 0..LANES / 2 {
        pairs[k] = better(column[2 * k], column[2 * k + 1]);
    }
    for k in 0..LANES / 4 {
        fours[k] = better(pairs[2 * k], pairs[2 * k + 1]);
    }
    for k in 0..GROUPS {
        all[k] = better(fours[2 * k], fours[2 * k + 1]);
    }
    all
}
