//! What all bounded planes share: the watertight test of a ray against a convex outline, and the plane's equation.
//!
//! A vertex is sheared and scaled so that the ray runs along an axis; whether the ray passes an edge on the left or the
//! right is then the sign of a 2×2 determinant, which [`difference_of_products`] gets right. The sheared vertex depends
//! on ray and vertex only, so two shapes with a common edge agree about it and no ray slips between them; a ray that
//! meets the edge exactly may be reported by either.
//!
//! Source: Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", *Journal of Computer Graphics Techniques*
//! 2(1), 2013, with an exact sign in place of its double-precision fallback.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::{
    Bounds,
    hit::{Crossing, Surface},
    lanes::{Column, LANES, RayLanes},
    ray::Ray,
    shape_error::ShapeError,
};
use crate::math::{
    self,
    compensated::{fused_dot, two_sum},
    cross, difference_of_products,
    scale::{self, largest},
};

/// How far a crossing may be moved back along the ray into its plane, of the lengths at hand.
const FURTHEST_BACK: f64 = 1.0 / (1 << 20) as f64;

/// The shear that turns a direction into the third axis.
#[derive(Clone, Copy)]
struct Shear {
    /// The direction's largest component, which becomes the last; z if neither.
    is_x: bool,
    is_y: bool,
    x: f64,
    y: f64,
}

impl Shear {
    #[inline(always)]
    fn along(dir: DVec3) -> Self {
        let size = dir.abs();
        let is_x = size.x > size.y && size.x > size.z;
        let is_y = !is_x && size.y > size.z;
        let d = permuted(dir, is_x, is_y);
        Self { is_x, is_y, x: d.x / d.z, y: d.y / d.z }
    }

    /// The place of `v` seen along the direction.
    #[inline(always)]
    fn project(&self, v: DVec3) -> DVec2 {
        let v = permuted(v, self.is_x, self.is_y);
        DVec2::new((-self.x).mul_add(v.z, v.x), (-self.y).mul_add(v.z, v.y))
    }
}

/// `v` with its components turned so that the chosen one comes last.
#[inline(always)]
fn permuted(v: DVec3, is_x: bool, is_y: bool) -> DVec3 {
    let pick = |x: f64, y: f64, z: f64| {
        if is_x {
            x
        } else if is_y {
            y
        } else {
            z
        }
    };
    DVec3::new(pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z))
}

/// Whether the line of a ray passes within a convex outline of corners that are given in turn.
#[derive(Clone, Copy)]
struct Outline {
    shear: Shear,
    origin: DVec3,
    last: DVec2,
    left: bool,
    right: bool,
}

impl Outline {
    #[inline(always)]
    fn new(origin: DVec3, dir: DVec3, last: DVec3) -> Self {
        let shear = Shear::along(dir);
        Self { shear, origin, last: shear.project(last - origin), left: false, right: false }
    }

    /// Takes the edge from the last corner to the next.
    #[inline(always)]
    fn next(&mut self, corner: DVec3) {
        let (last, next) = (self.last, self.shear.project(corner - self.origin));
        let side = difference_of_products(last.x, next.y, last.y, next.x);
        self.left |= !(side >= 0.0); // NaN is both, and so a miss
        self.right |= !(side <= 0.0);
        self.last = next;
    }

    /// Not if it is on different sides of two edges, or the outline is seen edge-on.
    #[inline(always)]
    fn is_passed(&self) -> bool {
        self.left != self.right
    }
}

/// Where a line meets the plane through `vertex` square to `normal`; NaN if it is in it: a closed surface has other
/// faces to be hit there.
#[inline(always)]
pub(super) fn parameter(vertex: DVec3, normal: DVec3, origin: DVec3, dir: DVec3) -> f64 {
    let t = fused_dot(normal, vertex - origin) / fused_dot(normal, dir);
    if t.is_finite() { t } else { f64::NAN }
}

/// Whether a ray runs so nearly within a plane that rounding may have moved their crossing far along it.
///
/// What the leaves of the tree call certain is not: there the sine of the angle is 2⁻¹⁹ at least.
#[inline(always)]
fn is_grazing(normal: DVec3, dir: DVec3) -> bool {
    const SINE: f64 = 1.0 / (1 << 21) as f64;
    // True on NaN.
    !(fused_dot(normal, dir).abs() >= SINE * (largest(normal) * largest(dir)))
}

