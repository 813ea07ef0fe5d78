//! The parts of a scene, checked, in the coordinates of whoever described it.

use glam::{DMat3, DVec3};

use super::obj::{Model, ModelError};
use crate::{
    aa::AntiAliasing,
    camera::{Camera, CameraError},
    color::Rgb,
    geometry::{Bounds, Mesh, MeshError, Shape},
    light::Light,
    material::Material,
};

/// What a scene is made of.
#[derive(Debug)]
pub struct Parts {
    /// Width and height of the picture in pixels.
    pub resolution: [u32; 2],
    /// The deepest level of recursion.
    pub depth: u32,
    /// The weight in a sample below which a reflected or transmitted ray is not cast; 0 casts all.
    pub cutoff: f32,
    /// How pixels are sampled, if the scene says it.
    pub aa: Option<AntiAliasing>,
    /// Where it is seen from.
    pub camera: CameraPlan,
    /// Shapes other than the faces of meshes.
    pub shapes: Vec<Shape>,
    /// The material of each of them, as a place in `materials`.
    pub material_of: Vec<u32>,
    /// Meshes, whose faces are numbered after the shapes.
    pub meshes: Vec<MeshPart>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The lights.
    pub lights: Vec<Light>,
    /// The colour of a ray that hits nothing.
    pub background: Rgb,
}

/// A mesh in a scene.
#[derive(Debug)]
pub struct MeshPart {
    /// The mesh.
    pub mesh: Mesh,
    /// The material of each triangle, as a place in the materials of the scene.
    pub material_of: Vec<u32>,
}

/// A camera, before it is known to see anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPlan {
    /// Where it is.
    pub eye: DVec3,
    /// A point in the middle of the picture.
    pub look_at: DVec3,
    /// A direction that is up in the picture.
    pub up: DVec3,
    /// The angle between the picture's lower and upper edge, in degrees.
    pub vertical_fov: f64,
}

impl CameraPlan {
    /// The camera.
    ///
    /// # Errors
    /// It sees nothing.
    pub fn camera(&self) -> Result<Camera, CameraError> {
        Camera::try_new(self.eye, self.look_at, self.up, self.vertical_fov)
    }
}

/// Where a model goes: scaled, then turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// What its lengths are multiplied by.
    pub scale: f64,
    /// How it is turned about its origin.
    pub turn: DMat3,
    /// How far it is moved then.
    pub shift: DVec3,
}

impl Placement {
    /// Where it is already.
    pub const NONE: Self = Self { scale: 1.0, turn: DMat3::IDENTITY, shift: DVec3::ZERO };

    /// The place of a point of the model.
    pub fn point(&self, p: DVec3) -> DVec3 {
        let p = p * self.scale;
        (if self.turn == DMat3::IDENTITY { p } else { self.turn * p }) + self.shift
    }

    /// The mesh in its place.
    pub(super) fn placed(&self, mesh: Mesh) -> Mesh {
        if *self == Self::NONE {
            return mesh;
        }
        mesh.placed(|p| self.point(p), |n| self.turn * n)
    }

    /// Whether the model of the file `path` still has coordinates in its place.
    ///
    /// # Errors
    /// A vertex is beyond all numbers.
    pub(super) fn check(&self, path: &str, model: &Model) -> Result<(), ModelError> {
        let mut places = model.mesh.vertices().iter().map(|v| self.point(*v)).enumerate();
        match places.find(|(_, p)| !p.is_finite()) {
            None => Ok(()),
            Some((vertex, value)) => Err(ModelError::Mesh {
                path: path.to_owned(),
                source: MeshError::NotFinite { vertex, value },
            }),
        }
    }
}

impl Parts {
    /// The smallest box about everything.
    pub fn bounds(&self) -> Bounds {
        let meshes = self.meshes.iter().map(|part| part.mesh.bounds());
        let shapes = self.shapes.iter().map(Shape::bounds);
        shapes.chain(meshes).fold(Bounds::EMPTY, Bounds::union)
    }

    /// Adds a model with its materials.
    pub fn add_model(&mut self, model: Model, place: &Placement) {
        let base = self.materials.len() as u32;
        self.materials.extend(model.materials);
        let mesh = place.placed(model.mesh);
        let material_of = model.material_of.iter().map(|m| m + base).collect();
        self.meshes.push(MeshPart { mesh, material_of });
    }
}
