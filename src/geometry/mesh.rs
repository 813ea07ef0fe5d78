//! Triangle meshes: corners shared by index, with normals, surface coordinates and tints interpolated between them.
//!
//! A mesh keeps its corners exactly as given, in double precision; twelve bytes of indices make a triangle. The
//! triangles are met by the watertight test of [`flat`], so no ray slips between two that share an edge, whether
//! they share it by index or by equal coordinates.
//!
//! **Smooth shading.** A corner may have a normal. What is hit, and from which side, is decided by the flat triangle
//! alone; the interpolated normal ([`Surface::shading`]) only bends the light. Near the terminator the flat
//! triangles would shadow each other in steps, so shadow rays start on the curved surface that the normals describe
//! (`Face::shadow_offset`).
//!
//! Source: Hanika, "Hacking the Shadow Terminator", *Ray Tracing Gems II* (2021), ch. 4.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use thiserror::Error;

use super::{
    Bounds, Similarity, flat,
    hit::{Crossing, Crossings, Surface},
    ray::Ray,
};
use crate::math::{cross, scale};

/// Corners, and triangles between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    attributes: Attributes,
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
        (0..self.triangles.len() as u32).map(|index| Face { mesh: Arc::clone(self), index })
    }

    #[inline(always)]
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
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

/// The cross product of two edges, scaled so that it is zero only if the corners lie on one line.
#[inline(always)]
fn doubled_area(&[a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let area = cross(u, v);
    // Squares of tiny lengths vanish; those of ordinary ones need no scaling.
    if area.abs().max_element() > 1e-250 && area.is_finite() {
        area
    } else {
        cross(scale::normalized(u).0, scale::normalized(v).0)
    }
}

/// A triangle of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    mesh: Arc<Mesh>,
    index: u32,
}

impl Face {
    /// The mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// The triangle of the mesh, counted from 0.
    pub fn index(&self) -> u32 {
        self.index
    }

    /// The corners, counterclockwise seen from the front.
    #[inline(always)]
    pub fn vertices(&self) -> [DVec3; 3] {
        self.mesh.corners(self.index)
    }

    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_points(self.vertices())
    }

    /// The face alone, in a mesh of its own.
    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        let corners = self.mesh.triangles[self.index as usize].map(|v| v as usize);
        let Attributes { normals, uvs, tints } = &self.mesh.attributes;
        let attributes = Attributes {
            normals: picked(normals, corners),
            uvs: picked(uvs, corners),
            tints: picked(tints, corners),
        };
        let vertices = self.vertices().map(|v| map.point(v)).into();
        let mesh = Mesh { vertices, triangles: vec![[0, 1, 2]], attributes };
        Self { mesh: Arc::new(mesh), index: 0 }
    }

    /// The crossing of the line of `ray`.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let corners = self.vertices();
        [flat::crossing_of(&corners, || doubled_area(&corners), ray), Crossing::NONE]
    }

    pub(crate) fn surface(&self, ray: &Ray, t: f64, rest: DVec3) -> Surface {
        let corners = self.vertices();
        let normal = doubled_area(&corners);
        let normal = scale::normalized(normal).0.normalize();
        let mut surface = flat::surface((corners[0], normal), ray.origin, ray.dir, t, rest);
        let Attributes { normals, uvs, tints } = &self.mesh.attributes;
        if normals.is_empty() && uvs.is_empty() && tints.is_empty() {
            return surface;
        }
        let weights = barycentric(&corners, normal, surface.point);
        let index = self.mesh.triangles[self.index as usize].map(|v| v as usize);
        if let Some(shading) = self.corner_normals().and_then(|n| mix(n, weights).try_normalize()) {
            surface.shading = shading;
        }
        if !uvs.is_empty() {
            let [a, b, c] = index.map(|v| uvs[v].as_dvec2());
            surface.uv = a * weights.x + b * weights.y + c * weights.z;
        }
        if !tints.is_empty() {
            surface.tint = mix(index.map(|v| tints[v].as_dvec3()), weights).as_vec3();
        }
        surface
    }

    /// The normals at the corners, unless the face is flat.
    fn corner_normals(&self) -> Option<[DVec3; 3]> {
        let normals = &self.mesh.attributes.normals;
        if normals.is_empty() {
            return None;
        }
        let normals = self.mesh.triangles[self.index as usize].map(|v| normals[v as usize]);
        (!normals.contains(&Vec3::ZERO)).then(|| normals.map(glam::Vec3::as_dvec3))
    }

    /// How far the curved surface that the normals describe is from the flat one at `surface`, on the side of its
    /// normal or, with `inward`, on the other; zero for a flat face and where the surface is hollow.
    pub(crate) fn shadow_offset(&self, surface: &Surface, inward: bool) -> DVec3 {
        let Some(normals) = self.corner_normals() else {
            return DVec3::ZERO;
        };
        let corners = self.vertices();
        let weights = barycentric(&corners, surface.normal, surface.point).to_array();
        let side = if inward { -1.0 } else { 1.0 };
        let mut offset = DVec3::ZERO;
        for k in 0..3 {
            let depth = (side * normals[k].dot(surface.point - corners[k])).min(0.0);
            offset -= normals[k] * (side * depth * weights[k]);
        }
        if side * offset.dot(surface.normal) > 0.0 { offset } else { DVec3::ZERO }
    }

    /// Whether the face has normals at its corners.
    pub fn is_smooth(&self) -> bool {
        self.corner_normals().is_some()
    }

    /// Whether the mesh has surface coordinates.
    pub fn has_uv(&self) -> bool {
        !self.mesh.attributes.uvs.is_empty()
    }
}

