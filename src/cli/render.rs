//! `whitted render`: checks everything that can be checked, renders, writes.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};
use image::RgbImage;
use whitted::aa::AntiAliasing;
use whitted::classic::{CLASSIC_SIZE, render_classic};
use whitted::film::metrics::read_png_rgb8;
use whitted::film::{Difference, FileError, Film, OutputFile, WholeFile, encode};
use whitted::render::{Goal, RayCounts, RenderOptions, Rendering};
use whitted::scene::{LoadOptions, Loaded, Scene};

use super::args::{ProgressMode, RenderArgs, Rules};
use super::failure::{Failure, warn};
use super::progress::Reporter;
use super::stats::{Seconds, Statistics};
use super::{memory, streams};

/// What writing takes, and what passed before the clock was looked at, at most: kept free at the end of a time limit.
const WRITE_SECONDS: f64 = 0.012;
const WRITE_SECONDS_PER_PIXEL: f64 = 4e-8;

/// The most rays per pixel of a render towards a goal, unless the mode says so.
const MOST_RAYS_FOR_GOAL: u32 = 1024;

/// Renders as `args` say; `started` is when the program did.
pub(crate) fn run(args: &RenderArgs, started: Instant) -> Result<(), Failure> {
    if args.rules == Rules::Classic {
        check_classic(args)?;
    }
    let loading = Instant::now();
    let is_classic = args.rules == Rules::Classic;
    let load_options = LoadOptions {
        models: args.models.clone(),
        eye: args.eye,
        look_at: args.look_at,
        up: args.up,
        fov: args.fov,
        objects: args.objects,
        rows: is_classic.then_some(CLASSIC_SIZE),
    };
    let Loaded { scene, warnings: odd } = whitted::scene::load(&args.scene, &load_options)?;
    warn(&odd, args.strict, args.quiet)?;
    let build = scene.bvh_stats().build_seconds;
    let load = (loading.elapsed().as_secs_f64() - build).max(0.0);

    let picture = Picture::prepare(args.output.as_deref(), &scene)?;
    let stats = args.stats.as_deref().map(StatsTarget::prepare).transpose()?;
    check_apart(&picture, stats.as_ref())?;
    check_memory(args.size.unwrap_or(scene.resolution()))?;

    let reference = args.reference.as_deref().map(read_png_rgb8).transpose()?;
    let options = options(args, &scene, started)?;
    check_reference(&options, &scene, reference.as_ref())?;
    let rendering = {
        let mode = if args.quiet { ProgressMode::None } else { args.progress };
        let reporter = Reporter::new(mode);
        if is_classic {
            render_classic(&scene, args.threads)?
        } else {
            whitted::render::render(&scene, &options, &|progress| reporter.report(&progress))?
        }
    };

    let measured = reference.map(|reference| measure(&rendering.film, &reference)).transpose()?;
    let name = picture.name();
    let writing = Instant::now();
    picture.write(&rendering.film)?;
    let write = writing.elapsed().as_secs_f64();
    let total = started.elapsed().as_secs_f64();
    let seconds = Seconds { load, build, render: rendering.seconds, write, total };
    if let Some(target) = stats {
        target.write(
            &Statistics::new(&scene, options.aa, &rendering, measured, seconds).to_json()?,
        )?;
    }
    // Under `json`, standard error is for programs, and they have the statistics.
    if !args.quiet && args.progress != ProgressMode::Json {
        for warning in warnings(&rendering, args) {
            streams::note(&format!("warning: {warning}"));
        }
        streams::note(&summary(&name, options.aa, &rendering, measured, total));
        if is_classic {
            let RayCounts { camera_hit, reflected, refracted, shadow, .. } = rendering.rays;
            streams::note(&format!(
                "classic rules: {camera_hit} eye rays that hit, {reflected} reflected, {refracted} \
                 refracted, {shadow} shadow"
            ));
        }
    }
    Ok(())
}

/// The classical rules leave no choice in these.
fn check_classic(args: &RenderArgs) -> Result<(), Failure> {
    let chosen = [
        ("--size", args.size.is_some()),
        ("--aa", args.aa.is_some()),
        ("--depth", args.depth.is_some()),
        ("--crop", args.crop.is_some()),
        ("--max-error", args.max_error.is_some()),
        ("--time-limit", args.time_limit.is_some()),
    ];
    match chosen.iter().find(|(_, is_given)| *is_given) {
        None => Ok(()),
        Some((flag, _)) => Err(Failure::usage(anyhow!(
            "--rules classic has its own size, rays and depth; leave out {flag}"
        ))),
    }
}