/// The parameter, of those at which the line of a ray is in the box about `vertices`, that is nearest to `t`; NaN if that is.
///
/// So a crossing that rounding has moved is still one with the shape, and whoever looks for it by boxes finds it.
#[cold]
fn within(vertices: &[DVec3], origin: DVec3, dir: DVec3, t: f64) -> f64 {
    if t.is_nan() {
        return t;
    }
    let Bounds { min, max } = Bounds::of_points(vertices.iter().copied());
    let (mut enter, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in (0..3).filter(|axis| dir[*axis] != 0.0) {
        let [a, b] = [min, max].map(|corner| (corner[axis] - origin[axis]) / dir[axis]);
        enter = enter.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    // Where it touches the box, rounding may leave no room.
    t.max(enter.min(exit)).min(exit.max(enter))
}

/// The crossing of the line of `ray` with the convex polygon of `vertices`, whose plane is square to `normal`.
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
    let mut outline = Outline::new(ray.origin, ray.dir, vertices[vertices.len() - 1]);
    for vertex in vertices {
        outline.next(*vertex);
    }
    if !outline.is_passed() {
        return Crossing::NONE;
    }
    let normal = normal();
    let t = parameter(vertices[0], normal, ray.origin, ray.dir);
    if is_grazing(normal, ray.dir) {
        return Crossing::at(within(vertices, ray.origin, ray.dir, t));
    }
    Crossing::at(t)
}

/// The same, to the bit, for some `lanes` of rays: the parameters, or NaN, and no second ones.
#[inline(always)]
pub(super) fn cross_lanes<const N: usize>(
    vertices: &[DVec3; N],
    normal: DVec3,
    rays: &RayLanes,
    lanes: Range<usize>,
    [first, second]: &mut [Column; 2],
) {
    let vertices = *vertices;
    let mut grazing = [0_u64; LANES];
    let lanes = lanes.start.min(LANES)..lanes.end.min(LANES);
    for k in lanes.clone() {
        let (origin, dir) = (rays.origin.get(k), rays.dir.get(k));
        let mut outline = Outline::new(origin, dir, vertices[N - 1]);
        for vertex in &vertices {
            outline.next(*vertex);
        }
        let t = parameter(vertices[0], normal, origin, dir);
        first[k] = if outline.is_passed() { t } else { f64::NAN };
        second[k] = f64::NAN;
        grazing[k] = u64::from(is_grazing(normal, dir));
    }
    if lanes.clone().fold(0, |any, k| any | grazing[k]) != 0 {
        for k in lanes.filter(|k| grazing[*k] != 0) {
            let (origin, dir) = (rays.origin.get(k), rays.dir.get(k));
            first[k] = within(&vertices, origin, dir, first[k]);
        }
    }
}

/// The surface of the plane through `vertex` square to the unit vector `normal`, where the ray along `dir` from
/// `origin` meets it at `t`; `rest` is what rounding took from the origin. Without a branch, for loops over lanes.
#[inline(always)]
pub(super) fn surface(
    (vertex, normal): (DVec3, DVec3),
    origin: DVec3,
    dir: DVec3,
    t: f64,
    rest: DVec3,
) -> Surface {
    let (near, near_rest) = sum(origin, dir * t + rest);
    let (away, away_rest) = sum(near, -vertex);
    let height = math::dot(normal, away) + fused_dot(normal, away_rest + near_rest);
    // Back into the plane along the ray, where the exact point is.
    let back = height / math::dot(normal, dir);
    let (back, straight) = (dir * back, normal * height);
    // Unless the ray is in the plane but for rounding; false on NaN.
    let is_near = largest(back) <= FURTHEST_BACK * (largest(dir * t) + largest(away));
    let pick = |x: f64, y: f64| if is_near { x } else { y };
    let back =
        DVec3::new(pick(back.x, straight.x), pick(back.y, straight.y), pick(back.z, straight.z));
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
