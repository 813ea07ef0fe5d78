//! The hits of a batch in the light: at once, or with others that come later.

use glam::{DVec2, DVec3};

use super::{Tracer, footprint, task::Task};
use crate::{geometry::lanes::lanes, light::Light, material::Material};

/// Hits of so few primitives are lit at once.
const FEW: usize = 4;

impl Tracer<'_> {
    /// Lights the hits, which are of so many primitives, now or later.
    #[inline(always)]
    pub(super) fn shade(&mut self, primitives: usize) {
        if self.waits && primitives > FEW && self.is_scattered() {
            self.wait();
        } else {
            self.light();
            self.show();
        }
    }

    /// Whether the hits to be lit are so far from each other that some light sees more primitives between them than one
    /// each way, if these fill its view.
    #[inline(always)]
    fn is_scattered(&self) -> bool {
        let [min, max] = self.lit.starts();
        let (middle, size) = (0.5 * (min + max), (max - min).max_element());
        let across = size * (self.scene.primitive_count() as f64).cbrt();
        let is_near = |light: &Light| across > (light.position - middle).length();
        self.scene.lights().iter().any(is_near)
    }

    /// Adds what the lights give to the hits that face them.
    #[inline(always)]
    fn light(&mut self) {
        let (scene, batch) = (self.scene, &*self.batch);
        for light in scene.lights() {
            let asked = self.lit.face(light, &batch.met.dir);
            self.counts.shadow += u64::from(asked.count_ones());
            for k in lanes(asked) {
                self.gathered[batch.tasks[k].sample as usize].rays += 1;
            }
            if asked != 0 {
                self.lit.add(scene, light, &batch.hits, asked);
            }
        }
    }

    /// Gives the colours of the lit hits to their samples.
    #[inline(always)]
    fn show(&mut self) {
        for k in lanes(self.lit.lanes()) {
            let task = &self.batch.tasks[k];
            let material = self.scene.material(self.batch.hits.primitive[k]);
            let shown = self.lit.show(k, material, self.uv_across(k, material));
            self.gathered[task.sample as usize].add_hit(task, &shown);
        }
    }

    /// How much the surface coordinates change across what the ray of a lane stands for, squared; `None` if
    /// nobody asks for it.
    #[inline(always)]
    fn uv_across(&self, k: usize, material: &Material) -> Option<DVec2> {
        if self.cone.is_none() || !material.texture.needs_uv() {
            return None;
        }
        let (batch, shape) = (&*self.batch, self.scene.shape(self.batch.hits.primitive[k]));
        let (task, dir) = (&batch.tasks[k], batch.met.dir.get(k));
        let width = f64::from(self.width_of(task, dir)) * (f64::from(task.way) + batch.hits.t[k]);
        let normal = self.lit.surfaces.facing.get(k);
        Some(footprint::on_surface(width, dir, normal, shape.uv_gradients()))
    }

    /// The side of what a ray along `dir` stands for at distance 1 from the camera, its way unfolded.
    #[inline(always)]
    pub(super) fn width_of(&self, task: &Task, dir: DVec3) -> f32 {
        match &self.cone {
            Some(cone) if task.level == 1 => cone.width_along(dir),
            _ => task.width,
        }
    }

    /// Keeps the lit hits, and the rays that they ask for, until there are more.
    #[inline(always)]
    fn wait(&mut self) {
        let (scene, batch) = (self.scene, &*self.batch);
        let (first, all) = (self.waiting.len(), self.lit.lanes());
        for k in lanes(all) {
            let hit = (batch.hits.primitive[k], batch.hits.face[k]);
            let material = scene.material(hit.0);
            let pigment = self.lit.pigment(k, material, self.uv_across(k, material));
            self.waiting.push(&self.lit, k, &batch.tasks[k], hit, pigment);
        }
        for (number, light) in scene.lights().iter().enumerate() {
            let asked = self.lit.face(light, &batch.met.dir);
            self.counts.shadow += u64::from(asked.count_ones());
            for k in lanes(asked) {
                self.gathered[batch.tasks[k].sample as usize].rays += 1;
                let before = (all & ((1 << k) - 1)).count_ones() as usize;
                let wish = self.lit.wish(k);
                self.waiting.ask(number, first + before, self.lit.toward.get(k), wish);
            }
        }
    }
}
