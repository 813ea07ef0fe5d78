//! A picture in blocks, each rendered by itself: what is kept of a render that is interrupted, and what bounds its
//! memory.

use std::sync::{Mutex, PoisonError};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    Goal, Outcome, Progress, RayCounts, RenderError, RenderOptions, Unfinished, part, view,
};
use crate::{
    aa::{AntiAliasing, grid_places},
    color::Rgb,
    film::{Tile, tiles},
    scene::Scene,
    trace::Tracer,
};

/// Rays of all kinds that a block may take where each pixel takes the same; about a second of one thread.
const RAYS: f64 = (1 << 22) as f64;
/// Those that a block of the adaptive mode would take if each of its pixels took the most.
const MOST_RAYS: f64 = (1 << 24) as f64;
/// So many rays of all kinds follow from a camera ray, itself included, in most scenes. Blocks are no larger where it
/// is less.
const USUAL: f64 = 4.0;
/// Camera rays, in a row and in a column, that tell how many it is: at most, and one for so many pixels.
const PROBES: u32 = 16;
const PIXELS_OF_PROBE: u32 = 16;
/// The sides of blocks, in pixels. Adaptive blocks share no rays with their neighbours, so small ones trace many places
/// twice.
const SMALLEST: u32 = 4;
const SMALLEST_ADAPTIVE: u32 = 64;
const LARGEST_ADAPTIVE: u32 = 128;
const LARGEST: u32 = 1024;
/// A picture has no more blocks than this, however long they take.
const MOST_BLOCKS: u64 = 1 << 20;

/// A finished block of a picture.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its number in the list of [`blocks`].
    pub number: usize,
    /// Its place in the whole picture.
    pub place: Tile,
    /// The colours, row by row, linear.
    pub colors: Vec<Rgb>,
    /// The rays through each pixel.
    pub samples: Vec<u32>,
    /// What it took and what it is worth.
    pub account: Account,
    /// How it ended.
    pub outcome: Outcome,
}

/// What is added up over the blocks of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// The rays cast.
    pub rays: RayCounts,
    /// The estimated squared error, summed over the pixels, in levels of 255.
    pub squared_error: f64,
    /// Pixels that got all the rays they may get but did not settle.
    pub unsettled: u64,
}

impl Account {
    /// The estimated error of so many pixels: root mean square of all channels, in levels of 255.
    pub fn rmse(&self, pixels: usize) -> f64 {
        rmse(self.squared_error, pixels)
    }

    /// The sum, in the order given.
    pub fn sum<'a>(accounts: impl IntoIterator<Item = &'a Self>) -> Self {
        accounts.into_iter().fold(Self::default(), |sum, one| Self {
            rays: sum.rays + one.rays,
            squared_error: sum.squared_error + one.squared_error,
            unsettled: sum.unsettled + one.unsettled,
        })
    }
}

/// The root mean square of so many pixels' errors whose squares add up to this.
pub(super) fn rmse(squared_error: f64, pixels: usize) -> f64 {
    (squared_error / pixels.max(1) as f64).sqrt()
}

/// Where finished blocks go. All is called from the worker threads.
pub trait Sink: Sync {
    /// Whether a block is still to be rendered.
    fn wants(&self, _number: usize) -> bool {
        true
    }

    /// Takes a block. Only a picture towards an error or until a time that was stopped can have pixels without rays.
    fn put(&self, block: Block);

    /// Takes a look at a picture towards an error or until a time, whose every pixel has a ray already: its place,
    /// colours and the rays through each pixel.
    fn show(&self, _place: &Tile, _colors: &[Rgb], _samples: &[u32]) {}

    /// Whether a picture towards an error or until a time is to be kept as it is now.
    ///
    /// The sink makes it true when it wants to keep the picture, as for a checkpoint. The render then pauses soon and
    /// calls [`Sink::keep`], in which the sink makes it false again.
    fn wants_unfinished(&self) -> bool {
        false
    }

    /// Keeps a picture towards an error or until a time, which may go on from it: because that is wanted, or because it
    /// is stopped.
    fn keep(&self, _unfinished: &Unfinished) {}

    /// Gives back what was kept of such a picture, to go on from.
    fn unfinished(&self) -> Option<Unfinished> {
        None
    }

    /// Whether no further block is to be begun. Blocks at which work goes on are finished; a picture towards an error
    /// or until a time, which is one block, ends as it is.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Whether blocks at which work goes on are not to be finished either: they are not put, and what was traced of them
    /// is lost. It does not matter to a picture towards an error or until a time.
    fn is_abandoned(&self) -> bool {
        false
    }

    /// Takes note of how far the render is.
    fn report(&self, _progress: Progress) {}
}

