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

/// The same, to the bit, for a triangle that is known to be crossed.
#[inline(always)]
pub(crate) fn certain_crossing(corners: &[DVec3; 3], ray: &Ray) -> Crossing {
    Crossing::at(flat::parameter(corners[0], doubled_area(corners), ray.origin, ray.dir))
}

/// Triangles side by side that are known to be crossed by the rays in their lanes.
pub(crate) struct CertainLanes {
    vertex: Vectors,
    area: Vectors,
}

impl CertainLanes {
    pub(crate) const NONE: Self = Self { vertex: Vectors::ZERO, area: Vectors::ZERO };

    /// Puts the triangle between `corners` into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, corners: &[DVec3; 3]) {
        self.vertex.set(lane, corners[0]);
        self.area.set(lane, doubled_area(corners));
    }

    /// The parameter of [`certain_crossing`] in a lane.
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
