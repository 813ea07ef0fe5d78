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
    crew::{Crew, Sampler, Scratch, in_turn, trace_centers},
    goal::Demand,
    look::{Window, corrected},
    plane::{Area, Plane},
};
use crate::{
    aa::{
        Sample,
        refined::{Refined, stages},
        sobol::{Sequence, mix},
    },
    color::Rgb,
};

/// The picture's squared error, as a multiple of what its pixels add up to: pixels stop where their estimate happens to be
/// low.
pub(super) const STOPPED_LOW: f64 = 1.25;

/// Rays that the corners of a suspect pixel cost, most being shared or not traced; and those of one that is not suspect.
const SHARED_CORNERS: f32 = 0.6;
const OWN_CORNERS: f32 = 1.5;

/// Samples that are taken without looking at the clock.
const AT_ONCE: usize = 512;

/// When a pixel gets more rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Threshold {
    /// Its squared error is at least this.
    Error(f32),
    /// Its squared error for each ray of the next stage is at least this.
    PerRay(f32),
    /// The same, for a share of the pixels, picked by hash.
    PerRayOfSome(f32, f32),
}

/// What is known of a pixel.
#[derive(Clone, Debug, Default)]
struct Pixel {
    /// 0 is the centre alone, 1 centre and corners, from 2 on with samples.
    stage: u8,
    /// Whether a neighbour's signature differs.
    suspect: bool,
    /// The estimated squared error in levels.
    error: f32,
    /// The contrast to the neighbours, zero unless suspect.
    contrast: f32,
    refined: Option<Box<Refined>>,
}

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
    pub(super) fn new<S: Sampler>(crew: &Crew<S>, area: &Area, width: u32, most: u32) -> Self {
        let centers = trace_centers(crew, &area.grown(1));
        let spent = centers.values().iter().map(|sample| u64::from(sample.rays)).sum();
        let colors = Mutex::new(Plane::new(*area, Rgb::ZERO));
        let pixels = Mutex::new(Plane::new(*area, Pixel::default()));
        crew.run(
            area,
            false,
            || false,
            |_, _, tile| {
                let window = Window::of_centers(tile, &centers);
                let (own_pixels, own_colors): (Vec<_>, Vec<_>) = tile
                    .pixels()
                    .map(|(x, y)| {
                        let look = window.look(x, y);
                        let color = if look.inner {
                            corrected(&centers, x, y)
                        } else {
                            centers.at(x, y).color
                        };
                        let pixel = Pixel {
                            suspect: look.suspect,
                            error: look.center_error(look.inner),
                            contrast: if look.suspect { look.contrast } else { 0.0 },
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
    pub(super) fn refine<S: Sampler>(
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
            }
            if changed.contains(&true) {
                let mut colors = colors.lock().unwrap_or_else(PoisonError::into_inner);
                let mut samples = samples.lock().unwrap_or_else(PoisonError::into_inner);
                for (index, (x, y)) in tile.pixels().enumerate().filter(|(i, _)| changed[*i]) {
                    if let Some(refined) = &own[index].refined {
                        *colors.at_mut(x, y) = refined.color();
                        let own_corner = u32::from(self.corners.at(x, y).rays > 0);
                        *samples.at_mut(x, y) = 1 + own_corner + refined.points();
                    }
                }
            }
            pixels.lock().unwrap_or_else(PoisonError::into_inner).put(tile, own);
        });
    }

    /// Traces the corners that pixels above the threshold will look at.
    fn trace_corners<S: Sampler>(
        &mut self,
        crew: &Crew<S>,
        threshold: Threshold,
        stop: &(impl Fn() -> bool + Sync),
    ) {
        if self.stages.is_empty() {
            return;
        }
        let traced = Mutex::new(Vec::new());
        let samples = Mutex::new(&mut self.samples);
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
            let mut samples = samples.lock().unwrap_or_else(PoisonError::into_inner);
            add_rays(&self.spent, &scratch.samples);
            for (&(x, y), sample) in wanted.iter().zip(&scratch.samples) {
                traced.push((x, y, *sample));
                if samples.area().contains(x, y) {
                    *samples.at_mut(x, y) += 1;
                }
            }
        });
        for (x, y, sample) in traced.into_inner().unwrap_or_else(PoisonError::into_inner) {
            *self.corners.at_mut(x, y) = sample;
        }
    }

    /// The estimated error: root mean square of all channels, in levels of 255.
    pub(super) fn estimated_rmse(&self) -> f64 {
        let sum: f64 = self.pixels.values().iter().map(|pixel| f64::from(pixel.error)).sum();
        (STOPPED_LOW * sum / self.area.len().max(1) as f64).sqrt()
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
            demand.add(pixel.error / rays, rays as u64);
        }
        demand
    }

    pub(super) fn into_picture(self) -> Picture {
        Picture {
            colors: self.colors.into_values(),
            samples: self.samples.into_values(),
            errors: self.pixels.values().iter().map(|pixel| pixel.error).collect(),
            outcome: Outcome::default(),
            factor: STOPPED_LOW,
        }
    }
}

/// Whether the four centres around a corner saw different things.
fn is_disputed(centers: &Plane<Sample>, x: i64, y: i64) -> bool {
    let signature = centers.at(x, y).signature;
    [(x - 1, y), (x, y - 1), (x - 1, y - 1)]
        .iter()
        .any(|&(x, y)| centers.at(x, y).signature != signature)
}

fn is_above(threshold: Threshold, error: f32, rays: f32) -> bool {
    match threshold {
        Threshold::Error(limit) => error > 0.0 && error >= limit,
        Threshold::PerRay(limit) | Threshold::PerRayOfSome(limit, _) => error >= limit * rays,
    }
}

