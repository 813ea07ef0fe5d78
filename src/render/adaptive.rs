//! Rays where the picture needs them: centres find the suspects, corners rank them, sequences of samples settle them.
//!
//! What becomes of a pixel depends on the samples within one pixel around it, and on nothing that other pixels decide.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicU64, Ordering},
};

use glam::DVec2;

use super::{
    Outcome, Picture,
    crew::{Crew, Sampler, in_turn, lock, trace_centers},
    goal::Demand,
    hidden::hidden_error,
    look::{ONE_COLOR, Window, corrected, skips_cells},
    outlook::{Outlook, outlooks, tile_of},
    plane::{Area, Plane},
    round::{
        Pixel, Round, Threshold, add_rays, is_above, is_disputed, is_picked, next_rays, wants_next,
    },
};
use crate::{
    aa::{
        Sample,
        refined::{Stage, stages},
    },
    color::Rgb,
};

/// The samples that a pixel gets at least where a pattern's cells are no wider than it: its centre and corners, and those of its
/// neighbours, may all have met the same colour.
const LEAST_IN_CELLS: u32 = 8;

/// A picture that gets better with every call of [`Adaptive::refine`].
pub(super) struct Adaptive {
    area: Area,
    /// Pixels in a row of the whole picture.
    width: u32,
    /// Of a pixel after its centre.
    stages: Vec<Stage>,
    centers: Plane<Sample>,
    /// Corners of pixels; those not traced have no rays.
    corners: Plane<Sample>,
    known: Known,
    /// Rays of all kinds so far.
    spent: AtomicU64,
}

/// What is known of the pixels of the area.
struct Known {
    pixels: Plane<Pixel>,
    colors: Plane<Rgb>,
    samples: Plane<u32>,
    /// By tile.
    outlooks: Plane<Outlook>,
}

impl Known {
    /// Adds what may hide at these places to what the picture is expected to be off by.
    fn expect_hidden(&mut self, mut places: Vec<(i64, i64)>) {
        let area = *self.pixels.area();
        // Sums depend on their order, which that of the tiles must not.
        places.sort_unstable_by_key(|&(x, y)| (y, x));
        for (x, y) in places {
            let hidden = hidden_error(&area, &self.pixels, x, y);
            self.pixels.at_mut(x, y).expected += hidden;
            let (column, row) = tile_of(&area, x, y);
            self.outlooks.at_mut(column, row).expected += f64::from(hidden);
        }
    }
}

impl Adaptive {
    /// Traces the centres of `area`, and of the pixels around it, so that a part of a picture is that of the whole.
    ///
    /// When `stop` says so, the pixels that are left have no samples, and nothing is to be refined.
    pub(super) fn new<S: Sampler + Send>(
        crew: &Crew<S>,
        area: &Area,
        width: u32,
        most: u32,
        stop: impl Fn() -> bool + Sync,
    ) -> Self {
        let centers = trace_centers(crew, &area.grown(1), stop);
        let spent = centers.values().iter().map(|sample| u64::from(sample.rays)).sum();
        let stages = stages(most);
        let samples = area.pixels().map(|(x, y)| u32::from(centers.at(x, y).rays > 0)).collect();
        let known = Mutex::new(Known {
            pixels: Plane::new(*area, Pixel::default()),
            colors: Plane::new(*area, Rgb::ZERO),
            samples: Plane::of(*area, samples),
            outlooks: outlooks(area),
        });
        let has_thin = (crew.new_sampler)().has_thin();
        let of_one_color = Mutex::new(Vec::new());
        crew.run(
            area,
            false,
            || false,
            |sampler, _, tile| {
                let window = Window::of_centers(tile, &centers);
                let (own_pixels, own_colors): (Vec<_>, Vec<_>) = tile
                    .pixels()
                    .zip(window.looks())
                    .map(|((x, y), look)| {
                        let color = if look.inner {
                            corrected(&centers, x, y)
                        } else {
                            centers.at(x, y).color
                        };
                        let thin =
                            if has_thin { sampler.least_samples(x as u32, y as u32) } else { 0 };
                        let skips = look.suspect && skips_cells(&centers, x, y, look.contrast);
                        let cells = if skips { LEAST_IN_CELLS } else { 0 };
                        let error = look.center_error(look.inner);
                        let pixel = Pixel {
                            suspect: look.suspect,
                            error,
                            expected: error,
                            least: thin.max(cells),
                            contrast: look.contrast,
                            busy: look.busy,
                            ..Pixel::default()
                        };
                        (pixel, color)
                    })
                    .unzip();
                let outlook = Outlook::of(tile, &own_pixels, &stages, &centers);
                let is_of_one_color =
                    |(_, pixel): &(_, &Pixel)| pixel.suspect && pixel.contrast < ONE_COLOR;
                let found = tile.pixels().zip(&own_pixels).filter(is_of_one_color);
                lock(&of_one_color).extend(found.map(|(place, _)| place));
                let mut known = lock(&known);
                known.pixels.put(tile, own_pixels);
                known.colors.put(tile, own_colors);
                let (column, row) = tile_of(area, tile.x0, tile.y0);
                *known.outlooks.at_mut(column, row) = outlook;
            },
        );
        let mut known = known.into_inner().unwrap_or_else(PoisonError::into_inner);
        known.expect_hidden(of_one_color.into_inner().unwrap_or_else(PoisonError::into_inner));
        Self {
            area: *area,
            width,
            stages,
            centers,
            corners: Plane::new(area.corners(), Sample::default()),
            known,
            spent: AtomicU64::new(spent),
        }
    }

