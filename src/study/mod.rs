//! What accuracy costs: renders in every mode, timed and compared with a converged picture.
//!
//! [`run`] measures and gives [`Row`]s; [`report`] makes tables and a page of them, [`charts`] plots.

pub mod charts;
mod draw;
mod plan;
mod raster;
pub mod reference;
pub mod report;
mod svg;

use std::{num::NonZeroUsize, path::Path};

use serde::Serialize;
use thiserror::Error;

use crate::{
    aa::{AntiAliasing, levels::levels},
    film::{FileError, Film},
    render::{Goal, RenderError, RenderOptions, Rendering, render},
    scene::{Scene, SceneError},
};
pub use plan::Plan;
use reference::Reference;

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
    /// The median of the repeats, of the render alone.
    pub seconds: f64,
    /// Rays of all kinds.
    pub rays: u64,
    /// Camera rays for each pixel, on average.
    pub rays_per_pixel: f64,
    /// The error against the converged picture: root mean square of all channels in levels of 255, before rounding.
    pub measured_rmse: f64,
    /// What the render said it was.
    pub estimated_rmse: f64,
    /// The largest difference of a channel in levels.
    pub worst: f64,
    /// The time as a multiple of that of `none`, of the same scene and size.
    pub relative_seconds: f64,
    /// The rays as a multiple of those of `none`.
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
    /// The work done, and that in all.
    pub done: f64,
    /// The whole work.
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

/// Measures all that `plan` asks for; `load` finds scenes by their names and `folder` keeps converged pictures for the next
/// time.
///
/// # Errors
/// A scene cannot be loaded, a render fails, or a converged picture cannot be written.
pub fn run(
    plan: &Plan,
    load: &dyn Fn(&str) -> Result<Scene, SceneError>,
    folder: &Path,
    progress: &dyn Fn(&Step),
) -> Result<Study, StudyError> {
    let mut run =
        Run { plan, folder, progress, done: 0.0, total: plan.work(), study: Study::default() };
    for name in &plan.scenes {
        let scene = load(name)?;
        let setting = Setting { trade: Trade::Accuracy, name, scene: &scene, size: plan.size };
        let reference = run.compare(&setting, &plan.modes)?;
        run.portray(&setting, &reference)?;
    }
    for objects in &plan.objects {
        let name = format!("spheres:{objects}");
        let scene = load(&name)?;
        let setting =
            Setting { trade: Trade::Objects, name: &name, scene: &scene, size: plan.small_size };
        run.compare(&setting, &plan.few_modes)?;
    }
    let scene = load(&plan.depth_scene)?;
    for size in &plan.sizes {
        let setting =
            Setting { trade: Trade::Size, name: &plan.depth_scene, scene: &scene, size: *size };
        run.compare(&setting, &plan.few_modes)?;
    }
    run.depths(&scene)?;
    Ok(run.study)
}

/// What is rendered in several modes.
struct Setting<'a> {
    trade: Trade,
    name: &'a str,
    scene: &'a Scene,
    size: [u32; 2],
}

struct Run<'a> {
    plan: &'a Plan,
    folder: &'a Path,
    progress: &'a dyn Fn(&Step),
    done: f64,
    total: f64,
    study: Study,
}

