//! A pixel of a pattern that is the same in all of them, and what its neighbours say of its error.

use glam::Vec3;

use super::plane::Plane;
use crate::{
    aa::{
        Sample,
        estimate::Spread,
        kinds::Kinds,
        levels::{error_of_light, levels},
        lines::border_error,
        pattern::Pattern,
    },
    color::Rgb,
};

/// What is kept of a pixel until its neighbours are known.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cell {
    pub(super) color: Rgb,
    /// The signature, if all samples share it; else a number of the pixel's own.
    pub(super) signature: u32,
    alike: bool,
    /// The squared error, in levels, as the pixel's own samples tell it.
    error: f32,
    kinds: Kinds,
    /// The squared error if the first, or the second, of the other kinds was met by chance.
    by_chance: [f32; 2],
}

/// What makes cells of samples.
pub(super) struct Judge {
    pattern: Pattern,
    // Of one pixel; kept for their memory.
    levels: Vec<Vec3>,
    spread: Spread,
}

impl Judge {
    pub(super) fn of(pattern: Pattern) -> Self {
        let levels = Vec::with_capacity(pattern.count());
        Self { pattern, levels, spread: Spread::default() }
    }

    /// What the `samples` of a pixel say, which has a number of its own.
    pub(super) fn cell(&mut self, samples: &[Sample], own_number: u32) -> Cell {
        let Self { pattern, levels: seen, spread } = self;
        seen.clear();
        seen.extend(samples.iter().map(|sample| levels(sample.color)));
        spread.restart(seen[0]);
        let (mut sum, mut detail) = (Rgb::ZERO, 0.0);
        for (sample, levels) in samples.iter().zip(&*seen) {
            sum += sample.color;
            detail += sample.detail.squared_error();
            spread.add(*levels, sample.signature);
        }
        let color = sum / samples.len() as f32;
        let of_variance = |variance: Rgb| error_of_light(color, variance.map(f32::sqrt));
        let lines = pattern.lines(samples);
        let along = lines.map_or(0.0, |lines| of_variance(lines.variance()));
        let lone = lines.and_then(|lines| lines.lone_errors());
        let kinds = Kinds::of(samples, lone.is_some());
        let scattered = || {
            let colors = samples.iter().map(|sample| sample.color);
            [of_variance(pattern.variance(colors)); 2]
        };
        let detail = detail / samples.len() as f32;
        let finer = if detail > 0.0 { pattern.picture_error(seen, detail) } else { 0.0 };
        let is_by_chance = kinds.has_few_others();
        let only = spread.only_signature();
        Cell {
            color,
            signature: only.unwrap_or(own_number),
            alike: only.is_some(),
            error: pattern.error(seen, spread).max(along).max(finer),
            kinds,
            by_chance: if is_by_chance { lone.unwrap_or_else(scattered) } else { [0.0; 2] },
        }
    }
}

impl Plane<Cell> {
    /// The squared error of a pixel, but for what may hide between samples that are alike.
    pub(super) fn error_at(&self, x: i64, y: i64) -> f32 {
        let cell = self.at(x, y);
        if cell.by_chance.iter().all(|by_chance| *by_chance <= cell.error) {
            return cell.error;
        }
        let around = |k| self.nearest(x + k as i64 % 3 - 1, y + k as i64 / 3 - 1).kinds;
        let small = cell.kinds.small_among(&std::array::from_fn::<_, 9, _>(around));
        small.map_or(cell.error, |k| cell.by_chance[k].max(cell.error))
    }

    /// The squared error that may hide between the samples of a pixel, if they are alike; `contrast` is that to its neighbours.
    pub(super) fn hidden_at(&self, x: i64, y: i64, pattern: Pattern, contrast: f32) -> f32 {
        if !self.at(x, y).alike {
            return 0.0;
        }
        let along = match pattern {
            Pattern::Grid(side) => self.border_error_at(x, y, side),
            Pattern::Sequence(_) => 0.0,
        };
        along.max(pattern.unseen() * contrast)
    }

    /// That of edges which run along the pixel's own: they are straight, and things on either side are alike.
    fn border_error_at(&self, x: i64, y: i64, side: usize) -> f32 {
        let here = self.at(x, y);
        let is_as = |cell: &Cell, other: &Cell| other.alike && other.signature == cell.signature;
        let of_side = |(right, down): (i64, i64)| {
            let there = self.nearest(x + right, y + down);
            let goes_on = |k: i64| {
                let (x, y) = (x + k * down, y + k * right);
                is_as(here, self.nearest(x, y)) && is_as(there, self.nearest(x + right, y + down))
            };
            let is_edge = there.alike && there.signature != here.signature;
            let is_straight = is_edge && goes_on(-1) && goes_on(1);
            if is_straight { border_error(here.color, there.color, side) } else { 0.0 }
        };
        [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().map(of_side).sum()
    }
}
