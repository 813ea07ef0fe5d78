//! What a ray crosses on its way to an end.

use std::ops::ControlFlow;

use super::{
    Accel,
    decide::flat_crossing,
    extreme,
    frame::Entry,
    leaf::{Candidates, LeafRay},
    node::Content,
    simd::{Kernel, Simd, bits},
    target::Left,
    tree::Tree,
    walk::{Visitor, walk},
};
use crate::geometry::{Crossing, Ray};

/// What is told of crossings; a closure, or something that must be inlined.
pub(super) trait Visit {
    /// A crossing of a primitive; a break ends the search.
    fn visit(&mut self, primitive: u32, crossing: Crossing) -> ControlFlow<()>;
}

impl<F: FnMut(u32, Crossing) -> ControlFlow<()>> Visit for F {
    #[inline(always)]
    fn visit(&mut self, primitive: u32, crossing: Crossing) -> ControlFlow<()> {
        self(primitive, crossing)
    }
}

/// The visit of all crossings, or the search for one with an opaque primitive.
pub(super) struct Crossed<'a, B, V> {
    pub(super) accel: &'a Accel,
    pub(super) ray: &'a Ray,
    pub(super) end: f64,
    pub(super) opaque: B,
    pub(super) visit: V,
}

impl<B, V> Kernel for Crossed<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: Visit,
{
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { accel, ray, end, opaque, visit } = self;
        let mut test = Test { accel, ray, end, opaque, visit };
        for place in accel.outside() {
            if test.test(simd, place) {
                return true;
            }
        }
        let Some(tree) = &accel.tree else { return false };
        match tree.frame.enter(ray) {
            Entry::Miss => false,
            Entry::Ray(tree_ray) => {
                let leaf_ray = LeafRay::new(&tree_ray, end);
                let (limit, left) = (tree_ray.end_above(end), Left::of(accel, ray));
                let mut search = Search { test, tree, leaf_ray, left, limit, stopped: false };
                walk::<S, false>(simd, tree, &tree_ray, &mut search);
                search.stopped
            }
            Entry::Extreme => {
                let mut stopped = false;
                let origin = tree.frame.point(ray.origin);
                extreme::walk(&tree.nodes, tree.root, ray, origin, |leaf| {
                    stopped = Tree::places(leaf).any(|place| test.test(simd, place));
                    stopped
                });
                stopped
            }
        }
    }
}

/// The test of one primitive in double precision.
pub(super) struct Test<'a, B, V> {
    pub(super) accel: &'a Accel,
    pub(super) ray: &'a Ray,
    pub(super) end: f64,
    pub(super) opaque: B,
    pub(super) visit: V,
}

impl<B, V> Test<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: Visit,
{
    /// Whether the primitive in `place` stops the ray.
    #[inline(always)]
    pub(super) fn test<S: Simd>(&mut self, simd: S, place: usize) -> bool {
        let number = self.accel.numbers[place];
        let [first, second] = self.accel.crossings(simd, self.ray, place);
        self.crosses(number, first) || self.crosses(number, second)
    }

    /// Whether a crossing with primitive `number` stops the ray.
    #[inline(always)]
    pub(super) fn crosses(&mut self, number: u32, crossing: Crossing) -> bool {
        crossing.t > 0.0
            && crossing.t < self.end
            && ((self.opaque)(number) || self.visit.visit(number, crossing).is_break())
    }
}

pub(super) struct Search<'a, B, V> {
    pub(super) test: Test<'a, B, V>,
    pub(super) tree: &'a Tree,
    pub(super) leaf_ray: LeafRay,
    pub(super) left: Left,
    pub(super) limit: f32,
    pub(super) stopped: bool,
}

impl<B, V> Search<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: Visit,
{
    /// Whether one of the candidates of a leaf whose primitives start at `first` stops the ray: a certain hit of an
    /// opaque one does without further ado.
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, first: u32, candidates: &Candidates) -> bool {
        let Candidates { maybe, certain, .. } = *candidates;
        for lane in bits(maybe) {
            let place = first as usize + lane;
            let certain = certain & 1 << lane != 0;
            if certain && (self.test.opaque)(self.test.accel.numbers[place]) {
                return true;
            }
            let stopped = match self.tree.flat(place as u32) {
                None => self.test.test(simd, place),
                Some(flat) => {
                    let crossing = flat_crossing(simd, flat, self.test.ray, certain);
                    self.test.crosses(flat.number, crossing)
                }
            };
            if stopped {
                return true;
            }
        }
        false
    }
}

impl<S: Simd, B, V> Visitor<S> for Search<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: Visit,
{
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn leaf(&mut self, simd: S, leaf: Content) -> bool {
        #[cfg(feature = "leaf-study")]
        match super::study::leaf(simd, self.tree, leaf, &self.leaf_ray, self.limit) {
            super::study::Textbook::Unwanted => {}
            super::study::Textbook::Missed => return false,
            super::study::Textbook::Hit(found) => {
                self.stopped = found.for_each(|place, t| {
                    let number = self.test.accel.numbers[place as usize];
                    self.test.crosses(number, self.leaf_ray.crossing(t))
                });
                return self.stopped;
            }
        }
        let (ray, limit) = (&self.leaf_ray, self.limit);
        if let Some((first, candidates)) = self.left.sort_out(simd, self.tree, leaf, ray, limit) {
            self.stopped = self.take(simd, first, &candidates);
        } else if let Content::One(place) = leaf {
            self.stopped = self.test.test(simd, place);
        }
        self.stopped
    }
}
