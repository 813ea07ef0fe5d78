//! Rays where the picture needs them: centres find the suspects, corners rank them, sequences of samples settle them.
//!
//! What becomes of a pixel depends on the samples within two pixels around it, and on nothing that other pixels decide.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicU64, Ordering},
};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{
    Outcome, Picture,
    blocks::rmse,
    crew::{Crew, Sampler, in_turn, lock, trace_centers},
    demand::Demand,
    known::{APRON, Known},
    outlook::Outlook,
    plane::{Area, Plane, Tiled},
    round::{Pixel, Round, Threshold, add_rays, corners_of},
};
use crate::{
    aa::{
        Sample,
        refined::{Stage, stages},
    },
    color::Rgb,
};

/// A picture that gets better with every call of [`Adaptive::refine`].
#[derive(Serialize, Deserialize)]
pub(super) struct Adaptive {
    area: Area,
    /// Pixels in a row of the whole picture.
    width: u32,
    /// Of a pixel after its centre.
    stages: Vec<Stage>,
    centers: Plane<Sample>,
    /// Corners of pixels; those not traced have no rays.
    corners: Tiled<Sample>,
    /// Whether all centres are traced.
    has_begun: bool,
    known: Known,
    /// Rays of all kinds so far.
    spent: AtomicU64,
}

impl Adaptive {
    /// A picture of `area` of which nothing is known.
    pub(super) fn new(area: &Area, width: u32, most: u32) -> Self {
        Self {
            area: *area,
            width,
            stages: stages(most),
            centers: Plane::new(area.grown(APRON as i64), Sample::default()),
            corners: Tiled::new(area.corners()),
            has_begun: false,
            known: Known::new(area),
            spent: AtomicU64::new(0),
        }
    }

