//! What a ray asks of the tree: the nearest hit, or all crossings.

use std::ops::ControlFlow;

use super::{
    Accel, extreme,
    frame::{Entry, TreeRay},
    node::Content,
    simd::{Kernel, Simd},
    walk::{Visitor, walk},
};
use crate::geometry::{Crossing, Hit, Ray};

/// The best hit so far, decided in double precision.
#[derive(Clone, Copy, Debug)]
struct Best {
    /// Its parameter, or the end of the ray.
    t: f64,
    /// Its primitive; before there is a hit 0, which nothing undercuts.
    primitive: u32,
    face: u8,
    is_hit: bool,
}

impl Best {
    #[inline(always)]
    fn offer(&mut self, crossing: Crossing, primitive: u32) -> bool {
        let t = crossing.t;
        let wins = t > 0.0 && (t < self.t || t == self.t && primitive < self.primitive);
        if wins {
            *self = Self { t, primitive, face: crossing.face, is_hit: true };
        }
        wins
    }

    fn hit(&self) -> Option<Hit> {
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
        let best = Best { t: end, primitive: 0, face: 0, is_hit: false };
        let mut search = NearestSearch { accel, ray, tree_ray: None, limit: 0.0, best };
        for place in accel.outside() {
            search.test(place);
        }
        if let Some(tree) = &accel.tree {
            match tree.frame.enter(ray) {
                Entry::Miss => {}
                Entry::Ray(tree_ray) => {
                    search.tree_ray = Some(tree_ray);
                    search.limit = tree_ray.end_above(search.best.t);
                    walk::<S, true>(simd, &tree.nodes, tree.root, &tree_ray, &mut search);
                }
                Entry::Extreme => {
                    let origin = tree.frame.point(ray.origin);
                    extreme::walk(&tree.nodes, tree.root, ray, origin, |leaf| {
                        tree.places(leaf).for_each(|place| search.test(place));
                        false
                    });
                }
            }
        }
        search.best.hit()
    }
}

struct NearestSearch<'a> {
    accel: &'a Accel,
    ray: &'a Ray,
    tree_ray: Option<TreeRay>,
    limit: f32,
    best: Best,
}

impl NearestSearch<'_> {
    #[inline(always)]
    fn test(&mut self, place: usize) {
        let number = self.accel.numbers[place];
        for crossing in self.accel.shapes[place].crossings_of(self.ray, number) {
            if self.best.offer(crossing, number)
                && let Some(ray) = &self.tree_ray
            {
                self.limit = ray.end_above(self.best.t);
            }
        }
    }
}

impl<S: Simd> Visitor<S> for NearestSearch<'_> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn leaf(&mut self, _simd: S, leaf: Content) -> bool {
        if let Some(tree) = &self.accel.tree {
            for place in tree.places(leaf) {
                self.test(place);
            }
        }
        false
    }
}

/// The visit of all crossings.
pub(super) struct Crossed<'a, V> {
    pub(super) accel: &'a Accel,
    pub(super) ray: &'a Ray,
    pub(super) end: f64,
    pub(super) visit: V,
}

impl<V: FnMut(u32, Crossing) -> ControlFlow<()>> Kernel for Crossed<'_, V> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { accel, ray, end, visit } = self;
        let mut search = CrossedSearch { accel, ray, end, limit: 0.0, visit, stopped: false };
        for place in accel.outside() {
            if search.test(place) {
                return true;
            }
        }
        if let Some(tree) = &accel.tree {
            match tree.frame.enter(ray) {
                Entry::Miss => {}
                Entry::Ray(tree_ray) => {
                    search.limit = tree_ray.end_above(end);
                    walk::<S, false>(simd, &tree.nodes, tree.root, &tree_ray, &mut search);
                }
                Entry::Extreme => {
                    let origin = tree.frame.point(ray.origin);
                    extreme::walk(&tree.nodes, tree.root, ray, origin, |leaf| {
                        tree.places(leaf).any(|place| search.test(place))
                    });
                }
            }
        }
        search.stopped
    }
}

struct CrossedSearch<'a, V> {
    accel: &'a Accel,
    ray: &'a Ray,
    end: f64,
    limit: f32,
    visit: V,
    stopped: bool,
}

impl<V: FnMut(u32, Crossing) -> ControlFlow<()>> CrossedSearch<'_, V> {
    #[inline(always)]
    fn test(&mut self, place: usize) -> bool {
        let number = self.accel.numbers[place];
        for crossing in self.accel.shapes[place].crossings_of(self.ray, number) {
            if crossing.t > 0.0
                && crossing.t < self.end
                && (self.visit)(number, crossing).is_break()
            {
                self.stopped = true;
                return true;
            }
        }
        false
    }
}

impl<S: Simd, V: FnMut(u32, Crossing) -> ControlFlow<()>> Visitor<S> for CrossedSearch<'_, V> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn leaf(&mut self, _simd: S, leaf: Content) -> bool {
        if let Some(tree) = &self.accel.tree {
            for place in tree.places(leaf) {
                if self.test(place) {
                    return true;
                }
            }
        }
        false
    }
}
