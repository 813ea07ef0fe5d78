//! The triangle; its front is where its corners run counterclockwise.

use glam::DVec3;

use super::{
    Bounds, Similarity, flat,
    hit::{Crossing, Crossings, Surface},
    ray::Ray,
    shape::ShapeError,
};

/// A flat triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    vertices: [DVec3; 3],
    normal: DVec3,
}

impl Triangle {
    /// The triangle with these corners. Triangles with common corners leave no gap between them.
    ///
    /// # Errors
    /// Corners that are not finite, or on one line.
    pub fn try_new(vertices: [DVec3; 3]) -> Result<Self, ShapeError> {
        Ok(Self { vertices, normal: flat::unit_normal(&vertices)? })
    }

    /// The corners.
    pub fn vertices(&self) -> [DVec3; 3] {
        self.vertices
    }

    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_points(self.vertices)
    }

    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        Self { vertices: self.vertices.map(|v| map.point(v)), normal: self.normal }
    }

    /// The crossing of the line of `ray`.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        [flat::crossing(&self.vertices, self.normal, ray), Crossing::NONE]
    }

    /// The parameter of the crossing, or NaN.
    #[inline(always)]
    pub(super) fn parameter(&self, origin: DVec3, dir: DVec3) -> f64 {
        flat::crossing_parameter(&self.vertices, self.normal, origin, dir)
    }

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, t: f64, rest: DVec3) -> Surface {
        flat::surface(self.plane(), ray.origin, ray.dir, t, rest)
    }

    /// A point of the plane, and its unit normal.
    #[inline(always)]
    pub(super) fn plane(&self) -> (DVec3, DVec3) {
        (self.vertices[0], self.normal)
    }
}
