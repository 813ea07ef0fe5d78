//! Up to 64 rays that share a point, traced together.
//!
//! The nodes are tested against their [`Beam`], once for all; a leaf's box against the rays, eight at a time. A leaf of one sphere
//! or flat shape is then tried by all of them in a loop over the lanes, which vectors can do; the primitives of other leaves by
//! each ray that may meet them. What decides is the shapes' own arithmetic, so the answers are, to the bit, those of single
//! rays; that a lane tries what it need not have tried makes no difference.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{
    Accel,
    beam::Beam,
    crossed,
    frame::{FAR_SQUARED, NEAR_SQUARED, TreeRay, above},
    leaf::{Candidates, LeafRay},
    node::{Child, Content, Node},
    simd::{Kernel, Simd},
    tree::Tree,
    walk::MAX_DEPTH,
};
use crate::geometry::{
    Crossing,
    lanes::{Column, HitLanes, LANES, RayLanes, hull, lanes},
};

/// Rays whose boxes are tested by one instruction.
const GROUP: usize = 8;

/// Fewer rays than this are as fast one by one.
const FEWEST: u32 = 8;

/// Fewer lanes than this are as fast one by one where a primitive is tried.
const FEWEST_LANES: u32 = 3;

/// A wider beam, at distance 1 in units of half the scene, meets too much that no ray of it does.
const WIDEST: f32 = 0.25;

/// The stack of the walk: each node on the way down leaves at most seven of its children to be visited later.
const STACK: usize = MAX_DEPTH * 7 + 1;

/// The limit of a lane that is not in use, or whose ray passes the tree by.
const ASIDE: f32 = -1.0;

/// The limit of a lane whose ray is blocked.
const BLOCKED: f32 = -2.0;

/// Room for the roundings of a ray's start and end along the beam's axis.
const START_SLACK: f32 = 1.0 / (1 << 20) as f32;

/// A number in single precision for each lane.
type Singles = [f32; LANES];

/// A child to be visited: where the beam enters it, what it is, and its box (node and slot).
#[derive(Clone, Copy)]
struct Visit {
    enter: f32,
    child: Child,
    node: u32,
    slot: u32,
}

/// The rays of a packet in the tree's frame, and the beam about them.
struct Packet {
    origin: [Singles; 3],
    dir: [Singles; 3],
    inverse: [Singles; 3],
    /// Lengths of the direction here for each length of the direction in the world.
    rate: Column,
    /// The parameter at which a ray arrives, and how much later than computed its end may be.
    arrival: Column,
    slack: Column,
    /// Beyond this parameter a ray asks for nothing more; negative for a lane that is done or not in use.
    limit: Singles,
    beam: Beam,
}

/// What the rays of a packet search for.
trait Searches<S: Simd> {
    /// Tries the primitives of a leaf with the rays of the lanes `met`, and may lower their limits. Must be `#[inline(always)]`.
    fn leaf(&mut self, simd: S, packet: &mut Packet, met: u64, leaf: Content);

    /// How far along the axis of the beam any ray still searches.
    fn end(&self, packet: &Packet) -> f32;
}

impl Packet {
    /// The packet of rays that share the point `point`, from where `toward` times their directions lead; `None` if they had better
    /// be traced one by one. They end at `end`.
    #[inline(always)]
    fn new(tree: &Tree, rays: &RayLanes, point: DVec3, toward: f64, end: f64) -> Option<Self> {
        if rays.used.count_ones() < FEWEST {
            return None;
        }
        let beam = Beam::around(tree.frame.point(point), rays, toward)?;
        if beam.spread() > WIDEST {
            return None;
        }
        let (zero, none) = ([[0.0; LANES]; 3], [0.0; LANES]);
        let mut packet = Self {
            origin: zero,
            dir: zero,
            inverse: zero,
            rate: none,
            arrival: none,
            slack: none,
            limit: [ASIDE; LANES],
            beam,
        };
        let mut distances = [0.0; LANES];
        for k in 0..LANES {
            let (ray, squared) = tree.frame.beside(rays.origin.get(k), rays.dir.get(k));
            packet.set(k, &ray);
            distances[k] = squared;
        }
        // Not within, rather than beyond: NaN is neither.
        let not_within = |squared| rays.used & !within(&distances, squared);
        if not_within(FAR_SQUARED) != 0 {
            return None;
        }
        let (far, mut met) = (not_within(NEAR_SQUARED), rays.used);
        if far != 0 {
            met &= packet.bring(tree, rays, far);
        }
        for k in 0..LANES {
            let limit = packet.end_above(k, end);
            let is_open = (met >> k & 1 != 0) & (limit >= 0.0);
            packet.limit[k] = if is_open { limit } else { ASIDE };
        }
        Some(packet)
    }

