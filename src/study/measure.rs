//! The measuring.

use std::{mem::take, path::Path};

use super::{
    Mode, Plan, Portrait, Row, Step, Study, StudyError, Trade,
    plan::{self, DEPTH_MODE},
    reference::Reference,
};
use crate::{
    aa::AntiAliasing,
    accel::Preset,
    render::{Rendering, render},
    scene::{Scene, SceneError},
};

/// Measures all that `plan` asks for; `load` finds scenes by their names and `folder` keeps converged pictures for the
/// next time.
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
    for objects in &plan.builds {
        let name = format!("spheres:{objects}");
        run.builds(&name, load(&name)?)?;
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

    /// Renders in all modes, at the scene's own depth.
    fn compare(&mut self, setting: &Setting, modes: &[Mode]) -> Result<Reference, StudyError> {
        let reference = self.reference(setting)?;
        let depth = setting.scene.depth();
        let modes: Vec<(Mode, u32)> = modes.iter().map(|mode| (*mode, depth)).collect();
        self.take_turns(setting, &modes, &reference)?;
        Ok(reference)
    }

    /// Renders in all modes, each to a depth, by turns: in each round once, so that a busy moment of the machine does
    /// not fall on one of them alone.
    fn take_turns(
        &mut self,
        setting: &Setting,
        modes: &[(Mode, u32)],
        reference: &Reference,
    ) -> Result<(), StudyError> {
        let rounds = self.plan.repeats;
        let mut times = vec![Vec::new(); modes.len()];
        let first = self.study.rows.len();
        for round in 1..=rounds {
            for ((mode, depth), seconds) in modes.iter().zip(&mut times) {
                let name = mode.name();
                let what =
                    format!("{}: {name} to depth {depth}, {round} of {rounds}", setting.name);
                self.step(what, mode.weight() * plan::pixels(setting.size));
                let options = mode.options(setting.size, *depth, self.plan.threads);
                let rendering = render(setting.scene, &options, &|_| ())?;
                seconds.push(rendering.seconds);
                if round == rounds {
                    let row = row(setting, name, &rendering, median(take(seconds)), reference);
                    self.study.rows.push(row);
                }
            }
        }
        relate(&mut self.study.rows[first..]);
        Ok(())
    }

    fn portray(&mut self, setting: &Setting, reference: &Reference) -> Result<(), StudyError> {
        let mode = Mode::Plain(AntiAliasing::default());
        let options = mode.options(setting.size, setting.scene.depth(), self.plan.threads);
        let film = render(setting.scene, &options, &|_| ())?.film;
        let errors = reference.errors_of_pixels(&film);
        self.study.portraits.push(Portrait { scene: setting.name.to_owned(), film, errors });
        Ok(())
    }

    /// What is lost and saved by a lower limit of the recursion, against the picture with the scene's own.
    fn depths(&mut self, scene: &Scene) -> Result<(), StudyError> {
        let name = self.plan.depth_scene.clone();
        let setting =
            Setting { trade: Trade::Depth, name: &name, scene, size: self.plan.small_size };
        let reference = self.reference(&setting)?;
        let depths: Vec<(Mode, u32)> =
            (1..=scene.depth()).map(|depth| (DEPTH_MODE, depth)).collect();
        self.take_turns(&setting, &depths, &reference)
    }

    /// What more or less time for the build of the tree gives back in that of the picture, by turns.
    fn builds(&mut self, name: &str, mut scene: Scene) -> Result<(), StudyError> {
        let (size, rounds) = (self.plan.small_size, self.plan.repeats);
        let reference =
            self.reference(&Setting { trade: Trade::Build, name, scene: &scene, size })?;
        let mode = Mode::Plain(AntiAliasing::None);
        let options = mode.options(size, scene.depth(), self.plan.threads);
        let mut times = vec![(Vec::new(), Vec::new()); Preset::ALL.len()];
        let first = self.study.rows.len();
        for round in 1..=rounds {
            for (preset, (building, seconds)) in Preset::ALL.into_iter().zip(&mut times) {
                let what = format!("{name}: {preset} build, {round} of {rounds}");
                self.step(what, plan::build_work(scene.primitive_count(), size));
                scene = scene.rebuilt(preset);
                let rendering = render(&scene, &options, &|_| ())?;
                building.push(scene.bvh_stats().build_seconds);
                seconds.push(rendering.seconds);
                if round < rounds {
                    continue;
                }
                let setting = Setting { trade: Trade::Build, name, scene: &scene, size };
                let (build, build_seconds) = (preset.to_string(), median(take(building)));
                let row = row(&setting, mode.name(), &rendering, median(take(seconds)), &reference);
                self.study.rows.push(Row { build, build_seconds, ..row });
            }
        }
        relate(&mut self.study.rows[first..]);
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
        build: Preset::Auto.to_string(),
        build_seconds: setting.scene.bvh_stats().build_seconds,
        seconds,
        rays: rays.all(),
        rays_per_pixel: rays.camera as f64 / pixels,
        measured_rmse,
        estimated_rmse: rendering.estimated_rmse.unwrap_or(f64::NAN),
        worst,
        relative_seconds: f64::NAN,
        relative_rays: f64::NAN,
    }
}

