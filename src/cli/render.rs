//! `whitted render`: checks everything that can be checked, renders, writes.

use std::time::Instant;

use anyhow::Context;
use image::RgbImage;
use whitted::aa::{AntiAliasing, MOST_RAYS};
use whitted::classic::{CLASSIC_SIZE, render_classic};
use whitted::film::{Difference, Film, Label, Share, encode};
use whitted::render::{Goal, Outcome, RayCounts, RenderOptions, Rendering};
use whitted::scene::{Loaded, Scene};

use super::args::{ProgressMode, RenderArgs, Rules};
use super::compare::read_picture;
use super::failure::{Failure, warn};
use super::job::{self, Finished, Order};
use super::options::{
    check_classic, check_memory, check_parts, check_reference, check_size, label, options,
};
use super::preview::Preview;
use super::signals::Signals;
use super::stats::{Errors, Seconds, Statistics};
use super::target::{Picture, StatsTarget, check_apart};
use super::{finished, streams};

/// A picture to render: all of what is wanted, or one share of it.
struct Task {
    options: RenderOptions,
    label: Label,
    picture: Picture,
    stats: Option<StatsTarget>,
}

/// Renders as `args` say; `started` is when the program did.
pub(crate) fn run(args: &RenderArgs, started: Instant) -> Result<(), Failure> {
    let signals = Signals::watch().context("signals cannot be watched")?;
    check_classic(args)?;
    check_parts(args)?;
    check_size(args)?;
    let loading = Instant::now();
    let rows = (args.rules == Rules::Classic).then_some(CLASSIC_SIZE);
    let Loaded { scene, warnings: odd } = args.seen.load(rows)?;
    warn(&odd, args.strict, args.quiet)?;
    let build = scene.bvh_stats().build_seconds;
    let load = (loading.elapsed().as_secs_f64() - build).max(0.0);

    let hash = scene.hash();
    let shares = args.tile.as_ref().map_or_else(Vec::new, |shares| shares.0.clone());
    let shares: Vec<Option<Share>> =
        if shares.is_empty() { vec![None] } else { shares.into_iter().map(Some).collect() };
    let several = shares.len() > 1;
    let mut tasks = Vec::new();
    for share in shares {
        tasks.push(task(args, &scene, &hash, share, several, started)?);
    }
    let reference = args.reference.as_deref().map(read_picture).transpose()?;
    for task in &tasks {
        check_memory(&task.label, task.options.goal)?;
        check_reference(&task.label, reference.as_ref())?;
    }
    let mut preview = Preview::open(args);
    for (k, task) in tasks.iter().enumerate() {
        let since = if several { Instant::now() } else { started };
        perform(
            task,
            args,
            &scene,
            (&signals, &mut preview),
            reference.as_ref(),
            [load, build],
            since,
        )?;
        if let Some(signal) = signals.received().filter(|_| k + 1 < tasks.len()) {
            return Err(Failure::stopped(
                signal,
                "between two tiles; go on with the same command and --resume",
            ));
        }
    }
    Ok(())
}

fn task(
    args: &RenderArgs,
    scene: &Scene,
    hash: &str,
    share: Option<Share>,
    several: bool,
    started: Instant,
) -> Result<Task, Failure> {
    let by_share = several || args.output.is_none();
    let picture = Picture::prepare(args.output.as_deref(), scene.name(), share, by_share)?;
    let in_name = share.filter(|_| several);
    let stats =
        args.stats.as_deref().map(|path| StatsTarget::prepare(path, in_name)).transpose()?;
    check_apart(&picture, stats.as_ref())?;
    let options = options(args, scene, share, (started, picture.format()))?;
    let label = label(args, scene, hash, &options, share);
    Ok(Task { options, label, picture, stats })
}

/// Renders and writes one picture, and says so.
fn perform(
    task: &Task,
    args: &RenderArgs,
    scene: &Scene,
    (signals, preview): (&Signals, &mut Preview),
    reference: Option<&RgbImage>,
    [load, build]: [f64; 2],
    started: Instant,
) -> Result<(), Failure> {
    let Task { options, label, picture, stats } = task;
    // Under `json`, standard error is for programs, and they have the statistics.
    let is_silent = args.quiet || args.progress == ProgressMode::Json;
    let has_more_to_tell = stats.is_some() || reference.is_some();
    if args.resume && !has_more_to_tell && finished::is_finished(picture, label) {
        if !is_silent {
            streams::note(&format!("{} is finished already", picture.name()));
        }
        return Ok(());
    }
    let Finished { rendering, write } = if args.rules == Rules::Classic {
        let rendering = render_classic(scene, args.threads)?;
        let writing = Instant::now();
        picture.write(&rendering.film, label)?;
        Finished { rendering, write: writing.elapsed().as_secs_f64() }
    } else {
        job::run(&Order { scene, options, label, picture, signals }, args, preview)?
    };
    let measured = reference.map(|reference| measure(&rendering.film, reference)).transpose()?;
    let total = started.elapsed().as_secs_f64();
    let seconds = Seconds { load, build, render: rendering.seconds, write, total };
    let mode = match args.rules {
        Rules::Classic => "classic".to_owned(),
        Rules::Whitted => options.aa.to_string(),
    };
    let missed = missed_goal(&rendering, args, options.aa, &seconds);
    if let Some(target) = stats {
        let has_goal = options.goal != Goal::Mode;
        let errors = Errors { measured, is_goal_reached: has_goal.then_some(missed.is_none()) };
        let statistics = Statistics::new(scene, mode.clone(), &rendering, &errors, seconds);
        target.write(&statistics.to_json()?)?;
    }
    if let Some(warning) = missed.as_ref().filter(|_| !args.quiet && !args.strict) {
        streams::note(&match args.progress {
            ProgressMode::Json => serde_json::json!({ "warning": warning }).to_string(),
            _ => format!("warning: {warning}"),
        });
    }
    if !is_silent {
        streams::note(&summary(&picture.name(), mode, &rendering, measured, total));
        if args.rules == Rules::Classic {
            let RayCounts { camera_hit, reflected, refracted, shadow, .. } = rendering.rays;
            streams::note(&format!(
                "classic rules: {camera_hit} eye rays that hit, {reflected} reflected, {refracted} \
                 refracted, {shadow} shadow"
            ));
        }
    }
    match missed {
        Some(warning) if args.strict => Err(Failure::strict(warning)),
        _ => Ok(()),
    }
}

