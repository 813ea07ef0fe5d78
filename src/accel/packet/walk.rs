//! The way of a packet through the tree.

use super::{GROUP, Packet, Searches, boxes::Prepared, eye::Eye};
#[cfg(feature = "leaf-study")]
use crate::accel::study;
use crate::{
    accel::{
        leaf::Candidates,
        node::{Child, Content},
        simd::{Simd, bits},
        tree::Tree,
        walk::MAX_DEPTH,
    },
    geometry::lanes::{LANES, lanes},
};

/// Fewer rays than this are as fast one by one where the triangles of a leaf are tried.
const FEWEST_SEEING: u32 = 20;

/// So many rays that try all spheres of a leaf, one by one, take as long as one sphere that all rays try.
const RAYS_FOR_EACH: u32 = 12;

/// The stack of the walk: each node on the way down leaves at most seven of its children to be visited later.
const STACK: usize = MAX_DEPTH * 7 + 1;

/// A child to be visited: where the beam enters it, what it is, and its box (node and slot), if it has one.
#[derive(Clone, Copy)]
pub(super) struct Visit {
    pub(super) enter: f32,
    pub(super) child: Child,
    pub(super) node: u32,
    pub(super) slot: u32,
}

/// The node of what has no box: a tree of one leaf.
const NO_NODE: u32 = u32::MAX;

impl Packet {
    /// Shows `searches` the leaves that a ray of the packet may meet.
    #[inline(always)]
    pub(super) fn walk<S: Simd>(&mut self, simd: S, tree: &Tree, searches: &mut impl Searches<S>) {
        let mut stack = [Visit { enter: 0.0, child: Child::NONE, node: 0, slot: 0 }; STACK];
        let mut len = 0;
        let mut limit = self.deepest();
        // Many packets meet no leaf.
        let (is_eye, mut eye, mut prepared) = (Eye::is_for(tree, &self.axis), None, None);
        let mut visit = Visit { enter: 0.0, child: tree.root, node: NO_NODE, slot: 0 };
        loop {
            if let Content::Node(k) = visit.child.content() {
                #[cfg(feature = "leaf-study")]
                study::count_beam();
                let (met, enter) = self.beam.test(simd, &tree.nodes[k], limit);
                let enter = simd.store(enter).0;
                let base = len;
                for slot in bits(met) {
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
                let leaf = visit.child.content();
                let near = self.near(simd, tree, limit, leaf);
                if near != 0 {
                    let prepared = prepared.get_or_insert_with(|| self.prepared());
                    let met = self.meet(simd, tree, &visit, prepared);
                    match leaf {
                        Content::Triangles(run) if is_eye && met.count_ones() >= FEWEST_SEEING => {
                            let eye = eye.get_or_insert_with(|| Eye::of(self));
                            eye.leaf(simd, tree, self, searches, run, met);
                        }
                        _ => self.leaf(simd, tree, searches, (met, near), prepared, leaf),
                    }
                    if met != 0 {
                        limit = self.deepest();
                    }
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

    /// The spheres of a leaf that the beam may meet, as bits; all of anything else.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, tree: &Tree, limit: f32, leaf: Content) -> u32 {
        match leaf {
            Content::Spheres(run) => self.beam.spheres(simd, &tree.spheres, run, limit),
            _ => u32::MAX,
        }
    }

    /// Has `searches` try the primitives of a leaf with the rays of the lanes `met`; `near` tells which spheres of the
    /// leaf the beam may meet.
    #[inline(always)]
    fn leaf<S: Simd>(
        &mut self,
        simd: S,
        tree: &Tree,
        searches: &mut impl Searches<S>,
        (met, near): (u64, u32),
        prepared: &Prepared,
        leaf: Content,
    ) {
        match leaf {
            Content::Spheres(run) => {
                if near.count_ones() * RAYS_FOR_EACH <= met.count_ones() {
                    for lane in bits(near) {
                        searches.test(simd, self, run.first as usize + lane, met);
                    }
                    return;
                }
                for k in lanes(met) {
                    let (ray, limit) = (self.leaf_ray(prepared, k), self.limit[k]);
                    let candidates = tree.spheres.sort_out(simd, run, &ray, limit);
                    self.take(simd, searches, k, run.first, &candidates);
                }
            }
            Content::Triangles(run) => {
                for k in lanes(met) {
                    let (ray, limit) = (self.leaf_ray(prepared, k), self.limit[k]);
                    let candidates = tree.triangles.sort_out(simd, run, &ray, limit);
                    self.take(simd, searches, k, run.first, &candidates);
                }
            }
            Content::One(place) if met != 0 => searches.test(simd, self, place, met),
            Content::One(_) | Content::Node(_) => {}
        }
    }

    /// Has `searches` take the candidates of a leaf, whose primitives start at `first`, for the ray of lane `k`.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        simd: S,
        searches: &mut impl Searches<S>,
        k: usize,
        first: u32,
        candidates: &Candidates,
    ) {
        let Candidates { maybe, certain, from, to } = candidates;
        for lane in bits(*maybe) {
            let bounds = [from.0[lane], to.0[lane]];
            let certain = (certain >> lane & 1 != 0).then_some(bounds);
            searches.take(simd, self, k, first + lane as u32, certain);
        }
    }

    /// How deep any ray still searches.
    #[inline(always)]
    fn deepest(&self) -> f32 {
        // In eight parts, each a lane of vectors.
        let mut ends = [f32::NEG_INFINITY; GROUP];
        for start in (0..LANES).step_by(GROUP) {
            for (part, end) in ends.iter_mut().enumerate() {
                let other = self.limit[start + part];
                *end = if other > *end { other } else { *end };
            }
        }
        ends.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }
}
