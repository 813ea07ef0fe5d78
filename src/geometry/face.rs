//! One triangle of a mesh, with what is interpolated between its corners.
//!
//! **Smooth shading.** A corner may have a normal. What is hit, and from which side, is decided by the flat triangle
//! alone; the interpolated normal ([`Surface::shading`]) only bends the light. Near the terminator the flat
//! triangles would shadow each other in steps, so shadow rays start on the curved surface that the normals describe
//! (`Face::shadow_offset`).
//!
//! Source: Hanika, "Hacking the Shadow Terminator", *Ray Tracing Gems II* (2021), ch. 4.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::{
    Bounds, Similarity, flat,
    hit::{Crossing, Crossings, Surface},
    mesh::{Attributes, Mesh},
    ray::Ray,
    triangle::{self, doubled_area},
};
use crate::math::{cross, scale};

/// A triangle of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    mesh: Arc<Mesh>,
    index: u32,
}

impl Face {
    pub(super) fn new(mesh: Arc<Mesh>, index: u32) -> Self {
        Self { mesh, index }
    }

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
        [triangle::crossing(&self.vertices(), ray), Crossing::NONE]
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

    /// [`Shape::uv_gradients`](super::Shape::uv_gradients).
    pub(super) fn uv_gradients(&self) -> [DVec3; 2] {
        let uvs = &self.mesh.attributes.uvs;
        if uvs.is_empty() {
            return [DVec3::ZERO; 2];
        }
        let ([a, b, c], corners) = (self.vertices(), self.mesh.triangles[self.index as usize]);
        let [at_a, at_b, at_c] = corners.map(|v| uvs[v as usize].as_dvec2());
        let normal = (b - a).cross(c - a);
        // Of the weights of the second and third corner.
        let (second, third) = ((c - a).cross(normal), normal.cross(b - a));
        let (to_b, to_c) = (at_b - at_a, at_c - at_a);
        [[to_b.x, to_c.x], [to_b.y, to_c.y]]
            .map(|[to_b, to_c]| (second * to_b + third * to_c) / normal.length_squared())
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
    use glam::{DVec2, Vec2};

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
}
