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
    frame::{TreeRay, above, below},
    simd::{Lanes, Simd},
};

/// What a leaf's primitives are to a ray: a bit for each.
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
    const NONE: Self = Self { maybe: 0, certain: 0, from: Lanes([0.0; 8]), to: Lanes([0.0; 8]) };
}

/// A ray made ready for the tests of leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafRay {
    pub(super) origin: [f32; 3],
    pub(super) dir: [f32; 3],
    /// One over the squared length of the direction.
    pub(super) inverse: f32,
    /// The length of the direction.
    length: f32,
    /// The end of the ray, rounded down.
    end: f32,
    /// The ray itself.
    #[cfg(feature = "leaf-study")]
    pub(super) ray: TreeRay,
}

impl LeafRay {
    #[inline(always)]
    pub(super) fn new(ray: &TreeRay, end: f64) -> Self {
        let [x, y, z] = ray.dir;
        let square = x * x + (y * y + z * z);
        Self {
            origin: ray.origin,
            dir: ray.dir,
            inverse: 1.0 / square,
            length: square.sqrt(),
            end: ray.end_below(end),
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

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, v: &[[f32; 8]; 3]) -> [S::F; 3] {
    [simd.load(&v[0]), simd.load(&v[1]), simd.load(&v[2])]
}

/// Up to eight spheres.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Spheres {
    pub(super) center: [[f32; 8]; 3],
    /// The square of a radius that is certainly too large; negative for a sphere that is not there.
    pub(super) outer: [f32; 8],
    /// The square of a radius that is certainly too small; negative if there is none.
    inner: [f32; 8],
    /// The place of the first, and how many there are.
    pub(super) first: u32,
    pub(super) count: u32,
}

impl Spheres {
    /// A block for primitives from the place `first` on.
    pub(super) fn new(first: u32) -> Self {
        Self { center: [[0.0; 8]; 3], outer: [-1.0; 8], inner: [-1.0; 8], first, count: 0 }
    }

    /// Adds a sphere; `pad` is what a box is enlarged by.
    pub(super) fn push(&mut self, center: [f64; 3], radius: f64, pad: f64) {
        let lane = self.count as usize;
        self.count += 1;
        // The perpendicular from the centre to the ray is off by up to 27 u across and 28 u along the ray: 2 pads.
        let (large, small) = (radius + 2.0 * pad, radius - 2.0 * pad);
        for (lanes, x) in self.center.iter_mut().zip(center) {
            lanes[lane] = x as f32;
        }
        self.outer[lane] = above(large * large);
        self.inner[lane] = if small > 0.0 { below(small * small) } else { -1.0 };
    }

    /// Sorts out the spheres.
    ///
    /// With c the centre seen from the origin and b = c·d/d·d, the ray passes the centre at b at the distance of
    /// q = c − b d, and is inside the sphere for √((r² − q·q)/d·d) to either side.
    #[inline(always)]
    pub(super) fn sort_out<S: Simd>(&self, simd: S, ray: &LeafRay, limit: f32) -> Candidates {
        let (dir, inverse) = (splat(simd, ray.dir), simd.splat(ray.inverse));
        let c = sub(simd, load(simd, &self.center), splat(simd, ray.origin));
        let b = simd.mul(dot(simd, c, dir), inverse);
        let q = [
            simd.neg_mul_add(b, dir[0], c[0]),
            simd.neg_mul_add(b, dir[1], c[1]),
            simd.neg_mul_add(b, dir[2], c[2]),
        ];
        let offset = dot(simd, q, q);
        // The root of a negative number is NaN; `min` and `max` hand on a NaN in their second place, which is a miss.
        let gap = simd.sub(simd.load(&self.outer), offset);
        let half = simd.sqrt(simd.mul(gap, inverse));
        let (enter, leave) = (simd.sub(b, half), simd.add(b, half));
        let maybe = simd.le(simd.max(simd.splat(0.0), enter), simd.min(simd.splat(limit), leave));
        if maybe == 0 {
            return Candidates::NONE;
        }
        let gap = simd.sub(simd.load(&self.inner), offset);
        let late = simd.sub(b, simd.sqrt(simd.mul(gap, inverse)));
        let ahead = simd.le(simd.splat(f32::MIN_POSITIVE), enter);
        let certain = maybe & ahead & simd.le(late, simd.splat(ray.end));
        Candidates { maybe, certain, from: simd.store(enter), to: simd.store(late) }
    }
}

/// Up to eight triangles.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Triangles {
    pub(super) corner: [[f32; 8]; 3],
    pub(super) edge1: [[f32; 8]; 3],
    pub(super) edge2: [[f32; 8]; 3],
    /// The longest edge of all.
    size: f32,
    /// What the errors below are multiplied by where the pad is larger than usual.
    coarseness: f32,
    /// The place of the first, and how many there are.
    pub(super) first: u32,
    pub(super) count: u32,
    /// Where the tree has the corners of the first.
    pub(super) corners: u32,
}

