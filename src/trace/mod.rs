//! Whitted's recursion: the light that comes back along rays, and why it is what it is.
//!
//! The recursion is a work list of rays, each with the weight of its answer in its sample and its level, so the call
//! stack stays flat however deep it goes. Rays are taken from the end of the list in batches of one level: those of a
//! batch are traced together, then lit together light by light (module `lit`), because rays that start or end in one
//! point are cheaper together. Hits that are far from each other wait for others to be lit with (module `wavefront`).
//! What a sample becomes does not depend on the batches: its parts are summed in fixed point (module `sum`), where order
//! does not matter.

pub mod classic;
mod counts;
mod footprint;
mod lit;
mod meet;
mod onward;
mod shadow;
mod signature;
mod sum;
mod wavefront;

use glam::{DVec2, DVec3};

use crate::{
    aa::{Sample, detail::Detail},
    accel::Work,
    camera::Cone,
    color::Rgb,
    geometry::{
        Ray,
        lanes::{HitLanes, LANES, MetLanes, RayLanes, Vectors, lanes},
    },
    light::Light,
    material::Material,
    scene::Scene,
};
pub use counts::RayCounts;
use lit::{Lit, Shown};
use signature::{Branch, Path};
use sum::Sum;
use wavefront::Wavefront;

/// How many rays are traced together.
pub const BATCH: usize = LANES;

/// Hits of so few primitives are lit at once.
const FEW: usize = 4;

/// Of fewer samples than this, hits that wait would be too few to be near each other.
pub(crate) const ENOUGH: usize = 1 << 10;

/// The least weight in a sample of a hit whose cell counts.
const WEIGHT_OF_CELLS: f32 = 0.25;

/// What a ray on the work list is for.
#[derive(Clone, Copy, Debug)]
struct Task {
    /// What its answer counts in the sample.
    weight: Rgb,
    /// Camera rays have level 1.
    level: u32,
    /// The length of the path from the camera so far.
    way: f32,
    /// The side of the square that it stands for, by length of the path; 0 for camera rays, whose direction tells.
    width: f32,
    /// Which of the samples asked for it belongs to.
    sample: u32,
    path: Path,
}

impl Task {
    /// What the camera ray of a sample is for.
    #[inline(always)]
    fn camera(sample: u32) -> Self {
        Self { weight: Rgb::ONE, level: 1, way: 0.0, width: 0.0, sample, path: Path::START }
    }

    /// What a ray is for that comes from where this one has gone so far, if its answer counts `weight` in this one's.
    #[inline(always)]
    fn child(&self, (gone, width): (f64, f32), weight: Rgb, branch: Branch) -> Self {
        Self {
            weight: self.weight * weight,
            level: self.level + 1,
            way: self.way + gone as f32,
            width,
            sample: self.sample,
            path: self.path.branch(branch),
        }
    }
}

/// What a sample gathers.
#[derive(Clone, Copy, Debug, Default)]
struct Gathered {
    color: Sum,
    signature: u32,
    cell: u32,
    detail: Detail,
    rays: u32,
}

impl Gathered {
    #[inline(always)]
    fn add(&mut self, light: Rgb, signature: u32) {
        self.rays += 1;
        self.color.add(light);
        self.signature = self.signature.wrapping_add(signature);
    }

    fn sample(&self) -> Sample {
        let Self { color, signature, cell, detail, rays } = *self;
        let color = color.value().max(Rgb::ZERO).min(Rgb::ONE);
        Sample { color, signature, cell, detail, rays }
    }

    /// Adds a hit that shows its own colour.
    #[inline(always)]
    fn add_hit(&mut self, task: &Task, shown: &Shown) {
        self.add(task.weight * shown.light, shown.signature);
        if shown.cell != 0 && task.weight.max_element() >= WEIGHT_OF_CELLS {
            self.cell = self.cell.wrapping_add(task.path.cell(shown.cell).signature());
        }
        if shown.detail != Detail::default() {
            self.detail = self.detail.and(shown.detail.lit(task.weight).squared_error());
            if task.level == 1 && shown.detail.is_whole() {
                self.detail = self.detail.whole();
            }
        }
    }
}

/// The rays that are traced together, a lane for each, and what they are for.
#[derive(Debug)]
struct Batch {
    tasks: Vec<Task>,
    /// The rays by themselves, unless they come from the camera.
    rays: Vec<Ray>,
    met: MetLanes,
    hits: HitLanes,
}

/// Traces rays through a scene; each worker has its own.
#[derive(Debug)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    depth: u32,
    /// What camera rays stand for, if samples are to tell of pictures that are finer.
    cone: Option<Cone>,
    counts: RayCounts,
    /// The work list: rays, and what each is for.
    rays: Vec<Ray>,
    tasks: Vec<Task>,
    /// The rays taken from the list, and what becomes of them; in boxes, because they are large.
    batch: Box<Batch>,
    lit: Box<Lit>,
    /// Whether hits that are far from each other wait for others.
    waits: bool,
    waiting: Wavefront,
    gathered: Vec<Gathered>,
}