    /// Replaces the ray of a lane that starts in the frame.
    #[inline(always)]
    fn set(&mut self, k: usize, ray: &TreeRay) {
        let inverse = ray.inverse();
        for axis in 0..3 {
            self.origin[axis][k] = ray.origin[axis];
            self.dir[axis][k] = ray.dir[axis];
            self.inverse[axis][k] = inverse[axis];
        }
        self.rate[k] = ray.rate;
    }

    /// Brings the rays of the lanes `far` to the tree, and returns all lanes but those that pass it by.
    #[inline(always)]
    fn bring(&mut self, tree: &Tree, rays: &RayLanes, far: u64) -> u64 {
        let mut passes = [0_u64; LANES];
        for k in 0..LANES {
            let is_far = far >> k & 1 != 0;
            let (ray, arrives) = tree.frame.from_afar(rays.origin.get(k), rays.dir.get(k));
            for axis in 0..3 {
                let x = self.origin[axis][k];
                self.origin[axis][k] = if is_far { ray.origin[axis] } else { x };
            }
            self.arrival[k] = if is_far { ray.arrival } else { 0.0 };
            self.slack[k] = if is_far { ray.slack } else { 0.0 };
            passes[k] = u64::from(is_far & !arrives);
        }
        !(0..LANES).fold(0, |all, k| all | passes[k] << k)
    }

    /// The world's parameter `t` of a lane here, as [`TreeRay::end_above`] but without a branch.
    #[inline(always)]
    fn end_above(&self, k: usize, t: f64) -> f32 {
        limit_above(t * self.rate[k] - self.arrival[k] + self.slack[k])
    }

    /// The ray of a lane in the tree's frame.
    #[inline(always)]
    fn ray(&self, k: usize) -> TreeRay {
        let lane = |columns: &[Singles; 3]| columns.each_ref().map(|column| column[k]);
        let (origin, dir) = (lane(&self.origin), lane(&self.dir));
        let (rate, arrival, slack) = (self.rate[k], self.arrival[k], self.slack[k]);
        TreeRay { origin, dir, rate, arrival, slack }
    }

    /// Which of the rays may meet the box of `node` in `slot`; the same arithmetic as a single ray's.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, node: &Node, slot: usize) -> u64 {
        let mut met = 0;
        for start in (0..LANES).step_by(GROUP) {
            #[cfg(feature = "leaf-study")]
            super::study::count_eight();
            let group = |column: &Singles| load(simd, column, start);
            let (mut enter, mut leave) = (simd.splat(0.0), group(&self.limit));
            for axis in 0..3 {
                let inverse = group(&self.inverse[axis]);
                let offset = simd.mul(group(&self.origin[axis]), inverse);
                let low = simd.mul_sub(simd.splat(node.planes[axis][slot]), inverse, offset);
                let high = simd.mul_sub(simd.splat(node.planes[3 + axis][slot]), inverse, offset);
                enter = simd.max(enter, simd.min(low, high));
                leave = simd.min(leave, simd.max(low, high));
            }
            met |= u64::from(simd.le(enter, leave)) << start;
        }
        met
    }

    /// Whether any ray still searches.
    fn is_open(&self) -> bool {
        self.limit.iter().any(|limit| *limit >= 0.0)
    }

    /// Shows `searches` the leaves that a ray of the packet may meet.
    #[inline(always)]
    fn walk<S: Simd>(&mut self, simd: S, tree: &Tree, searches: &mut impl Searches<S>) {
        let mut stack = [Visit { enter: 0.0, child: Child::NONE, node: 0, slot: 0 }; STACK];
        let mut len = 0;
        let mut limit = searches.end(self);
        let mut visit = match tree.root.content() {
            Content::Node(node) => {
                Visit { enter: 0.0, child: tree.root, node: node as u32, slot: 0 }
            }
            content => {
                // A tree of one leaf has no box to be tested.
                let open = (0..LANES).filter(|k| self.limit[*k] >= 0.0);
                let open = open.fold(0, |open, k| open | 1 << k);
                searches.leaf(simd, self, open, content);
                return;
            }
        };
        loop {
            if let Content::Node(k) = visit.child.content() {
                #[cfg(feature = "leaf-study")]
                super::study::count_beam();
                let (mut met, enter) = self.beam.test(simd, &tree.nodes[k], limit);
                let enter = simd.store(enter).0;
                let base = len;
                while met != 0 {
                    let slot = (met.trailing_zeros() & 7) as usize;
                    met &= met - 1;
                    let child = tree.nodes[k].children[slot];
                    let next =
                        Visit { enter: enter[slot], child, node: k as u32, slot: slot as u32 };
                    // Nearer children on top.
                    let mut place = len;
                    while place > base && stack[place - 1].enter < next.enter {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = next;
                    len += 1;
                }
            } else {
                let node = &tree.nodes[visit.node as usize];
                let met = self.meet(simd, node, visit.slot as usize);
                if met != 0 {
                    searches.leaf(simd, self, met, visit.child.content());
                    limit = searches.end(self);
                }
            }
            loop {
                let Some(last) = len.checked_sub(1) else { return };
                len = last;
                if stack[last].enter <= limit {
                    visit = stack[last];
                    break;
                }
            }
        }
    }
}

