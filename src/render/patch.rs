//! The pixels of a tile of a picture that gets better: those that may be refined, and what the others come to.

use serde::{Deserialize, Serialize};

use super::{
    crew::in_turn,
    hints::{Hint, Least},
    look::skips_cells,
    outlook::{Outlook, Worth},
    plane::{Area, Plane},
    round::{Pixel, Threshold},
    window::Survey,
};
use crate::aa::{Sample, estimate::Look, refined::Stage};

/// The samples that a pixel gets at least where a pattern's cells are no wider than it: its centre and corners, and
/// those of its neighbours, may all have met the same colour.
const LEAST_IN_CELLS: Least = Least { samples: 8, if_alike: 8, part: 0.5 };

/// What is known of the pixels of a tile.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Patch {
    /// Those that may be refined, or were; close together if they are so in the picture.
    pub(super) pixels: Vec<Pixel>,
    /// What all others add to the picture's squared error.
    pub(super) settled: f64,
    /// What more rays are worth here.
    pub(super) outlook: Outlook,
}

/// What there is to know of a tile before any pixel is refined.
pub(super) struct FirstLook<'a, H> {
    pub(super) tile: &'a Area,
    /// What its centres and those around say.
    pub(super) survey: &'a Survey,
    /// Its centres, row by row, and all.
    pub(super) own: &'a [Sample],
    pub(super) centers: &'a Plane<Sample>,
    /// What the scene tells of a pixel, if it tells of any here.
    pub(super) hint: Option<H>,
    pub(super) stages: &'a [Stage],
    /// No pixel with a smaller squared error is refined.
    pub(super) least: f32,
}

impl<H: Fn(i64, i64) -> Hint> FirstLook<'_, H> {
    /// What the pixels come to if no neighbours' rays met anything else and none is to be refined.
    pub(super) fn calm(&self) -> Option<Patch> {
        let Self { survey, own, hint, stages, least, .. } = self;
        if !survey.suspects.is_empty() || hint.is_some() || stages.is_empty() {
            return None;
        }
        let pixels = survey.smooth.iter().zip(&survey.noise).zip(*own);
        let worths = pixels.map(|((smooth, noise), center)| {
            Worth::of_smooth(smooth.max(noise.error()), *smooth, center)
        });
        let outlook = Outlook::of(0.0, worths);
        let settled = outlook.expected;
        (!outlook.may_exceed(Threshold::Error(*least)))
            .then(|| Patch { settled, ..Patch::default() }.looked_over())
    }

    /// The pixels one by one.
    pub(super) fn patch(&self) -> Patch {
        let Self { tile, survey, own, hint, stages, least, .. } = self;
        let mut looks = vec![None; tile.len()];
        for (place, look) in &survey.suspects {
            looks[*place] = Some(look);
        }
        let mut patch = Patch::default();
        for (x, y) in in_turn(tile) {
            let place = tile.place_of(x, y);
            let center = &own[place];
            let mut pixel = match looks[place] {
                Some(look) => self.suspect((x, y), look, center),
                None => self.smooth((x, y), place, center),
            };
            let mut expected = pixel.worth.expected;
            if let Some(hint) = hint {
                expected += pixel.heed(hint(x, y), center.color);
            }
            pixel.worth = Worth::of(&pixel, expected, stages, center);
            if pixel.worth.exceeds(Threshold::Error(*least)) {
                patch.pixels.push(pixel);
            } else {
                patch.settled += f64::from(pixel.worth.expected);
            }
        }
        patch.looked_over()
    }

    /// A pixel whose neighbours' rays all met the same.
    #[inline(always)]
    fn smooth(&self, (x, y): (i64, i64), place: usize, center: &Sample) -> Pixel {
        let (smooth, noise) = (self.survey.smooth[place], self.survey.noise[place]);
        Pixel {
            x,
            y,
            error: smooth.max(noise.error()),
            // What the neighbours of each say is right on average.
            worth: Worth { expected: smooth, ..Worth::default() },
            contrast: noise.contrast(),
            busy: noise.busy(),
            detail: center.detail,
            ..Pixel::default()
        }
    }

    /// A pixel around which rays met something else.
    fn suspect(&self, (x, y): (i64, i64), look: &Look, center: &Sample) -> Pixel {
        let skips = skips_cells(self.centers, x, y, look.contrast);
        let error = look.center_error().max(center.detail.squared_error());
        Pixel {
            x,
            y,
            suspect: true,
            error,
            worth: Worth { expected: error, ..Worth::default() },
            least: if skips { LEAST_IN_CELLS } else { Least::default() },
            contrast: look.contrast,
            busy: look.busy,
            detail: center.detail,
            ..Pixel::default()
        }
    }
}

impl Patch {
    /// The same, with the outlook of what it is now.
    pub(super) fn looked_over(mut self) -> Self {
        self.outlook = Outlook::of(self.settled, self.pixels.iter().map(|pixel| pixel.worth));
        self
    }

    /// Adds to what a pixel is expected to be off by.
    pub(super) fn expect(&mut self, x: i64, y: i64, more: f32) {
        match self.pixels.iter_mut().find(|pixel| (pixel.x, pixel.y) == (x, y)) {
            Some(pixel) => pixel.worth.expected += more,
            None => self.settled += f64::from(more),
        }
        self.outlook.expected += f64::from(more);
    }
}
