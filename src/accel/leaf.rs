//! Leaves: up to eight primitives of a kind side by side, sorted out in single precision.
//!
//! Each primitive is either certainly missed, certainly hit (and where, from and to), or neither. Only the last kind must be
//! decided in double precision at once; of the certain hits, which can mostly be told apart by their intervals, only the
//! winner, when the search is over.
//!
//! The bounds: coordinates are at most 1, origins at most 2 from the centre, and so distances at most 4; with
//! u = 2⁻²⁴, a difference "vertex − origin" is off by at most 10 u, the ray at that point by another 4 u.

use glam::DVec3;

use super::{
    frame::{TreeRay, above},
    node::Run,
    rows::Rows,
    simd::{Lanes, Simd},
};

/// What a leaf's primitives are to a ray, or a primitive to eight rays: a bit for each.
pub(super) struct Candidates {
    /// Those that may be hit before the limit.
    pub(super) maybe: u32,
    /// Those of them that certainly are hit before the end, for the first time between `from` and `to`.
    pub(super) certain: u32,
    /// The bounds of the certain hits.
    pub(super) from: Lanes,
    pub(super) to: Lanes,
}

impl Candidates {
    pub(super) const NONE: Self =
        Self { maybe: 0, certain: 0, from: Lanes([0.0; 8]), to: Lanes([0.0; 8]) };
}

/// A ray made ready for the tests of leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafRay {
    pub(super) origin: [f32; 3],
    pub(super) dir: [f32; 3],
    /// One over the squared length of the direction.
    pub(super) inverse: f32,
    /// The length of the direction.
    pub(super) length: f32,
    /// The end of the ray, rounded down.
    pub(super) end: f32,
    /// How far it may have to go, and how far from its origin corners may be.
    pub(super) reach: f32,
    /// The ray itself.
    #[cfg(feature = "leaf-study")]
    pub(super) ray: TreeRay,
}

impl LeafRay {
    #[inline(always)]
    pub(super) fn new(ray: &TreeRay, end: f64) -> Self {
        let square = ray.square();
        Self {
            origin: ray.origin,
            dir: ray.dir,
            inverse: 1.0 / square,
            length: square.sqrt(),
            end: ray.end_below(end),
            reach: 4.0,
            #[cfg(feature = "leaf-study")]
            ray: *ray,
        }
    }
}

/// The same vector in all lanes.
#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, v: [f32; 3]) -> [S::F; 3] {
    [simd.splat(v[0]), simd.splat(v[1]), simd.splat(v[2])]
}

#[inline(always)]
pub(super) fn dot<S: Simd>(simd: S, a: [S::F; 3], b: [S::F; 3]) -> S::F {
    simd.mul_add(a[0], b[0], simd.mul_add(a[1], b[1], simd.mul(a[2], b[2])))
}

#[inline(always)]
pub(super) fn cross<S: Simd>(simd: S, a: [S::F; 3], b: [S::F; 3]) -> [S::F; 3] {
    [
        simd.mul_sub(a[1], b[2], simd.mul(a[2], b[1])),
        simd.mul_sub(a[2], b[0], simd.mul(a[0], b[2])),
        simd.mul_sub(a[0], b[1], simd.mul(a[1], b[0])),
    ]
}

#[inline(always)]
pub(super) fn sub<S: Simd>(simd: S, a: [S::F; 3], b: [S::F; 3]) -> [S::F; 3] {
    [simd.sub(a[0], b[0]), simd.sub(a[1], b[1]), simd.sub(a[2], b[2])]
}

/// The leaves of spheres: centre and radius of each.
#[derive(Debug)]
pub(super) struct Spheres {
    pub(super) rows: Rows<4>,
    /// By how much a radius may be off to either side.
    pub(super) margin: f32,
}

impl Spheres {
    /// The leaves `runs` of spheres that are in their places here; boxes are enlarged by `pad`.
    pub(super) fn new(runs: &[Run], pad: f64, sphere: impl Fn(u32) -> (DVec3, f64) + Sync) -> Self {
        let rows = Rows::new(runs, |place| {
            let (center, radius) = sphere(place);
            [center.x as f32, center.y as f32, center.z as f32, radius as f32]
        });
        // The perpendicular from the centre to the ray is off by up to 20 u across and 36 u along the ray, for one of a
        // packet, which begins further away, by 20 u and 44 u. The two are at right angles, so its length is off by less
        // than 49 u, and what is made of the radius by 4 u: less than 2 pads, which are 64 u.
        Self { rows, margin: above(2.0 * pad) }
    }

