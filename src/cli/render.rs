//! `whitted render`: checks everything that can be checked, renders, writes.

use std::time::Instant;

use anyhow::Context;
use image::RgbImage;
use whitted::classic::{CLASSIC_SIZE, render_classic};
use whitted::film::{Difference, Film, Label, Share, WholeFile, encode};
use whitted::render::{Goal, Outcome, RayCounts, RenderOptions, Rendering};
use whitted::scene::{Loaded, Scene};

use super::args::{ProgressMode, RenderArgs, Rules};
use super::compare::read_picture;
use super::failure::Failure;
use super::goal::short;
use super::job::{self, Finished, Order};
use super::options::{
    check_classic, check_memory, check_parts, check_reference, check_size, check_stdin, label,
    options,
};
use super::preview::Preview;
use super::signals::Signals;
use super::stats::{Errors, Seconds, Statistics};
use super::target::{Picture, StatsTarget, check_apart, check_spared};
use super::warnings::Warnings;
use super::{finished, streams};

/// A picture to render: all of what is wanted, or one share of it.
struct Task {
    options: RenderOptions,
    label: Label,
    picture: Picture,
    stats: Option<StatsTarget>,
}

impl Task {
    /// The files that it writes, by the flags that name them.
    fn results(&self) -> impl Iterator<Item = (&'static str, &WholeFile)> {
        let picture = match &self.picture {
            Picture::File(file) => Some(("--output", file.file())),
            Picture::Stdout => None,
        };
        let stats = match &self.stats {
            Some(StatsTarget::File(file)) => Some(("--stats", file)),
            Some(StatsTarget::Stdout) | None => None,
        };
        picture.into_iter().chain(stats)
    }
}

/// Renders as `args` say; `started` is when the program did.
pub(crate) fn run(args: &RenderArgs, started: Instant) -> Result<(), Failure> {
    let signals = Signals::watch().context("signals cannot be watched")?;
    check_classic(args)?;
    check_parts(args)?;
    check_size(args)?;
    check_stdin(args)?;
    let loading = Instant::now();
    let rows = (args.rules == Rules::Classic).then_some(CLASSIC_SIZE);
    let Loaded { scene, warnings: odd, files } = args.seen.load(rows)?;
    let warnings = Warnings::new(args);
    for warning in odd {
        warnings.add(warning.to_string());
    }
    warnings.check()?;
    let build = scene.bvh_stats().build_seconds;
    let load = (loading.elapsed().as_secs_f64() - build).max(0.0);

    let hash = scene.hash();
    let shares = args.tile.as_ref().map_or_else(Vec::new, |shares| shares.0.clone());
    let shares: Vec<Option<Share>> =
        if shares.is_empty() { vec![None] } else { shares.into_iter().map(Some).collect() };
    let several = shares.len() > 1;
    let mut tasks = Vec::new();
    for share in shares {
        let task = task(args, &scene, &hash, share, several, started)?;
        let (read, reference) = ("which the scene is read from", "the reference");
        for (flag, result) in task.results() {
            check_spared(flag, result, read, &files)?;
            check_spared(flag, result, reference, &args.reference)?;
        }
        tasks.push(task);
    }
    let reference = args.reference.as_deref().map(read_picture).transpose()?;
    for task in &tasks {
        check_memory(&task.label, task.options.goal)?;
        check_reference(&task.label, reference.as_ref())?;
    }
    let mut preview = Preview::open(args, &warnings);
    warnings.check()?;
    for (k, task) in tasks.iter().enumerate() {
        let since = if several { Instant::now() } else { started };
        perform(
            task,
            args,
            &scene,
            (&signals, &warnings, &mut preview),
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
    (signals, warnings, preview): (&Signals, &Warnings, &mut Preview),
    reference: Option<&RgbImage>,
    [load, build]: [f64; 2],
    started: Instant,
) -> Result<(), Failure> {
    let Task { options, label, picture, stats } = task;
    // Under `json`, standard error is for programs, and they have the statistics.
    let is_silent = args.quiet || args.progress == ProgressMode::Json;
    let has_more_to_tell = stats.is_some() || reference.is_some();
    if args.resume
        && !has_more_to_tell
        && let Some(found) = finished::find(picture, label)
    {
        if let Some(warning) = found.warning {
            warnings.add(warning);
        }
        if !is_silent {
            streams::note(&format!("{} is finished already", picture.name()));
        }
        return warnings.check();
    }
    let Finished { rendering, missed, write } = if args.rules == Rules::Classic {
        let rendering = render_classic(scene, args.threads)?;
        let writing = Instant::now();
        picture.write(&rendering.film, label)?;
        Finished { rendering, missed: None, write: writing.elapsed().as_secs_f64() }
    } else {
        job::run(&Order { scene, options, label, picture, signals, warnings }, args, preview)?
    };
    let measured = reference.map(|reference| measure(&rendering.film, reference)).transpose()?;
    let total = started.elapsed().as_secs_f64();
    let seconds = Seconds { load, build, render: rendering.seconds, write, total };
    let mode = match args.rules {
        Rules::Classic => "classic".to_owned(),
        Rules::Whitted => options.aa.to_string(),
    };
    if let Some(target) = stats {
        let has_goal = options.goal != Goal::Mode;
        let errors = Errors { measured, is_goal_reached: has_goal.then_some(missed.is_none()) };
        let statistics = Statistics::new(scene, mode.clone(), &rendering, &errors, seconds);
        target.write(&statistics.to_json()?)?;
    }
    if let Some(missed) = missed {
        let took = rendering.outcome.late.map_or_else(String::new, |late| {
            format!(
                " (the rays took {:.3} s after {:.3} s of loading, before {write:.3} s of writing)",
                late.as_secs_f64(),
                load + build
            )
        });
        warnings.add(missed + &took);
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
    warnings.check()
}

/// The error against the reference, as the picture file will have it.
fn measure(film: &Film, reference: &RgbImage) -> Result<f64, Failure> {
    let levels = RgbImage::from_raw(film.width(), film.height(), encode::to_srgb8(film));
    let levels = levels.context("a film has three bytes a pixel")?;
    Ok(Difference::between(&levels, reference)?.rmse)
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
            format!("with all rays worth casting that {mode} allows, before the time was up")
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
        1 => " (1 pixel still above the limit with all its rays)".to_owned(),
        pixels => format!(" ({pixels} pixels still above the limit with all their rays)"),
    };
    let Rendering { film, rays, threads, depth, seconds, .. } = rendering;
    let plural = if *threads == 1 { "" } else { "s" };
    format!(
        "wrote {name}: {}x{} pixels, {mode}, depth {depth}{error}{unsettled}, {total:.2} s\n\
         {} rays in {seconds:.2} s on {threads} thread{plural}: {} camera, {} reflected, {} refracted, \
         {} transmitted, {} shadow",
        film.width(),
        film.height(),
        rays.all(),
        rays.camera,
        rays.reflected,
        rays.refracted,
        rays.transmitted,
        rays.shadow,
    )
}