/// Whether primitives may be tried in lanes; the naive ones of the study have none.
#[inline(always)]
fn has_lanes() -> bool {
    #[cfg(feature = "leaf-study")]
    if super::study::is_naive() {
        return false;
    }
    true
}

/// Eight lanes of a column.
#[inline(always)]
fn load<S: Simd>(simd: S, column: &Singles, start: usize) -> S::F {
    match column[start..].first_chunk() {
        Some(group) => simd.load(group),
        None => simd.splat(ASIDE),
    }
}

/// The lanes in which a number is not above `limit`.
#[inline(always)]
fn within(column: &Column, limit: f64) -> u64 {
    (0..LANES).fold(0, |all, k| all | u64::from(column[k] <= limit) << k)
}

/// A limit not below `x`, or negative like it, without a branch.
#[inline(always)]
fn limit_above(x: f64) -> f32 {
    (x as f32) * (1.0 + 2.0 * f32::EPSILON) + f32::MIN_POSITIVE
}

/// The search for the nearest hits of rays from one origin in free space.
pub(super) struct NearestPacket<'a> {
    pub(super) accel: &'a Accel,
    pub(super) rays: &'a RayLanes<'a>,
    pub(super) hits: &'a mut HitLanes,
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
            let (ray, searches) = (packet.ray(k), packet.limit[k] >= 0.0);
            let along = limit_above(f64::from(packet.beam.along(ray.dir)));
            let start = packet.beam.depth(ray.origin) + START_SLACK;
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
    /// A certain hit of each lane, that has not been decided in double precision because it may never matter: its place, and what its
    /// parameter is not less than.
    pending: [u32; LANES],
    from: Singles,
}

impl Nearest<'_> {
    /// Tries the primitive in `place` with the rays of the lanes `met`.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64) {
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
        let [first, second] = &self.crossed;
        let hits = &mut *self.hits;
        for k in range.clone() {
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

    /// Takes the candidates of a leaf for the ray of one lane.
    ///
    /// A pending hit loses to one that ends before it starts; where intervals overlap, both are decided.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        k: usize,
        first: u32,
        candidates: &Candidates,
    ) {
        let Candidates { mut maybe, certain, from, to } = *candidates;
        while maybe != 0 {
            let lane = maybe.trailing_zeros() & 7;
            maybe &= maybe - 1;
            let place = first + lane;
            if certain & 1 << lane == 0 {
                self.test(simd, packet, place as usize, 1 << k);
                continue;
            }
            let (from, to) = (from.0[lane as usize], to.0[lane as usize]);
            if from > packet.limit[k] {
                continue;
            }
            if to >= self.from[k] && self.pending[k] != u32::MAX {
                self.test(simd, packet, self.pending[k] as usize, 1 << k);
            }
            (self.pending[k], self.from[k]) = (place, from);
            packet.limit[k] = packet.limit[k].min(to);
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
            self.test(simd, packet, place as usize, same);
        }
    }
}