/// Times and rays as multiples of those of the mode `none`, if it is among the rows; of several, that with the usual
/// tree.
fn relate(rows: &mut [Row]) {
    let usual = Preset::Auto.to_string();
    let is_base = |row: &&Row| row.mode == "none" && row.build == usual;
    let Some((seconds, rays)) = rows.iter().find(is_base).map(|row| (row.seconds, row.rays)) else {
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

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;
    use crate::scene::{load_builtin, load_builtin_of};

    #[test]
    fn medians_are_in_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 9.0]), 3.0);
        assert_eq!(median(vec![3.0, 1.0, 9.0, 5.0]), 4.0);
    }

    /// Tiny pictures, three rounds of them.
    fn tiny() -> Plan {
        Plan {
            objects: Vec::new(),
            sizes: vec![[4, 3]],
            size: [4, 3],
            small_size: [4, 3],
            reference_rays: 4,
            repeats: 3,
            ..Plan::quick()
        }
    }

    fn load(name: &str) -> Result<Scene, SceneError> {
        match name.strip_prefix("spheres:") {
            Some(count) => load_builtin_of("spheres", count.parse().ok()),
            None => load_builtin(name),
        }
    }

    /// Oracle: the numbers of modes, presets and depths. What is done in the end is what was to do.
    #[test]
    fn what_is_compared_takes_turns() {
        let folder = tempfile::tempdir().expect("a folder");
        let plan = Plan { scenes: vec!["assignment".to_owned()], builds: vec![200], ..tiny() };
        let steps = RefCell::new(Vec::new());
        let study = super::run(&plan, &load, folder.path(), &|step| {
            steps.borrow_mut().push(step.clone());
        });
        assert_eq!(study.expect("a study").portraits.len(), 1);
        let steps = steps.into_inner();
        let rounds: Vec<&str> =
            steps.iter().filter_map(|step| step.what.rsplit_once(", ")).map(|(_, r)| r).collect();
        let groups = [plan.modes.len(), Preset::ALL.len(), plan.few_modes.len(), 6];
        let turns =
            |n: usize| ["1 of 3", "2 of 3", "3 of 3"].into_iter().flat_map(move |r| vec![r; n]);
        assert_eq!(rounds, groups.into_iter().flat_map(turns).collect::<Vec<_>>());
        let last = steps.last().expect("a step");
        let left = last.total - last.done - DEPTH_MODE.weight() * plan::pixels(plan.small_size);
        assert!(left.abs() < 0.01 * last.total, "{left} of {} left", last.total);
    }

    #[test]
    fn without_the_mode_none_nothing_is_a_multiple_of_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let plan = Plan { scenes: Vec::new(), builds: Vec::new(), repeats: 1, ..tiny() };
        let rows = super::run(&plan, &load, folder.path(), &|_| ()).expect("a study").rows;
        assert!(rows.iter().any(|row| row.trade == Trade::Depth));
        for row in rows {
            let is_known = row.trade != Trade::Depth;
            assert_eq!(row.relative_seconds.is_finite(), is_known, "{row:?}");
            assert_eq!(row.relative_rays.is_finite(), is_known, "{row:?}");
        }
    }
}
