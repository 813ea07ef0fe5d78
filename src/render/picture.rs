//! A part of a picture, of whatever samplers see: what becomes of it by each mode and goal.

use std::{sync::Mutex, time::Instant};

use super::{
    Account, Block, Goal, Outcome, Progress, RayCounts, Sink, Unfinished,
    adaptive::Adaptive,
    blocks::rmse,
    crew::{Crew, Meter, Sampler},
    plain,
    plane::Area,
    round::Threshold,
    watch::Watch,
};
use crate::{aa::AntiAliasing, color::Rgb, film::Tile};

/// A picture before it is a film.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The colours, row by row, linear.
    pub colors: Vec<Rgb>,
    /// The rays through each pixel.
    pub samples: Vec<u32>,
    /// The estimated squared error, summed over the pixels, in levels of 255.
    pub squared_error: f64,
    /// How it ended.
    pub outcome: Outcome,
}

impl Picture {
    /// The estimated error: root mean square of all channels, in levels of 255.
    pub fn estimated_rmse(&self) -> f64 {
        rmse(self.squared_error, self.colors.len())
    }

    pub(super) fn into_block(self, number: usize, place: Tile, rays: RayCounts) -> Block {
        let Self { colors, samples, squared_error, outcome } = self;
        let account = Account { rays, squared_error, unsettled: outcome.unsettled as u64 };
        Block { number, place, colors, samples, account, outcome }
    }
}

/// The part `part` of a picture `width` pixels wide, of whatever `new_sampler`'s samplers see; each worker thread has
/// its own.
///
/// Every pixel depends on its place in the whole picture and on what is seen within two pixels of it, never on
/// `part`; the estimate of the error also on where parts end, but for the adaptive mode.
pub fn picture<S: Sampler + Send>(
    part: &Tile,
    width: u32,
    aa: AntiAliasing,
    goal: Goal,
    new_sampler: &(dyn Fn() -> S + Sync),
    progress: &(dyn Fn(Progress) + Sync),
) -> Picture {
    let watch = Watch { sink: &Nobody, place: part, rays: &Mutex::default() };
    picture_watched(part, width, (aa, goal), new_sampler, progress, &watch)
}

/// Takes no notice of what a picture is on its way.
struct Nobody;

impl Sink for Nobody {
    fn put(&self, _: Block) {}
}

/// The same, looked after. Of a picture that the sink has abandoned, any part may be missing.
pub(super) fn picture_watched<S: Sampler + Send>(
    part: &Tile,
    width: u32,
    (aa, goal): (AntiAliasing, Goal),
    new_sampler: &(dyn Fn() -> S + Sync),
    progress: &(dyn Fn(Progress) + Sync),
    watch: &Watch,
) -> Picture {
    let area = Area::of(part);
    let started = Instant::now();
    let meter = Meter::new(progress_units(aa, goal) * area.len() as u64, progress);
    let crew = Crew::new(new_sampler, &meter);
    let stop = || watch.sink.is_abandoned();
    match aa {
        AntiAliasing::None | AntiAliasing::Grid { side: 1 } => plain::centers(&crew, &area, &stop),
        AntiAliasing::Grid { side } => plain::grid(&crew, &area, side, &stop),
        AntiAliasing::Sequence { count } => plain::sequence(&crew, &area, width, count, &stop),
        AntiAliasing::Adaptive { error, most } => {
            let begun = || watch.kept().unwrap_or_else(|| Unfinished::new(&area, width, most));
            let (adaptive, outcome) = match goal {
                Goal::Mode => {
                    let mut adaptive = Adaptive::new(&area, width, most);
                    let threshold = Threshold::Error(error * error);
                    if adaptive.begin(&crew, error * error, stop) {
                        meter.reach(0.5);
                        adaptive.refine(&crew, threshold, true, stop);
                    }
                    let unsettled = adaptive.unsettled(error * error);
                    (adaptive, Outcome { unsettled, ..Outcome::default() })
                }
                Goal::Error(wanted) => begun().reach_error(&crew, wanted, watch),
                Goal::Until(end) => begun().reach_time(&crew, (started, end), watch),
            };
            if !stop() {
                meter.reach(1.0);
            }
            Picture { outcome, ..adaptive.into_picture() }
        }
    }
}

/// How much of [`Progress`] a pixel is, of which its centre is one: the adaptive mode goes over it twice, and on the
/// way to a goal the centres are the least of it.
pub(super) fn progress_units(aa: AntiAliasing, goal: Goal) -> u64 {
    match (aa, goal) {
        (AntiAliasing::Adaptive { .. }, Goal::Mode) => 2,
        (AntiAliasing::Adaptive { .. }, _) => 64,
        _ => 1,
    }
}
