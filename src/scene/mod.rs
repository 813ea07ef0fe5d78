//! A scene: what is seen, checked and ready to trace.
//!
//! A scene is traced in coordinates of its own, in which it has a radius of about 1. The change of coordinates
//! is exact ([`Similarity`]), so a scene looks the same at every scale. Callers of [`Scene::nearest`] and
//! [`Scene::is_occluded`] use the coordinates of the description.

pub mod builtin;
pub mod desc;
mod disjoint;
pub mod error;
pub mod format;
pub mod generators;
mod hash;
pub mod load;
pub mod nff;
pub mod obj;
pub mod open;
mod orbit;
mod parts;
mod pieces;
mod report;
mod shapes;
mod stage;
mod surfaces;
#[cfg(test)]
mod tests;
pub mod text;
mod values;
mod warning;

use std::{
    ops::ControlFlow,
    sync::{Arc, OnceLock},
    time::Instant,
};

pub use self::{
    builtin::{Builtin, builtins, load_builtin, load_builtin_of},
    desc::SceneDesc,
    error::SceneError,
    open::{LoadOptions, Loaded, ModelPlace, STANDARD_INPUT, load},
    orbit::Orbit,
    parts::{CameraPlan, MeshPart, Parts},
    report::{Names, SceneReport, inspect_scene},
    warning::Warning,
};
use crate::{
    aa::AntiAliasing,
    accel::{Accel, Isa, Preset},
    camera::Camera,
    color::Rgb,
    geometry::{Brick, Hit, Mesh, Ray, Shape, Similarity, Surface},
    light::Light,
    material::Material,
};
use load::ImageSource;

/// A scene, ready to trace.
#[derive(Debug)]
pub struct Scene {
    name: String,
    resolution: [u32; 2],
    depth: u32,
    cutoff: f32,
    map: Similarity,
    camera_plan: CameraPlan,
    // The rest is in the scene's own coordinates.
    aa: Option<AntiAliasing>,
    camera: Camera,
    background: Rgb,
    lights: Vec<Light>,
    materials: Vec<Material>,
    material_of: Vec<u32>,
    /// A bit for each primitive: whether nothing shines through. Rays towards lights ask it of any, and bits stay in the
    /// caches.
    opaque: Vec<u64>,
    meshes: Vec<Arc<Mesh>>,
    /// Of meshes and flat shapes; made when they are asked for.
    pieces: OnceLock<Vec<Brick>>,
    accel: Accel,
    build_seconds: f64,
}

/// What the arrangement of the primitives took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhStats {
    /// How many nodes the tree has.
    pub nodes: usize,
    /// The memory of tree and primitives.
    pub bytes: usize,
    /// The time to build it, in seconds.
    pub build_seconds: f64,
}

impl Scene {
    /// The scene of a description; `images` finds the pictures of its textures.
    ///
    /// # Errors
    /// What is wrong with the description.
    pub fn try_new(
        name: &str,
        desc: &SceneDesc,
        images: &mut ImageSource,
    ) -> Result<Self, SceneError> {
        Self::assemble(name, Parts::try_new(desc, images)?)
    }

    /// The scene of checked parts.
    ///
    /// # Errors
    /// A camera that sees nothing.
    pub fn assemble(name: &str, parts: Parts) -> Result<Self, SceneError> {
        let camera = parts.camera.camera()?;
        let bounds = parts.bounds();
        let mut points = Vec::new();
        for shape in &parts.shapes {
            shape.for_each_point(|p| points.push(p));
        }
        let on_meshes = parts.meshes.iter().flat_map(|part| part.mesh.vertices());
        let map = Similarity::normalizing(&bounds, points.into_iter().chain(on_meshes.copied()));
        let Parts { resolution, depth, shapes, mut material_of, materials, lights, .. } = parts;
        // In place: there may be gigabytes of them.
        let mut shapes: Vec<Shape> = shapes.into_iter().map(|shape| shape.mapped(&map)).collect();
        let mut meshes = Vec::new();
        for MeshPart { mesh, material_of: of_faces } in parts.meshes {
            let mesh = Arc::new(mesh.mapped(&map));
            shapes.extend(mesh.faces().map(Shape::from));
            material_of.extend(of_faces);
            meshes.push(mesh);
        }
        let opaque = bits(&material_of, |material| !materials[material as usize].is_transmissive());
        let building = Instant::now();
        let accel = Accel::build(shapes);
        Ok(Self {
            name: name.to_owned(),
            resolution,
            depth,
            cutoff: parts.cutoff,
            aa: parts.aa,
            camera_plan: parts.camera,
            camera: camera.mapped(&map),
            background: parts.background,
            lights: lights
                .iter()
                .map(|l| Light { position: map.point(l.position), ..*l })
                .collect(),
            materials: materials.into_iter().map(|m| m.mapped(&map)).collect(),
            material_of,
            opaque,
            meshes,
            pieces: OnceLock::new(),
            accel,
            build_seconds: building.elapsed().as_secs_f64(),
            map,
        })
    }

