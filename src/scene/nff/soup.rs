//! Triangles on their way to a mesh.

use glam::{DVec3, Vec3};

use crate::{
    geometry::{
        Mesh, MeshError,
        mesh::{Attributes, has_area},
        triangulate::Triangulator,
    },
    math::scale::normalized,
    scene::parts::MeshPart,
};

/// Triangles that share the corners of the polygon that they were cut from, but none with other polygons.
#[derive(Debug, Default)]
pub(super) struct Soup {
    vertices: Vec<DVec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    material_of: Vec<u32>,
}

impl Soup {
    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Adds the triangles of a polygon, with normals at its corners if there are any; if none has an area, nothing, and
    /// false.
    pub(super) fn add(
        &mut self,
        corners: Vec<DVec3>,
        normals: &[DVec3],
        material: u32,
        triangulator: &mut Triangulator,
    ) -> bool {
        let start = self.vertices.len() as u32;
        let before = self.triangles.len();
        for triangle in triangulator.cut(&corners) {
            if has_area(&triangle.map(|k| corners[k as usize])) {
                self.triangles.push(triangle.map(|k| start + k));
                self.material_of.push(material);
            }
        }
        if self.triangles.len() == before {
            return false;
        }
        self.vertices.extend(corners);
        let unit = |normal: &DVec3| normalized(*normal).0.normalize_or_zero().as_vec3();
        self.normals.extend(normals.iter().map(unit));
        true
    }

    pub(super) fn mesh(self) -> Result<MeshPart, MeshError> {
        let attributes = Attributes { normals: self.normals, ..Attributes::default() };
        let mesh = Mesh::try_new(self.vertices, self.triangles, attributes)?;
        Ok(MeshPart { mesh, material_of: self.material_of })
    }
}
