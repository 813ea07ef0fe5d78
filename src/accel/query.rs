//! What a ray asks of the tree: the nearest hit.

use super::{
    Accel,
    decide::flat_crossing,
    extreme,
    frame::{Entry, TreeRay},
    leaf::{Candidates, LeafRay},
    node::Content,
    simd::{Kernel, Simd, bits},
    target::{Left, prefetch},
    tree::Tree,
    walk::{Visitor, walk},
};
use crate::geometry::{Crossing, Hit, Ray};

/// The best hit so far, decided in double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best {
    /// Its parameter, or the end of the ray.
    pub(super) t: f64,
    /// Its primitive; before there is a hit 0, which nothing undercuts.
    primitive: u32,
    face: u8,
    is_hit: bool,
}

impl Best {
    #[inline(always)]
    pub(super) fn before(end: f64) -> Self {
        Self { t: end, primitive: 0, face: 0, is_hit: false }
    }

    /// Takes the crossing with the primitive of a `number` if it is better: nearer, or as near and of a lower primitive.
    #[inline(always)]
    fn offer(&mut self, crossing: Crossing, number: impl Fn() -> u32) {
        let t = crossing.t;
        if t > 0.0 && t <= self.t {
            let primitive = number();
            if t < self.t || primitive < self.primitive {
                *self = Self { t, primitive, face: crossing.face, is_hit: true };
            }
        }
    }

    /// Offers the crossings of the primitive in `place`.
    #[inline(always)]
    pub(super) fn test<S: Simd>(&mut self, simd: S, accel: &Accel, ray: &Ray, place: usize) {
        let [first, second] = accel.crossings(simd, ray, place);
        self.offer(first, || accel.numbers[place]);
        self.offer(second, || accel.numbers[place]);
    }

    #[inline(always)]
    pub(super) fn hit(&self) -> Option<Hit> {
        let Self { t, primitive, face, is_hit } = *self;
        is_hit.then_some(Hit { t, primitive, face })
    }
}

/// The search for the nearest hit.
pub(super) struct Nearest<'a> {
    pub(super) accel: &'a Accel,
    pub(super) ray: &'a Ray,
    pub(super) end: f64,
}

impl Kernel for Nearest<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Hit> {
        let Self { accel, ray, end } = self;
        let mut best = Best::before(end);
        for place in accel.outside() {
            best.test(simd, accel, ray, place);
        }
        if let Some(tree) = &accel.tree {
            match tree.frame.enter(ray) {
                Entry::Miss => {}
                Entry::Ray(tree_ray) => {
                    let mut search = Search::new(accel, tree, ray, tree_ray, best);
                    walk::<S, true>(simd, tree, &tree_ray, &mut search);
                    best = search.finish(simd);
                }
                Entry::Extreme => {
                    let origin = tree.frame.point(ray.origin);
                    extreme::walk(&tree.nodes, tree.root, ray, origin, |leaf| {
                        Tree::places(leaf).for_each(|place| best.test(simd, accel, ray, place));
                        false
                    });
                }
            }
        }
        best.hit()
    }
}

/// A certain hit that has not been decided in double precision, because it may never matter.
#[derive(Clone, Copy)]
struct Pending {
    /// The place of its primitive; beyond all if there is none.
    place: u32,
    /// Its parameter in the tree's frame is not less than this.
    from: f32,
}

impl Pending {
    const NONE: Self = Self { place: u32::MAX, from: f32::INFINITY };
}

#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    accel: &'a Accel,
    tree: &'a Tree,
    ray: &'a Ray,
    tree_ray: TreeRay,
    leaf_ray: LeafRay,
    left: Left,
    /// No hit beyond this parameter, in the tree's frame, can be the nearest.
    pub(super) limit: f32,
    best: Best,
    pending: Pending,
}

impl<'a> Search<'a> {
    #[inline(always)]
    pub(super) fn new(
        accel: &'a Accel,
        tree: &'a Tree,
        ray: &'a Ray,
        tree_ray: TreeRay,
        best: Best,
    ) -> Self {
        let leaf_ray = LeafRay::new(&tree_ray, best.t);
        let limit = tree_ray.end_above(best.t);
        let left = Left::of(accel, ray);
        let pending = Pending::NONE;
        Self { accel, tree, ray, tree_ray, leaf_ray, left, limit, best, pending }
    }

    /// Decides the primitive in `place`.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, place: u32) {
        self.best.test(simd, self.accel, self.ray, place as usize);
        self.limit = self.limit.min(self.tree_ray.end_above(self.best.t));
    }

    /// Decides a leaf's primitive, which is hit if `certain`.
    #[inline(always)]
    fn decide<S: Simd>(&mut self, simd: S, place: u32, certain: bool) {
        match self.tree.flat(place) {
            None => self.test(simd, place),
            Some(flat) => {
                let crossing = flat_crossing(simd, flat, self.ray, certain);
                self.best.offer(crossing, || flat.number);
                self.limit = self.limit.min(self.tree_ray.end_above(self.best.t));
            }
        }
    }

    /// Takes the candidates of a leaf whose primitives start at `first`.
    ///
    /// A pending hit loses to one that ends before it starts; where intervals overlap, both are decided.
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, first: u32, candidates: &Candidates) {
        let Candidates { maybe, certain, from, to } = *candidates;
        for lane in bits(maybe) {
            let place = first + lane as u32;
            if certain & 1 << lane == 0 {
                self.decide(simd, place, false);
                continue;
            }
            let (from, to) = (from.0[lane], to.0[lane]);
            if from > self.limit {
                continue;
            }
            if to >= self.pending.from && self.pending.place != u32::MAX {
                self.decide(simd, self.pending.place, true);
            }
            self.pending = Pending { place, from };
            self.limit = self.limit.min(to);
            prefetch(simd, self.accel, self.tree, place);
        }
    }

    #[inline(always)]
    pub(super) fn finish<S: Simd>(mut self, simd: S) -> Best {
        let Pending { place, from } = self.pending;
        if place != u32::MAX && from <= self.limit {
            #[cfg(feature = "leaf-study")]
            if super::study::is_naive() {
                let crossing = self.leaf_ray.crossing(from);
                self.best.offer(crossing, || self.accel.numbers[place as usize]);
                return self.best;
            }
            self.decide(simd, place, true);
        }
        self.best
    }
}

impl<S: Simd> Visitor<S> for Search<'_> {
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
                return found.for_each(|place, from| {
                    if from < self.limit {
                        self.pending = Pending { place, from };
                        self.limit = from;
                    }
                    false
                });
            }
        }
        let (ray, limit) = (&self.leaf_ray, self.limit);
        if let Some((first, candidates)) = self.left.sort_out(simd, self.tree, leaf, ray, limit) {
            self.take(simd, first, &candidates);
        } else if let Content::One(place) = leaf {
            self.test(simd, place as u32);
        }
        false
    }
}
