//! What all bounded planes share: the watertight test of a ray against a convex outline, and the plane's equation.
//!
//! A vertex is sheared and scaled so that the ray runs along an axis; whether the ray passes an edge on the left or the
//! right is then the sign of a 2×2 determinant, which
//! [`difference_of_products`] gets right. The sheared vertex depends on ray and vertex only, so two shapes with a common
//! edge agree about it and no ray slips between them; a ray that meets the edge exactly may be reported by either.
//!
//! Source: Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", *Journal of Computer Graphics Techniques*
//! 2(1), 2013, with an exact sign in place of its double-precision fallback.

use glam::{DVec2, DVec3};

use super::{
    Bounds,
    hit::{Crossing, Surface},
    ray::Ray,
    shape::ShapeError,
};
use crate::math::{self, compensated::two_sum, cross, difference_of_products, scale};

/// The shear that turns a direction into the third axis.
struct Shear {
    axis: u8,
    x: f64,
    y: f64,
}

impl Shear {
    #[inline(always)]
    fn along(dir: DVec3) -> Self {
        let size = dir.abs();
        let axis = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let d = permuted(dir, axis);
        Self { axis, x: d.x / d.z, y: d.y / d.z }
    }

    /// The place of `v` seen along the direction.
    #[inline(always)]
    fn project(&self, v: DVec3) -> DVec2 {
        let v = permuted(v, self.axis);
        DVec2::new((-self.x).mul_add(v.z, v.x), (-self.y).mul_add(v.z, v.y))
    }
}

/// `v` with its components turned so that `axis` comes last.
#[inline(always)]
fn permuted(v: DVec3, axis: u8) -> DVec3 {
    match axis {
        0 => DVec3::new(v.y, v.z, v.x),
        1 => DVec3::new(v.z, v.x, v.y),
        _ => v,
    }
}

/// The crossing of the line of `ray` with the convex polygon of `vertices`, whose plane is square to `normal`.
///
/// A ray in the plane is a miss: a closed surface has other faces to be hit there.
#[inline(always)]
pub(super) fn crossing(vertices: &[DVec3], normal: DVec3, ray: &Ray) -> Crossing {
    crossing_of(vertices, || normal, ray)
}

/// As [`crossing`], for a shape that makes its normal, of any length, only when the ray is known to pass the edges.
#[inline(always)]
pub(super) fn crossing_of(
    vertices: &[DVec3],
    normal: impl FnOnce() -> DVec3,
    ray: &Ray,
) -> Crossing {
    let shear = Shear::along(ray.dir);
    let seen = |v: &DVec3| shear.project(*v - ray.origin);
    let mut last = seen(&vertices[vertices.len() - 1]);
    let (mut left, mut right) = (false, false);
    for vertex in vertices {
        let next = seen(vertex);
        let side = difference_of_products(last.x, next.y, last.y, next.x);
        left |= !(side >= 0.0); // NaN is both, and so a miss
        right |= !(side <= 0.0);
        last = next;
    }
    if left == right {
        return Crossing::NONE; // on different sides of two edges, or the outline is seen edge-on
    }
    plane_crossing(vertices[0], normal(), ray)
}

/// The crossing of the line of `ray` with the plane through `vertex` square to `normal`.
#[inline(always)]
pub(super) fn plane_crossing(vertex: DVec3, normal: DVec3, ray: &Ray) -> Crossing {
    let t = dot(normal, vertex - ray.origin) / dot(normal, ray.dir);
    if t.is_finite() { Crossing::at(t) } else { Crossing::NONE }
}

/// The surface of the plane through `vertex` square to the unit vector `normal`, where `ray` meets it at `t`; `rest` is what
/// rounding took from the ray's origin.
#[inline(always)]
pub(super) fn surface(vertex: DVec3, normal: DVec3, ray: &Ray, t: f64, rest: DVec3) -> Surface {
    let (near, near_rest) = sum(ray.origin, ray.dir * t + rest);
    let (away, away_rest) = sum(near, -vertex);
    let height = math::dot(normal, away) + dot(normal, away_rest + near_rest);
    // Back into the plane along the ray, where the exact point is.
    let back = ray.dir * (height / math::dot(normal, ray.dir));
    let back = if back.is_finite() { back } else { normal * height };
    let (point, point_rest) = sum(near, near_rest - back);
    let local = point - vertex;
    let error = Surface::error_bound(normal, point.abs() + local.abs());
    Surface { point_rest, local, ..Surface::plain(point, normal, error) }
}

/// The rounded sum and its rounding error.
#[inline(always)]
fn sum(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let [x, y, z] = [two_sum(a.x, b.x), two_sum(a.y, b.y), two_sum(a.z, b.z)];
    (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1))
}

/// The dot product with a rounding less a term than the plain one.
#[inline(always)]
fn dot(a: DVec3, b: DVec3) -> f64 {
    a.x.mul_add(b.x, a.y.mul_add(b.y, a.z * b.z))
}

/// The unit normal of the outline through `vertices`: the direction of its vector area, a sum over the fan of triangles
/// from the first corner.
///
/// # Errors
/// A corner that is not finite, or no area.
pub(super) fn unit_normal(vertices: &[DVec3]) -> Result<DVec3, ShapeError> {
    for v in vertices {
        ShapeError::check_point("vertices", *v)?;
    }
    let size = Bounds::of_points(vertices.iter().copied()).extent();
    let (_, e) = scale::normalized(size);
    let spoke = |v: DVec3| scale::scaled(v - vertices[0], e);
    let area: DVec3 = vertices[1..].windows(2).map(|w| cross(spoke(w[0]), spoke(w[1]))).sum();
    scale::normalized(area).0.try_normalize().ok_or(ShapeError::NoArea)
}
