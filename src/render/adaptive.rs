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
    crew::{Crew, Sampler, in_turn, trace_centers},
    goal::Demand,
    look::{Window, corrected, skips_cells},
    plane::{Area, Plane},
    round::{
        Pixel, Round, Threshold, add_rays, corner_rays, is_above, is_disputed, is_picked,
        wants_corners,
    },
};
use crate::{
    aa::{Sample, refined::stages},
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
    stages: Vec<u32>,
    centers: Plane<Sample>,
    /// Corners of pixels; those not traced have no rays.
    corners: Plane<Sample>,
    pixels: Plane<Pixel>,
    colors: Plane<Rgb>,
    samples: Plane<u32>,
    /// Rays of all kinds so far.
    spent: AtomicU64,
}

impl Adaptive {
    /// Traces the centres of `area`, and of the pixels around it, so that a part of a picture is that of the whole.
    pub(super) fn new<S: Sampler + Send>(
        crew: &Crew<S>,
        area: &Area,
        width: u32,
        most: u32,
    ) -> Self {
        let centers = trace_centers(crew, &area.grown(1));
        let spent = centers.values().iter().map(|sample| u64::from(sample.rays)).sum();
        let colors = Mutex::new(Plane::new(*area, Rgb::ZERO));
        let pixels = Mutex::new(Plane::new(*area, Pixel::default()));
        let has_thin = (crew.new_sampler)().has_thin();
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
                        let skips = look.suspect && skips_cells(&centers, x, y);
                        let cells = if skips { LEAST_IN_CELLS } else { 0 };
                        let pixel = Pixel {
                            suspect: look.suspect,
                            error: look.center_error(look.inner),
                            expected: look.center_error(look.inner),
                            least: thin.max(cells),
                            contrast: look.contrast,
                            busy: look.busy,
                            ..Pixel::default()
                        };
                        (pixel, color)
                    })
                    .unzip();
                pixels.lock().unwrap_or_else(PoisonError::into_inner).put(tile, own_pixels);
                colors.lock().unwrap_or_else(PoisonError::into_inner).put(tile, own_colors);
            },
        );
        Self {
            area: *area,
            width,
            stages: stages(most),
            centers,
            corners: Plane::new(area.corners(), Sample::default()),
            pixels: pixels.into_inner().unwrap_or_else(PoisonError::into_inner),
            colors: colors.into_inner().unwrap_or_else(PoisonError::into_inner),
            samples: Plane::new(*area, 1),
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
        let spent = &self.spent;
        let (pixels, colors, samples) = (
            Mutex::new(&mut self.pixels),
            Mutex::new(&mut self.colors),
            Mutex::new(&mut self.samples),
        );
        let round = Round {
            area: &self.area,
            width: self.width,
            stages: &self.stages,
            centers: &self.centers,
            corners: &self.corners,
            threshold,
            stop: &stop,
        };
        crew.run(&self.area, counted, &stop, |sampler, scratch, tile| {
            let mut own = pixels.lock().unwrap_or_else(PoisonError::into_inner).take(tile);
            let mut changed = vec![false; own.len()];
            round.cross(tile, &mut own, &mut changed);
            let mut wanting: Vec<usize> = Vec::new();
            loop {
                wanting.clear();
                let places = in_turn(tile).map(|(x, y)| tile.place_of(x, y));
                wanting.extend(places.filter(|&index| round.wants(tile, &own[index], index)));
                if wanting.is_empty() {
                    break;
                }
                if !round.give(tile, &wanting, &mut own, &mut changed, (sampler, scratch), spent) {
                    break;
                }
                if matches!(threshold, Threshold::PerRayOfSome(..)) {
                    break; // how much was worth it is known for one stage
                }
            }
            if changed.contains(&true) {
                let mut colors = colors.lock().unwrap_or_else(PoisonError::into_inner);
                let mut samples = samples.lock().unwrap_or_else(PoisonError::into_inner);
                for (index, (x, y)) in tile.pixels().enumerate().filter(|(i, _)| changed[*i]) {
                    if let Some(refined) = &own[index].refined {
                        *colors.at_mut(x, y) = refined.color();
                        // Corners that only neighbours wanted do not count, or it would depend on whether those are rendered.
                        let own = !own[index].suspect || is_disputed(&self.centers, x, y);
                        *samples.at_mut(x, y) = 1 + u32::from(own) + refined.points();
                    }
                }
            }
            pixels.lock().unwrap_or_else(PoisonError::into_inner).put(tile, own);
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
        let (pixels, centers, known) = (&self.pixels, &self.centers, &self.corners);
        crew.run(known.area(), false, stop, |sampler, scratch, tile| {
            let wants = |x: i64, y: i64, disputed: bool| {
                pixels.area().contains(x, y) && {
                    let pixel = pixels.at(x, y);
                    pixel.stage == 0
                        && is_picked(threshold, x, y)
                        && (disputed || !pixel.suspect)
                        && wants_corners(pixel, centers.at(x, y), threshold)
                }
            };
            let wanted: Vec<(i64, i64)> = in_turn(tile)
                .filter(|&(x, y)| {
                    let disputed = is_disputed(centers, x, y);
                    known.at(x, y).rays == 0
                        && (wants(x, y, disputed)
                            || wants(x - 1, y, disputed)
                            || wants(x, y - 1, disputed)
                            || wants(x - 1, y - 1, disputed))
                })
                .collect();
            if wanted.is_empty() {
                return;
            }
            scratch.places.clear();
            scratch.samples.clear();
            scratch.places.extend(wanted.iter().map(|&(x, y)| DVec2::new(x as f64, y as f64)));
            sampler.sample(&scratch.places, &mut scratch.samples);
            let mut traced = traced.lock().unwrap_or_else(PoisonError::into_inner);
            add_rays(&self.spent, &scratch.samples);
            traced.extend(wanted.iter().zip(&scratch.samples).map(|(&(x, y), s)| (x, y, *s)));
        });
        for (x, y, sample) in traced.into_inner().unwrap_or_else(PoisonError::into_inner) {
            *self.corners.at_mut(x, y) = sample;
        }
    }

    /// The estimated error: root mean square of all channels, in levels of 255.
    pub(super) fn estimated_rmse(&self) -> f64 {
        let sum: f64 = self.pixels.values().iter().map(|pixel| f64::from(pixel.expected)).sum();
        (sum / self.area.len().max(1) as f64).sqrt()
    }

    /// Rays of all kinds so far.
    pub(super) fn spent(&self) -> u64 {
        self.spent.load(Ordering::Relaxed)
    }

    /// The last stage that there is.
    fn last_stage(&self) -> usize {
        if self.stages.is_empty() { 0 } else { self.stages.len() + 1 }
    }

    /// Whether a pixel that is off may get more rays.
    pub(super) fn can_improve(&self) -> bool {
        let last = self.last_stage();
        self.pixels.values().iter().any(|p| p.error > 0.0 && usize::from(p.stage) < last)
    }

    /// How many pixels got all the rays they may get, and have a squared error of at least `limit`.
    pub(super) fn unsettled(&self, limit: f32) -> usize {
        let last = self.last_stage();
        let is_unsettled = |p: &&Pixel| {
            usize::from(p.stage) >= last && is_above(Threshold::Error(limit), p.error, 0.0)
        };
        self.pixels.values().iter().filter(is_unsettled).count()
    }

    /// What the next stages of all pixels are worth, and take.
    pub(super) fn demand(&self) -> Demand {
        let mut demand = Demand::new();
        for ((x, y), pixel) in self.area.pixels().zip(self.pixels.values()) {
            let each = self.centers.at(x, y).rays;
            let rays = match (pixel.stage, &pixel.refined) {
                (0, _) if !self.stages.is_empty() => corner_rays(pixel) * each as f32,
                (stage @ 1.., Some(refined)) => match self.stages.get(usize::from(stage) - 1) {
                    Some(points) => ((points - refined.points()) * each) as f32,
                    None => continue,
                },
                _ => continue,
            };
            let points = pixel.refined.as_ref().map_or(0, |refined| refined.points());
            let worth = if points < pixel.least { f32::MAX } else { pixel.error / rays };
            demand.add(worth, rays.ceil() as u64);
        }
        demand
    }

    pub(super) fn into_picture(self) -> Picture {
        Picture {
            colors: self.colors.into_values(),
            samples: self.samples.into_values(),
            errors: self.pixels.values().iter().map(|pixel| pixel.expected).collect(),
            outcome: Outcome::default(),
        }
    }
}