fn picked<T: Copy>(list: &[T], corners: [usize; 3]) -> Vec<T> {
    if list.is_empty() { Vec::new() } else { corners.map(|v| list[v]).into() }
}

#[inline(always)]
fn mix([a, b, c]: [DVec3; 3], weights: DVec3) -> DVec3 {
    a * weights.x + b * weights.y + c * weights.z
}

/// The weights of the corners at a point of the triangle's plane; never negative, and 1 together.
fn barycentric(&[a, b, c]: &[DVec3; 3], normal: DVec3, p: DVec3) -> DVec3 {
    let part = |q: DVec3, r: DVec3| normal.dot(cross(q - p, r - p)).max(0.0);
    let weights = DVec3::new(part(b, c), part(c, a), part(a, b));
    let sum = weights.element_sum();
    if sum > 0.0 { weights / sum } else { DVec3::splat(1.0 / 3.0) } // too small to tell
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::Shape;

    fn one_face(attributes: Attributes) -> Face {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = Mesh::try_new(vertices, vec![[0, 1, 2]], attributes).expect("a mesh");
        Arc::new(mesh).faces().next().expect("one face")
    }

    #[test]
    fn a_shape_stays_small() {
        assert_eq!((size_of::<Shape>(), size_of::<Face>()), (40, 16));
    }

    /// Oracle: attributes that are a linear function of the place.
    #[test]
    fn attributes_are_interpolated() {
        let uvs = vec![Vec2::new(1.0, 2.0), Vec2::new(3.0, 2.0), Vec2::new(1.0, 6.0)];
        let tints = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let face = one_face(Attributes { uvs, tints, normals: Vec::new() });
        let ray = Ray::new(DVec3::new(0.25, 0.5, 3.0), DVec3::NEG_Z);
        let surface = face.surface(&ray, face.crossings(&ray)[0].t, DVec3::ZERO);
        assert!((surface.uv - DVec2::new(1.5, 4.0)).length() < 1e-15, "{}", surface.uv);
        assert!((surface.tint - Vec3::new(0.25, 0.5, 0.0)).length() < 1e-7, "{}", surface.tint);
        assert_eq!((surface.normal, surface.shading), (DVec3::Z, DVec3::Z));
    }

    /// Oracle: on a facet of a sphere the curved surface is the sphere, up to terms of third order.
    #[test]
    fn shadow_rays_start_on_the_curved_surface() {
        let angle = 0.2_f64;
        let on_sphere = |k: f64| {
            let turn = k * std::f64::consts::TAU / 3.0;
            DVec3::new(angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos())
        };
        let vertices: Vec<DVec3> = (0..3).map(|k| on_sphere(f64::from(k))).collect();
        let normals = vertices.iter().map(|v| v.as_vec3()).collect();
        let attributes = Attributes { normals, ..Attributes::default() };
        let mesh = Mesh::try_new(vertices, vec![[0, 1, 2]], attributes).expect("a mesh");
        let face = Arc::new(mesh).faces().next().expect("one face");
        let ray = Ray::new(DVec3::new(0.01, 0.02, 5.0), DVec3::NEG_Z);
        let surface = face.surface(&ray, face.crossings(&ray)[0].t, DVec3::ZERO);
        let lifted = surface.point + face.shadow_offset(&surface, false);
        let sagitta = 1.0 - surface.point.length();
        assert!(sagitta > 0.01 && lifted.length() >= 1.0 - 0.1 * sagitta, "{}", lifted.length());
        assert_eq!(face.shadow_offset(&surface, true), DVec3::ZERO); // seen from within it is hollow
    }

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
