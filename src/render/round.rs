//! A pixel's way from stage to stage: who gets more samples, where, and what they change.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{
    crew::{Sampler, Scratch},
    hints::{Glint, Hint, Least},
    outlook::Worth,
    plane::{Plane, Tiled},
};
use crate::{
    aa::{
        Sample,
        detail::Detail,
        levels::{levels, squared_distance},
        refined::{Refined, Stage},
        sobol::{Sequence, hash},
    },
    color::Rgb,
};

/// Samples that are taken without looking at the clock: at least and at most.
const AT_ONCE: [usize; 2] = [1 << 9, 1 << 14];

/// So many times as few samples meet a highlight as tell how bright it is: its flanks show as well.
const SOONER: u32 = 8;

/// When a pixel gets more rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Threshold {
    /// Its squared error is at least this.
    Error(f32),
    /// Its squared error for each ray of the next stage is at least this.
    PerRay(f32),
    /// The same, for a share of the pixels, picked by hash with the number given; for one stage only, and not whatever
    /// their error.
    PerRayOfSome(f32, f32, u32),
}

impl Threshold {
    /// The share of the pixels for which it is.
    pub(super) fn share(self) -> f32 {
        match self {
            Self::PerRayOfSome(_, share, _) => share.min(1.0),
            Self::Error(_) | Self::PerRay(_) => 1.0,
        }
    }

    /// Whether pixels above it go on until they are below or may get no more, so that what their samples were is not
    /// asked again.
    pub(super) fn is_final(self) -> bool {
        matches!(self, Self::Error(_))
    }
}

/// What is known of a pixel that may be refined, or was.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pixel {
    /// Its column and row in the whole picture.
    pub(super) x: i64,
    pub(super) y: i64,
    /// 0 is the centre alone, 1 centre and corners, from 2 on with samples.
    pub(super) stage: u8,
    /// Whether a neighbour's signature differs.
    pub(super) suspect: bool,
    /// The estimated squared error in levels, by which it is refined.
    pub(super) error: f32,
    /// The contrast to the neighbours; zero unless suspect or amid noise.
    pub(super) contrast: f32,
    /// How often things change around, from 0 to 1; zero unless suspect or amid noise.
    pub(super) busy: f32,
    /// What its centre shows of pictures.
    pub(super) detail: Detail,
    /// Whether something thin is known to be in it.
    pub(super) is_thin: bool,
    /// Samples of the sequence that it gets whatever its error, unless time is short.
    pub(super) least: Least,
    /// What highlights narrower than it may add unseen.
    pub(super) unseen: Unseen,
    /// What more rays are worth to it.
    pub(super) worth: Worth,
    pub(super) refined: Option<Box<Refined>>,
    /// Whether it got samples that the picture does not show yet.
    pub(super) has_changed: bool,
}

impl Pixel {
    /// Takes in what the scene tells of it, and the colour of its centre; returns the squared error that this adds to what is
    /// expected.
    pub(super) fn heed(&mut self, Hint { least, glint }: Hint, center: Rgb) -> f32 {
        self.is_thin = least.is_some();
        self.least = self.least.max(least);
        if glint.light > 0.0 {
            self.unseen = Unseen::of(glint, center);
            self.error = self.error.max(self.unseen.error);
        }
        self.unseen.expected_after(0)
    }

    /// Whether it is above the threshold, that is for it, and may get more rays.
    pub(super) fn is_above(&self, threshold: Threshold) -> bool {
        self.worth.exceeds(threshold) && is_picked(threshold, self.x, self.y)
    }

    /// The samples of the sequence so far.
    pub(super) fn points(&self) -> u32 {
        self.refined.as_ref().map_or(0, |refined| refined.points())
    }

    /// Whether a corner of it is to be traced: around others of a suspect pixel all centres saw the same, and tell.
    pub(super) fn needs_corner(&self, centers: &Plane<Sample>, x: i64, y: i64) -> bool {
        !self.suspect || is_disputed(centers, x, y)
    }

    /// Whether it is to get more samples whatever its error.
    pub(super) fn is_due(&self) -> bool {
        let is_alike = || self.refined.as_ref().is_some_and(|refined| refined.is_alike());
        let points = self.points();
        points < self.least.samples || points < self.least.if_alike && is_alike()
    }
}

/// The highlights of a pixel that its samples may not have met.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Unseen {
    /// The squared error if they met nothing of them.
    error: f32,
    /// So many samples tell how bright they are.
    samples: u32,
}

impl Unseen {
    /// The highlights in a pixel whose centre met none of them, and has this colour.
    fn of(glint: Glint, center: Rgb) -> Self {
        let with_it = (center + Rgb::splat(glint.light)).min(Rgb::ONE);
        Self { error: squared_distance(levels(with_it), levels(center)), samples: glint.samples }
    }

    /// The squared error that may be left after so many samples.
    fn error_after(self, points: u32) -> f32 {
        let left = self.samples.saturating_sub(points) as f32;
        self.error * left / self.samples.max(1) as f32
    }

    /// The squared error that is expected of what so many samples did not meet.
    fn expected_after(self, points: u32) -> f32 {
        self.error_after(points.saturating_mul(SOONER))
    }
}

/// Whether the four centres around a corner saw different things.
fn is_disputed(centers: &Plane<Sample>, x: i64, y: i64) -> bool {
    let signature = centers.at(x, y).signature;
    [(x - 1, y), (x, y - 1), (x - 1, y - 1)]
        .iter()
        .any(|&(x, y)| centers.at(x, y).signature != signature)
}

