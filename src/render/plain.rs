//! Pictures with the same rays in every pixel, and the estimate of their error from these rays alone.

use std::sync::{Mutex, PoisonError};

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use super::{
    Outcome, Picture,
    crew::{Crew, Sampler, in_turn, lock, sum_of_tiles, trace_centers},
    look::Window,
    plane::{Area, Plane},
};
use crate::{
    aa::{
        Sample,
        estimate::{
            GRID_OF_FOUR, Parts, Spread, bare_sequence_share, grid_unseen, interleaved_share,
            sequence_unseen,
        },
        grid_places,
        kinds::Kinds,
        levels::{error_of_light, levels},
        sobol::Sequence,
    },
    color::Rgb,
};

/// One ray through each centre.
pub(super) fn centers<S: Sampler + Send>(crew: &Crew<S>, area: &Area) -> Picture {
    let mut centers = Plane::new(*area, Sample::default());
    trace_centers(crew, &mut centers, || false);
    let squared_error = sum_of_tiles(area, |tile| {
        let errors = Window::of_centers(tile, &centers).center_errors();
        errors.into_iter().map(f64::from).sum()
    });
    Picture {
        colors: centers.values().par_iter().map(|sample| sample.color).collect(),
        samples: vec![1; area.len()],
        squared_error,
        outcome: Outcome::default(),
    }
}

/// The squared error of a ray at any place of its pixel, as a multiple of that of a ray through the centre: measured at
/// edges.
const ANY_PLACE: f64 = 1.75;

/// What is kept of a pixel of a grid until its neighbours are known.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    color: Rgb,
    error: f32,
    /// The signature, if all samples share it; else a number of the pixel's own.
    signature: u32,
    alike: bool,
    kinds: Kinds,
    /// The squared error if the others were met by chance.
    by_chance: f32,
}

/// A grid of `side` × `side` rays through each pixel.
pub(super) fn grid<S: Sampler + Send>(crew: &Crew<S>, area: &Area, side: u32) -> Picture {
    let parts = Parts::OfGrid(side as usize);
    let places = |x: i64, y: i64, places: &mut Vec<DVec2>| {
        places.extend(grid_places(DVec2::new(x as f64, y as f64), side));
    };
    let judge = |levels: &[Vec3], spread: &Spread| {
        // Without any edge it is at most half of what it is at one.
        let part = if spread.kinds() == 1 { 0.5 } else { 1.0 };
        if side == 2 {
            return part * spread.error(GRID_OF_FOUR, 0.0);
        }
        let variance = parts.variance(levels.iter().copied());
        part * interleaved_share(side) * variance.element_sum() / 3.0
    };
    even(crew, area, (side * side, parts), places, judge, grid_unseen(side))
}

/// `count` rays of a sequence through each pixel of a picture `width` pixels wide.
pub(super) fn sequence<S: Sampler + Send>(
    crew: &Crew<S>,
    area: &Area,
    width: u32,
    count: u32,
) -> Picture {
    let places = |x: i64, y: i64, places: &mut Vec<DVec2>| {
        let sequence = Sequence::of_pixel(y as u64 * u64::from(width) + x as u64, 1);
        let corner = DVec2::new(x as f64, y as f64);
        places.extend((0..count).map(|point| corner + sequence.place(point)));
    };
    let judge = |_: &[Vec3], spread: &Spread| spread.error(bare_sequence_share(count), 0.0);
    let parts = Parts::OfSequence(count as usize);
    even(crew, area, (count, parts), places, judge, sequence_unseen(count))
}

/// `count` rays through each pixel at the places that `pixel_places` adds to a list. `judge` tells the squared error of
/// their mean from their display levels; where they are alike, `unseen` of the contrast to the neighbours is added. A
/// single one says nothing of its error by itself, but its neighbours do.
fn even<S: Sampler + Send>(
    crew: &Crew<S>,
    area: &Area,
    (count, parts): (u32, Parts),
    pixel_places: impl Fn(i64, i64, &mut Vec<DVec2>) + Sync,
    judge: impl Fn(&[Vec3], &Spread) -> f32 + Sync,
    unseen: f32,
) -> Picture {
    let cells = Mutex::new(Plane::new(*area, Cell::default()));
    let (rays, count) = (count, count as usize);
    let group = crew.tiles_at_once(count as f32);
    crew.run_groups(
        area,
        group,
        true,
        || false,
        |sampler, scratch, tiles| {
            let pixels_at_once = sampler.at_once().div_ceil(count);
            let mut own: Vec<Vec<Cell>> =
                tiles.iter().map(|tile| vec![Cell::default(); tile.len()]).collect();
            let of_tile = |(k, tile)| in_turn(tile).map(move |(x, y)| (k, x, y));
            let pixels: Vec<(usize, i64, i64)> =
                tiles.iter().enumerate().flat_map(of_tile).collect();
            let mut seen = Vec::with_capacity(count);
            for some in pixels.chunks(pixels_at_once) {
                scratch.places.clear();
                scratch.samples.clear();
                for (_, x, y) in some {
                    pixel_places(*x, *y, &mut scratch.places);
                }
                sampler.sample(&scratch.places, &mut scratch.samples);
                for ((k, x, y), samples) in some.iter().zip(scratch.samples.chunks(count)) {
                    seen.clear();
                    seen.extend(samples.iter().map(|sample| levels(sample.color)));
                    let mut spread = Spread::about(seen[0]);
                    let mut sum = Rgb::ZERO;
                    for (sample, levels) in samples.iter().zip(&seen) {
                        sum += sample.color;
                        spread.add(*levels, sample.signature);
                    }
                    let only = spread.only_signature();
                    let color = sum / count as f32;
                    let kinds = Kinds::of(samples);
                    let by_chance = if kinds.has_few_others() {
                        let variance = parts.variance(samples.iter().map(|sample| sample.color));
                        error_of_light(color, variance.map(f32::sqrt))
                    } else {
                        0.0
                    };
                    own[*k][tiles[*k].place_of(*x, *y)] = Cell {
                        color,
                        error: judge(&seen, &spread),
                        signature: only.unwrap_or((x * 31 + y * 17) as u32),
                        alike: only.is_some(),
                        kinds,
                        by_chance,
                    };
                }
            }
            let mut cells = lock(&cells);
            for (tile, own) in tiles.iter().zip(own) {
                cells.put(tile, own);
            }
        },
    );
    let cells = cells.into_inner().unwrap_or_else(PoisonError::into_inner);
    let squared_error = sum_of_tiles(area, |tile| {
        let window = Window::new(tile, &cells, |cell| (cell.color, cell.signature));
        if count == 1 {
            let errors = window.center_errors();
            return ANY_PLACE * errors.into_iter().map(f64::from).sum::<f64>();
        }
        let hidden = window.suspects().into_iter().map(|(place, look)| {
            let (x, y) = tile.pixel_at(place);
            if cells.at(x, y).alike { unseen * look.contrast } else { 0.0 }
        });
        let seen = tile.pixels().map(|(x, y)| {
            let cell = cells.at(x, y);
            let around = (0..9).map(|k| cells.nearest(x + k % 3 - 1, y + k / 3 - 1).kinds);
            if cell.by_chance > cell.error && cell.kinds.are_small_among(around) {
                cell.by_chance
            } else {
                cell.error
            }
        });
        seen.chain(hidden).map(f64::from).sum()
    });
    Picture {
        colors: cells.values().par_iter().map(|cell| cell.color).collect(),
        samples: vec![rays; area.len()],
        squared_error,
        outcome: Outcome::default(),
    }
}
