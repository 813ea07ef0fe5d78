//! What rays are for, and what becomes of their answers.

use super::{
    lit::Shown,
    signature::{Branch, Path},
    sum::Sum,
};
use crate::{
    aa::{Sample, detail::Detail},
    color::Rgb,
};

/// The least weight in a sample of a hit whose cell counts.
const WEIGHT_OF_CELLS: f32 = 0.25;

/// What a ray on the work list is for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    /// What its answer counts in the sample.
    pub(super) weight: Rgb,
    /// Camera rays have level 1.
    pub(super) level: u32,
    /// The length of the path from the camera so far.
    pub(super) way: f32,
    /// The side of the square that it stands for, by length of the path; 0 for camera rays, whose direction tells.
    pub(super) width: f32,
    /// Which of the samples asked for it belongs to.
    pub(super) sample: u32,
    pub(super) path: Path,
}

impl Task {
    /// What the camera ray of a sample is for.
    #[inline(always)]
    pub(super) fn camera(sample: u32) -> Self {
        Self { weight: Rgb::ONE, level: 1, way: 0.0, width: 0.0, sample, path: Path::START }
    }

    /// What a ray is for that comes from where this one has gone so far, if its answer counts `weight` in this one's.
    #[inline(always)]
    pub(super) fn child(&self, (gone, width): (f64, f32), weight: Rgb, branch: Branch) -> Self {
        Self {
            weight: self.weight * weight,
            level: self.level + 1,
            way: self.way + gone as f32,
            width,
            sample: self.sample,
            path: self.path.branch(branch),
        }
    }
}

/// What a sample gathers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gathered {
    color: Sum,
    signature: u32,
    cell: u32,
    detail: Detail,
    pub(super) rays: u32,
}

impl Gathered {
    /// Adds what a ray brings back.
    #[inline(always)]
    pub(super) fn add(&mut self, light: Rgb, signature: u32) {
        self.rays += 1;
        self.color.add(light);
        self.signature = self.signature.wrapping_add(signature);
    }

    /// What came of it.
    pub(super) fn sample(&self) -> Sample {
        let Self { color, signature, cell, detail, rays } = *self;
        let color = color.value().max(Rgb::ZERO).min(Rgb::ONE);
        Sample { color, signature, cell, detail, rays }
    }

    /// Adds a hit that shows its own colour.
    #[inline(always)]
    pub(super) fn add_hit(&mut self, task: &Task, shown: &Shown) {
        self.add(task.weight * shown.light, shown.signature);
        if shown.cell != 0 && task.weight.max_element() >= WEIGHT_OF_CELLS {
            self.cell = self.cell.wrapping_add(task.path.cell(shown.cell).signature());
        }
        if shown.detail != Detail::default() {
            self.detail = self.detail.and(shown.detail.lit(task.weight).squared_error());
            if task.level == 1 && shown.detail.is_whole() {
                self.detail = self.detail.whole();
            }
        }
    }
}
