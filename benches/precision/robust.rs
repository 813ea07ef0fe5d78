//! The library's tests in single precision, with the same names: each returns the first `t > 0`, or NaN.
//!
//! The formulas and their sources are those of `whitted::geometry`; cylinder and cone are upright and open.

use glam::{Vec2, Vec3};

#[inline(always)]
fn difference_of_products(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let cd = c * d;
    let error = (-c).mul_add(d, cd);
    a.mul_add(b, -cd) + error
}

#[inline(always)]
fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}

#[inline(always)]
fn two_product(a: f32, b: f32) -> (f32, f32) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

#[inline(always)]
fn two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// The dot product as if computed in twice the precision.
#[inline(always)]
fn exact_dot(a: Vec3, b: Vec3) -> f32 {
    let (p, error_p) = two_product(a.x, b.x);
    let (h, error_h) = two_product(a.y, b.y);
    let (s, error_s) = two_sum(p, h);
    let (k, error_k) = two_product(a.z, b.z);
    let (sum, error_sum) = two_sum(s, k);
    sum + ((error_p + (error_h + error_s)) + (error_k + error_sum))
}

#[inline(always)]
fn hypot(a: f32, b: f32) -> f32 {
    a.mul_add(a, b * b).sqrt()
}

/// The roots q/a and c/q of a t² + 2 b t + c.
#[inline(always)]
fn roots(a: f32, b: f32, c: f32, root_of_discriminant: f32) -> (f32, f32) {
    let q = -(b + root_of_discriminant.copysign(b));
    let stable = q / a;
    (stable, if q == 0.0 { stable } else { c / q })
}

#[inline(always)]
fn first(t0: f32, t1: f32, counts: impl Fn(f32) -> bool) -> f32 {
    let (near, far) = if t0 <= t1 { (t0, t1) } else { (t1, t0) };
    if near > 0.0 && counts(near) {
        near
    } else if far > 0.0 && counts(far) {
        far
    } else {
        f32::NAN
    }
}

pub(crate) struct Sphere {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
}

impl Sphere {
    #[inline(always)]
    pub(crate) fn test(&self, origin: Vec3, dir: Vec3) -> f32 {
        let f = origin - self.center;
        let a = dir.length_squared();
        let (reach, offset) = (self.radius * a.sqrt(), cross(f, dir).length());
        let gap = reach - offset;
        if !(gap >= 0.0) {
            return f32::NAN;
        }
        let distance = f.length();
        let c = (distance - self.radius) * (distance + self.radius);
        let (t0, t1) = roots(a, f.dot(dir), c, (gap * (reach + offset)).sqrt());
        first(t0, t1, |_| true)
    }
}

pub(crate) struct Cylinder {
    pub(crate) base: Vec3,
    pub(crate) height: f32,
    pub(crate) radius: f32,
}

impl Cylinder {
    #[inline(always)]
    pub(crate) fn test(&self, origin: Vec3, d: Vec3) -> f32 {
        let f = origin - self.base;
        let reach = self.radius * hypot(d.x, d.z);
        let offset = difference_of_products(f.x, d.z, f.z, d.x).abs();
        let gap = reach - offset;
        if !(gap >= 0.0) {
            return f32::NAN;
        }
        let a = d.x.mul_add(d.x, d.z * d.z);
        let b = f.x.mul_add(d.x, f.z * d.z);
        let distance = hypot(f.x, f.z);
        let c = (distance - self.radius) * (distance + self.radius);
        let (t0, t1) = roots(a, b, c, (gap * (reach + offset)).sqrt());
        first(t0, t1, |t| (0.0..=self.height).contains(&t.mul_add(d.y, f.y)))
    }
}

pub(crate) struct Cone {
    pub(crate) apex: Vec3,
    pub(crate) height: f32,
    pub(crate) radius: f32,
}