/// The blocks of the part of `scene`'s picture that `options` ask for: they cover it without overlap, and depend on
/// nothing else than is given here.
///
/// A picture towards an error or until a time is one block. Others are cut so that a block takes about a second of one
/// thread, as far as a few rays tell how many rays follow from each.
///
/// # Errors
/// [`RenderError::Crop`](super::RenderError::Crop) if the part is empty or not in the picture.
pub fn blocks(scene: &Scene, options: &RenderOptions) -> Result<Vec<Tile>, RenderError> {
    let part = part(scene, options)?;
    if options.goal != Goal::Mode {
        return Ok(vec![part]);
    }
    Ok(cut(&part, options.aa, rays_of_one(scene, options, &part)))
}

/// The rays of all kinds that follow from a camera ray through `part`, itself included: the mean of some.
fn rays_of_one(scene: &Scene, options: &RenderOptions, part: &Tile) -> f64 {
    let view = view(scene, options);
    let mut tracer = Tracer::new(scene, options.depth.unwrap_or(scene.depth()), None, false);
    let corner = DVec2::new(part.x0.into(), part.y0.into());
    let size = DVec2::new(part.width().into(), part.height().into());
    let side = ((size.x * size.y).sqrt() as u32 / PIXELS_OF_PROBE).clamp(1, PROBES);
    let dirs = grid_places(DVec2::ZERO, side).map(|place| view.direction(corner + place * size));
    let dirs: Vec<DVec3> = dirs.collect();
    tracer.trace(view.eye(), dirs.iter().copied(), &mut Vec::new());
    tracer.take_counts().all() as f64 / dirs.len() as f64
}

/// Blocks of `part` where `rays` follow from each camera ray.
fn cut(part: &Tile, aa: AntiAliasing, rays: f64) -> Vec<Tile> {
    let side = |budget: f64, each: u32, least: u32, most: u32| {
        let of_pixel = f64::from(each) * rays.max(USUAL);
        let count = |side: u32| {
            u64::from(part.width().div_ceil(side)) * u64::from(part.height().div_ceil(side))
        };
        let is_enough = |side: u32| f64::from(side * side) * of_pixel <= budget;
        let mut side = most;
        while side > least && !is_enough(side) && count(side / 2) <= MOST_BLOCKS {
            side /= 2;
        }
        side
    };
    let side = match aa {
        AntiAliasing::None => side(RAYS, 1, SMALLEST, LARGEST),
        AntiAliasing::Grid { side: cells } => {
            side(RAYS, cells.saturating_pow(2), SMALLEST, LARGEST)
        }
        AntiAliasing::Sequence { count } => side(RAYS, count, SMALLEST, LARGEST),
        AntiAliasing::Adaptive { most, .. } => {
            side(MOST_RAYS, most, SMALLEST_ADAPTIVE, LARGEST_ADAPTIVE)
        }
    };
    tiles(part.width(), part.height(), side).iter().map(|tile| tile.plus(part)).collect()
}

/// Renders a block, given its number and place and where to report its progress; there is none if it was abandoned.
type RenderBlock<'a> =
    dyn Fn(usize, &Tile, &(dyn Fn(Progress) + Sync)) -> Option<Block> + Sync + 'a;

