//! Rays where the picture needs them: centres find the suspects, corners rank them, sequences of samples settle them.
//!
//! What becomes of a pixel depends on the samples within one pixel around it, and on nothing that other pixels decide.

use std::sync::{Mutex, PoisonError};

use glam::DVec2;

use super::{
    Picture,
    crew::{Crew, Sampler, in_turn, trace_centers},
    look::{Window, corrected},
    plane::{Area, Plane},
};
use crate::{
    aa::{
        Sample,
        refined::{Refined, stages},
        sobol::Sequence,
    },
    color::Rgb,
};

/// The picture's squared error, as a multiple of what its pixels add up to: pixels stop where their estimate happens to be
/// low.
pub(super) const STOPPED_LOW: f64 = 1.25;

/// Rays that the corners of a suspect pixel cost, most being shared or not traced; and those of one that is not suspect.
const SHARED_CORNERS: f32 = 0.6;
const OWN_CORNERS: f32 = 1.5;

/// When a pixel gets more rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Threshold {
    /// Its squared error is at least this.
    Error(f32),
    /// Its squared error for each ray of the next stage is at least this.
    PerRay(f32),
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
}

impl Adaptive {
    /// Traces the centres of `area`, and of the pixels around it, so that a part of a picture is that of the whole.
    pub(super) fn new<S: Sampler>(crew: &Crew<S>, area: &Area, width: u32, most: u32) -> Self {
        let centers = trace_centers(crew, &area.grown(1));
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
        }
    }

    /// Gives every pixel above the threshold its next samples, until none is or all have the most they may get.
    ///
    /// When `stop` says so, the tiles that are left stay as they are.
    pub(super) fn refine<S: Sampler>(
        &mut self,
        crew: &Crew<S>,
        threshold: Threshold,
        stop: impl Fn() -> bool + Sync,
    ) {
        self.trace_corners(crew, threshold, &stop);
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
        };
        crew.run(&self.area, true, stop, |sampler, scratch, tile| {
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
                scratch.places.clear();
                scratch.samples.clear();
                for &index in &wanting {
                    round.next_places(tile, index, &own[index], &mut scratch.places);
                }
                sampler.sample(&scratch.places, &mut scratch.samples);
                let mut answers = scratch.samples.iter();
                for &index in &wanting {
                    round.advance(&mut own[index], &mut answers);
                    changed[index] = true;
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

    /// The sum of the pixels' squared errors as they estimate them.
    pub(super) fn squared_error(&self) -> f64 {
        self.pixels.values().iter().map(|pixel| f64::from(pixel.error)).sum()
    }

    /// Whether any pixel got all the rays it may get, and is still above the threshold.
    pub(super) fn exhausted(&self, threshold: Threshold) -> usize {
        let last = self.stages.len() + 1;
        let limit = |pixel: &Pixel| match threshold {
            Threshold::Error(limit) => pixel.error >= limit,
            Threshold::PerRay(_) => true,
        };
        let done = |pixel: &&Pixel| usize::from(pixel.stage) >= last && limit(pixel);
        self.pixels.values().iter().filter(done).count()
    }

    pub(super) fn into_picture(self) -> Picture {
        Picture {
            colors: self.colors.into_values(),
            samples: self.samples.into_values(),
            errors: self.pixels.values().iter().map(|pixel| pixel.error).collect(),
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
        Threshold::PerRay(limit) => error >= limit * rays,
    }
}

fn wants_corners(pixel: &Pixel, center: &Sample, threshold: Threshold) -> bool {
    let corners = if pixel.suspect { SHARED_CORNERS } else { OWN_CORNERS };
    is_above(threshold, pixel.error, corners * center.rays as f32)
}

/// What the pixels of a tile need to know to get their next samples.
struct Round<'a> {
    area: &'a Area,
    width: u32,
    stages: &'a [u32],
    centers: &'a Plane<Sample>,
    corners: &'a Plane<Sample>,
    threshold: Threshold,
}

impl Round<'_> {
    /// Takes the corners into the pixels above the threshold that have only their centres.
    fn cross(&self, tile: &Area, pixels: &mut [Pixel], changed: &mut [bool]) {
        if self.stages.is_empty() {
            return;
        }
        for (index, (x, y)) in tile.pixels().enumerate() {
            let (pixel, center) = (&mut pixels[index], self.centers.at(x, y));
            if pixel.stage > 0 || !wants_corners(pixel, center, self.threshold) {
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
        is_above(self.threshold, pixel.error, rays as f32)
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
