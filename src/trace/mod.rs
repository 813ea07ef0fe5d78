//! Whitted's recursion: the light that comes back along rays, and why it is what it is.
//!
//! The recursion is a work list of rays, each with the weight of its answer in its sample and its level, so the call
//! stack stays flat however deep it goes. Rays are taken from the end of the list in batches of one level: those of a
//! batch are traced together, then lit together light by light, because rays that start or end in one point
//! are cheaper together. What a sample becomes does not depend on the batches: its parts are summed in fixed
//! point (module `sum`), where order does not matter.

pub mod classic;
mod counts;
mod shadow;
mod signature;
mod sum;

use glam::DVec3;

use crate::{
    accel::Work,
    color::Rgb,
    geometry::{Hit, Ray, Surface, reflect, refract},
    light::Light,
    material::Material,
    scene::Scene,
    texture::TexturePoint,
};
pub use counts::RayCounts;
use shadow::Shadows;
use signature::{Branch, Path};
use sum::Sum;

/// How many rays are traced together.
pub const BATCH: usize = 64;

/// What one place on the film shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The light that comes back, linear and not clamped.
    pub color: Rgb,
    /// A hash of all that the ray tree met: surfaces and their sides, cells of patterns, which lights were seen through what.
    /// Two samples with the same signature differ by what varies smoothly.
    pub signature: u32,
    /// How many rays it took, those towards lights included.
    pub rays: u32,
}

/// What a ray on the work list is for.
#[derive(Clone, Copy, Debug)]
struct Task {
    /// What its answer counts in the sample.
    weight: Rgb,
    /// Camera rays have level 1.
    level: u32,
    /// Which of the samples asked for it belongs to.
    sample: u32,
    path: Path,
}

impl Task {
    /// What a ray that comes from this one is for, if its answer counts `weight` in this one's.
    #[inline(always)]
    fn child(&self, weight: Rgb, branch: Branch) -> Self {
        Self {
            weight: self.weight * weight,
            level: self.level + 1,
            sample: self.sample,
            path: self.path.branch(branch),
        }
    }
}

/// A hit that shows its own colour, while the lights are added.
#[derive(Clone, Copy, Debug)]
struct Lit<'a> {
    /// Its ray's place in the batch.
    ray: usize,
    hit: Hit,
    surface: Surface,
    material: &'a Material,
    /// The side that the ray came from: whether that is the inside.
    inside: bool,
    /// The light that the texture scatters, and the highlights.
    diffuse: Rgb,
    specular: Rgb,
    path: Path,
}

/// What a sample gathers.
#[derive(Clone, Copy, Debug, Default)]
struct Gathered {
    color: Sum,
    signature: u32,
    rays: u32,
}

impl Gathered {
    #[inline(always)]
    fn add(&mut self, light: Rgb, signature: u32) {
        self.rays += 1;
        self.color.add(light);
        self.signature = self.signature.wrapping_add(signature);
    }
}

/// Traces rays through a scene; each worker has its own.
#[derive(Debug)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    depth: u32,
    counts: RayCounts,
    shadows: Shadows<'a>,
    /// The work list: rays, and what each is for.
    rays: Vec<Ray>,
    tasks: Vec<Task>,
    // Scratch that is kept from batch to batch: the rays taken from the list, and what becomes of them.
    batch_rays: Vec<Ray>,
    batch: Vec<Task>,
    hits: Vec<Option<Hit>>,
    lit: Vec<Lit<'a>>,
    gathered: Vec<Gathered>,
}

impl<'a> Tracer<'a> {
    /// A tracer that casts no ray of a level above `depth`, camera rays having level 1.
    pub fn new(scene: &'a Scene, depth: u32) -> Self {
        Self {
            scene,
            depth,
            counts: RayCounts::default(),
            shadows: Shadows::new(scene),
            rays: Vec::new(),
            tasks: Vec::new(),
            batch_rays: Vec::new(),
            batch: Vec::new(),
            hits: Vec::new(),
            lit: Vec::new(),
            gathered: Vec::new(),
        }
    }

    /// How many rays were cast so far.
    pub fn counts(&self) -> RayCounts {
        self.counts
    }