    /// The scene's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Width and height of the picture in pixels, unless the user wants others.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// The deepest level of recursion, unless the user wants another.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Where the scene is seen from, unless the user wants another place.
    pub fn camera_plan(&self) -> &CameraPlan {
        &self.camera_plan
    }

    /// How pixels are sampled, if the scene says it and the user does not.
    pub fn aa(&self) -> Option<AntiAliasing> {
        self.aa
    }

    /// Has rays traced by the instructions of `isa`, or the portable ones where the machine lacks them; the picture is
    /// the same.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        self.accel.set_isa(isa);
        self
    }

    /// Arranges the primitives anew, in the time that `preset` allows; the picture is the same.
    #[must_use]
    pub fn rebuilt(self, preset: Preset) -> Self {
        let isa = self.accel.isa();
        let shapes = self.accel.into_shapes();
        let building = Instant::now();
        let accel = Accel::with_preset(shapes, preset);
        let build_seconds = building.elapsed().as_secs_f64();
        Self { accel, build_seconds, ..self }.with_isa(isa)
    }

    /// The number of primitives.
    pub fn primitive_count(&self) -> usize {
        self.accel.len()
    }

    /// The number of lights.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// What the arrangement of the primitives took.
    pub fn bvh_stats(&self) -> BvhStats {
        let (nodes, bytes) = (self.accel.node_count(), self.accel.bytes());
        BvhStats { nodes, bytes, build_seconds: self.build_seconds }
    }

    /// The nearest hit of a ray, and the surface there.
    ///
    /// The direction may have any length; `t` counts it. A ray made by [`Surface::leave`] does not meet the surface
    /// that it leaves.
    pub fn nearest(&self, ray: &Ray) -> Option<(Hit, Surface)> {
        let (ray, scale) = self.map.ray(ray);
        let hit = self.accel.nearest(&ray, f64::INFINITY)?;
        let surface = self.map.surface_back(&self.surface(&ray, &hit));
        Some((Hit { t: scale.of_hit(hit.t), ..hit }, surface))
    }

    /// Whether anything at all, transparent or not, is met with `0 < t < end`.
    pub fn is_occluded(&self, ray: &Ray, end: f64) -> bool {
        let (ray, scale) = self.map.ray(ray);
        self.accel.any_crossing(&ray, scale.revert(end), |_, _| ControlFlow::Break(()))
    }

    /// The weight in a sample below which a reflected or transmitted ray is not cast; 0 casts all.
    pub fn cutoff(&self) -> f32 {
        self.cutoff
    }

    // What follows is in the scene's own coordinates.

    pub(crate) fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Another camera, which is given in the coordinates of the description.
    pub(crate) fn own_camera(&self, camera: Camera) -> Camera {
        camera.mapped(&self.map)
    }

    pub(crate) fn background(&self) -> Rgb {
        self.background
    }

    pub(crate) fn lights(&self) -> &[Light] {
        &self.lights
    }

    pub(crate) fn accel(&self) -> &Accel {
        &self.accel
    }

    pub(crate) fn shape(&self, primitive: u32) -> &Shape {
        self.accel.shape(primitive)
    }

    /// What hangs together of meshes and flat shapes, each piece in the brick about it.
    pub(crate) fn pieces(&self) -> &[Brick] {
        self.pieces.get_or_init(|| {
            let of_meshes = self.meshes.iter().flat_map(|mesh| pieces::of_mesh(mesh));
            let primitives = 0..self.primitive_count() as u32;
            let of_shapes = pieces::of_flat(primitives.map(|primitive| self.shape(primitive)));
            of_meshes.chain(of_shapes).collect()
        })
    }

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        self.shape(hit.primitive).surface(ray, hit)
    }

    /// Whether any material wears a picture.
    pub(crate) fn has_pictures(&self) -> bool {
        self.materials.iter().any(|material| material.texture.needs_uv())
    }

    /// Whether nothing shines through a primitive.
    #[inline(always)]
    pub(crate) fn is_opaque(&self, primitive: u32) -> bool {
        self.opaque[primitive as usize / 64] >> (primitive % 64) & 1 != 0
    }

    pub(crate) fn material(&self, primitive: u32) -> &Material {
        &self.materials[self.material_of[primitive as usize] as usize]
    }
}

/// A bit for each of `numbers`: whether it `is_one` of some.
fn bits(numbers: &[u32], is_one: impl Fn(u32) -> bool) -> Vec<u64> {
    let bit = |(k, number): (usize, &u32)| u64::from(is_one(*number)) << k;
    numbers
        .chunks(64)
        .map(|some| some.iter().enumerate().map(bit).fold(0, |all, bit| all | bit))
        .collect()
}
