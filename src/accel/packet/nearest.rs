//! The nearest hits of the rays of a packet.

use std::ops::Range;

use super::{FEWEST_LANES, GROUP, Packet, START_SLACK, Searches, Singles, has_lanes, limit_above};
use crate::{
    accel::{
        Accel,
        leaf::Candidates,
        simd::{Kernel, Simd},
        target::{prefetch, triangle_crossing},
        tree::Tree,
    },
    geometry::{
        Crossing,
        lanes::{Column, HitLanes, LANES, RayLanes, hull, lanes},
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
        let Some(mut packet) = Packet::new(tree, rays, origin, 1.0, f64::INFINITY) else {
            return false;
        };
        *hits = HitLanes::NONE;
        let (mut rates, mut starts) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let searches = packet.limit[k] >= 0.0;
            let along = limit_above(f64::from(packet.beam.along(packet.direction(k))));
            let start = packet.beam.depth(packet.point(k)) + START_SLACK;
            rates[k] = if searches { along } else { 0.0 };
            starts[k] = if searches { start } else { f32::NEG_INFINITY };
        }
        let crossed = [[f64::NAN; LANES]; 2];
        let pending = [u32::MAX; LANES];
        let from = [f32::INFINITY; LANES];
        let mut nearest =
            Nearest { accel, tree, rays, hits, rates, starts, crossed, pending, from };
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
    /// How far each ray goes along the beam's axis in one unit of its parameter, rounded up.
    rates: Singles,
    /// How far along the axis each ray starts, rounded up.
    starts: Singles,
    /// Where the lanes cross the primitive that is tried.
    crossed: [Column; 2],
    /// The place of a certain hit of each lane, beyond all if there is none, that has not been decided in double precision because it may never matter, and what its
    /// parameter is not less than.
    pending: [u32; LANES],
    from: Singles,
}

impl Nearest<'_> {
    /// Decides a leaf's primitive, which the rays of the lanes `met` hit if `certain`.
    #[inline(always)]
    fn decide<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        place: u32,
        met: u64,
        certain: bool,
    ) {
        let corners = self.tree.corners(place).filter(|_| has_lanes());
        let Some(corners) = corners else {
            return self.test(simd, packet, place as usize, met);
        };
        let number = self.accel.numbers[place as usize];
        if met.count_ones() < FEWEST_LANES {
            for k in lanes(met) {
                let ray = self.rays.plain_ray(k);
                let crossing = triangle_crossing(simd, corners, &ray, certain);
                self.offer(packet, k, number, crossing);
            }
            return;
        }
        let range = hull(met);
        simd.triangle_lanes(corners, self.rays, range.clone(), &mut self.crossed);
        self.offer_lanes(packet, number, range);
    }

    /// Takes the crossings of the lanes of a range that are better.
    #[inline(always)]
    fn offer_lanes(&mut self, packet: &mut Packet, number: u32, range: Range<usize>) {
        let [first, second] = &self.crossed;
        let hits = &mut *self.hits;
        for k in range {
            // The second is never better where the first is ahead.
            let t = if first[k] > 0.0 { first[k] } else { second[k] };
            let is_better =
                (t > 0.0) & ((t < hits.t[k]) | (t == hits.t[k]) & (number < hits.primitive[k]));
            hits.t[k] = if is_better { t } else { hits.t[k] };
            hits.primitive[k] = if is_better { number } else { hits.primitive[k] };
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

    /// Decides what is pending.
    #[inline(always)]
    fn finish<S: Simd>(&mut self, simd: S, packet: &mut Packet) {
        let pending = |k: usize| self.pending[k] != u32::MAX && self.from[k] <= packet.limit[k];
        let mut open = (0..LANES).fold(0_u64, |open, k| open | u64::from(pending(k)) << k);
        while open != 0 {
            let place = self.pending[open.trailing_zeros() as usize];
            let same = |k: usize| u64::from(self.pending[k] == place) << k;
            let same = open & (0..LANES).fold(0, |all, k| all | same(k));
            open &= !same;
            self.decide(simd, packet, place, same, true);
        }
    }
}

impl<S: Simd> Searches<S> for Nearest<'_> {
    #[inline(always)]
    fn test(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64) {
        let (number, shape) = (self.accel.numbers[place], &self.accel.shapes[place]);
        let range = hull(met);
        if met.count_ones() < FEWEST_LANES
            || !has_lanes()
            || !simd.cross_lanes(shape, self.rays, range.clone(), &mut self.crossed)
        {
            for k in lanes(met) {
                for crossing in self.accel.crossings(simd, &self.rays.ray(k), place) {
                    self.offer(packet, k, number, crossing);
                }
            }
            return;
        }
        self.offer_lanes(packet, number, range);
    }

    #[inline(always)]
    fn take(
        &mut self,
        simd: S,
        packet: &mut Packet,
        k: usize,
        first: u32,
        candidates: &Candidates,
    ) {
        // A pending hit loses to one that ends before it starts; where intervals overlap, both are decided.
        let Candidates { mut maybe, certain, from, to } = *candidates;
        while maybe != 0 {
            let lane = maybe.trailing_zeros() & 7;
            maybe &= maybe - 1;
            let place = first + lane;
            if certain & 1 << lane == 0 {
                self.decide(simd, packet, place, 1 << k, false);
                continue;
            }
            let (from, to) = (from.0[lane as usize], to.0[lane as usize]);
            if from > packet.limit[k] {
                continue;
            }
            if to >= self.from[k] && self.pending[k] != u32::MAX {
                self.decide(simd, packet, self.pending[k], 1 << k, true);
            }
            (self.pending[k], self.from[k]) = (place, from);
            packet.limit[k] = packet.limit[k].min(to);
            prefetch(simd, self.accel, self.tree, place);
        }
    }

    #[inline(always)]
    fn end(&self, packet: &Packet) -> f32 {
        // In eight parts, each a lane of vectors.
        let mut ends = [f32::NEG_INFINITY; GROUP];
        for start in (0..LANES).step_by(GROUP) {
            for (part, end) in ends.iter_mut().enumerate() {
                let k = start + part;
                let other = packet.limit[k] * self.rates[k] + self.starts[k];
                *end = if other > *end { other } else { *end };
            }
        }
        ends.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }
}