impl Run<'_> {
    fn step(&mut self, what: String, work: f64) {
        (self.progress)(&Step { what, done: self.done, total: self.total });
        self.done += work;
    }

    fn reference(&mut self, setting: &Setting) -> Result<Reference, StudyError> {
        let [width, height] = setting.size;
        let rays = self.plan.reference_rays;
        let work = plan::pixels(setting.size) * f64::from(rays);
        self.step(format!("{} {width}x{height}: {rays} rays per pixel", setting.name), work);
        Reference::of(
            setting.scene,
            setting.name,
            setting.size,
            rays,
            self.plan.threads,
            self.folder,
        )
    }

    /// Renders in all modes by turns, so that a busy moment of the machine does not fall on one of them alone.
    fn compare(&mut self, setting: &Setting, modes: &[Mode]) -> Result<Reference, StudyError> {
        let reference = self.reference(setting)?;
        let mut renderings: Vec<Option<Rendering>> = vec![None; modes.len()];
        let mut seconds = vec![Vec::new(); modes.len()];
        let depth = setting.scene.depth();
        for repeat in 0..self.plan.repeats {
            for (k, mode) in modes.iter().enumerate() {
                let what = format!(
                    "{}: {}, {} of {}",
                    setting.name,
                    mode.name(),
                    repeat + 1,
                    self.plan.repeats
                );
                self.step(what, mode.weight() * plan::pixels(setting.size));
                let options = mode.options(setting.size, depth, self.plan.threads);
                let rendering = render(setting.scene, &options, &|_| ())?;
                seconds[k].push(rendering.seconds);
                renderings[k] = Some(rendering);
            }
        }
        let first = self.study.rows.len();
        for ((mode, rendering), times) in modes.iter().zip(&renderings).zip(seconds) {
            if let Some(rendering) = rendering {
                let row = row(setting, mode.name(), rendering, median(times), &reference);
                self.study.rows.push(row);
            }
        }
        relate(&mut self.study.rows[first..]);
        Ok(reference)
    }

    fn portray(&mut self, setting: &Setting, reference: &Reference) -> Result<(), StudyError> {
        let mode = Mode::Plain(AntiAliasing::default());
        let options = mode.options(setting.size, setting.scene.depth(), self.plan.threads);
        let film = render(setting.scene, &options, &|_| ())?.film;
        let errors = film
            .pixels()
            .iter()
            .zip(reference.pixels())
            .map(|(a, b)| ((levels(*a) - levels(*b)).length_squared() / 3.0).sqrt())
            .collect();
        self.study.portraits.push(Portrait { scene: setting.name.to_owned(), film, errors });
        Ok(())
    }

    /// What is lost and saved by a lower limit of the recursion, against the picture with the scene's own.
    fn depths(&mut self, scene: &Scene) -> Result<(), StudyError> {
        let name = self.plan.depth_scene.clone();
        let setting =
            Setting { trade: Trade::Depth, name: &name, scene, size: self.plan.small_size };
        let reference = self.reference(&setting)?;
        let mode = Mode::Plain(AntiAliasing::Adaptive { error: 1.0, most: 64 });
        for depth in 1..=scene.depth() {
            self.step(format!("{name}: depth {depth}"), mode.weight() * plan::pixels(setting.size));
            let options = mode.options(setting.size, depth, self.plan.threads);
            let mut times = Vec::new();
            let mut last = render(scene, &options, &|_| ())?;
            times.push(last.seconds);
            for _ in 1..self.plan.repeats {
                last = render(scene, &options, &|_| ())?;
                times.push(last.seconds);
            }
            let row = row(&setting, mode.name(), &last, median(times), &reference);
            self.study.rows.push(row);
        }
        Ok(())
    }
}

fn row(
    setting: &Setting,
    mode: String,
    rendering: &Rendering,
    seconds: f64,
    reference: &Reference,
) -> Row {
    let film = &rendering.film;
    let (measured_rmse, worst) = reference.error_of(film);
    let rays = rendering.rays;
    let pixels = f64::from(film.width()) * f64::from(film.height());
    Row {
        trade: setting.trade,
        scene: setting.name.to_owned(),
        primitives: setting.scene.primitive_count(),
        width: film.width(),
        height: film.height(),
        depth: rendering.depth,
        mode,
        seconds,
        rays: rays.camera + rays.reflected + rays.refracted + rays.transmitted + rays.shadow,
        rays_per_pixel: rays.camera as f64 / pixels,
        measured_rmse,
        estimated_rmse: rendering.estimated_rmse,
        worst,
        relative_seconds: 1.0,
        relative_rays: 1.0,
    }
}

/// Times and rays as multiples of those of the mode `none`, if it is among the rows.
fn relate(rows: &mut [Row]) {
    let Some((seconds, rays)) =
        rows.iter().find(|row| row.mode == "none").map(|row| (row.seconds, row.rays))
    else {
        return;
    };
    for row in rows {
        row.relative_seconds = row.seconds / seconds;
        row.relative_rays = row.rays as f64 / rays as f64;
    }
}

/// The middle one of some numbers, or the mean of the middle two.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_unstable_by(f64::total_cmp);
    let middle = numbers.len() / 2;
    match numbers.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => numbers[middle],
        _ => f64::midpoint(numbers[middle - 1], numbers[middle]),
    }
}

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
mod tests {
    use super::*;

    #[test]
    fn the_front_holds_what_no_other_beats() {
        let points = [(3.0, 1.0), (1.0, 5.0), (2.0, 6.0), (2.5, 2.0), (4.0, 1.5), (3.0, 0.5)];
        assert_eq!(pareto_front(&points), [(1.0, 5.0), (2.5, 2.0), (3.0, 0.5)]);
        assert!(pareto_front(&[]).is_empty());
    }

    #[test]
    fn medians_are_in_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 9.0]), 3.0);
        assert_eq!(median(vec![3.0, 1.0, 9.0, 5.0]), 4.0);
    }
}