/// What the flags ask for.
fn options(args: &RenderArgs, scene: &Scene, started: Instant) -> Result<RenderOptions, Failure> {
    let goal = match (args.max_error, args.time_limit) {
        (Some(error), _) => Goal::Error(error),
        (None, Some(seconds)) => {
            let writing = WRITE_SECONDS + WRITE_SECONDS_PER_PIXEL * pixels(args, scene);
            Goal::Until(started + Duration::from_secs_f64((seconds - writing).max(0.0)))
        }
        (None, None) => Goal::Mode,
    };
    let aa = match (args.aa, goal) {
        (None, Goal::Mode) => scene.aa().unwrap_or_default(),
        (None, _) => AntiAliasing::Adaptive { error: 0.0, most: MOST_RAYS_FOR_GOAL },
        (Some(aa @ AntiAliasing::Adaptive { .. }), _) | (Some(aa), Goal::Mode) => aa,
        (Some(aa), _) => {
            let flag = if args.max_error.is_some() { "--max-error" } else { "--time-limit" };
            return Err(Failure::usage(anyhow!(
                "{flag} chooses the rays of each pixel itself, but --aa {aa} fixes them; leave --aa out or use \
                 adaptive"
            )));
        }
    };
    if let Some(crop) = args.crop {
        let [width, height] = args.size.unwrap_or(scene.resolution());
        if crop.x1 > width || crop.y1 > height {
            return Err(Failure::usage(anyhow!(
                "--crop {},{},{},{} is not inside of the picture, {width}x{height} pixels",
                crop.x0,
                crop.y0,
                crop.x1,
                crop.y1
            )));
        }
    }
    Ok(RenderOptions {
        size: args.size,
        aa,
        depth: args.depth,
        threads: args.threads,
        crop: args.crop,
        goal,
    })
}

fn pixels(args: &RenderArgs, scene: &Scene) -> f64 {
    let [width, height] = match args.crop {
        Some(crop) => [crop.width(), crop.height()],
        None => args.size.unwrap_or(scene.resolution()),
    };
    f64::from(width) * f64::from(height)
}

/// A reference of another size is better refused before the render than after it.
fn check_reference(
    options: &RenderOptions,
    scene: &Scene,
    reference: Option<&RgbImage>,
) -> Result<(), Failure> {
    let Some(reference) = reference else { return Ok(()) };
    let [width, height] = match options.crop {
        Some(crop) => [crop.width(), crop.height()],
        None => options.size.unwrap_or(scene.resolution()),
    };
    if reference.dimensions() == (width, height) {
        return Ok(());
    }
    Err(Failure::usage(anyhow!(
        "--reference: the picture to render has {width}x{height} pixels, the reference {}x{}; choose one of the \
         same size",
        reference.width(),
        reference.height()
    )))
}

/// The error against the reference, as the picture file will have it.
fn measure(film: &Film, reference: &RgbImage) -> Result<f64, Failure> {
    let levels = RgbImage::from_raw(film.width(), film.height(), encode::to_srgb8(film));
    let levels = levels.context("a film has three bytes a pixel")?;
    Ok(Difference::between(&levels, reference)?.rmse)
}

/// What was aimed at but not reached.
fn warnings(rendering: &Rendering, args: &RenderArgs) -> Vec<String> {
    let outcome = &rendering.outcome;
    let mut warnings = Vec::new();
    if let Some(wanted) = outcome.missed_error {
        warnings.push(format!(
            "--max-error {wanted} is not reached: the estimated error is {:.3} levels with the most rays a pixel may \
             get; allow more, such as --aa adaptive:0,4096",
            rendering.estimated_rmse
        ));
    }
    if let (Some(late), Some(limit)) = (outcome.late, args.time_limit) {
        warnings.push(format!(
            "--time-limit {limit} is too short for one ray in each pixel, which took {:.3} s; nothing was refined",
            late.as_secs_f64()
        ));
    }
    warnings
}

/// Where the picture goes.
enum Picture {
    Stdout,
    File(OutputFile),
}