/// The corners of a pixel, each named by the pixel to its lower right.
pub(super) fn corners_of(x: i64, y: i64) -> [(i64, i64); 4] {
    [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)]
}

/// Whether the threshold is for this pixel at all.
fn is_picked(threshold: Threshold, x: i64, y: i64) -> bool {
    match threshold {
        Threshold::PerRayOfSome(_, share, round) if share < 1.0 => {
            let place = (x as u64) << 32 ^ y as u64;
            let number = hash(place ^ hash(u64::from(round))) >> 40;
            (number as f32) < share * (1_u32 << 24) as f32
        }
        _ => true,
    }
}

pub(super) fn add_rays(spent: &AtomicU64, samples: &[Sample]) {
    spent.fetch_add(samples.iter().map(|s| u64::from(s.rays)).sum(), Ordering::Relaxed);
}

/// What pixels need to know to get their next samples.
pub(super) struct Round<'a> {
    pub(super) width: u32,
    pub(super) stages: &'a [Stage],
    pub(super) centers: &'a Plane<Sample>,
    pub(super) corners: &'a Tiled<Sample>,
    pub(super) threshold: Threshold,
    pub(super) stop: &'a (dyn Fn() -> bool + Sync),
}

impl Round<'_> {
    /// Takes the corners into the pixels above the threshold that have only their centres.
    pub(super) fn cross(&self, chosen: &mut [&mut Pixel]) {
        let Some(corners) = self.stages.first() else { return };
        for pixel in chosen.iter_mut().filter(|pixel| pixel.stage == 0) {
            let (x, y) = (pixel.x, pixel.y);
            let center = self.centers.at(x, y);
            let corner = |(x, y): (i64, i64)| {
                if pixel.needs_corner(self.centers, x, y) {
                    // Without rays it was to be traced, but time was up.
                    let sample = self.corners.get(x, y).filter(|sample| sample.rays > 0)?;
                    return Some((sample.color, sample.signature));
                }
                let around = [(x, y), (x - 1, y), (x, y - 1), (x - 1, y - 1)];
                let sum: Rgb = around.iter().map(|&(x, y)| self.centers.at(x, y).color).sum();
                Some((sum * 0.25, center.signature))
            };
            let [Some(a), Some(b), Some(c), Some(d)] = corners_of(x, y).map(corner) else {
                continue;
            };
            self.judge(pixel, Box::new(Refined::new(*corners, center, &[a, b, c, d])));
        }
    }

    /// Whether a pixel with corners wants the samples of its next stage.
    pub(super) fn wants(&self, pixel: &Pixel) -> bool {
        pixel.refined.is_some() && pixel.worth.exceeds(self.threshold)
    }

    /// Takes over what is known of a pixel after a stage.
    fn judge(&self, pixel: &mut Pixel, refined: Box<Refined>) {
        let (mut error, mut expected) = refined.errors(pixel.contrast, pixel.busy, pixel.detail);
        let points = refined.points();
        let may_go_on = self.stages.last().is_some_and(|last| points < last.points);
        let unseen = pixel.unseen.error_after(points);
        if (pixel.is_thin || unseen > 0.0)
            && let Some(thin) = refined.error_of_thin()
        {
            (error, expected) = (error.max(thin), thin);
        }
        if may_go_on {
            error = error.max(unseen);
        }
        expected += pixel.unseen.expected_after(points);
        (pixel.error, pixel.refined) = (error, Some(refined));
        pixel.stage += 1;
        let center = self.centers.at(pixel.x, pixel.y);
        pixel.worth = Worth::of(pixel, expected, self.stages, center);
        pixel.has_changed = true;
    }

    /// Gives the pixels in the places `wanting` the samples of their next stage; returns whether there was time for
    /// all.
    pub(super) fn give<S: Sampler + Send>(
        &self,
        wanting: &[usize],
        chosen: &mut [&mut Pixel],
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
            let [least, most] = AT_ONCE;
            let at_once = sampler.at_once().clamp(least, most);
            while count < rest.len() && scratch.places.len() < at_once {
                self.next_places(chosen[rest[count]], &mut scratch.places);
                count += 1;
            }
            sampler.sample(&scratch.places, &mut scratch.samples);
            add_rays(spent, &scratch.samples);
            let mut answers = scratch.samples.iter();
            let (now, later) = rest.split_at(count);
            for &place in now {
                self.advance(chosen[place], &mut answers);
            }
            rest = later;
        }
        true
    }

    fn next_places(&self, pixel: &Pixel, places: &mut Vec<DVec2>) {
        let number = pixel.y as u64 * u64::from(self.width) + pixel.x as u64;
        let sequence = Sequence::of_pixel(number, 0);
        let corner = DVec2::new(pixel.x as f64, pixel.y as f64);
        let from = pixel.points();
        let to = self.stages.get(usize::from(pixel.stage)).map_or(from, |stage| stage.points);
        places.extend((from..to).map(|point| corner + sequence.place(point)));
    }

    fn advance<'s>(&self, pixel: &mut Pixel, answers: &mut impl Iterator<Item = &'s Sample>) {
        let next = self.stages.get(usize::from(pixel.stage));
        if let (Some(stage), Some(mut refined)) = (next, pixel.refined.take()) {
            refined.begin(*stage);
            for sample in answers.take((stage.points - refined.points()) as usize) {
                refined.add(sample);
            }
            self.judge(pixel, refined);
        }
    }
}
