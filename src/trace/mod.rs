//! Whitted's recursion: the light that comes back along rays, and why it is what it is.
//!
//! The recursion is a work list of rays, each with the weight of its answer in its sample and its level, so the call
//! stack stays flat however deep it goes. Rays are taken from the end of the list in batches of one level: those of a
//! batch are traced together, then lit together light by light (modules `shade` and `lit`), because rays that start or end in one
//! point are cheaper together. Hits that are far from each other wait for others to be lit with (module `wavefront`).
//! What a sample becomes does not depend on the batches: its parts are summed in fixed point (module `sum`), where order
//! does not matter.

pub mod classic;
mod counts;
mod footprint;
mod lit;
mod meet;
mod onward;
mod order;
mod shade;
mod shadow;
mod signature;
mod sum;
mod task;
mod wavefront;

use glam::DVec3;

use crate::{
    aa::Sample,
    accel::Work,
    camera::Cone,
    geometry::{
        Ray,
        lanes::{HitLanes, LANES, MetLanes, RayLanes, Vectors, lanes},
    },
    scene::Scene,
};
pub use counts::RayCounts;
use lit::Lit;
use task::{Gathered, Task};
use wavefront::Wavefront;

/// How many rays are traced together.
pub const BATCH: usize = LANES;

/// Of fewer samples than this, hits that wait would be too few to be near each other.
pub(crate) const ENOUGH: usize = 1 << 10;

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

    /// How many rays were cast since it was asked last.
    pub fn take_counts(&mut self) -> RayCounts {
        std::mem::take(&mut self.counts)
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
        // Each of many would be waited for by itself.
        let hits = &batch.hits;
        scene.accel().prefetch(lanes(hit).map(|k| scene.shape(hits.primitive[k])));
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
        self.shade(primitives);
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
