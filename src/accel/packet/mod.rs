//! Up to 64 rays that share a point, traced together.
//!
//! The nodes are tested against their [`Beam`], once for all; a leaf's box against the rays, eight at a time. A leaf of one sphere
//! or flat shape is then tried by all of them in a loop over the lanes, which vectors can do; the primitives of other leaves by
//! each ray that may meet them. What decides is the shapes' own arithmetic, so the answers are, to the bit, those of single
//! rays; that a lane tries what it need not have tried makes no difference.

mod blocked;
mod nearest;

use glam::DVec3;

use super::{
    beam::Beam,
    frame::{ARRIVAL_SLACK, FAR_SQUARED, NEAR_SQUARED, TreeRay},
    leaf::{Candidates, LeafRay},
    node::{Child, Content, Node},
    simd::Simd,
    tree::Tree,
    walk::MAX_DEPTH,
};
use crate::geometry::lanes::{Column, LANES, RayLanes, lanes};
pub(super) use blocked::BlockedPacket;
pub(super) use nearest::NearestPacket;

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
    /// The parameter at which a ray from afar arrives, less the room for its error; 0 for others.
    late: Column,
    /// Beyond this parameter a ray asks for nothing more; negative for a lane that is done or not in use.
    limit: Singles,
    /// The rest of what the tests of leaves need: one over the squared length of the direction, its length, and the end rounded down.
    inverse_square: Singles,
    length: Singles,
    end: Singles,
    beam: Beam,
}

/// What the rays of a packet search for.
trait Searches<S: Simd> {
    /// Tries the primitive in `place` with the rays of the lanes `met`; this and the next may lower their limits. Must be
    /// `#[inline(always)]`.
    fn test(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64);

    /// Takes the candidates of a leaf, whose primitives start at `first`, for the ray of lane `k`. Must be `#[inline(always)]`.
    fn take(&mut self, simd: S, packet: &mut Packet, k: usize, first: u32, candidates: &Candidates);

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
            rate: [0.0; LANES],
            late: [0.0; LANES],
            limit: [ASIDE; LANES],
            inverse_square: none,
            length: none,
            end: none,
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
            packet.end[k] = packet.end_below(k, end);
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
        let square = ray.square();
        (self.inverse_square[k], self.length[k]) = (1.0 / square, square.sqrt());
        self.rate[k] = ray.rate;
    }

    /// Brings the rays of the lanes `far` to the tree, and returns all lanes but those that pass it by.
    #[inline(always)]
    fn bring(&mut self, tree: &Tree, rays: &RayLanes, far: u64) -> u64 {
        let mut passes = [0_u64; LANES];
        for k in 0..LANES {
            let is_far = far >> k & 1 != 0;
            let (ray, arrives) = tree.frame.brought(rays.origin.get(k), rays.dir.get(k));
            for axis in 0..3 {
                let x = self.origin[axis][k];
                self.origin[axis][k] = if is_far { ray.origin[axis] } else { x };
            }
            self.late[k] = if is_far { ray.arrival - ray.slack } else { 0.0 };
            passes[k] = u64::from(is_far & !arrives);
        }
        !(0..LANES).fold(0, |all, k| all | passes[k] << k)
    }

    /// The world's parameter `t` of a lane here, as [`TreeRay::end_above`] but without a branch.
    #[inline(always)]
    fn end_above(&self, k: usize, t: f64) -> f32 {
        limit_above(t * self.rate[k] - self.late[k])
    }

    /// The world's parameter `t` of a lane here, rounded down likewise and with room for the error of the arrival.
    #[inline(always)]
    fn end_below(&self, k: usize, t: f64) -> f32 {
        let late = self.late[k];
        let slack = if late == 0.0 { 0.0 } else { 2.0 * ARRIVAL_SLACK };
        limit_below(t * self.rate[k] - late - slack)
    }

    /// The ray of a lane for the tests of leaves.
    #[inline(always)]
    fn leaf_ray(&self, k: usize) -> LeafRay {
        let (origin, dir) = (self.point(k), self.direction(k));
        LeafRay {
            origin,
            dir,
            inverse: self.inverse_square[k],
            length: self.length[k],
            end: self.end[k],
            #[cfg(feature = "leaf-study")]
            ray: TreeRay { origin, dir, rate: self.rate[k], arrival: self.late[k], slack: 0.0 },
        }
    }

    /// Where the ray of a lane starts in the tree's frame, or arrives.
    #[inline(always)]
    fn point(&self, k: usize) -> [f32; 3] {
        self.origin.each_ref().map(|column| column[k])
    }

    /// Its direction there.
    #[inline(always)]
    fn direction(&self, k: usize) -> [f32; 3] {
        self.dir.each_ref().map(|column| column[k])
    }

    /// Has `searches` try the primitives of a leaf with the rays of the lanes `met`.
    #[inline(always)]
    fn leaf<S: Simd>(
        &mut self,
        simd: S,
        tree: &Tree,
        searches: &mut impl Searches<S>,
        met: u64,
        leaf: Content,
    ) {
        match leaf {
            Content::Spheres(run) => {
                for k in lanes(met) {
                    let (ray, limit) = (self.leaf_ray(k), self.limit[k]);
                    let candidates = tree.spheres.sort_out(simd, run, &ray, limit);
                    searches.take(simd, self, k, run.first, &candidates);
                }
            }
            Content::Triangles(run) => {
                for k in lanes(met) {
                    let (ray, limit) = (self.leaf_ray(k), self.limit[k]);
                    let candidates = tree.triangles.sort_out(simd, run, &ray, limit);
                    searches.take(simd, self, k, run.first, &candidates);
                }
            }
            Content::One(place) => searches.test(simd, self, place, met),
            Content::Node(_) => {}
        }
    }

    /// Which of the rays may meet the box of `node` in `slot`; the same arithmetic as a single ray's.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, node: &Node, slot: usize) -> u64 {
        let mut met = 0;
        for start in (0..LANES).step_by(GROUP) {
            #[cfg(feature = "leaf-study")]
            crate::accel::study::count_eight();
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
                self.leaf(simd, tree, searches, open, content);
                return;
            }
        };
        loop {
            if let Content::Node(k) = visit.child.content() {
                #[cfg(feature = "leaf-study")]
                crate::accel::study::count_beam();
                let (mut met, enter) = self.beam.test(simd, &tree.nodes[k], limit);
                let enter = simd.store(enter).0;
                let base = len;
                while met != 0 {
                    let slot = (met.trailing_zeros() & 7) as usize;
                    met &= met - 1;
                    let child = tree.nodes[k].children[slot];
                    tree.prefetch(simd, child);
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
                    self.leaf(simd, tree, searches, met, visit.child.content());
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
    if crate::accel::study::is_naive() {
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

/// A limit not above `x`, if that is positive, without a branch.
#[inline(always)]
fn limit_below(x: f64) -> f32 {
    (x as f32) * (1.0 - 2.0 * f32::EPSILON) - f32::MIN_POSITIVE
}
