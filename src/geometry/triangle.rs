//! The triangle; its front is where its corners run counterclockwise.

use std::ops::Range;

use glam::DVec3;

use super::{
    Bounds, Similarity, flat,
    hit::{Crossing, Crossings, Surface},
    lanes::{Column, RayLanes, Vectors},
    ray::Ray,
    shape_error::ShapeError,
};
use crate::math::{cross, scale};

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
        [crossing(&self.vertices, ray), Crossing::NONE]
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

/// The crossing of the line of `ray` with the triangle between `corners`.
#[inline(always)]
pub(crate) fn crossing(corners: &[DVec3; 3], ray: &Ray) -> Crossing {
    flat::crossing_of(corners, || doubled_area(corners), ray)
}

/// The plane of a triangle, which is all that counts of one that is known to be crossed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) vertex: DVec3,
    area: DVec3,
}

impl Plane {
    /// The plane of the triangle between `corners`.
    #[inline(always)]
    pub(crate) fn through(corners: &[DVec3; 3]) -> Self {
        Self { vertex: corners[0], area: doubled_area(corners) }
    }

    /// The parameter of [`crossing`], to the bit, of a ray that is known to cross the triangle.
    #[inline(always)]
    pub(crate) fn parameter(&self, origin: DVec3, dir: DVec3) -> f64 {
        flat::parameter(self.vertex, self.area, origin, dir)
    }
}

/// Planes of triangles side by side that are known to be crossed by the rays in their lanes.
pub(crate) struct PlaneLanes {
    vertex: Vectors,
    area: Vectors,
}

impl PlaneLanes {
    pub(crate) const NONE: Self = Self { vertex: Vectors::ZERO, area: Vectors::ZERO };

    /// Puts a plane into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, plane: &Plane) {
        self.vertex.set(lane, plane.vertex);
        self.area.set(lane, plane.area);
    }

    /// [`Plane::parameter`] in a lane.
    #[inline(always)]
    pub(crate) fn parameter(&self, lane: usize, rays: &RayLanes) -> f64 {
        let (origin, dir) = (rays.origin.get(lane), rays.dir.get(lane));
        flat::parameter(self.vertex.get(lane), self.area.get(lane), origin, dir)
    }
}

/// As [`Triangle::crossings`], to the bit, for some `lanes` of rays: the parameters, or NaN, and no second ones.
#[inline(always)]
pub(crate) fn cross_lanes(
    corners: &[DVec3; 3],
    rays: &RayLanes,
    lanes: Range<usize>,
    crossed: &mut [Column; 2],
) {
    flat::cross_lanes(corners, doubled_area(corners), rays, lanes, crossed);
}

/// The cross product of two edges, scaled so that it is zero only if the corners lie on one line.
#[inline(always)]
pub(super) fn doubled_area(&[a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let area = cross(u, v);
    // Squares of tiny lengths vanish; those of ordinary ones need no scaling.
    if area.abs().max_element() > 1e-250 && area.is_finite() {
        area
    } else {
        cross(scale::normalized(u).0, scale::normalized(v).0)
    }
}
