//! The parallelogram q + u e₁ + v e₂ with 0 ≤ u, v ≤ 1, which are its surface coordinates; its front is where e₁ × e₂
//! points.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::{
    Bounds, Similarity, flat,
    hit::{Crossing, Crossings, Surface},
    lanes::{Column, RayLanes},
    ray::Ray,
    shape_error::ShapeError,
};
use crate::math::{cross, scale};

/// A parallelogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    vertices: [DVec3; 4],
    normal: DVec3,
    /// The gradients of the surface coordinates.
    gradients: [DVec3; 2],
}

impl Quad {
    /// The parallelogram at `corner` with the edges `edge1` and `edge2`.
    ///
    /// The other corners are rounded sums; where faces must share corners exactly, make them with
    /// [`Polygon`](super::Polygon).
    ///
    /// # Errors
    /// A corner or edges that are not finite, or edges on one line.
    pub fn try_new(corner: DVec3, edge1: DVec3, edge2: DVec3) -> Result<Self, ShapeError> {
        for (name, value) in [("corner", corner), ("edge1", edge1), ("edge2", edge2)] {
            ShapeError::check_point(name, value)?;
        }
        let vertices = [corner, corner + edge1, corner + edge1 + edge2, corner + edge2];
        Ok(Self::new(vertices, flat::unit_normal(&vertices)?))
    }

    /// The corners, counterclockwise seen from the front.
    pub fn vertices(&self) -> [DVec3; 4] {
        self.vertices
    }

    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_points(self.vertices)
    }

    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        Self::new(self.vertices.map(|v| map.point(v)), self.normal)
    }

    /// The crossing of the line of `ray`.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        [flat::crossing(&self.vertices, self.normal, ray), Crossing::NONE]
    }

    /// [`Shape::cross_lanes`](super::Shape::cross_lanes).
    #[inline(always)]
    pub(super) fn cross_lanes(
        &self,
        rays: &RayLanes,
        lanes: Range<usize>,
        crossed: &mut [Column; 2],
    ) {
        flat::cross_lanes(&self.vertices, self.normal, rays, lanes, crossed);
    }

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, t: f64, rest: DVec3) -> Surface {
        let surface = flat::surface(self.plane(), ray.origin, ray.dir, t, rest);
        Surface { uv: self.uv(surface.local), ..surface }
    }

    /// The surface coordinates of a point, seen from the corner.
    #[inline(always)]
    pub(super) fn uv(&self, local: DVec3) -> DVec2 {
        let [u, v] = self.gradients;
        DVec2::new(u.dot(local), v.dot(local))
    }

    /// [`Shape::uv_gradients`](super::Shape::uv_gradients).
    pub(super) fn uv_gradients(&self) -> [DVec3; 2] {
        self.gradients
    }

    /// A point of the plane, and its unit normal.
    #[inline(always)]
    pub(super) fn plane(&self) -> (DVec3, DVec3) {
        (self.vertices[0], self.normal)
    }

    /// By Cramer's rule, u = n·(s × e₂)/n·(e₁ × e₂) and v = n·(e₁ × s)/n·(e₁ × e₂) at s from the corner.
    fn new(vertices: [DVec3; 4], normal: DVec3) -> Self {
        let [corner, next, _, last] = vertices;
        // Each edge by itself brought to ordinary size, so that no product overflows.
        let ((edge1, scale1), (edge2, scale2)) =
            (scale::normalized(next - corner), scale::normalized(last - corner));
        let area = normal.dot(cross(edge1, edge2));
        // Edges that rounding has made parallel, at the end of the range of numbers, give no coordinates.
        let gradient = |v: DVec3, e: i32| {
            let v = scale::scaled(v / area, e);
            if v.is_finite() { v } else { DVec3::ZERO }
        };
        let u = gradient(cross(edge2, normal), scale1);
        let v = gradient(cross(normal, edge1), scale2);
        Self { vertices, normal, gradients: [u, v] }
    }
}
