//! The convex polygon; its front is where its corners run counterclockwise.

use glam::DVec3;

use super::{
    Bounds, Similarity, flat,
    hit::{Crossing, Crossings, Surface},
    ray::Ray,
    shape_error::ShapeError,
};
use crate::math::UNIT_ROUNDOFF;

/// A flat convex polygon of three or more corners.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    vertices: Vec<DVec3>,
    normal: DVec3,
}

impl Polygon {
    /// The polygon with these corners. Polygons with common corners leave no gap between them.
    ///
    /// # Errors
    /// Fewer than three corners, corners that are not finite, on one line, not in one plane, or not convex; an outline
    /// that goes around as much to one side as to the other.
    pub fn try_new(vertices: Vec<DVec3>) -> Result<Self, ShapeError> {
        if vertices.len() < 3 {
            return Err(ShapeError::TooFewVertices { count: vertices.len() });
        }
        let normal = flat::unit_normal(&vertices).map_err(|error| {
            let has_area = vertices.windows(3).any(|corners| flat::unit_normal(corners).is_ok());
            if has_area { ShapeError::NoSide } else { error }
        })?;
        let polygon = Self { vertices, normal };
        let reach = polygon.bounds().largest_coordinate();
        polygon.mapped(&Similarity::scaling(reach)).check_outline()?;
        Ok(polygon)
    }

    /// Checks that the corners lie in one plane, up to the rounding of their coordinates, and turn one way round once.
    fn check_outline(&self) -> Result<(), ShapeError> {
        let Self { vertices, normal } = self;
        let corner = |k: usize| vertices[k % vertices.len()];
        let bounds = self.bounds();
        let rounding = 64.0 * UNIT_ROUNDOFF * (bounds.largest_coordinate() + bounds.size());
        let mut turned = 0.0;
        for k in 0..vertices.len() {
            if !(normal.dot(corner(k) - corner(0)).abs() <= rounding) {
                return Err(ShapeError::NotFlat { index: k });
            }
            let (e1, e2) = (corner(k + 1) - corner(k), corner(k + 2) - corner(k + 1));
            let turn = normal.dot(e1.cross(e2));
            if turn < -rounding * (e1.length() + e2.length()) {
                return Err(ShapeError::NotConvex { index: (k + 1) % vertices.len() });
            }
            turned += turn.atan2(e1.dot(e2));
        }
        // A convex outline turns once; a star turns more often.
        if turned < 1.5 * std::f64::consts::TAU { Ok(()) } else { Err(ShapeError::TurnsTwice) }
    }

    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_points(self.vertices.iter().copied())
    }

    /// The corners, counterclockwise seen from the front.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        Self {
            vertices: self.vertices.iter().map(|v| map.point(*v)).collect(),
            normal: self.normal,
        }
    }

    /// The crossing of the line of `ray`.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        [flat::crossing(&self.vertices, self.normal, ray), Crossing::NONE]
    }

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, t: f64, rest: DVec3) -> Surface {
        flat::surface((self.vertices[0], self.normal), ray.origin, ray.dir, t, rest)
    }
}