    /// What the camera rays `rays`, of one origin and in the scene's own coordinates, show; `samples` gets one for each.
    pub(crate) fn trace(&mut self, rays: &[Ray], samples: &mut Vec<Sample>) {
        self.gathered.clear();
        self.gathered.resize(rays.len(), Gathered::default());
        if self.depth > 0 {
            self.counts.camera += rays.len() as u64;
            self.rays.extend(rays);
            let camera = |sample| Task { weight: Rgb::ONE, level: 1, sample, path: Path::START };
            self.tasks.extend((0..rays.len() as u32).map(camera));
        }
        while self.take_batch() {
            self.scene.accel().run(Batch(self));
        }
        samples.clear();
        let sample =
            |g: &Gathered| Sample { color: g.color.value(), signature: g.signature, rays: g.rays };
        samples.extend(self.gathered.iter().map(sample));
    }

    /// Takes up to [`BATCH`] rays of one level from the end of the list; returns whether there were any.
    fn take_batch(&mut self) -> bool {
        let Some(last) = self.tasks.last() else { return false };
        let of_level =
            self.tasks.iter().rev().take(BATCH).take_while(|task| task.level == last.level);
        let start = self.tasks.len() - of_level.count();
        self.batch.clear();
        self.batch.extend(self.tasks.drain(start..));
        self.batch_rays.clear();
        self.batch_rays.extend(self.rays.drain(start..));
        true
    }

    #[inline(always)]
    fn trace_batch(&mut self) {
        self.hits.clear();
        self.hits.resize(self.batch.len(), None);
        let is_camera = self.batch[0].level == 1;
        if is_camera {
            self.scene.accel().nearest_packet(&self.batch_rays, &mut self.hits);
        } else {
            for (ray, hit) in self.batch_rays.iter().zip(&mut self.hits) {
                *hit = self.scene.accel().nearest(ray, f64::INFINITY);
            }
        }
        for k in 0..self.batch.len() {
            if let Some(hit) = self.hits[k] {
                self.counts.camera_hit += u64::from(is_camera);
                self.meet(k, &hit);
            } else {
                let signature = self.batch[k].path.background();
                self.gather(k, self.scene.background(), signature);
            }
        }
        let scene = self.scene;
        for light in scene.lights() {
            self.add_light(light);
        }
        self.show();
    }

    #[inline(always)]
    fn gather(&mut self, ray: usize, light: Rgb, signature: u32) {
        let task = &self.batch[ray];
        self.gathered[task.sample as usize].add(task.weight * light, signature);
    }

    /// Puts what comes to the hit of ray `index` by reflection and transmission on the list, and the hit itself among those
    /// to be lit.
    #[inline(always)]
    fn meet(&mut self, index: usize, hit: &Hit) {
        let (scene, task) = (self.scene, self.batch[index]);
        let (ray, material) = (&self.batch_rays[index], scene.material(hit.primitive));
        // The surface is put where it stays; it is large.
        self.lit.push(Lit {
            ray: index,
            hit: *hit,
            surface: scene.surface(ray, hit),
            material,
            inside: false,
            diffuse: Rgb::splat(material.ambient),
            specular: Rgb::ZERO,
            path: task.path,
        });
        let Some(lit) = self.lit.last_mut() else { return };
        let (surface, dir) = (&lit.surface, ray.dir);
        let inside = !(surface.normal.dot(dir) < 0.0);
        (lit.inside, lit.path) = (inside, task.path.hit(hit, inside));
        if task.level < self.depth {
            let counts = |weight: Rgb| (task.weight * weight).max_element() >= scene.cutoff();
            let mirror = Rgb::splat(material.reflection);
            let only_transmits = inside && material.is_transmissive();
            if material.reflection > 0.0 && !only_transmits && counts(mirror) {
                self.counts.reflected += 1;
                self.rays.push(surface.leave(hit, mirrored(dir, surface, inside), inside));
                self.tasks.push(task.child(mirror, Branch::Reflected));
            }
            if material.is_transmissive()
                && counts(material.transmission)
                && let Some(onward) =
                    transmitted(&mut self.counts, dir, surface, material.ior, inside)
            {
                self.rays.push(surface.leave(hit, onward, !inside));
                self.tasks.push(task.child(material.transmission, Branch::Transmitted));
            }
        }
        if inside && material.is_transmissive() {
            // From within, a body only transmits.
            let signature = lit.path.signature();
            self.lit.pop();
            self.gather(index, Rgb::ZERO, signature);
        }
    }