impl<'a> Tracer<'a> {
    /// A tracer that casts no ray of a level above `depth`, camera rays having level 1; `tells_highlights` is whether
    /// signatures tell the inner part of a highlight from the rest of its surface, and `cone` what camera rays stand for, if
    /// samples are to tell their [detail](Sample::detail).
    pub(crate) fn new(
        scene: &'a Scene,
        depth: u32,
        cone: Option<Cone>,
        tells_highlights: bool,
    ) -> Self {
        let (met, hits) = (MetLanes::NONE, HitLanes::NONE);
        let (tasks, rays) = (Vec::new(), Vec::new());
        Self {
            scene,
            depth,
            cone,
            counts: RayCounts::default(),
            rays: Vec::new(),
            tasks: Vec::new(),
            batch: Box::new(Batch { tasks, rays, met, hits }),
            lit: Box::new(Lit::new(tells_highlights)),
            waits: false,
            waiting: Wavefront::new(),
            gathered: Vec::new(),
        }
    }

    /// How many rays were cast so far.
    pub fn counts(&self) -> RayCounts {
        self.counts
    }

    /// Puts what camera rays from `eye` along `dirs`, in the scene's own coordinates, show behind what `samples` holds.
    pub(crate) fn trace(
        &mut self,
        eye: DVec3,
        mut dirs: impl ExactSizeIterator<Item = DVec3>,
        samples: &mut Vec<Sample>,
    ) {
        let (scene, all) = (self.scene, dirs.len());
        self.gathered.clear();
        self.gathered.resize(all, Gathered::default());
        self.waits = all >= ENOUGH;
        let count = if self.depth > 0 { all } else { 0 };
        self.counts.camera += count as u64;
        for first in (0..count).step_by(BATCH) {
            let batch = &mut *self.batch;
            batch.tasks.clear();
            for (k, dir) in dirs.by_ref().take(BATCH).enumerate() {
                batch.met.origin.set(k, eye);
                batch.met.dir.set(k, dir);
            }
            batch.met.rest = Vectors::ZERO;
            batch.tasks.extend((first as u32..count.min(first + BATCH) as u32).map(Task::camera));
            self.run();
            while self.take_batch() {
                self.run();
            }
        }
        if self.waits {
            scene.accel().run(Finish(self));
        }
        samples.extend(self.gathered.iter().map(Gathered::sample));
    }

    /// Takes up to [`BATCH`] rays of one level from the end of the list; returns whether there were any.
    fn take_batch(&mut self) -> bool {
        let Some(last) = self.tasks.last() else { return false };
        let of_level =
            self.tasks.iter().rev().take(BATCH).take_while(|task| task.level == last.level);
        let start = self.tasks.len() - of_level.count();
        let batch = &mut *self.batch;
        batch.tasks.clear();
        batch.tasks.extend(self.tasks.drain(start..));
        batch.rays.clear();
        batch.rays.extend(self.rays.drain(start..));
        for (k, ray) in batch.rays.iter().enumerate() {
            batch.met.dir.set(k, ray.dir);
        }
        true
    }

    /// Traces the batch that was taken, and lights its hits now or later.
    fn run(&mut self) {
        let accel = self.scene.accel();
        accel.run(Run(self));
        if self.waiting.is_full() {
            accel.run(Finish(self));
        }
    }

    #[inline(always)]
    fn trace_batch(&mut self) {
        let (scene, batch) = (self.scene, &mut *self.batch);
        let is_camera = batch.tasks[0].level == 1;
        let used = u64::MAX >> (LANES - batch.tasks.len());
        if is_camera {
            let MetLanes { origin, dir, .. } = &batch.met;
            let rays = RayLanes { origin, dir, from: None, used };
            scene.accel().nearest_packet(&rays, &mut batch.hits);
        } else {
            batch.hits.t = [f64::INFINITY; LANES];
            for (k, ray) in batch.rays.iter().enumerate() {
                if let Some(hit) = scene.accel().nearest(ray, f64::INFINITY) {
                    batch.hits.set(k, &hit);
                }
            }
        }
        batch.met.t = batch.hits.t;
        let hit = used & batch.hits.found();
        if is_camera {
            self.counts.camera_hit += u64::from(hit.count_ones());
        }
        for k in lanes(used & !hit) {
            let task = &self.batch.tasks[k];
            let light = task.weight * scene.background();
            self.gathered[task.sample as usize].add(light, task.path.background());
        }
        self.lit.clear();
        let (mut open, mut primitives) = (hit, 0);
        while open != 0 {
            primitives += 1;
            let primitive = self.batch.hits.primitive[open.trailing_zeros() as usize];
            let same = self.batch.hits.alike(open);
            open &= !same;
            self.meet(primitive, same, is_camera);
        }
        if self.waits && primitives > FEW && self.is_scattered() {
            self.wait();
            return;
        }
        self.light();
        self.show();
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
    fn width_of(&self, task: &Task, dir: DVec3) -> f32 {
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

/// The batch that a tracer has taken, to be traced.
struct Run<'t, 'a>(&'t mut Tracer<'a>);

impl Work for Run<'_, '_> {
    #[inline(always)]
    fn run(self) {
        self.0.trace_batch();
    }
}

/// All hits that wait, to be lit.
struct Finish<'t, 'a>(&'t mut Tracer<'a>);

impl Work for Finish<'_, '_> {
    #[inline(always)]
    fn run(self) {
        let Tracer { scene, waiting, gathered, .. } = self.0;
        waiting.finish(scene, gathered);
    }
}