impl Cone {
    #[inline(always)]
    pub(crate) fn test(&self, origin: Vec3, dir: Vec3) -> f32 {
        let unit = |v: Vec3| Vec3::new(self.height * v.x, self.radius * v.y, self.height * v.z);
        let (f, e) = (unit(origin - self.apex), unit(dir));
        let p1 = difference_of_products(f.x, e.y, f.y, e.x);
        let p2 = difference_of_products(f.z, e.y, f.y, e.z);
        let w = difference_of_products(f.x, e.z, f.z, e.x).abs();
        let m = hypot(p1, p2);
        let flip = |v: Vec3| Vec3::new(v.x, -v.y, v.z);
        let a = exact_dot(flip(e), e);
        let gap = if a < 0.0 { (m - w).max(0.0) } else { m - w };
        if !(gap >= 0.0) {
            return f32::NAN;
        }
        let (b, c) = (exact_dot(flip(f), e), exact_dot(flip(f), f));
        let root = (gap * (m + w)).sqrt();
        let (t0, t1) = roots(a, b, c, root);
        let n = difference_of_products(e.x, p1, -e.z, p2);
        let s = e.y * root.copysign(b);
        let (stable, other) = (-n - s, s - n);
        let product = p1.mul_add(p1, p2 * p2);
        let apex = |y: f32| if y.is_nan() { 0.0 } else { y };
        let (y0, y1) = if stable.abs() >= other.abs() {
            (stable / a, apex(product / stable))
        } else {
            (apex(product / other), other / a)
        };
        let lowest = -self.radius * self.height;
        let valid = |t: f32, y: f32| if y <= 0.0 && y >= lowest && t > 0.0 { t } else { f32::NAN };
        valid(t0, y0).min(valid(t1, y1))
    }
}

/// The place of `v` seen along the direction, whose largest component comes last.
struct Shear {
    axis: u8,
    x: f32,
    y: f32,
}

impl Shear {
    #[inline(always)]
    fn along(dir: Vec3) -> Self {
        let size = dir.abs();
        let axis = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let d = Self::permuted(dir, axis);
        Self { axis, x: d.x / d.z, y: d.y / d.z }
    }

    #[inline(always)]
    fn permuted(v: Vec3, axis: u8) -> Vec3 {
        match axis {
            0 => Vec3::new(v.y, v.z, v.x),
            1 => Vec3::new(v.z, v.x, v.y),
            _ => v,
        }
    }

    #[inline(always)]
    fn project(&self, v: Vec3) -> Vec2 {
        let v = Self::permuted(v, self.axis);
        Vec2::new((-self.x).mul_add(v.z, v.x), (-self.y).mul_add(v.z, v.y))
    }
}

/// A quad or triangle: its corners and unit normal.
pub(crate) struct Flat<const N: usize> {
    pub(crate) vertices: [Vec3; N],
    pub(crate) normal: Vec3,
}

impl<const N: usize> Flat<N> {
    pub(crate) fn new(vertices: [Vec3; N]) -> Self {
        let area = cross(vertices[1] - vertices[0], vertices[N - 1] - vertices[0]);
        Self { vertices, normal: area.normalize() }
    }

    #[inline(always)]
    pub(crate) fn test(&self, origin: Vec3, dir: Vec3) -> f32 {
        let dot = |a: Vec3, b: Vec3| a.x.mul_add(b.x, a.y.mul_add(b.y, a.z * b.z));
        let shear = Shear::along(dir);
        let mut last = shear.project(self.vertices[N - 1] - origin);
        let (mut left, mut right) = (false, false);
        for vertex in self.vertices {
            let next = shear.project(vertex - origin);
            let side = difference_of_products(last.x, next.y, last.y, next.x);
            left |= !(side >= 0.0);
            right |= !(side <= 0.0);
            last = next;
        }
        if left == right {
            return f32::NAN;
        }
        let t = dot(self.normal, self.vertices[0] - origin) / dot(self.normal, dir);
        if t > 0.0 && t.is_finite() { t } else { f32::NAN }
    }
}
