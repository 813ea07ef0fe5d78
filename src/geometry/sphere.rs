//! The sphere `|p − c|² = r²`; its surface coordinates are those of the normal seen along −z.

use glam::{DVec2, DVec3};

use super::{
    Bounds, Similarity,
    hit::{Crossing, Crossings, NO_CROSSINGS, Surface},
    ray::{Departure, Ray},
    shape::ShapeError,
};
use crate::math::{Roots, cross, scale};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Sphere {
    /// A sphere about `center`.
    ///
    /// # Errors
    /// A radius that is not positive and finite, or a centre that is not finite.
    pub fn try_new(center: DVec3, radius: f64) -> Result<Self, ShapeError> {
        ShapeError::check_point("center", center)?;
        ShapeError::check_length("radius", radius)?;
        Ok(Self { center, radius })
    }

    /// The centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    pub(crate) fn bounds(&self) -> Bounds {
        Bounds { min: self.center - self.radius, max: self.center + self.radius }
    }

    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        Self { center: map.point(self.center), radius: map.length(self.radius) }
    }

    /// The crossings of the line of `ray`.
    ///
    /// With f = o − c, |p − c|² = r² becomes (d·d)t² + 2(f·d)t + (f·f − r²) = 0. Its discriminant is taken as
    /// (r|d| − |f×d|)(r|d| + |f×d|), the gap between radius and line first, because b² − ac cancels for a
    /// small or distant sphere. The second root is c/q, never a difference.
    ///
    /// Source: Haines, Günther & Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", *Ray Tracing
    /// Gems* (2019), ch. 7; cross-product form.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let f = ray.origin - self.center;
        let a = ray.dir.length_squared();
        let (reach, offset) = (self.radius * a.sqrt(), cross(f, ray.dir).length());
        let gap = reach - offset;
        if !(gap >= 0.0) {
            return NO_CROSSINGS; // NaN is a miss
        }
        let b = f.dot(ray.dir);
        let distance = f.length();
        let c = (distance - self.radius) * (distance + self.radius);
        let (t0, t1) = Roots::new(a, b, c, (gap * (reach + offset)).sqrt()).sorted();
        [Crossing::at(t0), Crossing::at(t1)]
    }

    /// The crossings of a ray that leaves this sphere: none outward, and one inward, whose parameter −2b/a needs no
    /// subtraction.
    #[inline(always)]
    pub(crate) fn crossings_from(ray: &Ray, from: &Departure) -> Crossings {
        if !from.inward {
            return NO_CROSSINGS; // convex
        }
        let b = from.local.dot(ray.dir);
        // A chord of no length, of a ray that grazes, is still crossed.
        let t = (-2.0 * b / ray.dir.length_squared()).max(f64::MIN_POSITIVE);
        [Crossing::at(t), Crossing::NONE]
    }

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, t: f64, own: Option<&Departure>) -> Surface {
        let start = own.map_or(ray.origin - self.center, |from| from.local);
        let q = start + ray.dir * t;
        let normal = scale::unit(q).unwrap_or(DVec3::Y); // a sphere of no size in the scene
        let local = normal * self.radius;
        let point = self.center + local;
        let error = Surface::error_bound(normal, point.abs() + self.radius);
        let uv = DVec2::new(normal.x, normal.y) * 0.5 + 0.5;
        Surface { local, uv, ..Surface::plain(point, normal, error) }
    }
}
