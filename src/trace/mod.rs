//! Whitted's recursion: the light that comes back along a ray.
//!
//! The recursion is a work list of rays, each with the weight of its answer in the pixel and its level, so the call
//! stack stays flat however deep it goes.

pub mod refract;
pub mod shadow;

use std::ops::{Add, Sub};

use glam::DVec3;

use crate::{
    color::Rgb,
    geometry::{Hit, Ray, Surface},
    material::Material,
    scene::Scene,
    texture::TexturePoint,
};
use shadow::Shadows;

pub use refract::{reflect, refract};

/// How many rays of each kind were cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Rays from the camera.
    pub camera: u64,
    /// Rays in the mirror direction.
    pub reflected: u64,
    /// Rays bent by Snell's law.
    pub refracted: u64,
    /// Rays that go straight on through a body of index 1.
    pub transmitted: u64,
    /// Rays towards a light, one for each light and shaded hit that faces it.
    pub shadow: u64,
    /// Camera rays that hit anything.
    pub camera_hit: u64,
}

impl RayCounts {
    fn combine(self, other: Self, op: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            camera: op(self.camera, other.camera),
            reflected: op(self.reflected, other.reflected),
            refracted: op(self.refracted, other.refracted),
            transmitted: op(self.transmitted, other.transmitted),
            shadow: op(self.shadow, other.shadow),
            camera_hit: op(self.camera_hit, other.camera_hit),
        }
    }
}

impl Add for RayCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.combine(other, u64::add)
    }
}

impl Sub for RayCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.combine(other, u64::sub)
    }
}

/// A ray yet to be traced.
#[derive(Clone, Copy, Debug)]
struct Task {
    ray: Ray,
    /// What its answer counts in the pixel.
    weight: Rgb,
    /// Camera rays have level 1.
    level: u32,
}

/// Traces rays through a scene, one after the other; each worker has its own.
#[derive(Debug)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    depth: u32,
    tasks: Vec<Task>,
    shadows: Shadows<'a>,
    counts: RayCounts,
}

impl<'a> Tracer<'a> {
    /// A tracer that casts no ray of a level above `depth`, camera rays having level 1.
    pub fn new(scene: &'a Scene, depth: u32) -> Self {
        Self {
            scene,
            depth,
            tasks: Vec::new(),
            shadows: Shadows::new(scene),
            counts: RayCounts::default(),
        }
    }

    /// How many rays were cast so far.
    pub fn counts(&self) -> RayCounts {
        self.counts
    }

    /// The light that a camera ray of the scene's own coordinates brings back; not clamped.
    pub(crate) fn radiance(&mut self, ray: Ray) -> Rgb {
        if self.depth == 0 {
            return Rgb::ZERO;
        }
        self.counts.camera += 1;
        let mut radiance = Rgb::ZERO;
        self.tasks.push(Task { ray, weight: Rgb::ONE, level: 1 });
        while let Some(task) = self.tasks.pop() {
            let light = match self.scene.accel().nearest(&task.ray, f64::INFINITY) {
                Some(hit) => {
                    self.counts.camera_hit += u64::from(task.level == 1);
                    self.shade(&task, &hit)
                }
                None => self.scene.background(),
            };
            radiance += task.weight * light;
        }
        radiance
    }

    /// The light that leaves the surface by itself; what comes to it by reflection and transmission is put on the list.
    fn shade(&mut self, task: &Task, hit: &Hit) -> Rgb {
        let surface = self.scene.surface(&task.ray, hit);
        let material = self.scene.material(hit.primitive);
        let outside = surface.normal.dot(task.ray.dir) < 0.0;
        if material.is_transmissive() {
            self.transmit(task, hit, &surface, material, outside);
            if !outside {
                return Rgb::ZERO; // from within, a body only transmits
            }
        }
        if material.reflection > 0.0 && task.level < self.depth {
            let ray = surface.leave(hit, mirrored(task.ray.dir, &surface, outside), !outside);
            self.counts.reflected += 1;
            self.push(ray, task, Rgb::splat(material.reflection));
        }
        self.local_light(task, hit, &surface, material, outside)
    }