/// The error against the reference, as the picture file will have it.
fn measure(film: &Film, reference: &RgbImage) -> Result<f64, Failure> {
    let levels = RgbImage::from_raw(film.width(), film.height(), encode::to_srgb8(film));
    let levels = levels.context("a film has three bytes a pixel")?;
    Ok(Difference::between(&levels, reference)?.rmse)
}

/// What was aimed at but not reached.
fn missed_goal(
    rendering: &Rendering,
    args: &RenderArgs,
    aa: AntiAliasing,
    seconds: &Seconds,
) -> Option<String> {
    let outcome = &rendering.outcome;
    if let (Some(wanted), Some(reached)) = (outcome.missed_error, rendering.estimated_rmse) {
        let advice = match aa {
            AntiAliasing::Adaptive { most, .. } if wanted > 0.0 && most < MOST_RAYS => {
                let more = most.saturating_mul(4).clamp(4096, MOST_RAYS);
                format!("allow more, such as --aa adaptive:0,{more}")
            }
            _ => format!("allow a larger one, such as --max-error {}", rounded_up(reached)),
        };
        return Some(format!(
            "--max-error {wanted} is not reached: the estimated error is {} levels with the most rays a pixel may get; {advice}",
            short(reached)
        ));
    }
    let (late, limit) = (outcome.late?, args.time_limit?);
    let Seconds { load, build, write, .. } = seconds;
    Some(format!(
        "--time-limit {limit} is too short for one ray in each pixel, which took {:.3} s after {:.3} s of loading, before {write:.3} s \
         of writing; nothing was refined",
        late.as_secs_f64(),
        load + build,
    ))
}

/// A number with three digits behind the point, or more if it is small.
fn short(number: f64) -> String {
    match number {
        0.0 | 0.01.. => format!("{number:.3}"),
        1e-4..0.01 => format!("{number:.5}"),
        _ => format!("{number:.2e}"),
    }
}

/// An error with one digit that is not below `error`, and above 0.
fn rounded_up(error: f64) -> String {
    let unit = 10_f64.powi(error.max(1e-9).log10().floor() as i32);
    let digits = (-unit.log10()).round().max(0.0) as usize;
    format!("{:.digits$}", (error / unit).ceil().max(1.0) * unit)
}

/// What was done and what it took, in two lines.
fn summary(
    name: &str,
    mode: String,
    rendering: &Rendering,
    measured: Option<f64>,
    total: f64,
) -> String {
    let mode = match rendering.outcome {
        Outcome { is_used_up: true, .. } => {
            format!("with all rays that {mode} allows, before the time was up")
        }
        Outcome { cut: true, .. } => "adaptive until the time was up".to_owned(),
        Outcome { per_ray: Some(per_ray), .. } => {
            format!("adaptive to {} squared levels per ray", short(f64::from(per_ray)))
        }
        _ => mode,
    };
    let estimated =
        rendering.estimated_rmse.map(|rmse| format!(", off by about {rmse:.2} of 255 levels"));
    let measured = measured.map(|rmse| format!(", {rmse:.2} measured"));
    let error = estimated.into_iter().chain(measured).collect::<String>();
    let unsettled = match rendering.outcome.unsettled {
        0 => String::new(),
        pixels => format!(" ({pixels} pixels still above the limit with all their rays)"),
    };
    let Rendering { film, rays, threads, depth, seconds, .. } = rendering;
    let all = rays.camera + rays.reflected + rays.refracted + rays.transmitted + rays.shadow;
    let plural = if *threads == 1 { "" } else { "s" };
    format!(
        "wrote {name}: {}x{} pixels, {mode}, depth {depth}{error}{unsettled}, {total:.2} s\n\
         {all} rays in {seconds:.2} s on {threads} thread{plural}: {} camera, {} reflected, {} refracted, \
         {} transmitted, {} shadow",
        film.width(),
        film.height(),
        rays.camera,
        rays.reflected,
        rays.refracted,
        rays.transmitted,
        rays.shadow,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_keep_their_digits() {
        let shown = [0.0, 2.1e-5, 0.001_23, 0.0123, 0.5, 25.75].map(short);
        assert_eq!(shown, ["0.000", "2.10e-5", "0.00123", "0.012", "0.500", "25.750"]);
    }

    /// Oracle: what is advised is reached by what was.
    #[test]
    fn an_error_that_is_advised_is_one_that_was_reached() {
        let advised = [0.0123, 0.5, 0.999, 6.2, 25.75].map(rounded_up);
        assert_eq!(advised, ["0.02", "0.5", "1.0", "7", "30"]);
        for error in [1e-7, 3.3e-4, 0.07, 0.3, 1.0, 254.0] {
            let advised: f64 = rounded_up(error).parse().expect("a number");
            assert!(advised > 0.0 && advised >= error * 0.999_999, "{error}: {advised}");
        }
    }
}