/// Whether the threshold is for this pixel at all.
fn is_picked(threshold: Threshold, x: i64, y: i64) -> bool {
    match threshold {
        Threshold::PerRayOfSome(_, share) if share < 1.0 => {
            let hash = mix((x as u64) << 32 ^ y as u64 ^ 0xC0FF_EE00_C0FF_EE00) >> 40;
            (hash as f32) < share * (1_u32 << 24) as f32
        }
        _ => true,
    }
}

fn add_rays(spent: &AtomicU64, samples: &[Sample]) {
    spent.fetch_add(samples.iter().map(|s| u64::from(s.rays)).sum(), Ordering::Relaxed);
}

/// Camera rays that the corners of a pixel are taken to cost.
fn corner_rays(pixel: &Pixel) -> f32 {
    if pixel.suspect { SHARED_CORNERS } else { OWN_CORNERS }
}

fn wants_corners(pixel: &Pixel, center: &Sample, threshold: Threshold) -> bool {
    is_above(threshold, pixel.error, corner_rays(pixel) * center.rays as f32)
}

/// What the pixels of a tile need to know to get their next samples.
struct Round<'a> {
    area: &'a Area,
    width: u32,
    stages: &'a [u32],
    centers: &'a Plane<Sample>,
    corners: &'a Plane<Sample>,
    threshold: Threshold,
    stop: &'a (dyn Fn() -> bool + Sync),
}

impl Round<'_> {
    /// Takes the corners into the pixels above the threshold that have only their centres.
    fn cross(&self, tile: &Area, pixels: &mut [Pixel], changed: &mut [bool]) {
        if self.stages.is_empty() {
            return;
        }
        for (index, (x, y)) in tile.pixels().enumerate() {
            let (pixel, center) = (&mut pixels[index], self.centers.at(x, y));
            if pixel.stage > 0
                || !is_picked(self.threshold, x, y)
                || !wants_corners(pixel, center, self.threshold)
            {
                continue;
            }
            let corner = |(x, y): (i64, i64)| {
                if !pixel.suspect || is_disputed(self.centers, x, y) {
                    // Without rays it was to be traced, but time was up.
                    let sample = self.corners.at(x, y);
                    return (sample.rays > 0).then_some((sample.color, sample.signature));
                }
                let around = [(x, y), (x - 1, y), (x, y - 1), (x - 1, y - 1)];
                let sum: Rgb = around.iter().map(|&(x, y)| self.centers.at(x, y).color).sum();
                Some((sum * 0.25, center.signature))
            };
            let [Some(a), Some(b), Some(c), Some(d)] =
                [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)].map(corner)
            else {
                continue;
            };
            let refined = Refined::new(center, &[a, b, c, d]);
            pixel.error = refined.error(pixel.contrast);
            pixel.stage = 1;
            pixel.refined = Some(Box::new(refined));
            changed[index] = true;
        }
    }

    /// The samples of the sequence after the pixel's next stage, if there is one.
    fn next_points(&self, pixel: &Pixel) -> Option<u32> {
        (pixel.stage > 0).then(|| self.stages.get(usize::from(pixel.stage) - 1).copied()).flatten()
    }

    fn wants(&self, tile: &Area, pixel: &Pixel, index: usize) -> bool {
        let (Some(points), Some(refined)) = (self.next_points(pixel), &pixel.refined) else {
            return false;
        };
        let (x, y) = tile.pixel_at(index);
        let rays = (points - refined.points()) * self.centers.at(x, y).rays;
        is_picked(self.threshold, x, y) && is_above(self.threshold, pixel.error, rays as f32)
    }

    /// Gives the pixels that want them the samples of their next stage; returns whether there was time for all.
    fn give<S: Sampler>(
        &self,
        tile: &Area,
        wanting: &[usize],
        pixels: &mut [Pixel],
        changed: &mut [bool],
        (sampler, scratch): (&mut S, &mut Scratch),
        spent: &AtomicU64,
    ) -> bool {
        let mut rest = wanting;
        while !rest.is_empty() {
            if (self.stop)() {
                return false;
            }
            scratch.places.clear();
            scratch.samples.clear();
            let mut count = 0;
            while count < rest.len() && scratch.places.len() < AT_ONCE {
                self.next_places(tile, rest[count], &pixels[rest[count]], &mut scratch.places);
                count += 1;
            }
            sampler.sample(&scratch.places, &mut scratch.samples);
            add_rays(spent, &scratch.samples);
            let mut answers = scratch.samples.iter();
            let (now, later) = rest.split_at(count);
            for &index in now {
                self.advance(&mut pixels[index], &mut answers);
                changed[index] = true;
            }
            rest = later;
        }
        true
    }

    fn next_places(&self, tile: &Area, index: usize, pixel: &Pixel, places: &mut Vec<DVec2>) {
        let (x, y) = tile.pixel_at(index);
        debug_assert!(self.area.contains(x, y));
        let number = y as u64 * u64::from(self.width) + x as u64;
        let sequence = Sequence::of_pixel(number, 0);
        let corner = DVec2::new(x as f64, y as f64);
        let from = pixel.refined.as_ref().map_or(0, |refined| refined.points());
        let to = self.next_points(pixel).unwrap_or(from);
        places.extend((from..to).map(|point| corner + sequence.place(point)));
    }

    fn advance<'s>(&self, pixel: &mut Pixel, answers: &mut impl Iterator<Item = &'s Sample>) {
        let points = self.next_points(pixel);
        if let (Some(points), Some(refined)) = (points, &mut pixel.refined) {
            for sample in answers.take((points - refined.points()) as usize) {
                refined.add(sample);
            }
            pixel.error = refined.error(pixel.contrast);
            pixel.stage += 1;
        }
    }
}
