//! The sphere `|p − c|² = r²`; its surface coordinates are those of the normal seen along −z.

use glam::{DVec2, DVec3};

use super::{
    Bounds, Similarity,
    hit::{Crossing, Crossings, NO_CROSSINGS, Surface},
    lanes::SurfaceLanes,
    ray::{Departure, Ray},
    shape_error::ShapeError,
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
        let (t0, t1) = self.parameters(ray.origin, ray.dir);
        [Crossing::at(t0), Crossing::at(t1)]
    }

    /// The parameters of the crossings, in ascending order; without a branch, for loops over lanes.
    #[inline(always)]
    pub(super) fn parameters(&self, origin: DVec3, dir: DVec3) -> (f64, f64) {
        let f = origin - self.center;
        let a = dir.length_squared();
        let (reach, offset) = (self.radius * a.sqrt(), cross(f, dir).length());
        let gap = reach - offset;
        let b = f.dot(dir);
        let distance = f.length();
        let c = (distance - self.radius) * (distance + self.radius);
        // A miss makes both parameters NaN.
        let discriminant = if gap >= 0.0 { gap * (reach + offset) } else { f64::NAN };
        Roots::new(a, b, c, discriminant.sqrt()).sorted()
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
        let surface = self.surface_at(start + ray.dir * t);
        Surface { uv: Self::uv(surface.normal), ..surface }
    }

    /// The surface in the direction `q` from the centre, without its own coordinates; and without a branch, for loops
    /// over lanes.
    #[inline(always)]
    pub(super) fn surface_at(&self, q: DVec3) -> Surface {
        let normal = scale::unit_or(q, DVec3::Y); // a sphere may have no size in the scene
        let local = normal * self.radius;
        let point = self.center + local;
        let error = Surface::error_bound(normal, point.abs() + self.radius);
        Surface { local, ..Surface::plain(point, normal, error) }
    }

    /// The surface of a lane that [`surface_at`](Self::surface_at) has filled, in full.
    #[inline(always)]
    pub(crate) fn surface_of_lane(&self, surfaces: &SurfaceLanes, lane: usize) -> Surface {
        let (normal, point) = (surfaces.shading(lane), surfaces.point.get(lane));
        let error = Surface::error_bound(normal, point.abs() + self.radius);
        Surface { local: surfaces.local.get(lane), ..Surface::plain(point, normal, error) }
    }

    /// [`Shape::uv_gradients`](super::Shape::uv_gradients).
    pub(super) fn uv_gradients(&self) -> [DVec3; 2] {
        [DVec3::X, DVec3::Y].map(|axis| axis / (2.0 * self.radius))
    }

    /// The surface coordinates where the normal is this.
    #[inline(always)]
    pub(super) fn uv(normal: DVec3) -> DVec2 {
        DVec2::new(normal.x, normal.y) * 0.5 + 0.5
    }
}