impl Triangles {
    /// A block for primitives from the place `first` on, whose corners the tree has from `corners` on.
    pub(super) fn new(first: u32, corners: u32) -> Self {
        let zero = [[0.0; 8]; 3];
        let (size, coarseness, count) = (0.0, 1.0, 0);
        Self { corner: zero, edge1: zero, edge2: zero, size, coarseness, first, count, corners }
    }

    /// Adds a triangle; `coarseness` is how many times the usual pad a box is enlarged by.
    pub(super) fn push(&mut self, corners: [DVec3; 3], coarseness: f64) {
        let lane = self.count as usize;
        self.count += 1;
        let [a, b, c] = corners;
        for (axis, x) in a.to_array().into_iter().enumerate() {
            self.corner[axis][lane] = x as f32;
            self.edge1[axis][lane] = (b - a).to_array()[axis] as f32;
            self.edge2[axis][lane] = (c - a).to_array()[axis] as f32;
        }
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        self.size = self.size.max(above(longest));
        self.coarseness = above(coarseness);
    }

    /// Sorts out the triangles.
    ///
    /// The point a + v e₁ + w e₂ of the plane is o + t d: by Cramer's rule, with c = a − o, n = e₁ × e₂ and r = c × d,
    /// t = n·c / n·d, v = e₂·r / n·d, w = −e₁·r / n·d. Nothing is divided; v, w and 1 − v − w times |n·d|, of which the last
    /// is the worst, are off by less than 96 u |e| |d|, n·c by 38 u |e|² and n·d by 8 u |e|² |d|.
    ///
    /// Source: Möller & Trumbore, "Fast, minimum storage ray/triangle intersection", *Journal of Graphics Tools* 2(1),
    /// 1997.
    #[inline(always)]
    pub(super) fn sort_out<S: Simd>(&self, simd: S, ray: &LeafRay, limit: f32) -> Candidates {
        const U: f32 = f32::EPSILON / 2.0;
        let (edge1, edge2) = (load(simd, &self.edge1), load(simd, &self.edge2));
        let dir = splat(simd, ray.dir);
        let c = sub(simd, load(simd, &self.corner), splat(simd, ray.origin));
        let n = cross(simd, edge1, edge2);
        let r = cross(simd, c, dir);
        let signed = dot(simd, n, dir);
        let v = simd.toggle_sign(dot(simd, edge2, r), signed);
        let minus_w = simd.toggle_sign(dot(simd, edge1, r), signed);
        let scaled_t = simd.toggle_sign(dot(simd, n, c), signed);
        let den = simd.toggle_sign(signed, signed);
        let rest = simd.add(simd.sub(den, v), minus_w);
        let w = simd.sub(simd.splat(0.0), minus_w);
        let inside = simd.min(simd.min(v, w), rest);
        let area = self.size * self.size * self.coarseness;
        let error = 128.0 * U * self.size * self.coarseness * ray.length;
        // A ray in the frame is at most 4 long, however far its end is.
        let t_error = 256.0 * U * area;
        let reach = simd.mul_add(den, simd.splat(limit.min(4.0)), simd.splat(t_error));
        let maybe = ((1 << self.count) - 1)
            & simd.le(simd.splat(-error), inside)
            & simd.le(simd.splat(-t_error), scaled_t)
            & simd.le(scaled_t, reach);
        if maybe == 0 {
            return Candidates::NONE;
        }
        let t_error = simd.splat(64.0 * U * area);
        let den_error = simd.splat(16.0 * U * area * ray.length);
        let from = simd.div(simd.sub(scaled_t, t_error), simd.add(den, den_error));
        let to = simd.div(simd.add(scaled_t, t_error), simd.sub(den, den_error));
        let certain = maybe
            & simd.le(simd.splat(error), inside)
            & simd.le(simd.add(den_error, den_error), den)
            & simd.le(simd.splat(f32::MIN_POSITIVE), from)
            & simd.le(to, simd.splat(ray.end));
        Candidates { maybe, certain, from: simd.store(from), to: simd.store(to) }
    }
}
