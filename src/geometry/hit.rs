//! What a ray finds: crossings of one shape, the nearest hit, and the surface there.

use glam::{DVec2, DVec3, Vec3};

use super::ray::{Departure, Ray};
use crate::math::UNIT_ROUNDOFF;

/// A place where the line of a ray crosses a shape's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The ray's parameter; NaN where there is no crossing, so that every comparison with it is a miss.
    pub t: f64,
    /// The face, as in [`Hit::face`].
    pub face: u8,
}

impl Crossing {
    /// No crossing.
    pub const NONE: Self = Self { t: f64::NAN, face: 0 };

    /// A crossing of face 0.
    #[inline(always)]
    pub fn at(t: f64) -> Self {
        Self { t, face: 0 }
    }
}

/// The up to two crossings of a line with a shape, in ascending order of `t` (which may be negative).
pub type Crossings = [Crossing; 2];

/// No crossing at all.
pub(crate) const NO_CROSSINGS: Crossings = [Crossing::NONE; 2];

/// The first of `crossings` with `0 < t < end`.
#[inline(always)]
pub(crate) fn first_ahead(crossings: &Crossings, end: f64) -> Option<Crossing> {
    crossings.iter().find(|c| c.t > 0.0 && c.t < end).copied()
}

/// The nearest crossing of a ray with a set of primitives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray's parameter, in lengths of its direction.
    pub t: f64,
    /// Which primitive.
    pub primitive: u32,
    /// Which of its faces: 0 is the side, 1 the base and 2 the top of a cylinder or cone; else 0.
    pub face: u8,
}

/// A point of a surface, in full: what shading and the next ray need of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, in the coordinates of the ray.
    pub point: DVec3,
    /// What rounding took from `point`, where that is known (on flat shapes). A ray that bounces to and fro in small
    /// steps would lose as much of each, and always to the same side.
    pub point_rest: DVec3,
    /// The outward unit normal of the geometry there.
    pub normal: DVec3,
    /// The point in the primitive's own coordinates: about a sphere's centre, the middle of a cylinder's base, a cone's
    /// apex; turned so that the axis is y. A flat shape
    /// has the world's axes about its first corner.
    pub local: DVec3,
    /// How far `point` may be from the true surface along `normal`.
    pub error: f64,
    /// Surface coordinates from the lower left, for shapes that have them (sphere, quad, and a mesh that has some);
    /// else zero.
    pub uv: DVec2,
    /// The unit normal that light is bent by: `normal`, or that interpolated between the corners of a mesh. It has no
    /// say in which side of the surface a ray is on.
    pub shading: DVec3,
    /// What multiplies the material's colour, channel by channel: 1, or the tint of a mesh.
    pub tint: Vec3,
}

impl Surface {
    /// A point of a surface without coordinates of its own, shaded by its own normal.
    #[inline(always)]
    pub(crate) fn plain(point: DVec3, normal: DVec3, error: f64) -> Self {
        let (local, uv) = (point, DVec2::ZERO);
        let (shading, point_rest) = (normal, DVec3::ZERO);
        Self { point, point_rest, normal, local, error, uv, shading, tint: Vec3::ONE }
    }

    /// A bound of the distance along `normal` between a surface and a computed point on it, which lies within
    /// `lengths` (componentwise) of what it was computed from.
    ///
    /// Sixteen roundings of the lengths seen along the normal: a plane that is square to an axis is met exactly
    /// in that axis, however far away the point is in the others.
    ///
    /// Source: Pharr, Jakob & Humphreys, *Physically Based Rendering*, 4th ed. (2023), section 6.8.
    #[inline(always)]
    pub(crate) fn error_bound(normal: DVec3, lengths: DVec3) -> f64 {
        16.0 * UNIT_ROUNDOFF * normal.abs().dot(lengths)
    }

    /// Whether a ray along `dir` came here from the inside.
    #[inline(always)]
    pub fn is_met_from_inside(&self, dir: DVec3) -> bool {
        !(self.normal.dot(dir) < 0.0)
    }

    /// The point moved along the normal by the error bound to the outside or, with `inward`, to the inside.
    #[inline(always)]
    pub(crate) fn beside(&self, inward: bool) -> DVec3 {
        let offset = if inward { -self.error } else { self.error };
        self.point + self.normal * offset
    }

    /// The ray that leaves this point of `hit` along `dir`, to the outside or, with `inward`, to the inside.
    ///
    /// Its origin is moved along the normal to that side by the error bound, so that no other surface that touches
    /// here is met on the wrong side; its own surface is excluded by the [`Departure`].
    #[inline(always)]
    pub fn leave(&self, hit: &Hit, dir: DVec3, inward: bool) -> Ray {
        let origin = self.beside(inward);
        let from = Departure {
            primitive: hit.primitive,
            face: hit.face,
            inward,
            local: self.local,
            point: self.point,
            point_rest: self.point_rest,
        };
        Ray { origin, dir, from: Some(from) }
    }
}
