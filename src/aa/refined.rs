//! A pixel that got more than its centre.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::detail::Detail;
use super::estimate::{BUSY, Spread, all_alike, quarters_share, sequence_share, sequence_unseen};
use super::levels::{error_of_light, levels, squared_distance};
use crate::color::Rgb;

/// The most kinds of things in a pixel with something thin and little else.
const MOST_WITH_THIN: usize = 3;

/// A camera ray's answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Linear light, each channel clamped to `[0, 1]`.
    pub color: Rgb,
    /// A hash of what the ray and those that came of it met: surfaces and their sides, cells of patterns, which lights
    /// were seen through what, and the inner parts of highlights if wanted. Samples with the same signature differ by
    /// what varies smoothly.
    pub signature: u32,
    /// A number of the cells of patterns that show, directly or by what is reflected and transmitted; 0 for none.
    pub cell: u32,
    /// What it shows of pictures that are finer than it: than the pixel for the centre, than a cell for one of many.
    pub detail: Detail,
    /// How many rays it took, those towards the lights included.
    pub rays: u32,
}

/// How far a pixel is refined: by centre and corners, and so many samples of its sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// The samples of the sequence; 0 is centre and corners alone.
    pub points: u32,
    /// The shares of [`sequence_share`], [`quarters_share`] and [`sequence_unseen`].
    share: f32,
    quarters: f32,
    unseen: f32,
}

impl Stage {
    fn new(points: u32) -> Self {
        let (share, quarters) = (sequence_share(points), quarters_share(points));
        Self { points, share, quarters, unseen: sequence_unseen(points) }
    }
}

/// The stages of a pixel after its centre, for at most `most` rays through a pixel: a corner of its own (others belong
/// to neighbours), then 4, 8, 16, ... samples.
pub fn stages(most: u32) -> Vec<Stage> {
    let most = most.saturating_sub(2);
    if most < 2 {
        return Vec::new();
    }
    let powers = (2..31).map(|k| 1_u32 << k);
    let samples = powers.take_while(|points| *points < most);
    [0].into_iter().chain(samples).chain([most]).map(Stage::new).collect()
}

/// The samples of a pixel so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Refined {
    /// Half the centre and an eighth of each corner.
    cross: Rgb,
    sum: Rgb,
    points: u32,
    stage: Stage,
    spread: Spread,
    /// The sum of the linear colours and of their squares, of all that is in `spread`.
    linear: [Rgb; 2],
    quarters: Quarters,
}

/// The sums of the samples' display levels over each quarter of the sequence so far.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Quarters {
    sums: [Vec3; 4],
    counts: [u32; 4],
    /// The samples when the stage began, and those it is to end with.
    from: u32,
    to: u32,
}

impl Quarters {
    /// Makes room for the samples up to number `to`: two new quarters, the old ones joined by two.
    fn begin(&mut self, from: u32, to: u32) {
        if from > 0 {
            self.sums =
                [self.sums[0] + self.sums[1], self.sums[2] + self.sums[3], Vec3::ZERO, Vec3::ZERO];
            self.counts = [self.counts[0] + self.counts[1], self.counts[2] + self.counts[3], 0, 0];
        }
        (self.from, self.to) = (from, to);
    }

    fn add(&mut self, index: u32, levels: Vec3) {
        let (first, parts) = if self.from == 0 { (0, 4) } else { (2, 2) };
        let span = (self.to - self.from).max(1);
        let quarter = (first + (index - self.from) * parts / span).min(3) as usize;
        self.sums[quarter] += levels;
        self.counts[quarter] += 1;
    }

    /// The variance of the quarters' mean if they were independent.
    fn variance(&self) -> f32 {
        if self.counts.contains(&0) {
            return 0.0;
        }
        let means: [Vec3; 4] = std::array::from_fn(|k| self.sums[k] / self.counts[k] as f32);
        let mean = means.iter().sum::<Vec3>() / 4.0;
        means.iter().map(|m| squared_distance(*m, mean)).sum::<f32>() / 12.0
    }
}

impl Refined {
    /// A pixel with its centre and corners, which are the first of its [`stages`].
    pub fn new(stage: Stage, center: &Sample, corners: &[(Rgb, u32); 4]) -> Self {
        let origin = levels(center.color);
        let mut spread = Spread::about(origin);
        spread.add(origin, center.signature);
        let mut cross = center.color * 0.5;
        let mut linear = [center.color, center.color * center.color];
        for (color, signature) in corners {
            linear = [linear[0] + color, linear[1] + color * color];
            cross += *color * 0.125;
            spread.add(levels(*color), *signature);
        }
        Self {
            cross,
            sum: Rgb::ZERO,
            points: 0,
            stage,
            spread,
            linear,
            quarters: Quarters::default(),
        }
    }

