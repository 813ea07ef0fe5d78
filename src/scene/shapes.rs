//! From the descriptions of shapes to shapes.

use glam::DVec3;

use super::desc::{EndsDesc, ShapeDesc};
use crate::geometry::{
    Cone, Cylinder, Ends, Polygon, Quad, Shape, ShapeError, Sphere, Triangle, mesh::has_area,
    tetrahedron::tetrahedron, triangulate::Triangulator,
};

/// The shapes that one object is made of, and what the object is called.
pub(super) fn make_shapes(desc: &ShapeDesc) -> (&'static str, Result<Vec<Shape>, ShapeError>) {
    let v = DVec3::from_array;
    let one = |shape: Result<Shape, ShapeError>| shape.map(|shape| vec![shape]);
    let ends = |ends| match ends {
        EndsDesc::Open => Ends::Open,
        EndsDesc::Closed => Ends::Closed,
    };
    match desc {
        ShapeDesc::Sphere { center, radius } => {
            ("sphere", one(Sphere::try_new(v(*center), *radius).map(Shape::from)))
        }
        ShapeDesc::Cylinder { base, top, radius, ends: e } => (
            "cylinder",
            one(Cylinder::try_new(v(*base), v(*top), *radius, ends(*e)).map(Shape::from)),
        ),
        ShapeDesc::Cone { base, apex, radius, ends: e } => {
            ("cone", one(Cone::try_new(v(*base), v(*apex), *radius, ends(*e)).map(Shape::from)))
        }
        ShapeDesc::Quad { corner, edges: [edge1, edge2] } => {
            ("quad", one(Quad::try_new(v(*corner), v(*edge1), v(*edge2)).map(Shape::from)))
        }
        ShapeDesc::Triangle { vertices } => {
            ("triangle", one(Triangle::try_new(vertices.map(v)).map(Shape::from)))
        }
        ShapeDesc::Frustum { base, top, base_radius, top_radius } => (
            "frustum",
            one(Cone::truncated(v(*base), v(*top), *base_radius, *top_radius).map(Shape::from)),
        ),
        ShapeDesc::Polygon { vertices } => {
            let vertices: Vec<DVec3> = vertices.iter().copied().map(v).collect();
            let made = match Polygon::try_new(vertices.clone()) {
                Err(ShapeError::NotConvex { .. } | ShapeError::TurnsTwice) => cut(&vertices),
                made => one(made.map(Shape::from)),
            };
            ("polygon", made)
        }
        ShapeDesc::Tetrahedron { base_center, edge, turn } => {
            let planes = tetrahedron(v(*base_center), *edge, turn.to_radians());
            ("tetrahedron", planes.map(|planes| planes.map(Shape::from).into()))
        }
    }
}

/// The triangles of a flat polygon that is not convex.
fn cut(vertices: &[DVec3]) -> Result<Vec<Shape>, ShapeError> {
    let mut triangulator = Triangulator::default();
    let corners = |triangle: &[u32; 3]| triangle.map(|k| vertices[k as usize]);
    let triangles = triangulator.cut(vertices).iter().map(corners).filter(has_area);
    triangles.map(|corners| Triangle::try_new(corners).map(Shape::from)).collect()
}
