//! Workers that take tile after tile, and how far they are.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::DVec2;
use rayon::prelude::*;

use super::{
    Progress,
    hints::Hint,
    plane::{Area, Plane, TILE_SIDE},
};
use crate::{aa::Sample, trace::BATCH};

/// Asks the colour of places on the film.
///
/// An answer depends on its place alone. Places are in pixels from the upper left corner of the whole picture.
pub trait Sampler {
    /// Puts the samples at `places` behind what `samples` holds, in their order. Neighbours in the list are near each
    /// other in the picture.
    fn sample(&mut self, places: &[DVec2], samples: &mut Vec<Sample>);

    /// How many places, at least, are best asked for at once.
    fn at_once(&self) -> usize {
        BATCH
    }

    /// What is known to be in a pixel that few samples may miss; the adaptive mode asks.
    fn hint(&self, _x: u32, _y: u32) -> Hint {
        Hint::default()
    }

    /// Whether anything is known to be in any pixel.
    fn has_hints(&self) -> bool {
        false
    }
}

/// What the mutex guards; a panic elsewhere does not spoil it.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How far all workers together are.
pub(super) struct Meter<'a> {
    progress: &'a (dyn Fn(Progress) + Sync),
    state: Mutex<Progress>,
}

impl<'a> Meter<'a> {
    pub(super) fn new(total: u64, progress: &'a (dyn Fn(Progress) + Sync)) -> Self {
        Self { progress, state: Mutex::new(Progress { done: 0, total }) }
    }

    /// Reports that `count` more are done.
    fn add(&self, count: u64) {
        let mut state = lock(&self.state);
        state.done = (state.done + count).min(state.total);
        // Still under the lock, so that progress never goes backwards.
        (self.progress)(*state);
    }

    /// Reports a share of the whole, if that is more than was done.
    pub(super) fn reach(&self, share: f64) {
        let mut state = lock(&self.state);
        let done = (state.total as f64 * share.clamp(0.0, 1.0)) as u64;
        state.done = state.done.max(done);
        (self.progress)(*state);
    }
}

/// Each thread gets at least so many groups of tiles, so that all end about the same time.
const SHARES: usize = 4;

/// The workers.
pub(super) struct Crew<'a, S> {
    new_sampler: &'a (dyn Fn() -> S + Sync),
    pub(super) meter: &'a Meter<'a>,
    /// Those that have nothing to do.
    idle: Mutex<Vec<(S, Scratch)>>,
    /// As [`Sampler::at_once`] and [`Sampler::has_hints`].
    at_once: usize,
    pub(super) has_hints: bool,
}

/// Lists that a worker keeps from tile to tile.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub(super) places: Vec<DVec2>,
    pub(super) samples: Vec<Sample>,
}

impl<'a, S: Sampler + Send> Crew<'a, S> {
    pub(super) fn new(new_sampler: &'a (dyn Fn() -> S + Sync), meter: &'a Meter<'a>) -> Self {
        let first = new_sampler();
        let (at_once, has_hints) = (first.at_once(), first.has_hints());
        let idle = Mutex::new(vec![(first, Scratch::default())]);
        Self { new_sampler, meter, idle, at_once, has_hints }
    }

    /// How many tiles are best sampled together, if a pixel gets so many samples.
    pub(super) fn tiles_at_once(&self, samples: f32) -> usize {
        let tile = (TILE_SIDE * TILE_SIDE) as f32 * samples;
        ((self.at_once as f32 / tile) as usize).max(1)
    }

    /// Lets the workers do `work` on every tile of `area`.
    pub(super) fn run(&self, area: &Area, work: impl Fn(&S, &Area) + Sync) {
        self.run_groups(area, 1, false, || false, |sampler, _, tiles| work(sampler, &tiles[0]));
    }