    /// Gives every pixel above the threshold its next samples, until none is or all have the most they may get.
    ///
    /// When `stop` says so, the tiles that are left stay as they are.
    pub(super) fn refine<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        threshold: Threshold,
        counted: bool,
        stop: impl Fn() -> bool + Sync,
    ) {
        self.trace_corners(crew, threshold, &stop);
        let (area, centers, spent) = (&self.area, &self.centers, &self.spent);
        let known = Mutex::new(&mut self.known);
        let round = Round {
            area,
            width: self.width,
            stages: &self.stages,
            centers,
            corners: &self.corners,
            threshold,
            stop: &stop,
        };
        crew.run(area, counted, &stop, |sampler, scratch, tile| {
            let (column, row) = tile_of(area, tile.x0, tile.y0);
            let mut own = {
                let mut known = lock(&known);
                if !known.outlooks.at(column, row).may_exceed(threshold) {
                    return;
                }
                known.pixels.take(tile)
            };
            let mut changed = vec![false; own.len()];
            round.cross(tile, &mut own, &mut changed);
            let places = in_turn(tile).map(|(x, y)| tile.place_of(x, y));
            let mut wanting: Vec<usize> =
                places.filter(|&index| round.wants(tile, &own[index], index)).collect();
            while !wanting.is_empty() {
                if !round.give(tile, &wanting, &mut own, &mut changed, (sampler, scratch), spent) {
                    break;
                }
                if matches!(threshold, Threshold::PerRayOfSome(..)) {
                    break; // how much was worth it is known for one stage
                }
                wanting.retain(|&index| round.wants(tile, &own[index], index));
            }
            let outlook = Outlook::of(tile, &own, round.stages, centers);
            let mut known = lock(&known);
            for (index, (x, y)) in tile.pixels().enumerate().filter(|(i, _)| changed[*i]) {
                if let Some(refined) = &own[index].refined {
                    *known.colors.at_mut(x, y) = refined.color();
                    // Corners that only neighbours wanted do not count, or it would depend on whether those are rendered.
                    let own = !own[index].suspect || is_disputed(centers, x, y);
                    *known.samples.at_mut(x, y) = 1 + u32::from(own) + refined.points();
                }
            }
            known.pixels.put(tile, own);
            *known.outlooks.at_mut(column, row) = outlook;
        });
    }

    /// Traces the corners that pixels above the threshold will look at.
    fn trace_corners<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        threshold: Threshold,
        stop: &(impl Fn() -> bool + Sync),
    ) {
        if self.stages.is_empty() {
            return;
        }
        let traced = Mutex::new(Vec::new());
        let (area, outlooks) = (&self.area, &self.known.outlooks);
        // Corners belong to the pixels up and left of them too.
        let may_exceed = |x: i64, y: i64| {
            let (column, row) = tile_of(area, x.max(area.x0), y.max(area.y0));
            outlooks.nearest(column, row).may_exceed(threshold)
        };
        crew.run(self.corners.area(), false, stop, |sampler, scratch, tile| {
            let (left, top) = (tile.x0 - 1, tile.y0 - 1);
            if ![(tile.x0, tile.y0), (left, tile.y0), (tile.x0, top), (left, top)]
                .iter()
                .any(|&(x, y)| may_exceed(x, y))
            {
                return;
            }
            let wanted = self.wanted_corners(tile, threshold);
            if wanted.is_empty() {
                return;
            }
            scratch.places.clear();
            scratch.samples.clear();
            scratch.places.extend(wanted.iter().map(|&(x, y)| DVec2::new(x as f64, y as f64)));
            sampler.sample(&scratch.places, &mut scratch.samples);
            add_rays(&self.spent, &scratch.samples);
            let mut traced = lock(&traced);
            traced.extend(wanted.iter().zip(&scratch.samples).map(|(&(x, y), s)| (x, y, *s)));
        });
        for (x, y, sample) in traced.into_inner().unwrap_or_else(PoisonError::into_inner) {
            *self.corners.at_mut(x, y) = sample;
        }
    }

    /// The corners in a tile that pixels above the threshold will look at, and that are not traced yet.
    fn wanted_corners(&self, tile: &Area, threshold: Threshold) -> Vec<(i64, i64)> {
        let (area, centers) = (&self.area, &self.centers);
        let around = Area {
            x0: (tile.x0 - 1).max(area.x0),
            y0: (tile.y0 - 1).max(area.y0),
            x1: tile.x1.min(area.x1),
            y1: tile.y1.min(area.y1),
        };
        let mut is_wanted = vec![false; tile.len()];
        for (x, y) in around.pixels() {
            let pixel = self.known.pixels.at(x, y);
            if pixel.stage > 0
                || !wants_next(&self.stages, threshold, pixel, centers.at(x, y))
                || !is_picked(threshold, x, y)
            {
                continue;
            }
            for (x, y) in [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)] {
                if tile.contains(x, y)
                    && self.corners.at(x, y).rays == 0
                    && (!pixel.suspect || is_disputed(centers, x, y))
                {
                    is_wanted[tile.place_of(x, y)] = true;
                }
            }
        }
        if !is_wanted.contains(&true) {
            return Vec::new();
        }
        in_turn(tile).filter(|&(x, y)| is_wanted[tile.place_of(x, y)]).collect()
    }

    /// The estimated error: root mean square of all channels, in levels of 255.
    pub(super) fn estimated_rmse(&self) -> f64 {
        let sum: f64 = self.known.outlooks.values().iter().map(|tile| tile.expected).sum();
        (sum / self.area.len().max(1) as f64).sqrt()
    }

    /// The colours and the rays of the pixels so far.
    pub(super) fn shown(&self) -> (&[Rgb], &[u32]) {
        (self.known.colors.values(), self.known.samples.values())
    }

    /// Rays of all kinds so far.
    pub(super) fn spent(&self) -> u64 {
        self.spent.load(Ordering::Relaxed)
    }

    /// Whether a pixel that is off may get more rays.
    pub(super) fn can_improve(&self) -> bool {
        self.known.outlooks.values().iter().any(Outlook::can_improve)
    }

    /// How many pixels got all the rays they may get, and have a squared error of at least `limit`.
    pub(super) fn unsettled(&self, limit: f32) -> usize {
        let is_unsettled = |p: &&Pixel| {
            usize::from(p.stage) >= self.stages.len()
                && is_above(Threshold::Error(limit), p.error, 0.0)
        };
        self.known.pixels.values().iter().filter(is_unsettled).count()
    }

    /// What the next stages of all pixels are worth, and take.
    pub(super) fn demand(&self) -> Demand {
        let mut demand = Demand::new();
        for ((x, y), pixel) in self.area.pixels().zip(self.known.pixels.values()) {
            if let Some(rays) = next_rays(&self.stages, pixel, self.centers.at(x, y)) {
                let worth = if pixel.is_due() { f32::MAX } else { pixel.error / rays };
                demand.add(worth, rays.ceil() as u64);
            }
        }
        demand
    }

    pub(super) fn into_picture(self) -> Picture {
        let Known { pixels, colors, samples, .. } = self.known;
        Picture {
            colors: colors.into_values(),
            samples: samples.into_values(),
            errors: pixels.values().iter().map(|pixel| pixel.expected).collect(),
            outcome: Outcome::default(),
        }
    }
}
