//! The nearest hits of the rays of a packet.

use std::ops::Range;

use super::{FEWEST_LANES, Packet, Searches, Singles, WIDEST, has_lanes};
use crate::{
    accel::{
        Accel,
        decide::{cross_lanes, flat_crossing},
        simd::{Kernel, Simd},
        target::prefetch,
        tree::Tree,
    },
    geometry::{
        Crossing,
        lanes::{Column, HitLanes, LANES, RayLanes, hull, lanes},
        triangle::PlaneLanes,
    },
};

/// The search for the nearest hits of rays from one origin in free space.
pub(in crate::accel) struct NearestPacket<'a> {
    pub(in crate::accel) accel: &'a Accel,
    pub(in crate::accel) rays: &'a RayLanes<'a>,
    pub(in crate::accel) hits: &'a mut HitLanes,
}

impl Kernel for NearestPacket<'_> {
    type Output = bool;

    /// Returns whether the rays were traced; if not, each must be by itself.
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { accel, rays, hits } = self;
        let Some(tree) = &accel.tree else { return false };
        let origin = rays.origin.get(rays.used.trailing_zeros() as usize % LANES);
        let end = (f64::INFINITY, 0.0);
        let Ok(mut packet) = Packet::new(tree, rays, origin, 1.0, end, f64::INFINITY, WIDEST)
        else {
            return false;
        };
        *hits = HitLanes::NONE;
        let crossed = [[f64::NAN; LANES]; 2];
        let pending = [u32::MAX; LANES];
        let from = [f32::INFINITY; LANES];
        let mut nearest = Nearest { accel, tree, rays, hits, crossed, pending, from };
        for place in accel.outside() {
            nearest.test(simd, &mut packet, place, rays.used);
        }
        packet.walk(simd, tree, &mut nearest);
        nearest.finish(simd, &mut packet);
        true
    }
}

struct Nearest<'a> {
    accel: &'a Accel,
    tree: &'a Tree,
    rays: &'a RayLanes<'a>,
    hits: &'a mut HitLanes,
    /// Where the lanes cross the primitive that is tried.
    crossed: [Column; 2],
    /// The place of a certain hit of each lane, beyond all if there is none, that has not been decided in double
    /// precision because it may never matter, and what its depth is not less than.
    pending: [u32; LANES],
    from: Singles,
}

impl Nearest<'_> {
    /// Decides a leaf's primitive, which the ray of a lane hits if `certain`.
    #[inline(always)]
    fn decide<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        place: u32,
        k: usize,
        certain: bool,
    ) {
        let Some(flat) = self.tree.flat(place).filter(|_| has_lanes()) else {
            return self.test(simd, packet, place as usize, 1 << k);
        };
        let crossing = flat_crossing(simd, flat, &self.rays.plain_ray(k), certain);
        self.offer(packet, k, flat.number, crossing);
    }

    /// Takes the crossings of the lanes of a range, with the primitives of these numbers, that are better.
    #[inline(always)]
    fn offer_lanes(
        &mut self,
        packet: &mut Packet,
        number: impl Fn(usize) -> u32,
        range: Range<usize>,
    ) {
        let [first, second] = &self.crossed;
        let hits = &mut *self.hits;
        for k in range {
            // The second is never better where the first is ahead.
            let t = if first[k] > 0.0 { first[k] } else { second[k] };
            let is_better =
                (t > 0.0) & ((t < hits.t[k]) | (t == hits.t[k]) & (number(k) < hits.primitive[k]));
            hits.t[k] = if is_better { t } else { hits.t[k] };
            hits.primitive[k] = if is_better { number(k) } else { hits.primitive[k] };
            hits.face[k] = if is_better { 0 } else { hits.face[k] };
            let limit = packet.end_above(k, hits.t[k]);
            packet.limit[k] = if limit < packet.limit[k] { limit } else { packet.limit[k] };
        }
    }

    /// Takes a crossing of the ray of one lane if it is better: nearer, or as near and of a lower primitive.
    #[inline(always)]
    fn offer(&mut self, packet: &mut Packet, k: usize, number: u32, crossing: Crossing) {
        let (t, hits) = (crossing.t, &mut *self.hits);
        if t > 0.0 && (t < hits.t[k] || t == hits.t[k] && number < hits.primitive[k]) {
            (hits.t[k], hits.primitive[k], hits.face[k]) = (t, number, crossing.face);
            packet.limit[k] = packet.limit[k].min(packet.end_above(k, t));
        }
    }

    /// Decides what is pending: triangles side by side, of anything else what several rays hit.
    #[inline(always)]
    fn finish<S: Simd>(&mut self, simd: S, packet: &mut Packet) {
        let pending = |k: usize| self.pending[k] != u32::MAX && self.from[k] <= packet.limit[k];
        let mut open = (0..LANES).fold(0_u64, |open, k| open | u64::from(pending(k)) << k);
        if self.tree.has_triangles() && has_lanes() {
            open &= !self.finish_flats(packet, open);
        }
        while open != 0 {
            let place = self.pending[open.trailing_zeros() as usize];
            let same = |k: usize| u64::from(self.pending[k] == place) << k;
            let same = open & (0..LANES).fold(0, |all, k| all | same(k));
            open &= !same;
            self.test(simd, packet, place as usize, same);
        }
    }

    /// Decides the triangles that are pending in some lanes; returns which have one.
    #[inline(always)]
    fn finish_flats(&mut self, packet: &mut Packet, open: u64) -> u64 {
        let (mut planes, mut numbers, mut all) = (PlaneLanes::NONE, [0; LANES], 0);
        for k in lanes(open) {
            let Some(flat) = self.tree.flat(self.pending[k]) else { continue };
            #[cfg(feature = "leaf-study")]
            crate::accel::study::count_triangle();
            planes.set(k, &flat.plane);
            numbers[k] = flat.number;
            all |= 1 << k;
        }
        let range = hull(all);
        let [first, second] = &mut self.crossed;
        for k in range.clone() {
            let t = planes.parameter(k, self.rays);
            first[k] = if all >> k & 1 != 0 { t } else { f64::NAN };
            second[k] = f64::NAN;
        }
        self.offer_lanes(packet, |k| numbers[k], range);
        all
    }
}

impl<S: Simd> Searches<S> for Nearest<'_> {
    #[inline(always)]
    fn test(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64) {
        let (number, shape) = (self.accel.numbers[place], &self.accel.shapes[place]);
        let range = hull(met);
        if met.count_ones() < FEWEST_LANES
            || !has_lanes()
            || !cross_lanes(simd, shape, self.rays, range.clone(), &mut self.crossed)
        {
            for k in lanes(met) {
                for crossing in self.accel.crossings(simd, &self.rays.ray(k), place) {
                    self.offer(packet, k, number, crossing);
                }
            }
            return;
        }
        self.offer_lanes(packet, |_| number, range);
    }

    #[inline(always)]
    fn take(
        &mut self,
        simd: S,
        packet: &mut Packet,
        k: usize,
        place: u32,
        certain: Option<[f32; 2]>,
    ) {
        // A pending hit loses to one that ends before it starts; where intervals overlap, both are decided.
        let Some([from, to]) = certain else {
            return self.decide(simd, packet, place, k, false);
        };
        if from > packet.limit[k] {
            return;
        }
        if to >= self.from[k] && self.pending[k] != u32::MAX {
            self.decide(simd, packet, self.pending[k], k, true);
        }
        (self.pending[k], self.from[k]) = (place, from);
        packet.limit[k] = packet.limit[k].min(to);
        prefetch(simd, self.accel, self.tree, place);
    }
}
