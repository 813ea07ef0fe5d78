//! From flags to what is rendered.

use std::time::{Duration, Instant};

use anyhow::anyhow;
use image::RgbImage;
use whitted::aa::AntiAliasing;
use whitted::classic::CLASSIC_SIZE;
use whitted::film::{Format, Label, Share, Tile, share};
use whitted::render::{Goal, RenderOptions};
use whitted::scene::{STANDARD_INPUT, Scene};

use super::args::{RenderArgs, Rules};
use super::failure::Failure;
use super::memory;

/// What passed before the clock was looked at, and what a file takes whatever is in it, at most.
const WRITE_SECONDS: f64 = 0.012;

/// What writing takes, in seconds, at most: kept free at the end of a time limit. OpenEXR files are compressed by `threads`.
fn write_seconds(format: Format, pixels: f64, threads: usize) -> f64 {
    let per_pixel = match format {
        Format::Png | Format::Ppm => 4e-8,
        Format::Exr => 1.6e-7 + 2.6e-7 / threads.max(1) as f64,
    };
    WRITE_SECONDS + per_pixel * pixels
}

/// The most rays per pixel of a render towards a goal, unless the mode says so.
const MOST_RAYS_FOR_GOAL: u32 = 1024;

/// The classical rules leave no choice in these.
pub(crate) fn check_classic(args: &RenderArgs) -> Result<(), Failure> {
    let chosen = [
        ("--size", args.size.is_some()),
        ("--aa", args.aa.is_some()),
        ("--depth", args.depth.is_some()),
        ("--crop", args.crop.is_some()),
        ("--tile", args.tile.is_some()),
        ("--resume", args.resume),
        ("--preview", args.preview),
        ("--max-error", args.max_error.is_some()),
        ("--time-limit", args.time_limit.is_some()),
    ];
    match chosen.iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) if args.rules == Rules::Classic => Err(Failure::usage(anyhow!(
            "--rules classic has its own size, rays and depth; leave out {flag}"
        ))),
        _ => Ok(()),
    }
}

/// A picture whose pixels depend on each other, or on the clock, cannot be rendered in parts.
pub(crate) fn check_parts(args: &RenderArgs) -> Result<(), Failure> {
    let goal = if args.max_error.is_some() { "--max-error" } else { "--time-limit" };
    let has_goal = args.max_error.is_some() || args.time_limit.is_some();
    if args.tile.is_some() && has_goal {
        return Err(Failure::usage(anyhow!(
            "--tile needs pixels that depend on the scene and options alone, but {goal} distributes the rays over the whole \
             picture; use --aa adaptive:ERROR instead"
        )));
    }
    let several = args.tile.as_ref().is_some_and(|shares| shares.0.len() > 1);
    for (flag, path) in [("--output", &args.output), ("--stats", &args.stats)] {
        let is_stdout = path.as_ref().is_some_and(|path| path.as_os_str() == "-");
        if is_stdout && (several || (flag == "--output" && args.resume)) {
            let reason =
                if several { "several tiles need a file each" } else { "--resume needs a file" };
            return Err(Failure::usage(anyhow!("{flag} - is standard output, but {reason}")));
        }
    }
    if several && args.reference.is_some() {
        return Err(Failure::usage(anyhow!(
            "--reference compares one picture; give only one tile"
        )));
    }
    Ok(())
}

/// Standard input holds one thing.
pub(crate) fn check_stdin(args: &RenderArgs) -> Result<(), Failure> {
    let has_reference =
        args.reference.as_ref().is_some_and(|path| path.as_os_str() == STANDARD_INPUT);
    if has_reference && args.seen.scene == STANDARD_INPUT {
        return Err(Failure::usage(anyhow!(
            "the scene and the --reference are both to come from standard input, which holds one; name a file for the other"
        )));
    }
    Ok(())
}

/// The size of the whole picture.
pub(crate) fn size(args: &RenderArgs, scene: &Scene) -> [u32; 2] {
    match args.rules {
        Rules::Classic => [CLASSIC_SIZE; 2],
        Rules::Whitted => args.size.unwrap_or(scene.resolution()),
    }
}