impl Picture {
    fn prepare(output: Option<&Path>, scene: &Scene) -> Result<Self, Failure> {
        let path = match output {
            Some(path) if path == Path::new("-") => {
                return if io::stdout().is_terminal() {
                    Err(Failure::usage(anyhow!(
                        "--output -: standard output is a terminal, which shows no PNG; redirect \
                         it or name a file"
                    )))
                } else {
                    Ok(Self::Stdout)
                };
            }
            Some(path) => path.to_owned(),
            None => PathBuf::from(format!("{}.png", scene.name())),
        };
        Ok(Self::File(OutputFile::prepare(path)?))
    }

    /// For the user.
    fn name(&self) -> String {
        match self {
            Self::Stdout => "a PNG to standard output".to_owned(),
            Self::File(file) => file.file().path().display().to_string(),
        }
    }

    fn write(self, film: &Film) -> Result<(), Failure> {
        match self {
            Self::Stdout => {
                let mut bytes = Vec::new();
                encode::write_png(film, &mut bytes)?;
                streams::write_stdout(&bytes)
            }
            Self::File(file) => Ok(file.commit(film)?),
        }
    }
}

/// Where the statistics go.
enum StatsTarget {
    Stdout,
    File(WholeFile),
}

impl StatsTarget {
    fn prepare(path: &Path) -> Result<Self, Failure> {
        if path == Path::new("-") {
            return Ok(Self::Stdout);
        }
        Ok(Self::File(WholeFile::prepare(path).context("--stats")?))
    }

    fn write(self, json: &str) -> Result<(), Failure> {
        match self {
            Self::Stdout => streams::write_stdout(json.as_bytes()),
            Self::File(file) => match file.commit(|writer| writer.write_all(json.as_bytes())) {
                // A pipe by name, such as /dev/stdout, whose reader has left.
                Err(FileError::Write { source, .. })
                    if source.kind() == io::ErrorKind::BrokenPipe =>
                {
                    Ok(())
                }
                done => Ok(done.context("--stats")?),
            },
        }
    }
}

/// Two results in one place would spoil each other.
fn check_apart(picture: &Picture, stats: Option<&StatsTarget>) -> Result<(), Failure> {
    let place = match (picture, stats) {
        (Picture::Stdout, Some(StatsTarget::Stdout)) => "standard output",
        (Picture::File(picture), Some(StatsTarget::File(stats)))
            if picture.file().is_same_file(stats) =>
        {
            "the same file"
        }
        _ => return Ok(()),
    };
    Err(Failure::usage(anyhow!("--output and --stats both go to {place}; name another for one")))
}

/// A picture larger than the memory at hand would end the program, or others, without a word.
fn check_memory([width, height]: [u32; 2]) -> Result<(), Failure> {
    let needed = memory::picture_bytes(width, height);
    match memory::available().map(u128::from) {
        Some(available) if needed > available => Err(anyhow!(
            "a picture of {width}x{height} pixels needs {} of memory, of which {} are free; choose \
             a smaller --size",
            memory::readable(needed),
            memory::readable(available),
        ))?,
        _ => Ok(()),
    }
}

/// What was done and what it took, in two lines.
fn summary(
    name: &str,
    aa: AntiAliasing,
    rendering: &Rendering,
    measured: Option<f64>,
    total: f64,
) -> String {
    let mode = match (rendering.outcome.cut, rendering.outcome.per_ray) {
        (true, _) => "adaptive until the time was up".to_owned(),
        (_, Some(per_ray)) => format!("adaptive to {per_ray:.4} squared levels per ray"),
        _ => aa.to_string(),
    };
    let mut error = format!("off by about {:.2} of 255 levels", rendering.estimated_rmse);
    if let Some(measured) = measured {
        error = format!("{error}, {measured:.2} measured");
    }
    let unsettled = match rendering.outcome.unsettled {
        0 => String::new(),
        pixels => format!(" ({pixels} pixels above their limit with all rays)"),
    };
    let Rendering { film, rays, threads, depth, seconds, .. } = rendering;
    let all = rays.camera + rays.reflected + rays.refracted + rays.transmitted + rays.shadow;
    let plural = if *threads == 1 { "" } else { "s" };
    format!(
        "wrote {name}: {}x{} pixels, {mode}, depth {depth}, {error}{unsettled}, {total:.2} s\n\
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
