//! Rendering towards an error or until a time.

use std::{
    f64::consts::SQRT_2,
    time::{Duration, Instant},
};

use serde::{Deserialize, Serialize};

use super::{
    Outcome, RayCounts,
    adaptive::Adaptive,
    crew::{Crew, Sampler},
    outlook::Worth,
    plane::Area,
    round::Threshold,
    watch::Watch,
};

/// The ladder of thresholds, in squared levels for each ray: its first step, and steps to halve it.
const FIRST_STEP: f64 = 1024.0;
const STEPS_TO_HALF: f64 = 2.0;
/// The last step: thresholds below make no difference to an 8-bit picture.
const LAST_STEP: u32 = 80;
/// A pixel's squared error goes about like this power of the threshold: it falls like n^-1.6 with n samples, the rays of a stage grow
/// like n, so its worth for each ray falls like n^-2.6.
const ERROR_POWER: f64 = 1.6 / 2.6;
/// The part of that which is left on average, because pixels go on by whole stages; rather too small, so as not to overshoot.
const LEFT: f64 = 0.5;
/// The rays that an error takes go about like this power of its inverse.
const RAYS_POWER: f64 = 1.5;
/// The most levels of the ladder that are taken at once towards an error.
const LONGEST_STEP: usize = 12;
/// The part of the time left that a step of a time-limited picture should take.
const SHARE_OF_TIME: f64 = 0.3;
/// The levels of the ladder that a step takes at most: what is worth an eighth of the most can wait.
const LEVELS_AT_ONCE: usize = 6;
/// Less time than this is not worth a step.
const SHORTEST: Duration = Duration::from_millis(4);

/// The levels of the ladder.
const LEVELS: usize = LAST_STEP as usize + 1;

