//! Pictures with the same rays in every pixel, and the estimate of their error from these rays alone.

use std::sync::{Mutex, PoisonError};

use glam::DVec2;
use rayon::prelude::*;

use super::{
    Outcome, Picture,
    cell::{Cell, Judge},
    crew::{Crew, Sampler, in_turn, lock, sample_centers, sum_of_tiles},
    plane::{Area, Plane},
    window::Window,
};
use crate::{
    aa::{detail::Detail, grid_places, pattern::Pattern, sobol::Sequence},
    color::Rgb,
};

/// Asked again and again; once it says so, what is left of a picture that nobody wants any more is not traced.
pub(super) type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// One ray through each centre.
pub(super) fn centers<S: Sampler + Send>(crew: &Crew<S>, area: &Area, stop: Stop) -> Picture {
    // Apart from each other, so that the colours are the picture's as they are.
    let seen = Mutex::new((Plane::new(*area, Rgb::ZERO), Plane::new(*area, 0)));
    let group = crew.tiles_at_once(1.0);
    crew.run_groups(area, group, true, stop, |sampler, scratch, tiles| {
        let pixels = || tiles.iter().flat_map(in_turn);
        let samples = sample_centers(sampler, scratch, pixels());
        let (colors, signatures) = &mut *lock(&seen);
        for ((x, y), sample) in pixels().zip(samples) {
            *colors.at_mut(x, y) = sample.color;
            *signatures.at_mut(x, y) = sample.signature;
        }
    });
    let (colors, signatures) = seen.into_inner().unwrap_or_else(PoisonError::into_inner);
    let (colors, signatures) = (colors.into_values(), signatures.into_values());
    let squared_error = sum_of_tiles(area, |tile| {
        let see = |place: usize| (colors[place], signatures[place], Detail::default());
        let errors = Window::new((tile, 1), area, see).center_errors();
        errors.into_iter().map(f64::from).sum()
    });
    Picture { colors, samples: vec![1; area.len()], squared_error, outcome: Outcome::default() }
}

/// The squared error of a ray at any place of its pixel, as a multiple of that of a ray through the centre: measured at
/// edges.
const ANY_PLACE: f64 = 1.75;

/// A grid of `side` × `side` rays through each pixel.
pub(super) fn grid<S: Sampler + Send>(
    crew: &Crew<S>,
    area: &Area,
    side: u32,
    stop: Stop,
) -> Picture {
    let places = |x: i64, y: i64, places: &mut Vec<DVec2>| {
        places.extend(grid_places(DVec2::new(x as f64, y as f64), side));
    };
    even(crew, area, Pattern::Grid(side as usize), stop, places)
}

/// `count` rays of a sequence through each pixel of a picture `width` pixels wide.
pub(super) fn sequence<S: Sampler + Send>(
    crew: &Crew<S>,
    area: &Area,
    width: u32,
    count: u32,
    stop: Stop,
) -> Picture {
    let places = |x: i64, y: i64, places: &mut Vec<DVec2>| {
        let sequence = Sequence::of_pixel(y as u64 * u64::from(width) + x as u64, 1);
        let corner = DVec2::new(x as f64, y as f64);
        places.extend((0..count).map(|point| corner + sequence.place(point)));
    };
    even(crew, area, Pattern::Sequence(count as usize), stop, places)
}

/// The rays of a `pattern` through each pixel, at the places that `pixel_places` adds to a list. A single one says nothing
/// of its error by itself, but its neighbours do.
fn even<S: Sampler + Send>(
    crew: &Crew<S>,
    area: &Area,
    pattern: Pattern,
    stop: Stop,
    pixel_places: impl Fn(i64, i64, &mut Vec<DVec2>) + Sync,
) -> Picture {
    let cells = Mutex::new(Plane::new(*area, Cell::default()));
    let count = pattern.count();
    let group = crew.tiles_at_once(count as f32);
    crew.run_groups(area, group, true, stop, |sampler, scratch, tiles| {
        let pixels_at_once = sampler.at_once().div_ceil(count);
        let mut own: Vec<Vec<Cell>> =
            tiles.iter().map(|tile| vec![Cell::default(); tile.len()]).collect();
        let of_tile = |(k, tile)| in_turn(tile).map(move |(x, y)| (k, x, y));
        let pixels: Vec<(usize, i64, i64)> = tiles.iter().enumerate().flat_map(of_tile).collect();
        let mut judge = Judge::of(pattern);
        for some in pixels.chunks(pixels_at_once) {
            scratch.places.clear();
            scratch.samples.clear();
            for (_, x, y) in some {
                pixel_places(*x, *y, &mut scratch.places);
            }
            sampler.sample(&scratch.places, &mut scratch.samples);
            for ((k, x, y), samples) in some.iter().zip(scratch.samples.chunks(count)) {
                let own_number = (x * 31 + y * 17) as u32;
                let cell = judge.cell(samples, own_number);
                own[*k][tiles[*k].place_of(*x, *y)] = cell;
            }
        }
        let mut cells = lock(&cells);
        for (tile, own) in tiles.iter().zip(own) {
            cells.put(tile, own);
        }
    });
    let cells = cells.into_inner().unwrap_or_else(PoisonError::into_inner);
    let squared_error = sum_of_tiles(area, |tile| {
        let see = |place: usize| {
            let Cell { color, signature, .. } = cells.values()[place];
            (color, signature, Detail::default())
        };
        let window = Window::new((tile, 1), area, see);
        if count == 1 {
            let errors = window.center_errors();
            return ANY_PLACE * errors.into_iter().map(f64::from).sum::<f64>();
        }
        let hidden = window.suspects().into_iter().map(|(place, look)| {
            let (x, y) = tile.pixel_at(place);
            cells.hidden_at(x, y, pattern, look.contrast)
        });
        let seen = tile.pixels().map(|(x, y)| cells.error_at(x, y));
        seen.chain(hidden).map(f64::from).sum()
    });
    Picture {
        colors: cells.values().par_iter().map(|cell| cell.color).collect(),
        samples: vec![count as u32; area.len()],
        squared_error,
        outcome: Outcome::default(),
    }
}
