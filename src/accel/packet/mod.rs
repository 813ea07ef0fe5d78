//! Up to 64 rays that share a point, traced together.
//!
//! The nodes are tested against their [`Beam`], once for all. Of a leaf of triangles, which are [seen](eye) from the
//! common point, each is tested against the rays, eight at a time; of other leaves the box is. What is alone in a leaf,
//! and each of the few spheres of a leaf that the beam may meet, is then tried by all of these rays in a loop over the
//! lanes, which vectors can do; many spheres are by each ray that may meet them. What decides is the shapes' own
//! arithmetic, so the answers are, to the bit, those of single rays; that a lane tries what it need not have tried makes
//! no difference.

mod blocked;
mod boxes;
mod eye;
mod nearest;
mod walk;

use glam::DVec3;

#[cfg(feature = "leaf-study")]
use super::frame::TreeRay;
use super::{
    beam::{Axis, Beam, Singles},
    leaf::LeafRay,
    simd::Simd,
    tree::Tree,
};
use crate::geometry::lanes::{Column, LANES, RayLanes};
pub(super) use blocked::BlockedPacket;
use boxes::Prepared;
pub(super) use nearest::NearestPacket;

/// Rays that are tested by one instruction.
const GROUP: usize = 8;

/// Fewer rays than this are as fast one by one.
const FEWEST: u32 = 8;

/// Fewer lanes than this are as fast one by one where a primitive is tried.
const FEWEST_LANES: u32 = 3;

/// A wider beam, at distance 1 in units of half the scene, enters too many nodes that none of its rays would.
const WIDEST: f32 = 0.25;

/// The limit of a lane that is not in use, or whose ray passes the tree by.
const ASIDE: f32 = -1.0;

/// The limit of a lane whose ray is blocked.
const BLOCKED: f32 = -2.0;

/// How far corners may be from where a ray begins, which is at most 4 to either side of the tree: twice as far as for a
/// single ray, and so are the errors.
const REACH: f32 = 8.0;

/// The rays of a packet in the tree's frame, as lines along their axis, and the beam about them.
struct Packet {
    axis: Axis,
    beam: Beam,
    /// Where the rays begin, and their directions, which go by 1 along the axis.
    origin: [Singles; 3],
    dir: [Singles; 3],
    /// How far the rays go along the axis in one unit of their parameter.
    rate: Column,
    /// Beyond this depth a ray asks for nothing more; negative for a lane that is done or not in use.
    limit: Singles,
    /// The depth of the end, rounded down.
    end: Singles,
}

/// Why rays are not traced together.
enum Apart {
    /// They had better be traced one by one.
    Single,
    /// Their beam is too wide; half of it would be that of these lanes.
    Wide(u64),
}

/// What the rays of a packet search for.
trait Searches<S: Simd> {
    /// Tries the primitive in `place` with the rays of the lanes `met`; this and the next may lower their limits. Must
    /// be `#[inline(always)]`.
    fn test(&mut self, simd: S, packet: &mut Packet, place: usize, met: u64);

    /// Takes the primitive of a leaf in `place` for the ray of lane `k`, which may meet it, or certainly does, for the
    /// first time between two depths. Must be `#[inline(always)]`.
    fn take(
        &mut self,
        simd: S,
        packet: &mut Packet,
        k: usize,
        place: u32,
        certain: Option<[f32; 2]>,
    );
}

impl Packet {
    /// The packet of rays that share the point `point`, from where `toward` times their directions lead, unless their
    /// beam is wider than `widest` or they go further than `furthest` in one unit of their parameter. They end where
    /// that is `end`, give or take `slack` in depth.
    #[inline(always)]
    fn new(
        tree: &Tree,
        rays: &RayLanes,
        point: DVec3,
        toward: f64,
        (end, slack): (f64, f32),
        furthest: f64,
        widest: f32,
    ) -> Result<Self, Apart> {
        if rays.used.count_ones() < FEWEST {
            return Err(Apart::Single);
        }
        let first = rays.dir.get(rays.used.trailing_zeros() as usize % LANES) * toward;
        let axis = Axis::along(tree.frame.point(point), first).ok_or(Apart::Single)?;
        let [along, right, up] = axis.order.map(|axis| rays.dir.axis(axis));
        let (zero, none) = ([[0.0; LANES]; 2], [0.0; LANES]);
        let (mut begin, mut slopes, mut rate) = (zero, zero, [0.0; LANES]);
        let (mut limit, mut ends) = ([ASIDE; LANES], none);
        let mut strays = [0_u64; LANES];
        for k in 0..LANES {
            let is_used = rays.used >> k & 1 != 0;
            let dir = [along[k] * toward, right[k] * toward, up[k] * toward];
            let line = axis.line(&tree.frame, dir);
            strays[k] = u64::from(is_used & !(line.follows & (line.rate <= furthest)));
            let depth = line.rate * end - axis.lead;
            let last = limit_above(depth) + slack;
            let is_open = is_used & line.arrives & (last >= 0.0);
            for side in 0..2 {
                begin[side][k] = if is_open { line.begin[side] as f32 } else { 0.0 };
                slopes[side][k] = if is_open { line.slopes[side] as f32 } else { 0.0 };
            }
            rate[k] = line.rate;
            limit[k] = if is_open { last } else { ASIDE };
            ends[k] = limit_below(depth) - slack;
        }
        if strays.iter().fold(0, |all, stray| all | stray) != 0 {
            return Err(Apart::Single);
        }
        let beam = Beam::around(axis, &begin, &slopes, open(&limit));
        if beam.spread() > widest {
            return Err(Apart::Wide(beam.half(&slopes) & rays.used));
        }
        let (mut origin, mut dir) = ([[axis.start; LANES]; 3], [[axis.forward as f32; LANES]; 3]);
        for side in 0..2 {
            origin[axis.order[1 + side]] = begin[side];
            dir[axis.order[1 + side]] = slopes[side];
        }
        Ok(Self { axis, beam, origin, dir, rate, limit, end: ends })
    }

    /// The depth of the world's parameter `t` of a lane, rounded up, without a branch.
    #[inline(always)]
    fn end_above(&self, k: usize, t: f64) -> f32 {
        limit_above(t * self.rate[k] - self.axis.lead)
    }

    /// The ray of a lane for the tests of leaves, whose parameter is its depth.
    #[inline(always)]
    fn leaf_ray(&self, prepared: &Prepared, k: usize) -> LeafRay {
        let [origin, dir] = [&self.origin, &self.dir].map(|v| v.each_ref().map(|column| column[k]));
        LeafRay {
            origin,
            dir,
            inverse: prepared.inverse_square[k],
            length: prepared.length[k],
            end: self.end[k],
            reach: REACH,
            #[cfg(feature = "leaf-study")]
            ray: TreeRay { origin, dir, rate: self.rate[k], arrival: self.axis.lead, slack: 0.0 },
        }
    }

    /// The slopes of the rays along the two other axes.
    #[inline(always)]
    fn slopes(&self) -> [&Singles; 2] {
        let [_, right, up] = self.axis.order;
        [&self.dir[right], &self.dir[up]]
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

/// The lanes that still search.
#[inline(always)]
fn open(limit: &Singles) -> u64 {
    (0..LANES).fold(0, |all, k| all | u64::from(limit[k] >= 0.0) << k)
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