    /// Lets the workers do `work` on groups of up to `count` tiles of `area`, which are neighbours; `counted` is whether their
    /// pixels count as done.
    ///
    /// Groups for which `stop` says so are left out.
    pub(super) fn run_groups(
        &self,
        area: &Area,
        count: usize,
        counted: bool,
        stop: impl Fn() -> bool + Sync,
        work: impl Fn(&mut S, &mut Scratch, &[Area]) + Sync,
    ) {
        let tiles = area.tiles();
        let fair = tiles.len() / (SHARES * rayon::current_num_threads());
        tiles.par_chunks(count.min(fair).max(1)).with_max_len(1).for_each(|tiles| {
            if stop() {
                return;
            }
            let worker = lock(&self.idle).pop();
            let (mut sampler, mut scratch) =
                worker.unwrap_or_else(|| ((self.new_sampler)(), Scratch::default()));
            work(&mut sampler, &mut scratch, tiles);
            lock(&self.idle).push((sampler, scratch));
            if counted {
                self.meter.add(tiles.iter().map(|tile| tile.len() as u64).sum());
            }
        });
    }
}

/// The sum of what `of` says of every tile of `area`, on all threads; in the order of the tiles, on which it depends.
pub(super) fn sum_of_tiles(area: &Area, of: impl Fn(&Area) -> f64 + Sync + Send) -> f64 {
    let parts: Vec<f64> = area.tiles().par_iter().map(of).collect();
    parts.iter().sum()
}

/// The pixels of a tile in Morton order, so that any run of them is close together and their rays go the same way.
pub(super) fn in_turn(tile: &Area) -> impl Iterator<Item = (i64, i64)> + use<> {
    let tile = *tile;
    TURN.iter()
        .map(move |&[x, y]| (tile.x0 + i64::from(x), tile.y0 + i64::from(y)))
        .filter(move |&(x, y)| x < tile.x1 && y < tile.y1)
}

/// The columns and rows of a tile in Morton order.
const TURN: [[u8; 2]; (TILE_SIDE * TILE_SIDE) as usize] = {
    let mut turn = [[0; 2]; (TILE_SIDE * TILE_SIDE) as usize];
    let mut code = 0;
    while code < turn.len() {
        turn[code] = [even_bits(code as u32) as u8, even_bits(code as u32 >> 1) as u8];
        code += 1;
    }
    turn
};

/// The bits of a number at even places, moved together.
const fn even_bits(code: u32) -> u32 {
    let mut x = code & 0x5555_5555;
    x = (x | x >> 1) & 0x3333_3333;
    x = (x | x >> 2) & 0x0f0f_0f0f;
    x = (x | x >> 4) & 0x00ff_00ff;
    (x | x >> 8) & 0xffff
}

/// The centre of a pixel on the film.
pub(super) fn center(x: i64, y: i64) -> DVec2 {
    DVec2::new(x as f64 + 0.5, y as f64 + 0.5)
}

/// Traces the centre of every pixel of the plane that has no rays yet; where `stop` says so, they are left.
pub(super) fn trace_centers<S: Sampler + Send>(
    crew: &Crew<S>,
    centers: &mut Plane<Sample>,
    stop: impl Fn() -> bool + Sync,
) {
    let area = *centers.area();
    let group = crew.tiles_at_once(1.0);
    let centers = Mutex::new(centers);
    crew.run_groups(&area, group, true, stop, |sampler, scratch, tiles| {
        let untraced: Vec<&Area> =
            tiles.iter().filter(|tile| !lock(&centers).is_traced(tile)).collect();
        let pixels = || untraced.iter().flat_map(|tile| in_turn(tile));
        let samples = sample_centers(sampler, scratch, pixels());
        let mut centers = lock(&centers);
        for ((x, y), sample) in pixels().zip(samples) {
            *centers.at_mut(x, y) = *sample;
        }
    });
}

/// The samples at the centres of `pixels`.
pub(super) fn sample_centers<'a, S: Sampler>(
    sampler: &mut S,
    scratch: &'a mut Scratch,
    pixels: impl Iterator<Item = (i64, i64)>,
) -> &'a [Sample] {
    scratch.places.clear();
    scratch.samples.clear();
    scratch.places.extend(pixels.map(|(x, y)| center(x, y)));
    sampler.sample(&scratch.places, &mut scratch.samples);
    &scratch.samples
}
