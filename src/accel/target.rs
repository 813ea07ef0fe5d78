//! A primitive of a leaf that is to be decided in double precision, and the one that a ray leaves.

use super::{
    Accel,
    leaf::{Candidates, LeafRay},
    node::Content,
    simd::Simd,
    tree::Tree,
};
use crate::geometry::Ray;

/// Asks for the memory that a decision about the primitive in `place` needs.
#[inline(always)]
pub(super) fn prefetch<S: Simd>(simd: S, accel: &Accel, tree: &Tree, place: u32) {
    if let Some(flat) = tree.flat(place) {
        return simd.prefetch(flat);
    }
    simd.prefetch(&accel.shapes[place as usize]);
    simd.prefetch(&accel.numbers[place as usize]);
}

/// The primitive that a ray leaves.
#[derive(Clone, Copy)]
pub(super) struct Left {
    place: u32,
    /// Whether the ray goes into it.
    inward: bool,
}

impl Left {
    #[inline(always)]
    pub(super) fn of(accel: &Accel, ray: &Ray) -> Self {
        let Some(from) = &ray.from else { return Self { place: u32::MAX, inward: false } };
        let place = accel.places.get(from.primitive as usize).copied().unwrap_or(u32::MAX);
        Self { place, inward: from.inward }
    }

    /// The lane of the leaf that starts at `first` in which it is, as a bit.
    #[inline(always)]
    fn lane(self, first: u32) -> u32 {
        let lane = self.place.wrapping_sub(first);
        if lane < 8 { 1 << lane } else { 0 }
    }

    /// Sorts out the primitives of a leaf of several, but for the one that the ray leaves, and tells the place of the
    /// first; `None` of what is no such leaf.
    #[inline(always)]
    pub(super) fn sort_out<S: Simd>(
        self,
        simd: S,
        tree: &Tree,
        leaf: Content,
        ray: &LeafRay,
        limit: f32,
    ) -> Option<(u32, Candidates)> {
        match leaf {
            Content::Spheres(run) => {
                let mut candidates = tree.spheres.sort_out(simd, run, ray, limit);
                self.settle_round(run.first, &mut candidates);
                Some((run.first, candidates))
            }
            Content::Triangles(run) => {
                let mut candidates = tree.triangles.sort_out(simd, run, ray, limit);
                self.settle_flat(run.first, &mut candidates);
                Some((run.first, candidates))
            }
            Content::One(_) | Content::Node(_) => None,
        }
    }

    /// Strikes it from the candidates of a leaf of triangles, which no ray that leaves one meets again.
    #[inline(always)]
    fn settle_flat(self, first: u32, candidates: &mut Candidates) {
        candidates.maybe &= !self.lane(first);
    }

    /// Strikes it from the candidates of a leaf of spheres, or leaves it to its own test, which alone knows what a ray
    /// inward meets.
    #[inline(always)]
    fn settle_round(self, first: u32, candidates: &mut Candidates) {
        let lane = self.lane(first);
        candidates.certain &= !lane;
        if !self.inward {
            candidates.maybe &= !lane;
        }
    }
}