/// What the flags ask for, for one share of the picture if that is given, of a program that was `started` to write that `format`.
pub(crate) fn options(
    args: &RenderArgs,
    scene: &Scene,
    part: Option<Share>,
    (started, format): (Instant, Format),
) -> Result<RenderOptions, Failure> {
    let [width, height] = size(args, scene);
    if let Some(crop) = args.crop
        && (crop.x1 > width || crop.y1 > height)
    {
        return Err(Failure::usage(anyhow!(
            "--crop {},{},{},{} is not inside the picture, which has {width}x{height} pixels",
            crop.x0,
            crop.y0,
            crop.x1,
            crop.y1
        )));
    }
    let crop = match part {
        None => args.crop,
        Some(part) => Some(
            share(width, height, part)
                .map_err(|error| Failure::usage(anyhow::Error::from(error).context("--tile")))?,
        ),
    };
    let goal = match (args.max_error, args.time_limit) {
        (Some(error), _) => Goal::Error(error),
        (None, Some(seconds)) => {
            let [width, height] = crop.map_or([width, height], |c| [c.width(), c.height()]);
            let pixels = f64::from(width) * f64::from(height);
            let writing = write_seconds(format, pixels, rayon::current_num_threads());
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
    let (size, depth, threads) = (args.size, args.depth, args.threads);
    Ok(RenderOptions { size, aa, depth, threads, crop, goal, camera: None })
}

/// What a picture file says of the options that decide every picture.
pub(crate) fn words(options: &RenderOptions, scene: &Scene) -> String {
    format!("aa={} depth={}", options.aa, options.depth.unwrap_or(scene.depth()))
}

/// What the picture file says of itself.
pub(crate) fn label(
    args: &RenderArgs,
    scene: &Scene,
    hash: &str,
    options: &RenderOptions,
    share: Option<Share>,
) -> Label {
    let [width, height] = size(args, scene);
    let mut words = match args.rules {
        Rules::Classic => vec!["rules=classic".to_owned()],
        Rules::Whitted => vec![words(options, scene)],
    };
    words.extend(args.max_error.map(|error| format!("max-error={error}")));
    words.extend(args.time_limit.map(|seconds| format!("time-limit={seconds}")));
    let whole = Tile { x0: 0, y0: 0, x1: width, y1: height };
    let part = options.crop.filter(|crop| *crop != whole);
    Label {
        software: Label::this_software(),
        scene: hash.to_owned(),
        size: [width, height],
        options: words.join(" "),
        part,
        share: share.filter(|_| part.is_some()),
        missing: 0,
        warning: None,
    }
}

/// A reference of another size is better refused before the render than after it.
pub(crate) fn check_reference(label: &Label, reference: Option<&RgbImage>) -> Result<(), Failure> {
    let Some(reference) = reference else { return Ok(()) };
    let (width, height) = (label.place().width(), label.place().height());
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

/// A whole picture that no memory holds is refused before the scene is read.
pub(crate) fn check_size(args: &RenderArgs) -> Result<(), Failure> {
    match args.size {
        Some(size) if args.tile.is_none() && args.crop.is_none() => check_most(size),
        _ => Ok(()),
    }
}

fn check_most([width, height]: [u32; 2]) -> Result<(), Failure> {
    let needed = memory::picture_bytes(width, height);
    if needed <= memory::MOST_BYTES {
        return Ok(());
    }
    let (needed, most) = (memory::readable(needed), memory::readable(memory::MOST_BYTES));
    Err(Failure::usage(anyhow!(
        "a picture of {width}x{height} pixels needs {needed} of memory; choose a --size that needs at most {most}, or render \
         it in smaller parts with --tile and join them with `whitted merge`"
    )))
}

/// A picture larger than the memory at hand would end the program, or others, without a word.
pub(crate) fn check_memory(label: &Label, goal: Goal) -> Result<(), Failure> {
    let (width, height) = (label.place().width(), label.place().height());
    check_most([width, height])?;
    let (mut needed, mut way_out) = (memory::picture_bytes(width, height), "in parts with --tile");
    if goal != Goal::Mode {
        needed += memory::goal_bytes(width, height);
        way_out = "with --aa adaptive:ERROR, which keeps less of each pixel";
    }
    match memory::available().map(u128::from) {
        Some(available) if needed > available => Err(anyhow!(
            "a picture of {width}x{height} pixels needs {} of memory, of which {} are free; choose a smaller --size, or \
             render it {way_out}",
            memory::readable(needed),
            memory::readable(available),
        ))?,
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_much_time_is_kept_for_writing_as_the_format_takes() {
        let pixels = 4e6;
        let micros =
            |format, threads| 1e6 * (write_seconds(format, pixels, threads) - 0.012) / pixels;
        for format in [Format::Png, Format::Ppm] {
            assert!(
                [1, 2, 64].iter().all(|&threads| (micros(format, threads) - 0.04).abs() < 1e-9)
            );
        }
        for (threads, measured) in [(1, 0.39), (2, 0.28)] {
            let kept = micros(Format::Exr, threads) / measured;
            assert!((1.0..1.1).contains(&kept), "{threads} threads: {kept}");
        }
        assert!((1..64).all(|threads| {
            let [few, more] = [threads, threads + 1].map(|threads| micros(Format::Exr, threads));
            few > more && more > 0.15
        }));
    }
}