    /// Announces that the samples of a stage come next.
    pub fn begin(&mut self, stage: Stage) {
        self.quarters.begin(self.points, stage.points);
        self.stage = stage;
    }

    /// Takes in the next sample of the pixel's sequence.
    pub fn add(&mut self, sample: &Sample) {
        let levels = levels(sample.color);
        self.quarters.add(self.points, levels);
        self.sum += sample.color;
        self.points += 1;
        self.linear = [self.linear[0] + sample.color, self.linear[1] + sample.color * sample.color];
        self.spread.add(levels, sample.signature);
    }

    /// How many samples of the sequence there are.
    pub fn points(&self) -> u32 {
        self.points
    }

    /// Whether all samples met the same.
    pub fn is_alike(&self) -> bool {
        self.spread.kinds() == 1
    }

    /// The pixel's colour: the mean of the sequence; few samples are helped by centre and corners.
    pub fn color(&self) -> Rgb {
        let weight = match self.points {
            0..12 => 2.0,
            12..24 => 1.0,
            _ => 0.0,
        };
        (self.sum + self.cross * weight) / (self.points as f32 + weight)
    }

    /// The colour's squared error: rather too large than too small, for this pixel; and as it is on average, for sums
    /// over many. `contrast` and `busy` are those of the pixel's [`Look`](super::estimate::Look) if it is
    /// suspect, those of the noise about it if all neighbours met the same; `detail` is that of its centre. Noise of a picture
    /// ends where its texels are smooth, other noise does not.
    ///
    /// From 8 samples on the second comes from what the quarters of the samples differ by, which knows nothing of what
    /// they met.
    pub fn errors(&self, contrast: f32, busy: f32, detail: Detail) -> (f32, f32) {
        // What differs although all met the same is noise, all of it where it is busy.
        let noise = if self.is_alike() && !detail.is_whole() { busy * busy * busy } else { 0.0 };
        let seen = self.spread.error(self.stage.share, noise.max(BUSY * busy));
        if self.points < 8 {
            let error = self.with_unseen(seen, (contrast, busy), detail);
            return (error, error);
        }
        let share =
            if noise > 0.0 { self.stage.quarters.powf(1.0 - noise) } else { self.stage.quarters };
        let quartered = share * self.quarters.variance();
        let error = |seen: f32| self.with_unseen(seen, (contrast, busy), detail);
        (error(seen.max(quartered)), error(quartered))
    }

    /// The squared error of a pixel in which something thin is before or behind little else: few samples meet it, and the mean is off
    /// by light rather than by levels, which are far apart where there is little light. `None` of a crowd, of which levels tell.
    pub fn error_of_thin(&self) -> Option<f32> {
        if self.spread.kinds() > MOST_WITH_THIN {
            return None;
        }
        let count = self.spread.count().max(2) as f32;
        let [sum, squares] = self.linear;
        let mean = sum / count;
        let variance = (squares - sum * mean).max(Rgb::ZERO) / (count - 1.0);
        let off = (variance * self.spread.share(self.stage.share, BUSY)).map(f32::sqrt);
        Some(error_of_light(self.color(), off))
    }

    /// The error with that of what may hide between the samples: little if they all met the same, unless they are of a
    /// picture that has more detail; much if they met different things of one colour, as where a pixel skips cells of a
    /// pattern.
    fn with_unseen(&self, seen: f32, (contrast, busy): (f32, f32), detail: Detail) -> f32 {
        let alike = all_alike(self.spread.count());
        let (hidden, in_picture) = (alike / 8.0 * contrast, alike * 2.0 * detail.squared_error());
        if self.spread.kinds() > 1 {
            return seen.max(hidden).max(in_picture);
        }
        seen + (self.stage.unseen * contrast).max(busy * hidden).max(in_picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_corners_and_powers_of_two_up_to_the_last() {
        let points = |most| stages(most).iter().map(|stage| stage.points).collect::<Vec<u32>>();
        assert_eq!(points(64), [0, 4, 8, 16, 32, 62]);
        assert_eq!(points(18), [0, 4, 8, 16]);
        assert_eq!(points(10), [0, 4, 8]);
        assert_eq!(points(4), [0, 2]);
        assert!([0, 1, 2, 3].iter().all(|&most| stages(most).is_empty()));
    }
}
