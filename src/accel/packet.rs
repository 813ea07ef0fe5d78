//! Up to 64 rays that share a point, traced together.
//!
//! The nodes are tested against their [`Beam`], once for all; a leaf's box against the rays, eight at a time; and those that may
//! meet it try its primitives each by itself, as a single ray does. So the answers are, to the bit, those of single rays.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{
    Accel,
    beam::Beam,
    crossed,
    frame::{Entry, TreeRay, above},
    leaf::LeafRay,
    node::{Child, Content, Node},
    query::{Best, Search},
    simd::{Kernel, Simd},
    target::Left,
    tree::Tree,
    walk::{MAX_DEPTH, Visitor},
};
use crate::geometry::{Crossing, Hit, Ray};

/// The most rays of a packet.
pub(super) const RAYS: usize = 64;
const LANES: usize = 8;

/// Fewer rays than this are as fast one by one.
const FEWEST: usize = 8;

/// A wider beam, at distance 1 in units of half the scene, meets too much that no ray of it does.
const WIDEST: f32 = 0.25;

/// Room for the roundings of a ray's start and end along the beam's axis.
const START_SLACK: f64 = 1.0 / (1 << 20) as f64;

/// The stack of the walk: each node on the way down leaves at most seven of its children to be visited later.
const STACK: usize = MAX_DEPTH * 7 + 1;

/// A child to be visited: where the beam enters it, what it is, and its box (node and slot).
#[derive(Clone, Copy)]
struct Visit {
    enter: f32,
    child: Child,
    node: u32,
    slot: u32,
}

/// Eight rays side by side, for the test of a box.
#[derive(Clone, Copy)]
struct Eight {
    inverse: [[f32; LANES]; 3],
    offset: [[f32; LANES]; 3],
    /// Beyond this parameter a ray asks for nothing more; negative for a ray that is done or not there.
    limit: [f32; LANES],
}

impl Eight {
    const NONE: Self =
        Self { inverse: [[1.0; LANES]; 3], offset: [[0.0; LANES]; 3], limit: [-1.0; LANES] };

    fn set(&mut self, lane: usize, ray: &TreeRay, limit: f32) {
        let inverse = ray.inverse();
        for (axis, inverse) in inverse.into_iter().enumerate() {
            self.inverse[axis][lane] = inverse;
            self.offset[axis][lane] = ray.origin[axis] * inverse;
        }
        self.limit[lane] = limit;
    }

    /// Which of the rays may meet the box of `node` in `slot`; the same arithmetic as a single ray's.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, node: &Node, slot: usize) -> u32 {
        let (mut enter, mut leave) = (simd.splat(0.0), simd.load(&self.limit));
        for axis in 0..3 {
            let (inverse, offset) = (simd.load(&self.inverse[axis]), simd.load(&self.offset[axis]));
            let low = simd.mul_sub(simd.splat(node.planes[axis][slot]), inverse, offset);
            let high = simd.mul_sub(simd.splat(node.planes[3 + axis][slot]), inverse, offset);
            enter = simd.max(enter, simd.min(low, high));
            leave = simd.min(leave, simd.max(low, high));
        }
        simd.le(enter, leave)
    }
}

/// What the rays of a packet search for.
trait Searches<S: Simd> {
    /// Tries the primitives of a leaf with one of the rays, and returns the ray's new limit. Must be `#[inline(always)]`.
    fn leaf(&mut self, simd: S, ray: usize, leaf: Content) -> f32;

    /// How far along the axis of the beam any ray still searches.
    fn end(&self) -> f32;
}

/// The rays of a packet and the beam about them.
struct Packet {
    eights: [Eight; RAYS / LANES],
    count: usize,
    beam: Beam,
}

impl Packet {
    /// The packet of `rays`, which share the point `point`; `None` if they had better be traced one by one.
    fn new(
        tree: &Tree,
        rays: &[TreeRay],
        limits: impl Iterator<Item = f32>,
        point: DVec3,
        dirs: impl Iterator<Item = DVec3> + Clone,
    ) -> Option<Self> {
        let beam = Beam::around(tree.frame.point(point), dirs)?;
        if beam.spread() > WIDEST {
            return None;
        }
        let mut eights = [Eight::NONE; RAYS / LANES];
        for ((ray, limit), k) in rays.iter().zip(limits).zip(0..) {
            eights[k / LANES].set(k % LANES, ray, limit);
        }
        Some(Self { eights, count: rays.len(), beam })
    }

