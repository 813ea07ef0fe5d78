//! From a scene to a film: blocks in parallel, each a function of scene and options alone.

mod adaptive;
mod blocks;
mod cell;
mod crew;
mod demand;
mod goal;
mod hidden;
mod highlights;
mod hints;
mod known;
mod look;
mod outlook;
mod patch;
mod picture;
mod plain;
mod plane;
pub mod refine;
mod round;
mod thin;
mod watch;
mod whole;
mod window;
mod worker;

use std::{
    num::NonZeroUsize,
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use rayon::{ThreadPool, ThreadPoolBuilder};
use thiserror::Error;

pub use blocks::{Account, Block, Sink, blocks};
pub use crew::Sampler;
pub use goal::Unfinished;
use hints::Hints;
pub use hints::{Glint, Hint, Least};
pub use picture::{Picture, picture};

pub use crate::trace::RayCounts;
use crate::{
    aa::{AaError, AntiAliasing},
    camera::{Camera, View},
    film::{Film, Tile},
    scene::Scene,
    trace::Tracer,
};
use picture::{picture_watched, progress_units};
use plane::Area;
use watch::Watch;
use worker::{Worker, places_at_once};

/// What the user may choose; the rest is the scene's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// Width and height in pixels, instead of the scene's.
    pub size: Option<[u32; 2]>,
    /// Where the scene is seen from, in the coordinates of its description, instead of from the scene's own place.
    pub camera: Option<Camera>,
    /// How pixels are sampled.
    pub aa: AntiAliasing,
    /// The deepest level of recursion, instead of the scene's; camera rays have level 1.
    pub depth: Option<u32>,
    /// The part of the picture that is wanted, instead of all of it.
    pub crop: Option<Tile>,
    /// What the adaptive mode aims at, instead of an error in each pixel.
    pub goal: Goal,
    /// How many threads work; all cores by default. The picture is the same for any number.
    pub threads: Option<NonZeroUsize>,
}

/// What a render aims at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Goal {
    /// What the anti-aliasing mode says of each pixel.
    #[default]
    Mode,
    /// An estimated error of the part that is rendered: root mean square of all channels, in levels of 255. Rays go
    /// where they reduce it most. Needs the adaptive mode, whose own error is not minded.
    Error(f64),
    /// The least error until then, but one ray in each pixel at least. Needs the adaptive mode, whose own error is not
    /// minded. How far it gets depends on the machine, so this picture is not the same every time.
    Until(Instant),
}

/// How a render ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// If the goal was an error, the threshold of the last step: pixels got more rays as long as their squared error in
    /// levels, for each ray of their next stage, was at least this, unless it was less than a 64th of the square of the
    /// error that was wanted. The same value gives the same pixels, whatever part is rendered.
    pub per_ray: Option<f32>,
    /// The error that was wanted but not reached.
    pub missed_error: Option<f64>,
    /// Pixels that got all the rays they may get but did not settle, if that was the goal.
    pub unsettled: usize,
    /// How long one ray in each pixel took, if the time was up by then.
    pub late: Option<Duration>,
    /// Whether the clock decided what was refined.
    pub cut: bool,
    /// Whether there was time left when more rays, of those that pixels may get, were worth nothing to any pixel.
    pub is_used_up: bool,
    /// Whether it was stopped before its goal, and only kept to go on from.
    pub is_stopped: bool,
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is done, in units of which each pixel has as many.
    pub done: u64,
    /// What there is to do.
    pub total: u64,
}

/// A picture, and what it took.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The picture.
    pub film: Film,
    /// The picture's estimated error against the exact average over each pixel: root mean square of all channels, in levels of
    /// 255; `None` for a single ray through a single pixel, and by the classical rules, which estimate nothing.
    pub estimated_rmse: Option<f64>,
    /// How it ended.
    pub outcome: Outcome,
    /// The rays cast.
    pub rays: RayCounts,
    /// The threads used.
    pub threads: usize,
    /// The time, in seconds, without loading and writing.
    pub seconds: f64,
    /// The deepest level of recursion that was allowed.
    pub depth: u32,
}

impl Rendering {
    /// The picture `film` of blocks with these accounts, in the order of their numbers.
    pub(crate) fn of_blocks<'a>(
        film: Film,
        accounts: impl Iterator<Item = &'a Account>,
        outcome: Outcome,
        effort: &Effort,
    ) -> Self {
        let sum = Account::sum(accounts);
        Self {
            // A ray through a pixel without neighbours tells nothing of its error.
            estimated_rmse: (film.samples() != [1]).then(|| sum.rmse(film.pixels().len())),
            outcome: Outcome { unsettled: sum.unsettled as usize, ..outcome },
            rays: sum.rays,
            threads: effort.threads,
            seconds: effort.seconds,
            depth: effort.depth,
            film,
        }
    }
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
    /// The part that is wanted is empty or not in the picture.
    #[error(
        "the part from ({}, {}) to ({}, {}) is not in a picture of {width}x{height} pixels, or empty",
        part.x0, part.y0, part.x1, part.y1
    )]
    Crop {
        /// The part.
        part: Tile,
        /// Pixels in a row of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
    },
    /// The mode has a number that no mode has.
    #[error(transparent)]
    Mode(#[from] AaError),
    /// A goal was set for a mode that gives every pixel the same rays.
    #[error("an error or a time to render to needs the anti-aliasing mode `adaptive`, not `{aa}`")]
    Goal {
        /// The mode.
        aa: AntiAliasing,
    },
}