impl<S: Simd> Searches<S> for Nearest<'_> {
    #[inline(always)]
    fn leaf(&mut self, simd: S, packet: &mut Packet, met: u64, leaf: Content) {
        match leaf {
            Content::Spheres(block) => {
                let block = &self.tree.spheres[block];
                for k in lanes(met) {
                    let ray = LeafRay::new(&packet.ray(k), f64::INFINITY);
                    let candidates = block.sort_out(simd, &ray, packet.limit[k]);
                    self.take(simd, packet, k, block.first, &candidates);
                }
            }
            Content::Triangles(block) => {
                let block = &self.tree.triangles[block];
                for k in lanes(met) {
                    let ray = LeafRay::new(&packet.ray(k), f64::INFINITY);
                    let candidates = block.sort_out(simd, &ray, packet.limit[k]);
                    self.take(simd, packet, k, block.first, &candidates);
                }
            }
            Content::One(place) => self.test(simd, packet, place, met),
            Content::Node(_) => {}
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

/// The search for what blocks rays that end, at `t = 1`, in one point.
pub(super) struct BlockedPacket<'a, B, V> {
    pub(super) accel: &'a Accel,
    pub(super) rays: &'a RayLanes<'a>,
    pub(super) target: DVec3,
    pub(super) opaque: &'a B,
    pub(super) visit: &'a mut V,
}

impl<B, V> Kernel for BlockedPacket<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(usize, u32, Crossing) -> ControlFlow<()>,
{
    /// The lanes that are blocked; `None` if the rays were not traced and each must be by itself.
    type Output = Option<u64>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<u64> {
        let Self { accel, rays, target, opaque, visit } = self;
        let tree = accel.tree.as_ref()?;
        let mut packet = Packet::new(tree, rays, target, -1.0, 1.0)?;
        // Seen from the light, the furthest start of a ray, rounded up with room for the error of either end.
        let mut end = 0.0_f64;
        for k in lanes(rays.used) {
            end = end.max(-packet.beam.along_axis(tree.frame.vector(rays.dir.get(k))));
        }
        let end = above(end * (1.0 + 1e-12) - packet.beam.lead).next_up() + START_SLACK;
        let crossed = [[f64::NAN; LANES]; 2];
        let mut blocks = Blocks { accel, tree, rays, opaque, visit, crossed, end };
        for place in accel.outside() {
            blocks.test(simd, &mut packet, place, rays.used);
        }
        packet.walk(simd, tree, &mut blocks);
        let blocked = |k: usize| u64::from(packet.limit[k] == BLOCKED) << k;
        Some(rays.used & (0..LANES).fold(0, |all, k| all | blocked(k)))
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
    end: f32,
}

/// A visit that knows its lane.
pub(super) struct VisitOf<'v, V> {
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
    /// Tries the primitive in `place` with the rays of the lanes `met`.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64) {
        let (number, shape) = (self.accel.numbers[place], &self.accel.shapes[place]);
        let own = self.rays.leaving(number);
        let (range, others) = (hull(met & !own), met & !own);
        if others.count_ones() < FEWEST_LANES
            || !has_lanes()
            || !simd.cross_lanes(shape, self.rays, range.clone(), &mut self.crossed)
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

    /// Tries the primitive in `place` with the rays of the lanes `met` one by one.
    #[inline(always)]
    fn test_each<S: Simd>(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64) {
        for k in lanes(met) {
            let ray = self.rays.ray(k);
            let visit = VisitOf { visit: self.visit, lane: k };
            let (accel, opaque) = (self.accel, self.opaque);
            let mut test = crossed::Test { accel, ray: &ray, end: 1.0, opaque, visit };
            if test.test(simd, place) {
                packet.limit[k] = BLOCKED;
            }
        }
    }

    /// Takes the candidates of a leaf for the ray of one lane: a certain hit of an opaque one blocks it without further ado.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        k: usize,
        first: u32,
        candidates: &Candidates,
    ) {
        let Candidates { mut maybe, certain, .. } = *candidates;
        let left = self.rays.from.map_or(u32::MAX, |from| from.hits.primitive[k]);
        while maybe != 0 && packet.limit[k] >= 0.0 {
            let lane = maybe.trailing_zeros() & 7;
            maybe &= maybe - 1;
            let place = (first + lane) as usize;
            let number = self.accel.numbers[place];
            if certain & 1 << lane != 0 && number != left && (self.opaque)(number) {
                packet.limit[k] = BLOCKED;
            } else {
                self.test_each(simd, packet, place, 1 << k);
            }
        }
    }
}

impl<S: Simd, B, V> Searches<S> for Blocks<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(usize, u32, Crossing) -> ControlFlow<()>,
{
    #[inline(always)]
    fn leaf(&mut self, simd: S, packet: &mut Packet, met: u64, leaf: Content) {
        match leaf {
            Content::Spheres(block) => {
                let block = &self.tree.spheres[block];
                for k in lanes(met) {
                    let ray = LeafRay::new(&packet.ray(k), 1.0);
                    let candidates = block.sort_out(simd, &ray, packet.limit[k]);
                    self.take(simd, packet, k, block.first, &candidates);
                }
            }
            Content::Triangles(block) => {
                let block = &self.tree.triangles[block];
                for k in lanes(met) {
                    let ray = LeafRay::new(&packet.ray(k), 1.0);
                    let candidates = block.sort_out(simd, &ray, packet.limit[k]);
                    self.take(simd, packet, k, block.first, &candidates);
                }
            }
            Content::One(place) => self.test(simd, packet, place, met),
            Content::Node(_) => {}
        }
    }

    #[inline(always)]
    fn end(&self, packet: &Packet) -> f32 {
        if packet.is_open() { self.end } else { f32::NEG_INFINITY }
    }
}
