//! From a scene to a film: tiles in parallel, each a function of scene and options alone.

mod adaptive;
mod crew;
mod look;
mod plain;
mod plane;

use std::{
    num::NonZeroUsize,
    sync::{Mutex, PoisonError},
    time::Instant,
};

use glam::DVec2;
use thiserror::Error;

pub use crew::Sampler;

pub use crate::trace::RayCounts;
use crate::{
    aa::{AntiAliasing, Sample},
    camera::View,
    color::Rgb,
    film::{Film, Tile},
    geometry::Ray,
    scene::Scene,
    trace::{self, BATCH, Tracer},
};
use adaptive::{Adaptive, Threshold};
use crew::{Crew, Meter};
use plane::Area;

/// What the user may choose; the rest is the scene's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// Width and height in pixels, instead of the scene's.
    pub size: Option<[u32; 2]>,
    /// How pixels are sampled.
    pub aa: AntiAliasing,
    /// The deepest level of recursion, instead of the scene's; camera rays have level 1.
    pub depth: Option<u32>,
    /// How many threads work; all cores by default. The picture is the same for any number.
    pub threads: Option<NonZeroUsize>,
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixels done.
    pub done: u64,
    /// Pixels in all.
    pub total: u64,
}

/// A picture, and what it took.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The picture.
    pub film: Film,
    /// The estimated squared error of each pixel, in levels of 255, in the order of [`Film::pixels`].
    pub errors: Vec<f32>,
    /// The picture's estimated error against the exact average over each pixel: root mean square of all channels, in levels of
    /// 255.
    pub estimated_rmse: f64,
    /// The rays cast.
    pub rays: RayCounts,
    /// The threads used.
    pub threads: usize,
    /// The time, in seconds, without loading and writing.
    pub seconds: f64,
    /// The deepest level of recursion that was allowed.
    pub depth: u32,
}

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The worker threads could not be started.
    #[error("{threads} threads cannot be started: {source}")]
    Threads {
        /// How many were wanted.
        threads: usize,
        /// The system's reason.
        source: rayon::ThreadPoolBuildError,
    },
}

/// A picture before it is a film.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The colours, row by row, linear.
    pub colors: Vec<Rgb>,
    /// The rays through each pixel.
    pub samples: Vec<u32>,
    /// The estimated squared error of each pixel, in levels of 255.
    pub errors: Vec<f32>,
    /// What the mean of `errors` is to be multiplied by.
    factor: f64,
}

impl Picture {
    /// The estimated error: root mean square of all channels, in levels of 255.
    pub fn estimated_rmse(&self) -> f64 {
        let sum: f64 = self.errors.iter().copied().map(f64::from).sum();
        (self.factor * sum / self.errors.len().max(1) as f64).sqrt()
    }
}

/// The part `part` of a picture `width` pixels wide, of whatever `new_sampler`'s samplers see; each worker thread has its own.
///
/// Every pixel depends on its place in the whole picture and on what is seen within a pixel's width around it, never on `part`.
pub fn picture<S: Sampler>(
    part: &Tile,
    width: u32,
    aa: AntiAliasing,
    new_sampler: &(dyn Fn() -> S + Sync),
    progress: &(dyn Fn(Progress) + Sync),
) -> Picture {
    let corner = |x: u32, y: u32| (i64::from(x), i64::from(y));
    let ((x0, y0), (x1, y1)) = (corner(part.x0, part.y0), corner(part.x1, part.y1));
    let area = Area { x0, y0, x1, y1 };
    let pixels = area.len() as u64;
    match aa {
        AntiAliasing::None | AntiAliasing::Grid { side: 1 } => {
            let meter = Meter::new(pixels, progress);
            plain::centers(&Crew { new_sampler, meter: &meter }, &area)
        }
        AntiAliasing::Grid { side } => {
            let meter = Meter::new(pixels, progress);
            plain::grid(&Crew { new_sampler, meter: &meter }, &area, side)
        }
        AntiAliasing::Sequence { count } => {
            let meter = Meter::new(pixels, progress);
            plain::sequence(&Crew { new_sampler, meter: &meter }, &area, width, count)
        }
        AntiAliasing::Adaptive { error, most } => {
            let meter = Meter::new(2 * pixels, progress);
            let crew = Crew { new_sampler, meter: &meter };
            let mut adaptive = Adaptive::new(&crew, &area, width, most);
            meter.reach(0.5);
            adaptive.refine(&crew, Threshold::Error(error * error), || false);
            meter.reach(1.0);
            adaptive.into_picture()
        }
    }
}

/// Renders `scene`; `progress` is called from the worker threads after every tile.
///
/// The picture depends on the scene, size, anti-aliasing and depth alone: it is the same, byte for byte, for any number
/// of threads.
///
/// # Errors
/// The threads cannot be started.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Rendering, RenderError> {
    let started = Instant::now();
    let [width, height] = options.size.unwrap_or(scene.resolution());
    let depth = options.depth.unwrap_or(scene.depth());
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let threads = options.threads.map_or_else(cores, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|source| RenderError::Threads { threads, source })?;

    let view = scene.camera().view(width, height);
    let part = Tile { x0: 0, y0: 0, x1: width, y1: height };
    let rays = Mutex::new(RayCounts::default());
    let new_sampler = || Worker {
        tracer: Tracer::new(scene, depth),
        view,
        rays: Vec::new(),
        traced: Vec::new(),
        counts: &rays,
    };
    let picture = pool.install(|| picture(&part, width, options.aa, &new_sampler, progress));
    let estimated_rmse = picture.estimated_rmse();
    let Picture { colors, samples, errors, .. } = picture;
    Ok(Rendering {
        film: Film::from_parts(part.width(), part.height(), colors, samples),
        errors,
        estimated_rmse,
        rays: rays.into_inner().unwrap_or_else(PoisonError::into_inner),
        threads,
        seconds: started.elapsed().as_secs_f64(),
        depth,
    })
}

/// Samples a scene through its camera; what it traced is added to `counts` in the end.
struct Worker<'a> {
    tracer: Tracer<'a>,
    view: View,
    rays: Vec<Ray>,
    traced: Vec<trace::Sample>,
    counts: &'a Mutex<RayCounts>,
}

impl Sampler for Worker<'_> {
    fn sample(&mut self, places: &[DVec2], samples: &mut Vec<Sample>) {
        for some in places.chunks(BATCH) {
            self.rays.clear();
            self.rays.extend(some.iter().map(|place| self.view.ray(*place)));
            self.tracer.trace(&self.rays, &mut self.traced);
            samples.extend(self.traced.iter().map(|traced| Sample {
                // A NaN, which no valid scene has, would be black.
                color: traced.color.max(Rgb::ZERO).min(Rgb::ONE),
                signature: traced.signature,
                rays: traced.rays,
            }));
        }
    }
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        *counts = *counts + self.tracer.counts();
    }
}
