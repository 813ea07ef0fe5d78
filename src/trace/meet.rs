//! Where rays meet a primitive: the surfaces there, and the rays that go on from them.

use glam::DVec3;

use super::{
    Tracer,
    onward::{mirrored, transmitted},
    signature::Branch,
};
use crate::{
    color::Rgb,
    geometry::{
        Departure, Hit, Ray, Shape, Surface,
        lanes::{Vectors, hull, lanes},
    },
    material::Material,
};

/// Fewer hits of a primitive than this are as fast one by one.
const FEWEST: u32 = 3;

/// Hits in fewer than one of so many lanes are as fast one by one, unless the rays come from the camera.
const SPARSEST: usize = 4;

impl Tracer<'_> {
    /// Takes the hits of one primitive in the lanes `same`: finds the surfaces there, puts what comes to them by
    /// reflection and transmission on the list, and themselves among those to be lit.
    #[inline(always)]
    pub(super) fn meet(&mut self, primitive: u32, same: u64, is_camera: bool) {
        let scene = self.scene;
        let (shape, material) = (scene.shape(primitive), scene.material(primitive));
        let goes_on = material.sends_on();
        let together = (!goes_on || matches!(shape, Shape::Sphere(_)))
            && same.count_ones() >= FEWEST
            && (is_camera || self.start_in_points(shape, same))
            && {
                let (rays, with_uv) = (&self.batch.met, material.texture.needs_uv());
                shape.surface_lanes(rays, same, with_uv, &mut self.lit.surfaces)
            };
        if !together {
            for k in lanes(same) {
                let hit = self.batch.hits.get(k);
                let ray = if is_camera {
                    Ray::new(self.batch.met.origin.get(k), self.batch.met.dir.get(k))
                } else {
                    self.batch.rays[k]
                };
                let surface = shape.surface(&ray, &hit);
                self.lit.surfaces.set(k, shape, &surface, ray.dir);
                if goes_on {
                    self.go_on(k, ray.dir, &hit, &surface, material);
                }
            }
        } else if let (Shape::Sphere(sphere), true) = (shape, goes_on) {
            for k in lanes(same) {
                let (hit, dir) = (self.batch.hits.get(k), self.batch.met.dir.get(k));
                let surface = sphere.surface_of_lane(&self.lit.surfaces, k);
                self.go_on(k, dir, &hit, &surface, material);
            }
        }
        self.lit.take(same, &self.batch, material);
        if material.is_transmissive() {
            // From within, a body only transmits.
            for k in lanes(same) {
                if self.lit.surfaces.is_inside(k) {
                    self.lit.leave_out(k);
                    let sample = self.batch.tasks[k].sample;
                    self.gathered[sample as usize].add(Rgb::ZERO, self.lit.signature(k));
                }
            }
        }
    }

    /// Has the rays of the lanes `same`, which hit the same shape, start in the points that they leave, as far as they
    /// meet it from there; returns false if they had better be taken one by one.
    #[inline(always)]
    fn start_in_points(&mut self, shape: &Shape, same: u64) -> bool {
        if hull(same).len() > SPARSEST * same.count_ones() as usize {
            return false;
        }
        let (batch, mut beside) = (&mut *self.batch, Vectors::ZERO);
        for k in lanes(same) {
            let ray = &batch.rays[k];
            let others = |from: &&Departure| from.primitive != batch.hits.primitive[k];
            let Some(from) = ray.from.as_ref().filter(others) else { return false };
            batch.met.origin.set(k, from.point);
            batch.met.rest.set(k, from.point_rest);
            beside.set(k, ray.origin);
        }
        shape.meet_directly(&mut batch.met, &beside, same)
    }

    /// Puts the rays that a surface reflects and transmits on the list.
    #[inline(always)]
    fn go_on(&mut self, k: usize, dir: DVec3, hit: &Hit, surface: &Surface, material: &Material) {
        let (scene, task) = (self.scene, self.batch.tasks[k]);
        if task.level >= self.depth {
            return;
        }
        let gone = (hit.t, self.width_of(&task, dir));
        let inside = surface.is_met_from_inside(dir);
        let counts = |weight: Rgb| (task.weight * weight).max_element() >= scene.cutoff();
        let mirror = Rgb::splat(material.reflection);
        let only_transmits = inside && material.is_transmissive();
        if material.reflection > 0.0 && !only_transmits && counts(mirror) {
            self.counts.reflected += 1;
            self.rays.push(surface.leave(hit, mirrored(dir, surface, inside), inside));
            self.tasks.push(task.child(gone, mirror, Branch::Reflected));
        }
        if material.is_transmissive()
            && counts(material.transmission)
            && let Some(onward) = transmitted(&mut self.counts, dir, surface, material.ior, inside)
        {
            self.rays.push(surface.leave(hit, onward, !inside));
            self.tasks.push(task.child(gone, material.transmission, Branch::Transmitted));
        }
    }
}
