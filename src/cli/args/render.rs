//! The flags of `whitted render`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::ValueEnum;
use whitted::aa::AntiAliasing;
use whitted::film::{Share, Tile};

use super::super::parse::{
    parse_crop, parse_depth, parse_error, parse_seconds, parse_shares, parse_sides, parse_threads,
};
use super::SceneArgs;

#[derive(Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "flags are independent of each other")]
#[command(after_help = "\
Examples:
  whitted render --aa none --size 1200x1200 -o big.png
  whitted render --max-error 1                     within 1 level of 255 of the exact picture
  whitted render --time-limit 2                    the best picture in two seconds
  whitted render spheres --objects 1000000
  whitted render --obj model.obj@8,-15,-75*6       a model in the assignment scene
  whitted render model.obj --eye 3,2,5 --look-at 0,1,0 --fov 40
  whitted render scene.toml --tile 3/64            one of 64 shares, for `whitted merge`

Exit codes: 0 done; 1 the render or the writing failed; 2 wrong usage; 3 the scene or a model is invalid;
4 a warning under --strict; 5 a checkpoint does not match; 130 interrupted; 143 terminated")]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) seen: SceneArgs,

    /// Picture to write: .png (8-bit sRGB), .exr (linear 32-bit floats, with the number of rays per pixel as a second
    /// layer), .ppm (8-bit sRGB), or - for a PNG on standard output [default: the scene's name with .png, in the
    /// current folder]
    #[arg(short, long, value_name = "FILE", help_heading = "Picture")]
    pub(crate) output: Option<PathBuf>,

    /// Width and height in pixels, such as 640x480; at most what fits into 16 GiB of memory (per tile, with --tile)
    /// [default: the scene's own]
    #[arg(long, value_name = "WxH", value_parser = parse_sides, allow_hyphen_values = true, help_heading = "Picture")]
    pub(crate) size: Option<[u32; 2]>,

    /// Anti-aliasing: none (one ray per pixel), grid:N (N x N rays per pixel), or adaptive[:ERROR[,MAX]] (rays where
    /// the picture needs them, until a pixel's estimated error is below ERROR levels of 255 or it has MAX rays; 4 and
    /// 64 by default; a MAX of 2 or 3 is as 1; with --max-error or --time-limit ERROR is ignored, and MAX is 1024
    /// without --aa) [default: the scene's own, or adaptive]
    #[arg(long, value_name = "MODE", help_heading = "Quality")]
    pub(crate) aa: Option<AntiAliasing>,

    /// Estimated root-mean-square error of the picture to get below, in levels of 255; rays go where they reduce it
    /// most. With --crop it is the error of the part, which then equals that part of the whole picture only if both end
    /// at the same squared error per ray (it is reported); --aa adaptive:ERROR has no such catch
    #[arg(long, value_name = "E", value_parser = parse_error, allow_negative_numbers = true, help_heading = "Quality")]
    pub(crate) max_error: Option<f64>,

    /// Seconds from the start of the program to the written picture: the best picture that fits into them is made, and
    /// its estimated error reported. It is not the same every time. With --resume, that many more seconds
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, conflicts_with = "max_error",
        allow_negative_numbers = true, help_heading = "Quality")]
    pub(crate) time_limit: Option<f64>,

    /// Part of the picture to render, in pixels from the upper left, such as 100,50,200,80 (X1 and Y1 are the first
    /// outside); its pixels equal those of the whole picture
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_crop, allow_hyphen_values = true, help_heading = "Picture")]
    pub(crate) crop: Option<Tile>,

    /// Share of the picture to render, the I-th of N equal ones counted from 1, for many machines. Several, such as
    /// 3/64,7/64, are rendered one after another, with the scene read once. Each goes to a file of its own, called
    /// scene-3of64.png and so on unless --output names it; with several tiles, -3of64 is inserted into that name
    /// and that of --stats. `whitted merge` joins them
    #[arg(long, value_name = "I/N[,I/N...]", value_parser = parse_shares, conflicts_with = "crop", help_heading = "Picture")]
    pub(crate) tile: Option<Shares>,

    /// Go on from the checkpoint that an interrupted render of the same picture left beside the output, or from the
    /// beginning if there is none. A finished .png or .exr is not rendered again, unless --stats or --reference asks
    /// for more
    #[arg(long, help_heading = "Long renders")]
    pub(crate) resume: bool,

    /// Seconds between checkpoints. The file has the output's name with .checkpoint appended and is deleted when the
    /// picture is finished; there is none for a picture on standard output. With --max-error or --time-limit the whole
    /// of it is written each time, and at least 50 times as long as that takes passes between two
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, default_value = "30",
        allow_negative_numbers = true, help_heading = "Long renders")]
    pub(crate) checkpoint: f64,

    /// PNG of the same size to measure the error against; - is standard input
    #[arg(long, value_name = "FILE", help_heading = "Quality")]
    pub(crate) reference: Option<PathBuf>,

    /// Deepest level of recursion, camera rays being level 1 [default: the scene's own]
    #[arg(long, value_name = "N", value_parser = parse_depth, allow_negative_numbers = true, help_heading = "Quality")]
    pub(crate) depth: Option<u32>,

    /// Threads to render with, at most 4096 [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads, allow_negative_numbers = true, help_heading = "Long renders")]
    pub(crate) threads: Option<NonZeroUsize>,

    /// Shading rules: whitted, or classic (those by which ray counts of the Standard Procedural Databases
    /// are compared: 513x513 rays through the corners of 512x512 pixels)
    #[arg(long, value_name = "RULES", value_enum, default_value_t, help_heading = "Quality")]
    pub(crate) rules: Rules,

    /// Treat warnings as errors: those before the render end the program, the others once the picture is written
    #[arg(long, help_heading = "Messages")]
    pub(crate) strict: bool,

    /// File for statistics as JSON; - is standard output
    #[arg(long, value_name = "FILE", help_heading = "Messages")]
    pub(crate) stats: Option<PathBuf>,

    /// Progress on standard error
    #[arg(long, value_name = "MODE", value_enum, default_value_t, help_heading = "Messages")]
    pub(crate) progress: ProgressMode,

    /// Show the picture while it is rendered, block by block: in a window if the program was built with the feature
    /// view and there is a display, else in the terminal, two pixels per character, in 24-bit colours
    #[arg(long, conflicts_with = "quiet", help_heading = "Messages")]
    pub(crate) preview: bool,

    /// Print only errors
    #[arg(short, long, help_heading = "Messages")]
    pub(crate) quiet: bool,
}

/// Shares of a picture, each named once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Shares(pub(crate) Vec<Share>);

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Rules {
    /// Those of the assignment
    #[default]
    Whitted,
    /// Those of the Standard Procedural Databases
    Classic,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressMode {
    /// A bar on a terminal, plain lines elsewhere
    #[default]
    Auto,
    /// A bar with the time left, even where there is no terminal
    Bar,
    /// A line every 5 seconds
    Plain,
    /// JSON objects, one per line, up to ten a second
    Json,
    /// Lines for Open Job Description, at most one a second
    Openjd,
    /// No progress
    None,
}
