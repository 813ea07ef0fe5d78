//! A picture in blocks, each rendered by itself: what is kept of a render that is interrupted, and what bounds its
//! memory.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::{Goal, Outcome, Progress, RayCounts, Unfinished};
use crate::{
    aa::AntiAliasing,
    color::Rgb,
    film::{Tile, tiles},
};

/// Rays that a block may take where each pixel takes the same; about a second of one thread.
const RAYS: u64 = 1 << 20;
/// Rays that a block of the adaptive mode would take if each of its pixels took the most.
const MOST_RAYS: u64 = 1 << 22;
/// The sides of blocks, in pixels. Adaptive blocks share no rays with their neighbours, so small ones trace many places
/// twice.
const SMALLEST: u32 = 16;
const SMALLEST_ADAPTIVE: u32 = 64;
const LARGEST_ADAPTIVE: u32 = 256;
const LARGEST: u32 = 1024;

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
        (self.squared_error / pixels.max(1) as f64).sqrt()
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

    /// Takes note of how far the render is.
    fn report(&self, _progress: Progress) {}
}

/// The blocks of the part `part` of a picture: they cover it without overlap, and depend on nothing else than is given
/// here.
pub fn blocks(part: &Tile, aa: AntiAliasing, goal: Goal) -> Vec<Tile> {
    if goal != Goal::Mode {
        return vec![*part];
    }
    let side = |rays: u64, each: u32, least: u32, most: u32| {
        let fits = |side: &u32| u64::from(side * side) * u64::from(each) <= rays;
        let sides = std::iter::successors(Some(most), |side| Some(side / 2));
        sides.take_while(|side| *side > least).find(fits).unwrap_or(least)
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

/// Renders a block, given its number and place and where to report its progress.
type RenderBlock<'a> = dyn Fn(usize, &Tile, &(dyn Fn(Progress) + Sync)) -> Block + Sync + 'a;

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
        let block = render(number, place, &report);
        sink.put(block);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: counting how often each pixel is covered.
    #[test]
    fn blocks_cover_each_pixel_once_whatever_the_mode() {
        let part = Tile { x0: 13, y0: 7, x1: 613, y1: 307 };
        for (mode, side) in [
            ("none", 1024),
            ("grid:2", 512),
            ("grid:3", 256),
            ("grid:64", 16),
            ("sobol:1048576", 16),
            ("adaptive", 256),
            ("adaptive:1,1024", 64),
            ("adaptive:1,1000000", 64),
        ] {
            let aa: AntiAliasing = mode.parse().expect(mode);
            let blocks = blocks(&part, aa, Goal::Mode);
            let mut cover = vec![0; 700 * 400];
            for tile in &blocks {
                assert!(tile.width() <= side && tile.height() <= side, "{mode}: {tile:?}");
                for (x, y) in
                    (tile.y0..tile.y1).flat_map(|y| (tile.x0..tile.x1).map(move |x| (x, y)))
                {
                    cover[(y * 700 + x) as usize] += 1;
                }
            }
            assert_eq!(blocks[0].width(), side.min(600), "{mode}");
            let inside = |k: usize| {
                let (x, y) = ((k % 700) as u32, (k / 700) as u32);
                (part.x0..part.x1).contains(&x) && (part.y0..part.y1).contains(&y)
            };
            assert!(cover.iter().enumerate().all(|(k, n)| *n == i32::from(inside(k))), "{mode}");
            assert_eq!(super::blocks(&part, aa, Goal::Error(1.0)), [part]);
        }
    }
}
