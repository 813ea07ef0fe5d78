//! What accuracy costs: renders in every mode, timed and compared with a converged picture.
//!
//! The modes, depths or builds that stand beside each other in a table are rendered by turns, each once in a round, and
//! the median of each one's times counts: what slows the machine down for a while slows all of them.
//!
//! [`run`] measures and gives [`Row`]s; [`report`] makes tables and a page of them, [`charts`] plots, and
//! [`files`] says what their files are called.

pub mod charts;
mod draw;
pub mod files;
mod measure;
mod plan;
pub mod plot;
mod raster;
pub mod reference;
pub mod report;
mod svg;

use std::num::NonZeroUsize;

use serde::Serialize;
use thiserror::Error;

use crate::{
    aa::AntiAliasing,
    film::{FileError, Film},
    render::{Goal, RenderError, RenderOptions},
    scene::SceneError,
};
pub use measure::run;
pub use plan::Plan;

/// Which trade a row belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trade {
    /// Error against time, by anti-aliasing mode.
    Accuracy,
    /// Cost of the modes by the number of objects.
    Objects,
    /// Error and time by the deepest level of recursion.
    Depth,
    /// Error and time by the picture's size.
    Size,
    /// Time of a picture by the time that its tree's build may take.
    Build,
}

/// One render, measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Why it was measured.
    pub trade: Trade,
    /// The scene.
    pub scene: String,
    /// The primitives in it.
    pub primitives: usize,
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
    /// The deepest level of recursion.
    pub depth: u32,
    /// The anti-aliasing mode, or `max-error:E`.
    pub mode: String,
    /// The preset by which the tree was built.
    pub build: String,
    /// The time of that build; the median if it was repeated.
    pub build_seconds: f64,
    /// The median of the rounds, of the render alone.
    pub seconds: f64,
    /// Rays of all kinds.
    pub rays: u64,
    /// Camera rays for each pixel, on average.
    pub rays_per_pixel: f64,
    /// The error against the converged picture: root mean square of all channels in levels of 255, before rounding.
    pub measured_rmse: f64,
    /// What the render said it was; NaN if it said nothing.
    pub estimated_rmse: f64,
    /// The largest difference of a channel in levels.
    pub worst: f64,
    /// The time as a multiple of that of `none`, of the same scene and size and with a tree built by the preset `auto`; NaN if
    /// that was not rendered.
    pub relative_seconds: f64,
    /// The rays as a multiple of those of `none`, likewise.
    pub relative_rays: f64,
}

/// A scene in three pictures: itself, and maps of rays and error.
#[derive(Clone, Debug)]
pub struct Portrait {
    /// The scene.
    pub scene: String,
    /// The picture in the default mode.
    pub film: Film,
    /// The root mean square difference of each pixel's channels from the converged picture, in levels.
    pub errors: Vec<f32>,
}

/// Everything measured.
#[derive(Clone, Debug, Default)]
pub struct Study {
    /// The rows, in the order of measurement.
    pub rows: Vec<Row>,
    /// The scenes of the accuracy trade.
    pub portraits: Vec<Portrait>,
}

/// How far a study is, in rays to trace.
#[derive(Clone, Debug)]
pub struct Step {
    /// What comes next.
    pub what: String,
    /// The rays that what is done took, as estimated.
    pub done: f64,
    /// The rays that the whole study takes, as estimated.
    pub total: f64,
}

/// Why there is no study.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A render failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The converged picture cannot be kept.
    #[error(transparent)]
    File(#[from] FileError),
}

/// A mode of rendering that a study compares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// An anti-aliasing mode as it is.
    Plain(AntiAliasing),
    /// Until the picture's estimate is below so many levels.
    MaxError(f64),
}

impl Mode {
    fn name(self) -> String {
        match self {
            Self::Plain(aa) => aa.to_string(),
            Self::MaxError(error) => format!("max-error:{error}"),
        }
    }

    fn options(self, size: [u32; 2], depth: u32, threads: Option<NonZeroUsize>) -> RenderOptions {
        let (aa, goal) = match self {
            Self::Plain(aa) => (aa, Goal::Mode),
            Self::MaxError(error) => {
                (AntiAliasing::Adaptive { error: 0.0, most: 1024 }, Goal::Error(error))
            }
        };
        RenderOptions {
            size: Some(size),
            aa,
            goal,
            depth: Some(depth),
            threads,
            ..Default::default()
        }
    }

    /// About how many rays a pixel takes, to tell the time left.
    fn weight(self) -> f64 {
        match self {
            Self::Plain(AntiAliasing::None) => 1.0,
            Self::Plain(AntiAliasing::Grid { side }) => f64::from(side * side),
            Self::Plain(AntiAliasing::Sequence { count }) => f64::from(count),
            Self::Plain(AntiAliasing::Adaptive { error, .. }) => {
                1.0 + 8.0 / f64::from(error.max(0.1))
            }
            Self::MaxError(error) => 1.0 + 4.0 / error.max(0.1),
        }
    }
}

/// Errors below this many levels are of rounding.
const LEAST_ERROR: f64 = 1e-3;

/// The points that no other beats in both numbers, from the left.
pub(crate) fn pareto_front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut points = points.to_vec();
    points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut best = f64::INFINITY;
    points.retain(|&(_, y)| {
        let better = y < best;
        best = best.min(y);
        better
    });
    points
}

#[cfg(test)]
impl Row {
    /// A row of the accuracy trade.
    fn example(mode: &str) -> Self {
        Self {
            trade: Trade::Accuracy,
            scene: "spheres:10".to_owned(),
            primitives: 11,
            width: 4,
            height: 3,
            depth: 6,
            mode: mode.to_owned(),
            build: "auto".to_owned(),
            build_seconds: 0.125,
            seconds: 0.25,
            rays: 1234,
            rays_per_pixel: 4.5,
            measured_rmse: 2.5,
            estimated_rmse: 3.0,
            worst: 77.0,
            relative_seconds: 1.5,
            relative_rays: 2.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_holds_what_no_other_beats() {
        let points = [(3.0, 1.0), (1.0, 5.0), (2.0, 6.0), (2.5, 2.0), (4.0, 1.5), (3.0, 0.5)];
        assert_eq!(pareto_front(&points), [(1.0, 5.0), (2.5, 2.0), (3.0, 0.5)]);
        assert!(pareto_front(&[]).is_empty());
    }
}
