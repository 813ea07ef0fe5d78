//! What blocks the rays of a packet on their way to a light.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{Apart, BLOCKED, FEWEST_LANES, Packet, Searches, WIDEST, has_lanes};
use crate::{
    accel::{
        Accel, crossed,
        decide::{cross_lanes, flat_crossing},
        simd::{Kernel, Simd},
        tree::Tree,
    },
    geometry::{
        Crossing, Ray,
        lanes::{Column, LANES, RayLanes, hull, lanes},
    },
};

/// Room for the roundings of a ray's start as its end and direction give it.
const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// A ray that starts further from the light than this, in the tree's frame, is traced by itself.
const FURTHEST: f64 = (1 << 26) as f64;

/// A part of a beam that was too wide meets too much if it is wider than the first or, times the cube root of the
/// number of primitives, than the second.
const WIDEST_PART: [f32; 2] = [0.12, 2.6];

/// The search for what blocks rays that end, at `t = 1`, in one point. If they are too far from each other, parts of
/// them are traced together.
pub(in crate::accel) struct BlockedPacket<'a, B, V> {
    pub(in crate::accel) accel: &'a Accel,
    pub(in crate::accel) rays: &'a RayLanes<'a>,
    pub(in crate::accel) target: DVec3,
    pub(in crate::accel) opaque: &'a B,
    pub(in crate::accel) visit: &'a mut V,
}

impl<B, V> Kernel for BlockedPacket<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(usize, u32, Crossing) -> ControlFlow<()>,
{
    /// The lanes that are blocked, and those whose rays were not traced: each must be by itself.
    type Output = (u64, u64);

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) -> (u64, u64) {
        let Some(tree) = &self.accel.tree else { return (0, self.rays.used) };
        let (mut blocked, mut alone) = (0, 0);
        // None is empty, so there are never more than lanes.
        let (mut parts, mut count) = ([self.rays.used; LANES], 1);
        let [most, dense] = WIDEST_PART;
        let mut widest = WIDEST;
        while count > 0 {
            count -= 1;
            let used = parts[count];
            let part = RayLanes { used, ..*self.rays };
            // From the light to where they start, which is as far as they go in one unit.
            match Packet::new(tree, &part, self.target, -1.0, (1.0, SLACK), FURTHEST, widest) {
                Ok(packet) => blocked |= self.trace(simd, tree, packet, &part),
                Err(Apart::Wide(half)) if half != 0 && half != used => {
                    widest = most.min(dense / (self.accel.len() as f32).cbrt());
                    (parts[count], parts[count + 1]) = (half, used & !half);
                    count += 2;
                }
                Err(_) => alone |= used,
            }
        }
        (blocked, alone)
    }
}

impl<B, V> BlockedPacket<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(usize, u32, Crossing) -> ControlFlow<()>,
{
    /// The lanes of a packet of `rays` that are blocked.
    #[inline(always)]
    fn trace<S: Simd>(&mut self, simd: S, tree: &Tree, mut packet: Packet, rays: &RayLanes) -> u64 {
        let Self { accel, opaque, visit, .. } = self;
        let crossed = [[f64::NAN; LANES]; 2];
        let mut blocks = Blocks { accel, tree, rays, opaque: *opaque, visit: *visit, crossed };
        for place in accel.outside() {
            blocks.test(simd, &mut packet, place, rays.used);
        }
        packet.walk(simd, tree, &mut blocks);
        let blocked = |k: usize| u64::from(packet.limit[k] == BLOCKED) << k;
        rays.used & (0..LANES).fold(0, |all, k| all | blocked(k))
    }
}

struct Blocks<'a, B, V> {
    accel: &'a Accel,
    tree: &'a Tree,
    rays: &'a RayLanes<'a>,
    opaque: &'a B,
    visit: &'a mut V,
    /// Where the lanes cross the primitive that is tried.
    crossed: [Column; 2],
}

/// A visit that knows its lane.
pub(in crate::accel) struct VisitOf<'v, V> {
    visit: &'v mut V,
    lane: usize,
}

impl<V: FnMut(usize, u32, Crossing) -> ControlFlow<()>> crossed::Visit for VisitOf<'_, V> {
    #[inline(always)]
    fn visit(&mut self, primitive: u32, crossing: Crossing) -> ControlFlow<()> {
        (self.visit)(self.lane, primitive, crossing)
    }
}

impl<B, V> Blocks<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(usize, u32, Crossing) -> ControlFlow<()>,
{
    /// Tries the primitive in `place` with the rays of the lanes `met` one by one.
    #[inline(always)]
    fn test_each<S: Simd>(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64) {
        for k in lanes(met) {
            let ray = self.rays.ray(k);
            if self.lane_test(&ray, k).test(simd, place) {
                packet.limit[k] = BLOCKED;
            }
        }
    }

    /// The test of primitives with the ray of a lane.
    #[inline(always)]
    fn lane_test<'t>(
        &'t mut self,
        ray: &'t Ray,
        k: usize,
    ) -> crossed::Test<'t, &'t B, VisitOf<'t, V>> {
        let visit = VisitOf { visit: self.visit, lane: k };
        crossed::Test { accel: self.accel, ray, end: 1.0, opaque: self.opaque, visit }
    }
}

impl<S: Simd, B, V> Searches<S> for Blocks<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(usize, u32, Crossing) -> ControlFlow<()>,
{
    #[inline(always)]
    fn test(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64) {
        let (number, shape) = (self.accel.numbers[place], &self.accel.shapes[place]);
        let own = self.rays.leaving(number);
        let (range, others) = (hull(met & !own), met & !own);
        if others.count_ones() < FEWEST_LANES
            || !has_lanes()
            || !cross_lanes(simd, shape, self.rays, range.clone(), &mut self.crossed)
        {
            self.test_each(simd, packet, place, met);
            return;
        }
        let [first, second] = &self.crossed;
        let is_between = |t: f64| (t > 0.0) & (t < 1.0);
        if (self.opaque)(number) {
            for k in range.clone() {
                let is_blocked = is_between(first[k]) | is_between(second[k]);
                let keeps = own >> k & 1 != 0;
                packet.limit[k] = if is_blocked & !keeps { BLOCKED } else { packet.limit[k] };
            }
        } else {
            let mut crossed = [0_u64; LANES];
            for k in range.clone() {
                crossed[k] = u64::from(is_between(first[k]) | is_between(second[k]));
            }
            for k in lanes(others).filter(|k| crossed[*k] != 0) {
                for t in [first[k], second[k]].into_iter().filter(|t| is_between(*t)) {
                    if (self.visit)(k, number, Crossing::at(t)).is_break() {
                        packet.limit[k] = BLOCKED;
                        break;
                    }
                }
            }
        }
        self.test_each(simd, packet, place, met & own);
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
        let number = self.accel.numbers[place as usize];
        let left = self.rays.from.map_or(u32::MAX, |from| from.hits.primitive[k]);
        if packet.limit[k] < 0.0 {
            return;
        }
        // A certain hit of an opaque one blocks it without further ado.
        if certain.is_some() && number != left && (self.opaque)(number) {
            packet.limit[k] = BLOCKED;
            return;
        }
        let Some(flat) = self.tree.flat(place).filter(|_| has_lanes()) else {
            return self.test_each(simd, packet, place as usize, 1 << k);
        };
        // A ray never meets the triangle that it leaves.
        if number != left {
            let ray = self.rays.plain_ray(k);
            let crossing = flat_crossing(simd, flat, &ray, certain.is_some());
            if self.lane_test(&ray, k).crosses(number, crossing) {
                packet.limit[k] = BLOCKED;
            }
        }
    }
}