    /// Sorts out the spheres.
    ///
    /// With c the centre seen from the origin and b = c·d/d·d, the ray passes the centre at b at the distance of
    /// q = c − b d, and is inside the sphere for √((r² − q·q)/d·d) to either side.
    #[inline(always)]
    pub(super) fn sort_out<S: Simd>(
        &self,
        simd: S,
        run: Run,
        ray: &LeafRay,
        limit: f32,
    ) -> Candidates {
        let leaf = self.rows.leaf(run);
        let (radius, margin) = (leaf.row(simd, 3), simd.splat(self.margin));
        let (dir, inverse) = (splat(simd, ray.dir), simd.splat(ray.inverse));
        let c = sub(simd, leaf.rows(simd, 0), splat(simd, ray.origin));
        let b = simd.mul(dot(simd, c, dir), inverse);
        let q = [
            simd.neg_mul_add(b, dir[0], c[0]),
            simd.neg_mul_add(b, dir[1], c[1]),
            simd.neg_mul_add(b, dir[2], c[2]),
        ];
        let offset = dot(simd, q, q);
        // The root of a negative number is NaN; `min` and `max` hand on a NaN in their second place, which is a miss.
        let outer = simd.add(radius, margin);
        let gap = simd.mul_sub(outer, outer, offset);
        let half = simd.sqrt(simd.mul(gap, inverse));
        let (enter, leave) = (simd.sub(b, half), simd.add(b, half));
        let limit = simd.splat(limit);
        let maybe = leaf.all() & simd.le(simd.max(simd.splat(0.0), enter), simd.min(limit, leave));
        if maybe == 0 {
            return Candidates::NONE;
        }
        // Negative if the sphere is smaller than its error: nothing is certain.
        let inner = simd.sub(radius, margin);
        let gap = simd.mul_sub(inner, simd.toggle_sign(inner, inner), offset);
        let late = simd.sub(b, simd.sqrt(simd.mul(gap, inverse)));
        let ahead = simd.le(simd.splat(f32::MIN_POSITIVE), enter);
        let certain = maybe & ahead & simd.le(late, simd.splat(ray.end));
        Candidates { maybe, certain, from: simd.store(enter), to: simd.store(late) }
    }
}

/// The leaves of triangles: a corner, two edges from there, and the length of the longest.
#[derive(Debug)]
pub(super) struct Triangles {
    pub(super) rows: Rows<10>,
}

impl Triangles {
    /// The leaves `runs` of triangles that have these corners by their places; `coarseness` is how many times the usual pad a box
    /// is enlarged by.
    pub(super) fn new(
        runs: &[Run],
        coarseness: f64,
        corners: impl Fn(u32) -> [DVec3; 3] + Sync,
    ) -> Self {
        let rows = Rows::new(runs, |place| {
            let [a, b, c] = corners(place);
            let (u, v) = (b - a, c - a);
            let longest = [u, v, c - b].map(DVec3::length_squared);
            let longest = longest[0].max(longest[1]).max(longest[2]).sqrt();
            let [a, u, v] = [a, u, v].map(|x| x.as_vec3().to_array());
            // What is larger than usual is as good as longer.
            let size = above(longest * coarseness);
            [a[0], a[1], a[2], u[0], u[1], u[2], v[0], v[1], v[2], size]
        });
        Self { rows }
    }

    /// Sorts out the triangles.
    ///
    /// The point a + v e₁ + w e₂ of the plane is o + t d: by Cramer's rule, with c = a − o, n = e₁ × e₂ and r = c × d,
    /// t = n·c / n·d, v = e₂·r / n·d, w = −e₁·r / n·d. Nothing is divided; v, w and 1 − v − w times |n·d|, of which the
    /// last is the worst, are off by less than 112 u |e| |d|, n·c by 38 u |e|² and n·d by 9 u |e|² |d|; for a ray of a
    /// packet, which begins further away, by less than twice as much.
    ///
    /// Source: Möller & Trumbore, "Fast, minimum storage ray/triangle intersection", *Journal of Graphics Tools* 2(1),
    /// 1997.
    #[inline(always)]
    pub(super) fn sort_out<S: Simd>(
        &self,
        simd: S,
        run: Run,
        ray: &LeafRay,
        limit: f32,
    ) -> Candidates {
        const U: f32 = f32::EPSILON / 2.0;
        let leaf = self.rows.leaf(run);
        let (edge1, edge2, size) = (leaf.rows(simd, 3), leaf.rows(simd, 6), leaf.row(simd, 9));
        let (zero, dir) = (simd.splat(0.0), splat(simd, ray.dir));
        let c = sub(simd, leaf.rows(simd, 0), splat(simd, ray.origin));
        let n = cross(simd, edge1, edge2);
        let r = cross(simd, c, dir);
        let signed = dot(simd, n, dir);
        let v = simd.toggle_sign(dot(simd, edge2, r), signed);
        let minus_w = simd.toggle_sign(dot(simd, edge1, r), signed);
        let scaled_t = simd.toggle_sign(dot(simd, n, c), signed);
        let den = simd.toggle_sign(signed, signed);
        let rest = simd.add(simd.sub(den, v), minus_w);
        let inside = simd.min(simd.min(v, simd.sub(zero, minus_w)), rest);
        let area = simd.mul(size, size);
        let error = simd.mul(size, simd.splat(32.0 * U * ray.reach * ray.length));
        // A ray in the frame has only so far to go, wherever its end is.
        let t_error = simd.mul(area, simd.splat(64.0 * U * ray.reach));
        let reach = simd.mul_add(den, simd.splat(limit.min(ray.reach)), t_error);
        let maybe = leaf.all()
            & simd.le(simd.sub(zero, error), inside)
            & simd.le(simd.sub(zero, t_error), scaled_t)
            & simd.le(scaled_t, reach);
        if maybe == 0 {
            return Candidates::NONE;
        }
        let t_error = simd.mul(area, simd.splat(16.0 * U * ray.reach));
        let den_error = simd.mul(area, simd.splat(16.0 * U * ray.length));
        let from = simd.div(simd.sub(scaled_t, t_error), simd.add(den, den_error));
        let to = simd.div(simd.add(scaled_t, t_error), simd.sub(den, den_error));
        let certain = maybe
            & simd.le(error, inside)
            & simd.le(simd.add(den_error, den_error), den)
            & simd.le(simd.splat(f32::MIN_POSITIVE), from)
            & simd.le(to, simd.splat(ray.end));
        Candidates { maybe, certain, from: simd.store(from), to: simd.store(to) }
    }
}