    /// Adds what one light gives to the hits of the batch that face it.
    #[inline(always)]
    fn add_light(&mut self, light: &Light) {
        self.shadows.clear();
        for (lit, index) in self.lit.iter().zip(0..) {
            let away = light.position - lit.surface.point;
            let to_light = away.normalize();
            let cosine = lit.normal().dot(to_light);
            if cosine > 0.0 {
                let mut ray = lit.surface.leave(&lit.hit, away, lit.inside);
                let shape = self.scene.shape(lit.hit.primitive);
                let offset = shape.shadow_offset(&lit.surface, lit.inside);
                if offset != DVec3::ZERO {
                    ray.origin += offset;
                }
                ray.dir = light.position - ray.origin; // so that the light is at t = 1
                self.shadows.push(index, ray, to_light, cosine);
                self.gathered[self.batch[lit.ray].sample as usize].rays += 1;
            }
        }
        self.counts.shadow += self.shadows.len() as u64;
        for shadow in self.shadows.cast(light.position) {
            let lit = &mut self.lit[shadow.index as usize];
            if shadow.transmittance == Rgb::ZERO {
                continue;
            }
            lit.path = lit.path.light(light, shadow.passed);
            let arriving = light.intensity * shadow.transmittance;
            lit.diffuse += arriving * (lit.material.diffuse * shadow.cosine as f32);
            if lit.material.specular > 0.0 {
                // The mirror direction, d − 2 (d·n) n, against the direction of the light.
                let dir = self.batch_rays[lit.ray].dir;
                let highlight =
                    dir.dot(shadow.to_light) - 2.0 * dir.dot(lit.normal()) * shadow.cosine;
                if highlight > 0.0 {
                    let shine = highlight.powf(lit.material.shininess) as f32;
                    lit.specular += arriving * (lit.material.specular * shine);
                }
            }
        }
    }

    /// Gives the colours of the lit hits to their samples.
    #[inline(always)]
    fn show(&mut self) {
        for lit in &self.lit {
            let Lit { material, mut path, .. } = *lit;
            let mut light = lit.specular;
            if lit.diffuse != Rgb::ZERO && material.opacity > 0.0 {
                let at = TexturePoint { uv: lit.surface.uv, point: lit.surface.point };
                let (color, cell) = material.texture.at(&at);
                light += lit.diffuse * color * lit.surface.tint * material.opacity;
                path = path.cell(cell);
            }
            let task = &self.batch[lit.ray];
            self.gathered[task.sample as usize].add(task.weight * light, path.signature());
        }
        self.lit.clear();
    }
}

/// The direction in which a ray goes on behind a surface, and counts it; `None` if it is totally reflected, which transmits
/// nothing.
#[inline(always)]
fn transmitted(
    counts: &mut RayCounts,
    dir: DVec3,
    surface: &Surface,
    ior: f64,
    inside: bool,
) -> Option<DVec3> {
    if ior == 1.0 {
        counts.transmitted += 1;
        return Some(dir);
    }
    let (from, to) = if inside { (ior, 1.0) } else { (1.0, ior) };
    let refracted = refracted(dir, surface, inside, from, to)?;
    counts.refracted += 1;
    Some(refracted)
}

/// The batch that a tracer has taken, to be traced.
struct Batch<'t, 'a>(&'t mut Tracer<'a>);

impl Work for Batch<'_, '_> {
    #[inline(always)]
    fn run(self) {
        self.0.trace_batch();
    }
}

impl Lit<'_> {
    /// The shading normal on the side that the ray came from.
    fn normal(&self) -> DVec3 {
        if self.inside { -self.surface.shading } else { self.surface.shading }
    }
}

/// The mirror direction of `dir` by the shading normal. Where that points below the surface, as it may at a grazing view
/// of a coarse mesh, it is mirrored up again.
fn mirrored(dir: DVec3, surface: &Surface, inside: bool) -> DVec3 {
    let side = if inside { -1.0 } else { 1.0 };
    let onward = reflect(dir, surface.shading * side);
    if surface.shading != surface.normal && !(onward.dot(surface.normal) * side > 0.0) {
        return reflect(onward, surface.normal * side);
    }
    onward
}

/// The refracted direction by the shading normal, or by the surface's own where the other faces away from the ray or
/// sends it back to its side; `None` if it is totally reflected.
fn refracted(dir: DVec3, surface: &Surface, inside: bool, from: f64, to: f64) -> Option<DVec3> {
    let side = if inside { -1.0 } else { 1.0 };
    let (normal, shading) = (surface.normal * side, surface.shading * side);
    if shading == normal || !(dir.dot(shading) < 0.0) {
        return refract(dir, normal, from, to);
    }
    let onward = refract(dir, shading, from, to)?;
    if onward.dot(normal) < 0.0 { Some(onward) } else { refract(dir, normal, from, to) }
}
