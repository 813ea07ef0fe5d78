//! The shading rules that classical ray tracers were compared by, for counting the same rays as they did.
//!
//! They differ from the rest of this program on purpose: opaque surfaces are seen from their front only, everything
//! that reflects or transmits does so from both sides, and shadow rays stop at glass.
//!
//! Source: Haines, "A Proposal for Standard Graphics Environments", *IEEE CG&A* 7(11) (1987), as the figures for the
//! Standard Procedural Databases are counted.

use std::ops::ControlFlow;

use glam::DVec3;

use super::RayCounts;
use crate::{
    color::Rgb,
    geometry::{Hit, Ray, Shape, Surface, reflect, refract},
    scene::Scene,
    texture::TexturePoint,
};

/// The level of rays that spawn no others; eye rays have level 1.
pub const CLASSIC_DEPTH: u32 = 5;

/// Traces rays by the classical rules.
#[derive(Debug)]
pub(crate) struct ClassicTracer<'a> {
    scene: &'a Scene,
    tasks: Vec<(Ray, Rgb, u32)>,
    counts: RayCounts,
}

impl<'a> ClassicTracer<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        Self { scene, tasks: Vec::new(), counts: RayCounts::default() }
    }

    pub(crate) fn counts(&self) -> RayCounts {
        self.counts
    }

    /// The light that an eye ray in the scene's own coordinates brings back; not clamped.
    pub(crate) fn radiance(&mut self, eye_ray: Ray) -> Rgb {
        let mut light = Rgb::ZERO;
        self.counts.camera += 1;
        self.tasks.push((eye_ray, Rgb::ONE, 1));
        while let Some((ray, weight, level)) = self.tasks.pop() {
            let Some((hit, surface)) = self.nearest(ray) else {
                light += weight * self.scene.background();
                continue;
            };
            self.counts.camera_hit += u64::from(level == 1);
            light += weight * self.shade(&ray, &hit, &surface, weight, level);
        }
        light
    }

    /// The nearest hit on a side that can be seen.
    fn nearest(&self, mut ray: Ray) -> Option<(Hit, Surface)> {
        loop {
            let hit = self.scene.accel().nearest(&ray, f64::INFINITY)?;
            let surface = self.scene.surface(&ray, &hit);
            let front = surface.normal.dot(ray.dir) < 0.0;
            if front || self.is_seen(hit.primitive) {
                return Some((hit, surface));
            }
            ray = surface.leave(&hit, ray.dir, false);
        }
    }

    /// Whether a surface is seen wherever it is hit: glass, patches, which have normals of their own, and what is hit
    /// from inside only.
    fn is_seen(&self, primitive: u32) -> bool {
        self.scene.material(primitive).is_transmissive()
            || match self.scene.shape(primitive) {
                Shape::Face(face) => face.is_smooth(),
                Shape::Inward(_) => true,
                _ => false,
            }
    }

    fn shade(&mut self, ray: &Ray, hit: &Hit, surface: &Surface, weight: Rgb, level: u32) -> Rgb {
        let material = self.scene.material(hit.primitive);
        let front = surface.normal.dot(ray.dir) < 0.0;
        let side = if front { 1.0 } else { -1.0 };
        let normal = surface.shading * side;
        if level < CLASSIC_DEPTH {
            if material.sends_on() {
                let onward = surface.leave(hit, reflect(ray.dir, normal), !front);
                self.counts.reflected += 1;
                self.tasks.push((onward, weight * material.reflection, level + 1));
            }
            if material.is_transmissive() {
                let (from, to) = if front { (1.0, material.ior) } else { (material.ior, 1.0) };
                if let Some(dir) = refract(ray.dir, normal, from, to) {
                    self.counts.refracted += 1;
                    let onward = surface.leave(hit, dir, front);
                    self.tasks.push((onward, weight * material.transmission, level + 1));
                }
            }
        }
        let (mut diffuse, mut specular) = (Rgb::splat(material.ambient), Rgb::ZERO);
        for light in self.scene.lights() {
            let mut shadow = surface.leave(hit, light.position - surface.point, !front);
            let to_light = shadow.dir.normalize();
            let cosine = normal.dot(to_light);
            if !(cosine > 0.0) {
                continue;
            }
            self.counts.shadow += 1;
            shadow.dir = light.position - shadow.origin;
            if self.is_blocked(&shadow) {
                continue;
            }
            diffuse += light.intensity * (material.diffuse * cosine as f32);
            let highlight = reflect(ray.dir, normal).dot(to_light);
            if highlight > 0.0 {
                specular += light.intensity
                    * (material.specular * highlight.powf(material.shininess) as f32);
            }
        }
        let at = TexturePoint { uv: surface.uv, point: surface.point };
        diffuse * material.texture.at(&at).0 * surface.tint * material.opacity + specular
    }

    /// Whether anything stands before `t = 1`, seen from the side it can be seen from.
    fn is_blocked(&self, ray: &Ray) -> bool {
        self.scene.accel().any_crossing(ray, 1.0, |primitive, crossing| {
            let hit = Hit { t: crossing.t, primitive, face: crossing.face };
            let blocks = self.is_seen(primitive) || {
                let normal: DVec3 = self.scene.surface(ray, &hit).normal;
                normal.dot(ray.dir) < 0.0
            };
            if blocks { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    }
}
