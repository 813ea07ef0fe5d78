//! `whitted render`: checks everything that can be checked, renders, writes.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, anyhow};
use whitted::classic::{CLASSIC_SIZE, render_classic};
use whitted::film::{FileError, Film, OutputFile, WholeFile, encode};
use whitted::render::{RayCounts, RenderOptions, Rendering};
use whitted::scene::{LoadOptions, Loaded, Scene};

use super::args::{ProgressMode, RenderArgs, Rules};
use super::failure::{Failure, warn};
use super::progress::Reporter;
use super::stats::{Seconds, Statistics};
use super::{memory, streams};

/// Renders as `args` say; `started` is when the program did.
pub(crate) fn run(args: &RenderArgs, started: Instant) -> Result<(), Failure> {
    let is_classic = args.rules == Rules::Classic;
    if is_classic && (args.size.is_some() || args.depth.is_some()) {
        return Err(Failure::usage(anyhow!(
            "--rules classic: size and depth are part of the rules; leave out --size and --depth"
        )));
    }
    let loading = Instant::now();
    let load_options = LoadOptions {
        models: args.models.clone(),
        eye: args.eye,
        look_at: args.look_at,
        up: args.up,
        fov: args.fov,
        objects: args.objects,
        rows: is_classic.then_some(CLASSIC_SIZE),
    };
    let Loaded { scene, warnings } = whitted::scene::load(&args.scene, &load_options)?;
    warn(&warnings, args.strict, args.quiet)?;
    let build = scene.bvh_stats().build_seconds;
    let load = (loading.elapsed().as_secs_f64() - build).max(0.0);

    let picture = Picture::prepare(args.output.as_deref(), &scene)?;
    let stats = args.stats.as_deref().map(StatsTarget::prepare).transpose()?;
    check_apart(&picture, stats.as_ref())?;
    check_memory(args.size.unwrap_or(scene.resolution()))?;

    let options =
        RenderOptions { size: args.size, aa: args.aa, depth: args.depth, threads: args.threads };
    let rendering = {
        let mode = if args.quiet { ProgressMode::None } else { args.progress };
        let reporter = Reporter::new(mode);
        if is_classic {
            render_classic(&scene, args.threads)?
        } else {
            whitted::render::render(&scene, &options, &|progress| reporter.report(&progress))?
        }
    };

    let name = picture.name();
    let writing = Instant::now();
    picture.write(&rendering.film)?;
    let write = writing.elapsed().as_secs_f64();
    let total = started.elapsed().as_secs_f64();
    let seconds = Seconds { load, build, render: rendering.seconds, write, total };
    if let Some(target) = stats {
        target.write(&Statistics::new(&scene, args.aa, &rendering, seconds).to_json()?)?;
    }
    // Under `json`, standard error is for programs, and they have the statistics.
    if !args.quiet && args.progress != ProgressMode::Json {
        streams::note(&summary(&name, args, &rendering, total));
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
fn summary(name: &str, args: &RenderArgs, rendering: &Rendering, total: f64) -> String {
    let Rendering { film, rays, threads, depth, seconds, .. } = rendering;
    let all = rays.camera + rays.reflected + rays.refracted + rays.transmitted + rays.shadow;
    let plural = if *threads == 1 { "" } else { "s" };
    format!(
        "wrote {name}: {}x{} pixels, {}, depth {depth}, {total:.2} s\n\
         {all} rays in {seconds:.2} s on {threads} thread{plural}: {} camera, {} reflected, {} refracted, \
         {} transmitted, {} shadow",
        film.width(),
        film.height(),
        args.aa,
        rays.camera,
        rays.reflected,
        rays.refracted,
        rays.transmitted,
        rays.shadow,
    )
}
