//! Triangle meshes: corners shared by index, with normals, surface coordinates and tints interpolated between them.
//!
//! A mesh keeps its corners exactly as given, in double precision; twelve bytes of indices make a triangle. The
//! triangles are met by the watertight test of [`flat`](super::flat), so no ray slips between two that share an edge,
//! whether they share it by index or by equal coordinates.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use thiserror::Error;

use super::{Bounds, Face, Similarity, triangle::doubled_area};

/// Corners, and triangles between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub(super) vertices: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) attributes: Attributes,
}

/// What is interpolated between the corners of a mesh. Each list is empty, or has an entry for every vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Unit normals; a triangle with a zero vector at one of its corners is flat.
    pub normals: Vec<Vec3>,
    /// Surface coordinates, from the lower left.
    pub uvs: Vec<Vec2>,
    /// What multiplies the colour of the surface, channel by channel.
    pub tints: Vec<Vec3>,
}

/// Why a mesh cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} of the mesh is ({value}), but must be finite (vertices count from 0)")]
    NotFinite {
        /// The vertex, counted from 0.
        vertex: usize,
        /// Its value.
        value: DVec3,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} of the mesh uses vertex {vertex} of {count} (all count from 0)")]
    NoSuchVertex {
        /// The triangle, counted from 0.
        triangle: usize,
        /// The vertex.
        vertex: u32,
        /// How many there are.
        count: usize,
    },
    /// A triangle has no area.
    #[error("triangle {triangle} of the mesh has no area (triangles count from 0)")]
    NoArea {
        /// The triangle, counted from 0.
        triangle: usize,
    },
    /// A list of attributes does not fit the vertices.
    #[error("the mesh has {count} {name} for {vertices} vertices")]
    Attributes {
        /// The attribute.
        name: &'static str,
        /// How many there are.
        count: usize,
        /// How many vertices there are.
        vertices: usize,
    },
}

impl Mesh {
    /// The mesh of these vertices and triangles, which face where their corners run counterclockwise.
    ///
    /// # Errors
    /// Coordinates that are not finite, indices of no vertex, triangles without area, attributes that do not fit.
    pub fn try_new(
        vertices: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        attributes: Attributes,
    ) -> Result<Self, MeshError> {
        for (name, count) in [
            ("normals", attributes.normals.len()),
            ("surface coordinates", attributes.uvs.len()),
            ("tints", attributes.tints.len()),
        ] {
            if count != 0 && count != vertices.len() {
                return Err(MeshError::Attributes { name, count, vertices: vertices.len() });
            }
        }
        if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(MeshError::NotFinite { vertex, value: vertices[vertex] });
        }
        let mesh = Self { vertices, triangles, attributes };
        for (corners, triangle) in mesh.triangles.iter().zip(0..) {
            let count = mesh.vertices.len();
            if let Some(&vertex) = corners.iter().find(|v| **v as usize >= count) {
                return Err(MeshError::NoSuchVertex { triangle, vertex, count });
            }
            if !has_area(&corners.map(|v| mesh.vertices[v as usize])) {
                return Err(MeshError::NoArea { triangle });
            }
        }
        Ok(mesh)
    }

    /// The vertices.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The triangles, as places in the vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// What is interpolated between the vertices.
    pub fn attributes(&self) -> &Attributes {
        &self.attributes
    }

    /// The smallest box about the vertices.
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.vertices.iter().copied())
    }

    /// The memory of vertices, attributes and indices, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.vertices.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.attributes.normals.as_slice())
            + size_of_val(self.attributes.uvs.as_slice())
            + size_of_val(self.attributes.tints.as_slice())
    }

    pub(crate) fn mapped(mut self, map: &Similarity) -> Self {
        for v in &mut self.vertices {
            *v = map.point(*v);
        }
        self
    }

    /// The mesh with every vertex moved by `place`, and every normal turned by `turn`.
    pub(crate) fn placed(
        mut self,
        place: impl Fn(DVec3) -> DVec3,
        turn: impl Fn(DVec3) -> DVec3,
    ) -> Self {
        for v in &mut self.vertices {
            *v = place(*v);
        }
        for n in &mut self.attributes.normals {
            *n = turn(n.as_dvec3()).as_vec3();
        }
        self
    }

    /// The faces of a mesh, one for each triangle.
    pub fn faces(self: &Arc<Self>) -> impl ExactSizeIterator<Item = Face> {
        (0..self.triangles.len() as u32).map(|index| Face::new(Arc::clone(self), index))
    }

    #[inline(always)]
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }
}

/// Whether three finite points span an area at all, however small.
pub fn has_area(corners: &[DVec3; 3]) -> bool {
    // Nearly always the plain cross product is far above its rounding.
    let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
    let (plain, sizes) = (u.cross(v).abs(), u.abs().max_element() * v.abs().max_element());
    plain.max_element() > 1e-12 * sizes && sizes > 1e-250 || doubled_area(corners) != DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_meshes_are_refused() {
        let v = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 2.0];
        let mesh = |t, a| Mesh::try_new(v.clone(), vec![t], a).map(|_| ());
        let none = Attributes::default;
        assert!(matches!(mesh([0, 1, 4], none()), Err(MeshError::NoSuchVertex { vertex: 4, .. })));
        assert!(matches!(mesh([0, 1, 3], none()), Err(MeshError::NoArea { triangle: 0 })));
        let short = Attributes { uvs: vec![Vec2::ZERO], ..none() };
        assert!(matches!(mesh([0, 1, 2], short), Err(MeshError::Attributes { count: 1, .. })));
        let nan = Mesh::try_new(vec![DVec3::NAN], Vec::new(), none());
        assert!(matches!(nan, Err(MeshError::NotFinite { vertex: 0, .. })));
        assert!(has_area(&[DVec3::ZERO, DVec3::X * 1e-200, DVec3::Y * 1e-200]));
    }
}