    /// Traces the centres of the area, and of the pixels around it, so that a part of a picture is that of the whole;
    /// returns whether all are. Pixels that are off by less than the squared error `least` are not refined.
    ///
    /// When `stop` says so, the pixels that are left have no samples, and nothing is to be refined.
    pub(super) fn begin<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        least: f32,
        stop: impl Fn() -> bool + Sync,
    ) -> bool {
        if !self.has_begun {
            trace_centers(crew, &mut self.centers, &stop);
            self.has_begun = !stop();
            let rays = self.centers.values().iter().map(|sample| u64::from(sample.rays));
            self.spent = AtomicU64::new(rays.sum());
            self.known.look(crew, &self.stages, &self.centers, least);
        } else if least < self.known.least() {
            self.known.look_closer(crew, &self.stages, &self.centers, least);
        }
        self.has_begun
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
            width: self.width,
            stages: &self.stages,
            centers,
            corners: &self.corners,
            threshold,
            stop: &stop,
        };
        // The first samples of a pixel are four and more.
        let group = crew.tiles_at_once(4.0 * threshold.share());
        crew.run_groups(area, group, counted, &stop, |sampler, scratch, tiles| {
            let mut taken: Vec<Vec<Pixel>> = {
                let mut known = lock(&known);
                tiles.iter().map(|tile| known.take(tile, threshold)).collect()
            };
            let is_above = |pixel: &&mut Pixel| pixel.is_above(threshold);
            let mut chosen: Vec<&mut Pixel> = taken.iter_mut().flatten().filter(is_above).collect();
            round.cross(&mut chosen);
            let mut wanting: Vec<usize> =
                (0..chosen.len()).filter(|&place| round.wants(chosen[place])).collect();
            while !wanting.is_empty() {
                if !round.give(&wanting, &mut chosen, (sampler, scratch), spent) {
                    break;
                }
                if matches!(threshold, Threshold::PerRayOfSome(..)) {
                    break; // how much was worth it is known for one stage
                }
                wanting.retain(|&place| round.wants(chosen[place]));
            }
            let mut known = lock(&known);
            for (tile, mut pixels) in tiles.iter().zip(taken).filter(|(_, all)| !all.is_empty()) {
                known.show(&mut pixels, centers);
                if threshold.is_final() {
                    for pixel in &mut pixels {
                        pixel.refined = None;
                    }
                }
                known.put_back(tile, pixels);
            }
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
        let area = &self.area;
        // Corners belong to the pixels up and left of them too.
        let may_exceed = |x: i64, y: i64| {
            let (x, y) = (x.clamp(area.x0, area.x1 - 1), y.clamp(area.y0, area.y1 - 1));
            self.known.outlook(x, y).may_exceed(threshold)
        };
        let group = crew.tiles_at_once(1.0);
        crew.run_groups(self.corners.area(), group, false, stop, |sampler, scratch, tiles| {
            let is_asked = |tile: &&Area| {
                let (left, top) = (tile.x0 - 1, tile.y0 - 1);
                [(tile.x0, tile.y0), (left, tile.y0), (tile.x0, top), (left, top)]
                    .iter()
                    .any(|&(x, y)| may_exceed(x, y))
            };
            let wanted: Vec<(Area, Vec<(i64, i64)>)> = tiles
                .iter()
                .filter(is_asked)
                .map(|tile| (*tile, self.wanted_corners(tile, threshold)))
                .filter(|(_, wanted)| !wanted.is_empty())
                .collect();
            if wanted.is_empty() {
                return;
            }
            let places = wanted.iter().flat_map(|(_, wanted)| wanted);
            scratch.places.clear();
            scratch.places.extend(places.map(|&(x, y)| DVec2::new(x as f64, y as f64)));
            let mut samples = Vec::with_capacity(scratch.places.len());
            sampler.sample(&scratch.places, &mut samples);
            add_rays(&self.spent, &samples);
            lock(&traced).push((wanted, samples));
        });
        for (wanted, samples) in traced.into_inner().unwrap_or_else(PoisonError::into_inner) {
            let mut samples = samples.into_iter();
            for (tile, wanted) in wanted {
                let corners = self.corners.of_mut(&tile);
                corners.resize(tile.len(), Sample::default());
                for ((x, y), sample) in wanted.into_iter().zip(samples.by_ref()) {
                    corners[tile.place_of(x, y)] = sample;
                }
            }
        }
    }

    /// The corners in a tile that pixels above the threshold will look at, and that are not traced yet.
    fn wanted_corners(&self, tile: &Area, threshold: Threshold) -> Vec<(i64, i64)> {
        let (area, centers) = (&self.area, &self.centers);
        let around = Area { x0: tile.x0 - 1, y0: tile.y0 - 1, ..*tile }.common(area);
        let (mut is_wanted, corners) = (vec![false; tile.len()], self.corners.of(tile));
        for pixel in self.known.above(&around, threshold).filter(|pixel| pixel.stage == 0) {
            for (x, y) in corners_of(pixel.x, pixel.y) {
                let is_traced = |place: usize| corners.get(place).is_some_and(|c| c.rays > 0);
                if tile.contains(x, y)
                    && !is_traced(tile.place_of(x, y))
                    && pixel.needs_corner(centers, x, y)
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

    /// Whether it is a picture of `area`.
    pub(super) fn is_of(&self, area: &Area) -> bool {
        self.area == *area
    }

    /// Whether all centres are traced.
    pub(super) fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// The estimated error: root mean square of all channels, in levels of 255.
    pub(super) fn estimated_rmse(&self) -> f64 {
        rmse(self.squared_error(), self.area.len())
    }

    /// The estimated squared error, summed over the pixels.
    fn squared_error(&self) -> f64 {
        self.known.outlooks().map(|tile| tile.expected).sum()
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
        self.known.outlooks().any(Outlook::can_improve)
    }

    /// Whether a pixel is to get more rays whatever its error.
    pub(super) fn is_due(&self) -> bool {
        self.known.outlooks().any(Outlook::is_due)
    }

    /// How many pixels got all the rays they may get, and have a squared error of at least `limit`.
    pub(super) fn unsettled(&self, limit: f32) -> usize {
        let is_unsettled = |p: &&Pixel| {
            usize::from(p.stage) >= self.stages.len() && p.error > 0.0 && p.error >= limit
        };
        self.known.pixels().filter(is_unsettled).count()
    }

    /// As [`Known::demand`].
    pub(super) fn demand(&self, is_short: bool) -> Demand {
        self.known.demand(is_short)
    }

    pub(super) fn into_picture(self) -> Picture {
        let squared_error = self.squared_error();
        let Known { colors, samples, .. } = self.known;
        Picture {
            colors: colors.into_values(),
            samples: samples.into_values(),
            squared_error,
            outcome: Outcome::default(),
        }
    }
}
