//! Rays and the shapes they meet: bounds, crossings, and the point, normal and error bound of a hit.
//!
//! Everything is in double precision and free of any epsilon: what decides a hit is a quantity whose sign is
//! right up to a few roundings of the inputs, and a ray that leaves a surface knows which one it leaves
//! ([`Departure`]), so that surface is not hit again by accident.
//!
//! The shapes' own methods expect lengths of ordinary size, as a [scene](crate::scene) normalises them.
//! [`Shape::first_hit`] takes a ray and a shape of any scale.

pub mod bounds;
mod brick;
pub mod cone;
pub mod cylinder;
pub mod face;
pub mod flat;
pub mod hit;
pub mod inward;
pub mod lanes;
pub mod mesh;
pub mod polygon;
pub mod quad;
pub mod ray;
pub mod refract;
pub mod shape;
pub mod shape_error;
pub mod similarity;
mod solid;
pub mod sphere;
pub mod tetrahedron;
pub mod triangle;
pub mod triangulate;
mod unit_cone;

pub use bounds::Bounds;
pub(crate) use brick::Brick;
pub use cone::Cone;
pub use cylinder::Cylinder;
pub use face::Face;
pub use hit::{Crossing, Crossings, Hit, Surface};
pub use inward::Inward;
pub use mesh::{Mesh, MeshError};
pub use polygon::Polygon;
pub use quad::Quad;
pub use ray::{Departure, Ray};
pub use refract::{reflect, refract};
pub use shape::Shape;
pub use shape_error::ShapeError;
pub use similarity::Similarity;
pub use sphere::Sphere;
pub use triangle::Triangle;

/// Whether a cylinder or cone is closed by flat ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ends {
    /// Side only: a ray may pass through the ends and meet the side from within.
    Open,
    /// Closed by discs, a solid.
    Closed,
}
