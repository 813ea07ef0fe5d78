//! Rendering towards an error or until a time.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::{
    Outcome, RayCounts,
    adaptive::Adaptive,
    crew::{Crew, Sampler},
    demand::{LAST_STEP, at_step},
    plane::Area,
    round::Threshold,
    watch::Watch,
};

/// The rays that an error takes go about like this power of its inverse.
const RAYS_POWER: f64 = 1.5;
/// The part of the time left that a step of a time-limited picture should take.
const SHARE_OF_TIME: f64 = 0.3;
/// Less time than this is not worth a step.
const SHORTEST: Duration = Duration::from_millis(4);
/// A pixel whose squared error is a smaller part of the one that is wanted for the picture is left as it is.
const LEAST_PART: f64 = 1.0 / 64.0;

/// The squared error from which on pixels are refined for an error that is wanted of the picture: all others add next to
/// nothing to it.
fn least_for(wanted: f64) -> f32 {
    (wanted * wanted * LEAST_PART) as f32
}

/// How a picture ends that is stopped.
fn stopped() -> Outcome {
    Outcome { is_stopped: true, ..Outcome::default() }
}

/// A picture towards an error or until a time before it gets there: all that is needed to go on from it.
///
/// It goes on to the same picture, wherever it was left, if the goal is an error.
#[derive(Serialize, Deserialize)]
pub struct Unfinished {
    /// The rays cast for it.
    pub(super) rays: RayCounts,
    pub(super) adaptive: Adaptive,
    /// Towards an error: the step of the ladder in work, or to be taken next.
    step: u32,
    is_in_step: bool,
    /// The threshold of the last step that was finished.
    per_ray: Option<f32>,
    /// Until a time: the steps so far, and what a ray took in the last one.
    round: u32,
    seconds_per_ray: f64,
}

impl Unfinished {
    /// A picture of `area` of which nothing is known.
    pub(super) fn new(area: &Area, width: u32, most: u32) -> Self {
        Self {
            rays: RayCounts::default(),
            adaptive: Adaptive::new(area, width, most),
            step: 0,
            is_in_step: false,
            per_ray: None,
            round: 0,
            seconds_per_ray: 0.0,
        }
    }

    /// Its estimated error, root mean square of all channels in levels of 255, once each pixel has a ray.
    pub fn estimated_rmse(&self) -> Option<f64> {
        self.adaptive.has_begun().then(|| self.adaptive.estimated_rmse())
    }

    /// Refines where the squared error for each ray is largest, until the estimate is `wanted` levels or less, or
    /// `watch` stops it.
    ///
    /// The threshold goes down a fixed ladder, and the picture is that of the threshold at which it ends: what is spent
    /// on the way is part of it.
    pub(super) fn reach_error<S: Sampler + Send>(
        mut self,
        crew: &Crew<S>,
        wanted: f64,
        watch: &Watch,
    ) -> (Adaptive, Outcome) {
        loop {
            if watch.keeps(&mut self) {
                return (self.adaptive, stopped());
            }
            if self.adaptive.begin(crew, least_for(wanted), || watch.interrupts()) {
                if let Some(outcome) = self.ending(wanted) {
                    return (self.adaptive, outcome);
                }
                watch.show(&self.adaptive);
                crew.meter.reach((wanted / self.adaptive.estimated_rmse()).powf(RAYS_POWER));
                self.step_down(crew, wanted, watch);
            }
        }
    }

    /// Takes the step of the ladder, or the rest of it, as far as `watch` lets it.
    fn step_down<S: Sampler + Send>(&mut self, crew: &Crew<S>, wanted: f64, watch: &Watch) {
        if !self.is_in_step {
            self.is_in_step = true;
            let demand = self.adaptive.demand(false);
            self.step = demand.level_for_error(self.step as usize, wanted) as u32;
        }
        let threshold = at_step(self.step);
        self.adaptive.refine(crew, Threshold::PerRay(threshold), false, || watch.interrupts());
        if watch.interrupts() {
            return;
        }
        self.is_in_step = false;
        self.per_ray = Some(threshold);
        self.step += 1;
    }

    /// How the picture ends if it has reached the error, or gets no nearer to it.
    fn ending(&self, wanted: f64) -> Option<Outcome> {
        let outcome = Outcome { per_ray: self.per_ray, ..Outcome::default() };
        if self.is_in_step {
            return None;
        }
        // What is not sampled yet where something is known to be is in no estimate.
        if !self.adaptive.is_due() && self.adaptive.estimated_rmse() <= wanted {
            return Some(outcome);
        }
        let is_over = self.step > LAST_STEP || !self.adaptive.can_improve();
        is_over.then_some(Outcome { missed_error: Some(wanted), ..outcome })
    }

    /// Refines where the squared error for each ray is largest, until `end`, or until `watch` stops it.
    ///
    /// Each step takes a part of the time left, as predicted from the rays before; the pixels of the last one are taken
    /// by chance, so that no part of the picture is left out.
    pub(super) fn reach_time<S: Sampler + Send>(
        mut self,
        crew: &Crew<S>,
        (started, end): (Instant, Instant),
        watch: &Watch,
    ) -> (Adaptive, Outcome) {
        let before = self.adaptive.spent();
        while !self.adaptive.begin(crew, 0.0, || watch.interrupts()) {
            if watch.keeps(&mut self) {
                return (self.adaptive, stopped());
            }
        }
        let (now, rays) = (Instant::now(), self.adaptive.spent() - before);
        // Without rays there was one in each pixel already.
        if rays > 0 && now >= end {
            let late = Some(now - started);
            return (self.adaptive, Outcome { late, ..Outcome::default() });
        }
        if rays > 0 {
            self.seconds_per_ray = (now - started).as_secs_f64() / rays as f64;
        }
        let whole = end.saturating_duration_since(started).as_secs_f64().max(1e-9);
        loop {
            if watch.keeps(&mut self) {
                return (self.adaptive, stopped());
            }
            let left = end.saturating_duration_since(Instant::now());
            watch.show(&self.adaptive);
            crew.meter.reach(1.0 - left.as_secs_f64() / whole);
            if left < SHORTEST || !self.step_within(crew, left, end, watch) {
                let is_used_up = left >= SHORTEST && Instant::now() < end;
                return (self.adaptive, Outcome { cut: true, is_used_up, ..Outcome::default() });
            }
        }
    }

    /// Takes a step that should take a part of the time `left` until `end`; returns whether there was anything to
    /// refine.
    fn step_within<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        left: Duration,
        end: Instant,
        watch: &Watch,
    ) -> bool {
        let demand = self.adaptive.demand(true);
        let affordable = left.as_secs_f64() / self.seconds_per_ray;
        let Some(level) = demand.level_for(affordable * SHARE_OF_TIME) else { return false };
        let share = (affordable * 0.9 / demand.at_level(level).max(1) as f64).min(1.0);
        let (before, stepping) = (self.adaptive.spent(), Instant::now());
        let threshold = Threshold::PerRayOfSome(at_step(level as u32), share as f32, self.round);
        self.round += 1;
        let stop = || Instant::now() >= end || watch.interrupts();
        self.adaptive.refine(crew, threshold, false, stop);
        let rays = self.adaptive.spent() - before;
        if rays > 0 {
            self.seconds_per_ray = stepping.elapsed().as_secs_f64() / rays as f64;
        }
        rays > 0 || share < 1.0 || watch.interrupts()
    }
}