    /// Shows `searches` the leaves that a ray of the packet may meet.
    #[inline(always)]
    fn walk<S: Simd>(&mut self, simd: S, tree: &Tree, searches: &mut impl Searches<S>) {
        let mut stack = [Visit { enter: 0.0, child: Child::NONE, node: 0, slot: 0 }; STACK];
        let mut len = 0;
        let mut limit = searches.end();
        let mut visit = match tree.root.content() {
            Content::Node(node) => {
                Visit { enter: 0.0, child: tree.root, node: node as u32, slot: 0 }
            }
            content => {
                // A tree of one leaf has no box to be tested.
                for ray in 0..self.count {
                    if self.eights[ray / LANES].limit[ray % LANES] >= 0.0 {
                        searches.leaf(simd, ray, content);
                    }
                }
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
                let content = visit.child.content();
                let mut changed = false;
                for k in 0..self.count.div_ceil(LANES) {
                    #[cfg(feature = "leaf-study")]
                    super::study::count_eight();
                    let mut met = self.eights[k].meet(simd, node, visit.slot as usize);
                    changed |= met != 0;
                    while met != 0 {
                        let lane = (met.trailing_zeros() & 7) as usize;
                        met &= met - 1;
                        let ray = k * LANES + lane;
                        self.eights[k].limit[lane] = searches.leaf(simd, ray, content);
                    }
                }
                if changed {
                    limit = searches.end();
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

/// The search for the nearest hits of rays from one origin.
pub(super) struct NearestPacket<'a> {
    pub(super) accel: &'a Accel,
    pub(super) rays: &'a [Ray],
    pub(super) hits: &'a mut [Option<Hit>],
}

impl Kernel for NearestPacket<'_> {
    type Output = bool;

    /// Returns whether the rays were traced; if not, each must be by itself.
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { accel, rays, hits } = self;
        let Some(tree) = accel.packet_tree(rays) else { return false };
        let (mut searches, mut tree_rays) = (Vec::with_capacity(RAYS), Vec::with_capacity(RAYS));
        for ray in rays {
            let (tree_ray, meets) = match tree.frame.enter(ray) {
                Entry::Ray(tree_ray) => (tree_ray, true),
                Entry::Miss => (TreeRay::NOWHERE, false),
                Entry::Extreme => return false,
            };
            let mut best = Best::before(f64::INFINITY);
            for place in accel.outside() {
                best.test(simd, accel, ray, place);
            }
            let mut search = Search::new(accel, tree, ray, tree_ray, best);
            if !meets {
                search.limit = -1.0;
            }
            searches.push(search);
            tree_rays.push(tree_ray);
        }
        let limits = searches.iter().map(|search| search.limit);
        let dirs = rays.iter().map(|ray| ray.dir);
        let Some(mut packet) = Packet::new(tree, &tree_rays, limits, rays[0].origin, dirs) else {
            return false;
        };
        let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let (mut rates, mut starts, mut ends) =
            ([0.0; RAYS], [0.0; RAYS], [f32::NEG_INFINITY; RAYS]);
        for (k, ray) in tree_rays.iter().enumerate() {
            rates[k] = above(packet.beam.along(vector(ray.dir))).next_up();
            starts[k] = above(packet.beam.depth(vector(ray.origin)) + START_SLACK);
            ends[k] = end_of(searches[k].limit, rates[k], starts[k]);
        }
        let mut nearest = Nearest { searches: &mut searches, rates, starts, ends };
        packet.walk(simd, tree, &mut nearest);
        for (hit, search) in hits.iter_mut().zip(searches) {
            *hit = search.finish(simd).hit();
        }
        true
    }
}

/// How far along the beam's axis a ray searches.
#[inline(always)]
fn end_of(limit: f32, rate: f32, start: f32) -> f32 {
    if limit >= 0.0 { limit * rate + start } else { f32::NEG_INFINITY }
}

struct Nearest<'s, 'a> {
    searches: &'s mut [Search<'a>],
    /// How far each ray goes along the beam's axis in one unit of its parameter, rounded up.
    rates: [f32; RAYS],
    /// Where along it each ray starts, rounded up.
    starts: [f32; RAYS],
    /// How far along the axis each still searches.
    ends: [f32; RAYS],
}

impl<S: Simd> Searches<S> for Nearest<'_, '_> {
    #[inline(always)]
    fn leaf(&mut self, simd: S, ray: usize, leaf: Content) -> f32 {
        let search = &mut self.searches[ray];
        search.leaf(simd, leaf);
        self.ends[ray] = end_of(search.limit, self.rates[ray], self.starts[ray]);
        search.limit
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        let mut end = self.ends[0];
        for other in &self.ends[1..] {
            end = if *other > end { *other } else { end };
        }
        end
    }
}

/// The search for what blocks rays that end, at `t = 1`, in one point.
pub(super) struct BlockedPacket<'a, B, V> {
    pub(super) accel: &'a Accel,
    pub(super) rays: &'a [Ray],
    pub(super) target: DVec3,
    pub(super) opaque: &'a B,
    pub(super) visit: &'a mut V,
    pub(super) blocked: &'a mut [bool],
}

