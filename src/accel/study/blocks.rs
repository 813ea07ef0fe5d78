//! Leaves as the textbook has them, in single precision.

use super::{
    super::{
        leaf::{LeafRay, Spheres, Triangles, cross, dot, splat, sub},
        node::{Content, Run},
        simd::{Lanes, Simd, bits},
        tree::Tree,
    },
    EPSILON, count_leaf, is_naive,
};
use crate::geometry::Crossing;

impl Spheres {
    /// The spheres, and the two roots of each, which are NaN where it is missed.
    #[inline(always)]
    fn naive<S: Simd>(&self, simd: S, run: Run, ray: &LeafRay) -> (u32, [S::F; 2]) {
        let leaf = self.rows.leaf(run);
        let (origin, dir) = (splat(simd, ray.origin), splat(simd, ray.dir));
        let inverse = simd.splat(ray.inverse);
        let f = sub(simd, leaf.rows(simd, 0), origin);
        let b = dot(simd, f, dir);
        let radius = leaf.row(simd, 3);
        let c = simd.neg_mul_add(radius, radius, dot(simd, f, f));
        let a = dot(simd, dir, dir);
        let root = simd.sqrt(simd.mul_sub(b, b, simd.mul(a, c)));
        let roots = [simd.sub(b, root), simd.add(b, root)];
        (leaf.all(), roots.map(|t| simd.mul(t, inverse)))
    }
}

impl Triangles {
    /// The parameter for each triangle, and which are hit.
    #[inline(always)]
    fn naive<S: Simd>(&self, simd: S, run: Run, ray: &LeafRay) -> (u32, S::F) {
        let leaf = self.rows.leaf(run);
        let (origin, dir) = (splat(simd, ray.origin), splat(simd, ray.dir));
        let (edge1, edge2) = (leaf.rows(simd, 3), leaf.rows(simd, 6));
        let p = cross(simd, dir, edge2);
        let inverse = simd.div(simd.splat(1.0), dot(simd, edge1, p));
        let s = sub(simd, origin, leaf.rows(simd, 0));
        let q = cross(simd, s, edge1);
        let u = simd.mul(dot(simd, s, p), inverse);
        let v = simd.mul(dot(simd, dir, q), inverse);
        let zero = simd.splat(0.0);
        let hit = simd.le(zero, u) & simd.le(zero, v) & simd.le(simd.add(u, v), simd.splat(1.0));
        (hit & leaf.all(), simd.mul(dot(simd, edge2, q), inverse))
    }
}

/// The hits of a ray in a leaf: the place of the first primitive, which of them are hit first and second, and where.
pub(in crate::accel) struct Found {
    first: u32,
    hits: [u32; 2],
    t: [Lanes; 2],
}

impl Found {
    /// Calls `take(place, t)`, `t` being the tree's, for every hit, until it returns that it stops; returns whether it
    /// did.
    #[inline(always)]
    pub(in crate::accel) fn for_each(&self, mut take: impl FnMut(u32, f32) -> bool) -> bool {
        for (hits, t) in self.hits.into_iter().zip(&self.t) {
            for lane in bits(hits) {
                if take(self.first + lane as u32, t.0[lane]) {
                    return true;
                }
            }
        }
        false
    }
}

impl LeafRay {
    /// The crossing at the tree's `t`.
    #[inline(always)]
    pub(in crate::accel) fn crossing(&self, t: f32) -> Crossing {
        Crossing::at((f64::from(t) + self.ray.arrival) / self.ray.rate)
    }
}

/// What the textbook says of a leaf.
pub(in crate::accel) enum Textbook {
    /// It is not asked; that is counted.
    Unwanted,
    /// Nothing is hit.
    Missed,
    /// Something is.
    Hit(Found),
}

/// The textbook's hits in a block of primitives.
#[inline(always)]
pub(in crate::accel) fn leaf<S: Simd>(
    simd: S,
    tree: &Tree,
    leaf: Content,
    ray: &LeafRay,
    limit: f32,
) -> Textbook {
    if !is_naive() {
        count_leaf(leaf);
        return Textbook::Unwanted;
    }
    let start = simd.splat(EPSILON * ray.ray.rate as f32 - ray.ray.arrival as f32);
    let limit = simd.splat(limit);
    let ahead = |t: S::F| simd.le(start, t) & simd.le(t, limit);
    match leaf {
        Content::Spheres(run) => {
            let (all, [t0, t1]) = tree.spheres.naive(simd, run, ray);
            // Of a NaN, which is a miss, `min` and `max` hand on the second.
            if all & simd.le(simd.max(start, t0), simd.min(limit, t1)) == 0 {
                return Textbook::Missed;
            }
            let hits = [all & ahead(t0), all & ahead(t1)];
            let t = [simd.store(t0), simd.store(t1)];
            Textbook::Hit(Found { first: run.first, hits, t })
        }
        Content::Triangles(run) => {
            let (hit, t) = tree.triangles.naive(simd, run, ray);
            let hit = hit & ahead(t);
            if hit == 0 {
                return Textbook::Missed;
            }
            let t = simd.store(t);
            Textbook::Hit(Found { first: run.first, hits: [hit, 0], t: [t, t] })
        }
        Content::One(_) | Content::Node(_) => Textbook::Unwanted,
    }
}
