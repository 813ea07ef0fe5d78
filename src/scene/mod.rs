//! A scene: what is seen, checked and ready to trace.
//!
//! A scene is traced in coordinates of its own, in which it has a radius of about 1. The change of coordinates
//! is exact ([`Similarity`]), so a scene looks the same at every scale. Callers of [`Scene::nearest`] and
//! [`Scene::is_occluded`] use the coordinates of the description.

pub mod builtin;
pub mod desc;
pub mod error;
pub mod generators;
pub mod load;
#[cfg(test)]
mod tests;

use std::{ops::ControlFlow, time::Instant};

pub use self::{
    builtin::{Builtin, builtins, load_builtin, load_builtin_of},
    desc::SceneDesc,
    error::SceneError,
};
use crate::{
    accel::Accel,
    camera::Camera,
    color::Rgb,
    geometry::{Bounds, Hit, Ray, Shape, Similarity, Surface},
    light::Light,
    material::Material,
};
use load::{ImageSource, Parts};

/// A scene, ready to trace.
#[derive(Debug)]
pub struct Scene {
    name: String,
    resolution: [u32; 2],
    depth: u32,
    map: Similarity,
    // The rest is in the scene's own coordinates.
    camera: Camera,
    background: Rgb,
    lights: Vec<Light>,
    materials: Vec<Material>,
    material_of: Vec<u32>,
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
        let parts = Parts::try_new(desc, images)?;
        Self::assemble(name, desc, parts)
    }

    /// The scene of `parts`; resolution, depth and camera are those of the description.
    fn assemble(name: &str, desc: &SceneDesc, parts: Parts) -> Result<Self, SceneError> {
        for (parameter, value) in
            [("resolution", desc.resolution[0].min(desc.resolution[1])), ("depth", desc.depth)]
        {
            if value == 0 {
                let place = "scene".to_owned();
                return Err(SceneError::Value {
                    place,
                    name: parameter,
                    value: 0.0,
                    range: "at least 1",
                });
            }
        }
        let desc_camera = &desc.camera;
        let [eye, look_at, up] =
            [desc_camera.eye, desc_camera.look_at, desc_camera.up].map(glam::DVec3::from_array);
        let camera = Camera::try_new(eye, look_at, up, desc_camera.vertical_fov)?;
        let Parts { shapes, material_of, materials, lights, background } = parts;

        let bounds = shapes.iter().fold(Bounds::EMPTY, |b, s| b.union(s.bounds()));
        let mut points = Vec::new();
        for shape in &shapes {
            shape.for_each_point(|p| points.push(p));
        }
        let map = Similarity::normalizing(&bounds, points.into_iter());
        let shapes = shapes.iter().map(|shape| shape.mapped(&map)).collect();
        let building = Instant::now();
        let accel = Accel::build(shapes);
        Ok(Self {
            name: name.to_owned(),
            resolution: desc.resolution,
            depth: desc.depth,
            camera: camera.mapped(&map),
            background,
            lights: lights
                .iter()
                .map(|l| Light { position: map.point(l.position), ..*l })
                .collect(),
            materials: materials.into_iter().map(|m| m.mapped(&map)).collect(),
            material_of,
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
        Some((Hit { t: scale.apply(hit.t), ..hit }, surface))
    }

    /// Whether anything at all, transparent or not, is met with `0 < t < end`.
    pub fn is_occluded(&self, ray: &Ray, end: f64) -> bool {
        let (ray, scale) = self.map.ray(ray);
        self.accel.any_crossing(&ray, scale.revert(end), |_, _| ControlFlow::Break(()))
    }

    // What follows is in the scene's own coordinates.

    pub(crate) fn camera(&self) -> &Camera {
        &self.camera
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

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        self.shape(hit.primitive).surface(ray, hit)
    }

    pub(crate) fn material(&self, primitive: u32) -> &Material {
        &self.materials[self.material_of[primitive as usize] as usize]
    }
}
