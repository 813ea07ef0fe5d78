//! From a scene to a film: tiles in parallel, each a function of scene and options alone.

use std::{
    num::NonZeroUsize,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Instant,
};

use glam::DVec2;
use rayon::prelude::*;
use thiserror::Error;

pub use crate::trace::RayCounts;
use crate::{
    aa::{AntiAliasing, average},
    camera::View,
    color::Rgb,
    film::{Film, Tile, tiles},
    geometry::Ray,
    scene::Scene,
    trace::{BATCH, Sample, Tracer},
};

/// The side of a tile in pixels: small enough to share the work out evenly, large enough to cost nothing by itself.
const TILE_SIDE: u32 = 16;

/// What the user may choose; the rest is the scene's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    let places = options.aa.places();
    let total = u64::from(width) * u64::from(height);
    let film = Mutex::new(Film::new(width, height));
    let done = AtomicU64::new(0);
    let finish = |tile: &Tile, pixels: &TilePixels| {
        let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
        film.blit(tile, &pixels.colors, &pixels.samples);
        let count = u64::from(tile.width()) * u64::from(tile.height());
        // Still under the lock, so that progress never goes backwards.
        progress(Progress { done: done.fetch_add(count, Ordering::Relaxed) + count, total });
    };
    let rays = pool.install(|| {
        tiles(width, height, TILE_SIDE)
            .into_par_iter()
            .with_max_len(1)
            .map_init(
                || (Tracer::new(scene, depth), TilePixels::default()),
                |(tracer, pixels), tile| {
                    let before = tracer.counts();
                    pixels.render(tracer, &view, &tile, &places);
                    finish(&tile, pixels);
                    tracer.counts() - before
                },
            )
            .reduce(RayCounts::default, std::ops::Add::add)
    });
    let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(Rendering { film, rays, threads, seconds: started.elapsed().as_secs_f64(), depth })
}

/// The pixels of one tile, row by row, and the scratch to make them; kept from tile to tile.
#[derive(Debug, Default)]
struct TilePixels {
    colors: Vec<Rgb>,
    samples: Vec<u32>,
    rays: Vec<Ray>,
    traced: Vec<Sample>,
    /// The colours of the samples of all pixels, pixel after pixel in Morton order.
    sampled: Vec<Rgb>,
}

impl TilePixels {
    fn render(&mut self, tracer: &mut Tracer, view: &View, tile: &Tile, places: &[DVec2]) {
        let pixels = morton_order(tile);
        self.sampled.clear();
        let rays = pixels
            .iter()
            .flat_map(|corner| places.iter().map(move |place| view.ray(*corner + *place)));
        // Neighbours in the picture are traced together.
        for ray in rays {
            self.rays.push(ray);
            if self.rays.len() == BATCH {
                self.trace(tracer);
            }
        }
        self.trace(tracer);

        let count = pixels.len();
        self.colors.clear();
        self.colors.resize(count, Rgb::ZERO);
        for (corner, samples) in pixels.iter().zip(self.sampled.chunks(places.len())) {
            let (column, row) = (corner.x as u32 - tile.x0, corner.y as u32 - tile.y0);
            self.colors[(row * tile.width() + column) as usize] = average(samples);
        }
        self.samples.clear();
        self.samples.resize(count, places.len() as u32);
    }

    fn trace(&mut self, tracer: &mut Tracer) {
        tracer.trace(&self.rays, &mut self.traced);
        self.sampled.extend(self.traced.iter().map(|sample| sample.color));
        self.rays.clear();
    }
}

/// The upper left corners of the pixels of a tile, so that any run of them is close together.
fn morton_order(tile: &Tile) -> Vec<DVec2> {
    let side = tile.width().max(tile.height()).next_power_of_two();
    let even_bits = |code: u32| (0..16).fold(0, |x, bit| x | ((code >> (2 * bit)) & 1) << bit);
    (0..side * side)
        .map(|code| (even_bits(code), even_bits(code >> 1)))
        .filter(|(x, y)| *x < tile.width() && *y < tile.height())
        .map(|(x, y)| DVec2::new(f64::from(tile.x0 + x), f64::from(tile.y0 + y)))
        .collect()
}