impl<B, V> Kernel for BlockedPacket<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(u32, u32, Crossing) -> ControlFlow<()>,
{
    type Output = bool;

    /// Returns whether the rays were traced; if not, each must be by itself.
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { accel, rays, target, opaque, visit, blocked } = self;
        let Some(tree) = accel.packet_tree(rays) else { return false };
        let mut tree_rays = Vec::with_capacity(RAYS);
        for ray in rays {
            let Entry::Ray(tree_ray) = tree.frame.enter(ray) else { return false };
            tree_rays.push(tree_ray);
        }
        let limits = tree_rays.iter().map(|ray| ray.end_above(1.0));
        let dirs = rays.iter().map(|ray| -ray.dir);
        let Some(mut packet) = Packet::new(tree, &tree_rays, limits, target, dirs.clone()) else {
            return false;
        };
        // Seen from the light, the furthest start of a ray, rounded up with room for the error of either end.
        let length = |dir: DVec3| packet.beam.along(tree.frame.vector(dir));
        let furthest = dirs.map(length).fold(0.0, f64::max);
        let end = above(furthest * (1.0 + 1e-12) - packet.beam.lead + 1e-6).next_up();
        let mut blocks = Blocks {
            accel,
            tree,
            rays,
            tree_rays: &tree_rays,
            opaque,
            visit,
            blocked,
            open: rays.len(),
            end,
        };
        for k in 0..rays.len() {
            for place in accel.outside() {
                if blocks.open_at(k) && blocks.test(k).test(simd, place) {
                    blocks.close(k);
                    packet.eights[k / LANES].limit[k % LANES] = -1.0;
                }
            }
        }
        packet.walk(simd, tree, &mut blocks);
        true
    }
}

struct Blocks<'a, B, V> {
    accel: &'a Accel,
    tree: &'a Tree,
    rays: &'a [Ray],
    tree_rays: &'a [TreeRay],
    opaque: &'a B,
    visit: &'a mut V,
    blocked: &'a mut [bool],
    /// How many rays are not blocked.
    open: usize,
    end: f32,
}

/// A visit that knows its ray.
pub(super) struct VisitOf<'v, V> {
    visit: &'v mut V,
    ray: u32,
}

impl<V: FnMut(u32, u32, Crossing) -> ControlFlow<()>> crossed::Visit for VisitOf<'_, V> {
    #[inline(always)]
    fn visit(&mut self, primitive: u32, crossing: Crossing) -> ControlFlow<()> {
        (self.visit)(self.ray, primitive, crossing)
    }
}

impl<'a, B, V> Blocks<'a, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(u32, u32, Crossing) -> ControlFlow<()>,
{
    #[inline(always)]
    fn test(&mut self, ray: usize) -> crossed::Test<'a, &'a B, VisitOf<'_, V>> {
        let visit = VisitOf { visit: self.visit, ray: ray as u32 };
        crossed::Test {
            accel: self.accel,
            ray: &self.rays[ray],
            end: 1.0,
            opaque: self.opaque,
            visit,
        }
    }

    fn open_at(&self, ray: usize) -> bool {
        !self.blocked[ray]
    }

    #[inline(always)]
    fn close(&mut self, ray: usize) {
        self.blocked[ray] = true;
        self.open -= 1;
    }
}

impl<S: Simd, B, V> Searches<S> for Blocks<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: FnMut(u32, u32, Crossing) -> ControlFlow<()>,
{
    #[inline(always)]
    fn leaf(&mut self, simd: S, ray: usize, leaf: Content) -> f32 {
        let tree_ray = &self.tree_rays[ray];
        let (leaf_ray, limit) = (LeafRay::new(tree_ray, 1.0), tree_ray.end_above(1.0));
        let (tree, left) = (self.tree, Left::of(self.accel, &self.rays[ray]));
        let test = self.test(ray);
        let mut search = crossed::Search { test, tree, leaf_ray, left, limit, stopped: false };
        if search.leaf(simd, leaf) {
            self.close(ray);
            return -1.0;
        }
        limit
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        if self.open == 0 { f32::NEG_INFINITY } else { self.end }
    }
}

impl Accel {
    /// The tree, if as many rays as these are worth a packet.
    #[inline(always)]
    fn packet_tree(&self, rays: &[Ray]) -> Option<&Tree> {
        self.tree.as_ref().filter(|_| (FEWEST..=RAYS).contains(&rays.len()))
    }
}