/// The threshold at a step of the ladder.
fn at_step(step: u32) -> f32 {
    (FIRST_STEP * (-f64::from(step) / STEPS_TO_HALF).exp2()) as f32
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

    /// Refines where the squared error for each ray is largest, until the estimate is `wanted` levels or less, or `watch` stops it.
    ///
    /// The threshold goes down a fixed ladder, and the picture is that of the threshold at which it ends: what is spent on the way
    /// is part of it.
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
            if self.adaptive.begin(crew, || watch.interrupts()) {
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
            let demand = self.adaptive.demand();
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
        if self.adaptive.estimated_rmse() <= wanted {
            return Some(outcome);
        }
        let is_over = self.step > LAST_STEP || !self.adaptive.can_improve();
        is_over.then_some(Outcome { missed_error: Some(wanted), ..outcome })
    }

    /// Refines where the squared error for each ray is largest, until `end`, or until `watch` stops it.
    ///
    /// Each step takes a part of the time left, as predicted from the rays before; the pixels of the last one are taken by chance,
    /// so that no part of the picture is left out.
    pub(super) fn reach_time<S: Sampler + Send>(
        mut self,
        crew: &Crew<S>,
        (started, end): (Instant, Instant),
        watch: &Watch,
    ) -> (Adaptive, Outcome) {
        let before = self.adaptive.spent();
        while !self.adaptive.begin(crew, || watch.interrupts()) {
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
                return (self.adaptive, Outcome { cut: true, ..Outcome::default() });
            }
        }
    }

    /// Takes a step that should take a part of the time `left` until `end`; returns whether there was anything to refine.
    fn step_within<S: Sampler + Send>(
        &mut self,
        crew: &Crew<S>,
        left: Duration,
        end: Instant,
        watch: &Watch,
    ) -> bool {
        let demand = self.adaptive.demand();
        let affordable = left.as_secs_f64() / self.seconds_per_ray;
        let Some(level) = demand.level_for(affordable * SHARE_OF_TIME) else { return false };
        let share = (affordable * 0.9 / demand.at_level(level).max(1) as f64).min(1.0);
        let (before, stepping) = (self.adaptive.spent(), Instant::now());
        let threshold = Threshold::PerRayOfSome(Demand::threshold(level), share as f32, self.round);
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

/// The first level of the ladder whose threshold the error for each ray of a pixel's next stage is above, if any is.
fn level_of(worth: &Worth) -> Option<usize> {
    if worth.error <= 0.0 {
        return None;
    }
    let share = f64::from(worth.error) / (FIRST_STEP * f64::from(worth.rays));
    // Twice the logarithm, rounded down, from the exponent and whether the mantissa is above the root of 2.
    let (bits, mantissa) = (share.to_bits(), (1 << 52) - 1);
    let is_upper = bits & mantissa >= SQRT_2.to_bits() & mantissa;
    let level = 2 * (1023 - (bits >> 52) as i64) - i64::from(is_upper);
    usize::try_from(level.max(0)).ok().filter(|level| *level < LEVELS)
}

/// How many rays the next stages of the pixels take, by the squared error for each ray that they are worth.
pub(super) struct Demand {
    /// By powers of √2 of the threshold, from the top of the ladder down.
    rays: [u64; LEVELS],
    /// What those pixels, and what all others add to the picture's squared error.
    expected: [f64; LEVELS],
    settled: f64,
    pixels: usize,
}

impl Demand {
    /// The demand of some pixels.
    pub(super) fn of(worths: &[Worth]) -> Self {
        let (rays, expected) = ([0; LEVELS], [0.0; LEVELS]);
        let mut demand = Self { rays, expected, settled: 0.0, pixels: 0 };
        for worth in worths {
            demand.add(worth);
        }
        demand
    }

    /// The demand of these and other pixels.
    pub(super) fn and(mut self, other: &Self) -> Self {
        for level in 0..LEVELS {
            self.rays[level] += other.rays[level];
            self.expected[level] += other.expected[level];
        }
        self.settled += other.settled;
        self.pixels += other.pixels;
        self
    }

    /// Adds a pixel.
    fn add(&mut self, worth: &Worth) {
        let expected = f64::from(worth.expected);
        self.pixels += 1;
        match level_of(worth) {
            Some(level) => {
                self.rays[level] += worth.rays.ceil() as u64;
                self.expected[level] += expected;
            }
            None => self.settled += expected,
        }
    }

    /// The picture's squared error, summed over the pixels, once all above the level's threshold are refined.
    fn forecast(&self, level: usize) -> f64 {
        let halves = |above: usize| (level - above) as f64 / STEPS_TO_HALF;
        let refined = |above: usize| LEFT * (-ERROR_POWER * halves(above)).exp2();
        let above = self.expected[..=level].iter().enumerate();
        let above: f64 = above.map(|(l, expected)| expected * refined(l)).sum();
        self.settled + above + self.expected[level + 1..].iter().sum::<f64>()
    }

    /// The first level from `least` on by which the picture's error may be `wanted`, but not one too far on.
    fn level_for_error(&self, least: usize, wanted: f64) -> usize {
        let goal = wanted * wanted * self.pixels as f64;
        let last = (least + LONGEST_STEP).min(LEVELS - 1);
        (least..last).find(|&level| self.forecast(level) <= goal).unwrap_or(least.max(last))
    }

    /// The rays that stages worth at least the level's threshold take.
    fn at_level(&self, level: usize) -> u64 {
        self.rays[..=level].iter().sum()
    }

    /// The lowest level whose stages take at most so many rays, not far below the first that has any, which is taken if even
    /// that takes more; none if there are no stages.
    fn level_for(&self, rays: f64) -> Option<usize> {
        let first = (0..self.rays.len()).find(|&level| self.rays[level] > 0)?;
        let last = (first + LEVELS_AT_ONCE).min(self.rays.len() - 1);
        let fits = |level: &usize| self.at_level(*level) as f64 <= rays;
        Some((first..=last).rev().find(fits).unwrap_or(first))
    }

    fn threshold(level: usize) -> f32 {
        at_step(level as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: levels counted by hand; a stage is above the threshold of its level and all lower ones.
    #[test]
    fn demand_is_counted_by_level() {
        let mut demand = Demand::of(&[]);
        assert_eq!(demand.level_for(1.0), None);
        let mut add = |per_ray: f32, rays: f32, expected: f32| {
            demand.add(&Worth { error: per_ray * rays, rays, expected });
        };
        add(2000.0, 10.0, 9.0); // above the first step
        add(512.0, 5.0, 4.0); // two steps down
        add(500.0, 7.0, 2.0); // three
        add(0.0, 100.0, 0.0); // never
        add(1e-30, 100.0, 0.5);
        add(0.0, 0.0, 0.5);
        assert_eq!((demand.at_level(0), demand.at_level(2), demand.at_level(3)), (10, 15, 22));
        assert_eq!(demand.level_for(1.0), Some(0));
        assert_eq!(demand.level_for(11.0), Some(1));
        assert_eq!(demand.level_for(1e9), Some(LEVELS_AT_ONCE));
        for (level, per_ray) in [(0, 2000.0), (2, 512.0), (3, 500.0)] {
            assert!(Demand::threshold(level) <= per_ray, "{level}");
        }
        assert_eq!((demand.pixels, demand.forecast(0)), (6, 1.0 + 9.0 * LEFT + 4.0 + 2.0));
        assert!(demand.forecast(2) < 9.0 * LEFT + 4.0 * LEFT + 3.0 && demand.forecast(80) > 1.0);
        let error = |squared: f64| (squared / 6.0).sqrt();
        assert_eq!(demand.level_for_error(0, error(12.0)), 0);
        assert_eq!(demand.level_for_error(1, error(12.0)), 1);
        assert_eq!(demand.level_for_error(0, error(9.0)), 2);
        assert_eq!(demand.level_for_error(5, error(0.1)), 5 + LONGEST_STEP);
        assert_eq!(demand.level_for_error(LEVELS, error(0.1)), LEVELS);
    }
}