/// Renders each block that the sink wants with `render`, which reports its progress in units of which a pixel has
/// `units`.
pub(super) fn run(blocks: &[Tile], units: u64, sink: &dyn Sink, render: &RenderBlock) {
    let size = |tile: &Tile| units * u64::from(tile.width()) * u64::from(tile.height());
    let total = blocks.iter().map(size).sum();
    let (wanted, there): (Vec<_>, Vec<_>) =
        blocks.iter().enumerate().partition(|(number, _)| sink.wants(*number));
    let done = there.iter().map(|(_, tile)| size(tile)).sum();
    let all = Mutex::new(Progress { done, total });
    if done > 0 {
        sink.report(Progress { done, total });
    }
    wanted.into_par_iter().with_max_len(1).for_each(|(number, place)| {
        if sink.is_stopped() {
            return;
        }
        let own = Mutex::new(0);
        let report = |progress: Progress| {
            let mut own = own.lock().unwrap_or_else(PoisonError::into_inner);
            let more = progress.done.saturating_sub(*own);
            *own += more;
            let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
            all.done += more;
            // Still under the lock, so that progress never goes backwards.
            sink.report(*all);
        };
        if let Some(block) = render(number, place, &report) {
            sink.put(block);
        }
    });
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::{
        render::{render, render_blocks},
        scene::load_builtin,
    };

    /// Oracle: counting how often each pixel is covered.
    #[test]
    fn blocks_cover_each_pixel_once_whatever_the_mode() {
        let part = Tile { x0: 13, y0: 7, x1: 613, y1: 307 };
        for (mode, rays, side) in [
            ("none", 1.0, 1024),
            ("none", 3.5, 1024),
            ("none", 100.0, 128),
            ("none", 1e9, 4),
            ("grid:2", 3.5, 512),
            ("grid:3", 3.5, 256),
            ("grid:64", 3.5, 16),
            ("sobol:1048576", 3.5, 4),
            ("adaptive", 3.5, 128),
            ("adaptive", 100.0, 64),
            ("adaptive:1,1024", 3.5, 64),
            ("adaptive:1,1000000", 3.5, 64),
        ] {
            let aa: AntiAliasing = mode.parse().expect(mode);
            let blocks = cut(&part, aa, rays);
            let mut cover = vec![0; 700 * 400];
            for tile in &blocks {
                assert!(tile.width() <= side && tile.height() <= side, "{mode}: {tile:?}");
                for (x, y) in
                    (tile.y0..tile.y1).flat_map(|y| (tile.x0..tile.x1).map(move |x| (x, y)))
                {
                    cover[(y * 700 + x) as usize] += 1;
                }
            }
            assert_eq!(blocks[0].width(), side.min(600), "{mode}, {rays} rays");
            let inside = |k: usize| {
                let (x, y) = ((k % 700) as u32, (k / 700) as u32);
                (part.x0..part.x1).contains(&x) && (part.y0..part.y1).contains(&y)
            };
            assert!(cover.iter().enumerate().all(|(k, n)| *n == i32::from(inside(k))), "{mode}");
        }
    }

    #[test]
    fn even_the_largest_picture_has_no_more_than_a_million_blocks() {
        let part = Tile { x0: 0, y0: 0, x1: 30_000, y1: 30_000 };
        for rays in [4.0, 1e9] {
            let blocks = cut(&part, AntiAliasing::Sequence { count: 1 << 20 }, rays);
            assert!((MOST_BLOCKS / 4..=MOST_BLOCKS).contains(&(blocks.len() as u64)));
        }
    }

    /// Oracle: the rays that a render counts.
    #[test]
    fn blocks_are_cut_by_the_rays_that_pixels_take() {
        let scene = load_builtin("assignment").expect("built in");
        let part = Tile { x0: 100, y0: 300, x1: 500, y1: 500 };
        let options =
            RenderOptions { crop: Some(part), aa: AntiAliasing::None, ..RenderOptions::default() };
        let counted = render(&scene, &options, &|_| ()).expect("rendered").rays;
        let (mean, told) = (counted.all() as f64 / 8e4, rays_of_one(&scene, &options, &part));
        assert!((told / mean - 1.0).abs() < 0.1, "{told} for {mean}");
        assert_eq!(blocks(&scene, &options).expect("inside"), cut(&part, options.aa, told));
        let towards_error = RenderOptions { goal: Goal::Error(1.0), ..options };
        assert_eq!(blocks(&scene, &towards_error).expect("inside"), [part]);
    }

    /// Abandons everything once it was asked so many times.
    struct Impatient {
        patience: AtomicU64,
        put: AtomicU64,
        share_done: Mutex<f64>,
    }

    impl Sink for Impatient {
        fn put(&self, _: Block) {
            self.put.fetch_add(1, Ordering::Relaxed);
        }

        fn is_abandoned(&self) -> bool {
            let left = |asks: u64| Some(asks.saturating_sub(1));
            self.patience.fetch_update(Ordering::Relaxed, Ordering::Relaxed, left) == Ok(0)
        }

        fn report(&self, progress: Progress) {
            *self.share_done.lock().expect("sound") = progress.done as f64 / progress.total as f64;
        }
    }

    #[test]
    fn abandoned_blocks_end_soon_and_are_not_put() {
        let scene = load_builtin("assignment").expect("built in");
        for mode in ["none", "grid:2", "sobol:5", "adaptive"] {
            let aa = mode.parse().expect("a mode");
            let options = RenderOptions { size: Some([200, 200]), aa, ..RenderOptions::default() };
            let places = blocks(&scene, &options).expect("whole");
            for (patience, put) in [(3, 0), (u64::MAX, places.len() as u64)] {
                let sink = Impatient {
                    patience: AtomicU64::new(patience),
                    put: AtomicU64::new(0),
                    share_done: Mutex::new(0.0),
                };
                render_blocks(&scene, &options, &places, &sink).expect("rendered");
                assert_eq!(sink.put.into_inner(), put, "{mode}, {patience}");
                let done = sink.share_done.into_inner().expect("sound");
                assert!(if put == 0 { done < 0.2 } else { done == 1.0 }, "{mode}: {done}");
            }
        }
    }
}
