//! How many rays are worth how much: what the pixels of a picture ask for, by a ladder of thresholds.

use std::f64::consts::SQRT_2;

use super::outlook::Worth;

/// The ladder of thresholds, in squared levels for each ray: its first step, and steps to halve it.
const FIRST_STEP: f64 = 1024.0;
const STEPS_TO_HALF: f64 = 2.0;
/// The last step: thresholds below make no difference to an 8-bit picture.
pub(super) const LAST_STEP: u32 = 80;
/// A pixel's squared error goes about like this power of the threshold: it falls like n^-1.6 with n samples, the rays
/// of a stage grow like n, so its worth for each ray falls like n^-2.6.
const ERROR_POWER: f64 = 1.6 / 2.6;
/// The part of that which is left on average, because pixels go on by whole stages; rather too small, so as not to
/// overshoot.
const LEFT: f64 = 0.4;
/// The most levels of the ladder that are taken at once towards an error.
const LONGEST_STEP: usize = 12;
/// The levels of the ladder that a step takes at most: what is worth an eighth of the most can wait.
const LEVELS_AT_ONCE: usize = 6;

/// The levels of the ladder.
const LEVELS: usize = LAST_STEP as usize + 1;

/// The threshold at a step of the ladder.
pub(super) fn at_step(step: u32) -> f32 {
    (FIRST_STEP * (-f64::from(step) / STEPS_TO_HALF).exp2()) as f32
}

/// The first level of the ladder whose threshold the error for each ray of a pixel's next stage is above, if any is.
fn level_of(error: f32, rays: f32) -> Option<usize> {
    if error <= 0.0 {
        return None;
    }
    let share = f64::from(error) / (FIRST_STEP * f64::from(rays));
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
    /// Whether there may not be time for all pixels that are to get rays whatever their error.
    is_short: bool,
}

impl Demand {
    /// The demand of so many pixels, of which nothing is known yet; `is_short` is whether there may not be time for all
    /// that are to get rays whatever their error.
    pub(super) fn of(pixels: usize, is_short: bool) -> Self {
        Self { rays: [0; LEVELS], expected: [0.0; LEVELS], settled: 0.0, pixels, is_short }
    }

    /// What is known of these and of others of the same picture.
    pub(super) fn and(mut self, other: &Self) -> Self {
        for level in 0..LEVELS {
            self.rays[level] += other.rays[level];
            self.expected[level] += other.expected[level];
        }
        self.settled += other.settled;
        self
    }

    /// Takes in what is known of a pixel.
    pub(super) fn add(&mut self, worth: &Worth) {
        let expected = f64::from(worth.expected);
        let error = if self.is_short { worth.if_short } else { worth.error };
        match level_of(error, worth.rays) {
            Some(level) => {
                self.rays[level] += worth.rays.ceil() as u64;
                self.expected[level] += expected;
            }
            None => self.settle(expected),
        }
    }

    /// Takes in pixels that ask for no rays, and what they add to the picture's squared error.
    pub(super) fn settle(&mut self, expected: f64) {
        self.settled += expected;
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
    pub(super) fn level_for_error(&self, least: usize, wanted: f64) -> usize {
        let goal = wanted * wanted * self.pixels as f64;
        let last = (least + LONGEST_STEP).min(LEVELS - 1);
        (least..last).find(|&level| self.forecast(level) <= goal).unwrap_or(least.max(last))
    }

    /// The rays that stages worth at least the level's threshold take.
    pub(super) fn at_level(&self, level: usize) -> u64 {
        self.rays[..=level].iter().sum()
    }

    /// The lowest level whose stages take at most so many rays, not far below the first that has any, which is taken if
    /// even that takes more; none if there are no stages.
    pub(super) fn level_for(&self, rays: f64) -> Option<usize> {
        let first = (0..self.rays.len()).find(|&level| self.rays[level] > 0)?;
        let last = (first + LEVELS_AT_ONCE).min(self.rays.len() - 1);
        let fits = |level: &usize| self.at_level(*level) as f64 <= rays;
        Some((first..=last).rev().find(fits).unwrap_or(first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: levels counted by hand; a stage is above the threshold of its level and all lower ones.
    #[test]
    fn demand_is_counted_by_level() {
        let mut demand = Demand::of(6, false);
        assert_eq!(demand.level_for(1.0), None);
        let mut add = |per_ray: f32, rays: f32, expected: f32| {
            demand.add(&Worth { error: per_ray * rays, if_short: 0.0, rays, expected });
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
            assert!(at_step(level as u32) <= per_ray, "{level}");
        }
        assert_eq!((demand.pixels, demand.forecast(0)), (6, 1.0 + 9.0 * LEFT + 4.0 + 2.0));
        assert!(demand.forecast(2) < 9.0 * LEFT + 4.0 * LEFT + 3.0 && demand.forecast(80) > 1.0);
        let error = |squared: f64| (squared / 6.0).sqrt();
        assert_eq!(demand.level_for_error(0, error(12.0)), 0);
        assert_eq!(demand.level_for_error(1, error(12.0)), 1);
        assert_eq!(demand.level_for_error(0, error(9.0)), 2);
        assert_eq!(demand.level_for_error(5, error(0.1)), 5 + LONGEST_STEP);
        assert_eq!(demand.level_for_error(LEVELS, error(0.1)), LEVELS);
        // What is to get rays whatever its error comes first, unless time is short.
        for (is_short, level) in [(false, 0), (true, 2)] {
            let mut demand = Demand::of(1, is_short);
            let (error, if_short) = (f32::INFINITY, 5.0 * 512.0);
            demand.add(&Worth { error, if_short, rays: 5.0, expected: 1.0 });
            assert_eq!(demand.level_for(1.0), Some(level));
        }
    }
}