/// Renders `scene`; `progress` is called from the worker threads, again and again.
///
/// The picture depends on the scene and the options alone, and not on the number of threads: it is the same, byte for byte,
/// every time, but for [`Goal::Until`].
///
/// # Errors
/// The part that is wanted is not in the picture, the mode has a number that none has, the goal needs another mode, or the
/// threads cannot be started.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Rendering, RenderError> {
    let part = part(scene, options)?;
    let whole = whole::Whole::new(&part, progress);
    let effort = render_blocks(scene, options, &blocks(scene, options)?, &whole)?;
    Ok(whole.into_rendering(&effort))
}

/// What a render took, apart from what is known of each block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// The threads used.
    pub threads: usize,
    /// The time, in seconds, without loading and writing.
    pub seconds: f64,
    /// The deepest level of recursion that was allowed.
    pub depth: u32,
}

/// The part of the picture that is wanted.
///
/// # Errors
/// [`RenderError::Crop`] if it is empty or not in the picture.
pub fn part(scene: &Scene, options: &RenderOptions) -> Result<Tile, RenderError> {
    let [width, height] = options.size.unwrap_or(scene.resolution());
    let part = options.crop.unwrap_or(Tile { x0: 0, y0: 0, x1: width, y1: height });
    if part.x0 >= part.x1 || part.y0 >= part.y1 || part.x1 > width || part.y1 > height {
        return Err(RenderError::Crop { part, width, height });
    }
    Ok(part)
}

/// Where the picture that is wanted is seen from.
fn view(scene: &Scene, options: &RenderOptions) -> View {
    let [width, height] = options.size.unwrap_or(scene.resolution());
    let camera = options.camera.map_or(*scene.camera(), |camera| scene.own_camera(camera));
    camera.view(width, height)
}

/// Renders those of the blocks at `places`, which are [`blocks`] of a picture of `scene`, that `sink` wants, and hands
/// them to it.
///
/// Each block is the same whichever others are rendered, in whatever order and by however many threads, unless the goal
/// is [`Goal::Until`]: then it depends on the clock.
///
/// # Errors
/// Those of [`render`].
pub fn render_blocks(
    scene: &Scene,
    options: &RenderOptions,
    places: &[Tile],
    sink: &dyn Sink,
) -> Result<Effort, RenderError> {
    let started = Instant::now();
    let part = part(scene, options)?;
    options.aa.check()?;
    let is_adaptive = matches!(options.aa, AntiAliasing::Adaptive { .. });
    if options.goal != Goal::Mode && !is_adaptive {
        return Err(RenderError::Goal { aa: options.aa });
    }
    let [width, _] = options.size.unwrap_or(scene.resolution());
    let depth = options.depth.unwrap_or(scene.depth());
    let pool = pool(options.threads)?;
    let (view, mode) = (view(scene, options), (options.aa, options.goal));
    let area = Area::of(&part);
    let hints = is_adaptive.then(|| pool.install(|| Hints::of(scene, &view, &area)));
    let is_one_ray = matches!(options.aa, AntiAliasing::None | AntiAliasing::Grid { side: 1 });
    // Telling highlights apart costs the adaptive mode a few rays about each, which narrow ones are worth.
    let tells_highlights = hints.as_ref().map_or(!is_one_ray, |hints| hints.has_glints);
    let hints = hints.and_then(|hints| hints.pixels);
    // Single rays through the centres tell of each other, if pictures are not too regular.
    let looks_into_pictures = !is_one_ray && scene.has_pictures();
    let cone = looks_into_pictures.then(|| view.cone(options.aa.side_of_sample()));
    let at_once = places_at_once(scene);
    let block = |number: usize, place: &Tile, progress: &(dyn Fn(Progress) + Sync)| {
        let rays = Mutex::new(RayCounts::default());
        let new_sampler = || Worker {
            tracer: Tracer::new(scene, depth, cone, tells_highlights),
            view,
            at_once,
            hints: hints.as_ref(),
            counts: &rays,
        };
        let watch = Watch { sink, place, rays: &rays };
        let picture = picture_watched(place, width, mode, &new_sampler, progress, &watch);
        if options.goal == Goal::Mode && sink.is_abandoned() {
            return None;
        }
        let rays = rays.into_inner().unwrap_or_else(PoisonError::into_inner);
        Some(picture.into_block(number, *place, rays))
    };
    pool.install(|| blocks::run(places, progress_units(options.aa, options.goal), sink, &block));
    let seconds = started.elapsed().as_secs_f64();
    Ok(Effort { threads: pool.current_num_threads(), seconds, depth })
}

/// So many worker threads, or one for each core.
pub(crate) fn pool(threads: Option<NonZeroUsize>) -> Result<ThreadPool, RenderError> {
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let threads = threads.map_or_else(cores, NonZeroUsize::get);
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|source| RenderError::Threads { threads, source })
}