    /// Ambient, diffuse and specular light.
    fn local_light(
        &mut self,
        task: &Task,
        hit: &Hit,
        surface: &Surface,
        material: &Material,
        outside: bool,
    ) -> Rgb {
        let normal = if outside { surface.shading } else { -surface.shading };
        let offset = self.scene.shape(hit.primitive).shadow_offset(surface, !outside);
        let (mut diffuse, mut specular) = (Rgb::splat(material.ambient), Rgb::ZERO);
        for light in self.scene.lights() {
            let mut shadow = surface.leave(hit, light.position - surface.point, !outside);
            let to_light = shadow.dir.normalize();
            let cosine = normal.dot(to_light);
            if !(cosine > 0.0) {
                continue;
            }
            self.counts.shadow += 1;
            if offset != DVec3::ZERO {
                shadow.origin += offset;
            }
            shadow.dir = light.position - shadow.origin; // so that the light is at t = 1
            let arriving = light.intensity * self.shadows.transmittance(&shadow);
            if arriving == Rgb::ZERO {
                continue;
            }
            diffuse += arriving * (material.diffuse * cosine as f32);
            if material.specular > 0.0 {
                let highlight = reflect(task.ray.dir, normal).dot(to_light);
                if highlight > 0.0 {
                    specular +=
                        arriving * (material.specular * highlight.powf(material.shininess) as f32);
                }
            }
        }
        if diffuse == Rgb::ZERO {
            return specular;
        }
        let at = TexturePoint { uv: surface.uv, point: surface.point };
        diffuse * material.texture.color(&at) * surface.tint * material.opacity + specular
    }

    fn transmit(
        &mut self,
        task: &Task,
        hit: &Hit,
        surface: &Surface,
        material: &Material,
        outside: bool,
    ) {
        if task.level >= self.depth {
            return;
        }
        let dir = task.ray.dir;
        let (count, onward) = if material.ior == 1.0 {
            (&mut self.counts.transmitted, dir)
        } else {
            let (from, to) = if outside { (1.0, material.ior) } else { (material.ior, 1.0) };
            match refracted(dir, surface, outside, from, to) {
                Some(refracted) => (&mut self.counts.refracted, refracted),
                None => return, // total reflection transmits nothing
            }
        };
        *count += 1;
        self.push(surface.leave(hit, onward, outside), task, material.transmission);
    }

    fn push(&mut self, ray: Ray, parent: &Task, weight: Rgb) {
        self.tasks.push(Task { ray, weight: parent.weight * weight, level: parent.level + 1 });
    }
}

/// The mirror direction of `dir` by the shading normal. Where that points below the surface, as it may at a grazing view
/// of a coarse mesh, it is mirrored up again.
fn mirrored(dir: DVec3, surface: &Surface, outside: bool) -> DVec3 {
    let side = if outside { 1.0 } else { -1.0 };
    let onward = reflect(dir, surface.shading * side);
    if surface.shading != surface.normal && !(onward.dot(surface.normal) * side > 0.0) {
        return reflect(onward, surface.normal * side);
    }
    onward
}

/// The refracted direction by the shading normal, or by the surface's own where the other faces away from the ray or
/// sends it back to its side; `None` if it is totally reflected.
fn refracted(dir: DVec3, surface: &Surface, outside: bool, from: f64, to: f64) -> Option<DVec3> {
    let side = if outside { 1.0 } else { -1.0 };
    let (normal, shading) = (surface.normal * side, surface.shading * side);
    if shading == normal || !(dir.dot(shading) < 0.0) {
        return refract(dir, normal, from, to);
    }
    let onward = refract(dir, shading, from, to)?;
    if onward.dot(normal) < 0.0 { Some(onward) } else { refract(dir, normal, from, to) }
}
