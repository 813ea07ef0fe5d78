//! The flags and their help texts.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};
use glam::DVec3;
use whitted::aa::AntiAliasing;
use whitted::film::{Share, Tile};
use whitted::scene::ModelPlace;

use super::parse::{
    parse_angle, parse_crop, parse_depth, parse_direction, parse_error, parse_model, parse_objects,
    parse_repeats, parse_seconds, parse_shares, parse_sides, parse_size, parse_threads,
    parse_vector,
};

/// A Whitted-style recursive ray tracer
#[derive(Debug, Parser)]
#[command(name = "whitted", version, subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to a picture
    Render(Box<RenderArgs>),
    /// Measure what accuracy costs: tables and plots of error against time
    Study(StudyArgs),
    /// Measure how far two pictures are apart
    Compare(CompareArgs),
    /// Show what a scene or model holds, what was repaired, what is missing
    Inspect(InspectArgs),
    /// Join the parts of a picture that were rendered with --tile or --crop
    Merge(MergeArgs),
    /// List the built-in scenes, or show one
    Scenes(ScenesArgs),
}

#[derive(Debug, clap::Args)]
pub(crate) struct MergeArgs {
    /// Parts that together are the whole picture: .png or .exr, written by `render --tile` or `--crop`
    #[arg(value_name = "PART", required = true)]
    pub(crate) parts: Vec<PathBuf>,

    /// Picture to write: .png, .exr (of .exr parts) or .ppm; the same bytes as an undivided render's
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,

    /// Nothing on standard error but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct ScenesArgs {
    /// Print this scene as TOML, to be changed and rendered
    #[arg(long, value_name = "NAME", conflicts_with = "schema")]
    pub(crate) show: Option<String>,

    /// Print the JSON schema of the scene format, for editors
    #[arg(long)]
    pub(crate) schema: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct InspectArgs {
    /// File to look at: .obj, .nff or .toml, or a built-in scene
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// One JSON object on standard output instead of text
    #[arg(long)]
    pub(crate) json: bool,

    /// What would be a warning is an error
    #[arg(long)]
    pub(crate) strict: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct RenderArgs {
    /// Built-in scene, of which `whitted scenes` shows a list, or a file: .toml, .nff, or .obj
    /// (a model, on a floor under two lights)
    #[arg(default_value = "assignment")]
    pub(crate) scene: String,

    /// Picture to write: .png (8-bit sRGB), .exr (linear 32-bit floats, and the rays of each pixel as a second layer), .ppm (8-bit
    /// sRGB), or - for a PNG on standard output [default: the scene's name with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Width and height in pixels, such as 640x480; at most what 16 GiB of memory hold, for each tile if there are some
    /// [default: the scene's own]
    #[arg(long, value_name = "WxH", value_parser = parse_sides)]
    pub(crate) size: Option<[u32; 2]>,

    /// Anti-aliasing: none (one ray per pixel), grid:N (N x N rays per pixel), or adaptive[:ERROR[,MAX]] (rays where the
    /// picture needs them, until a pixel's estimated error is below ERROR levels of 255 or it has MAX rays; 4 and 64 by
    /// default) [default: adaptive]
    #[arg(long, value_name = "MODE")]
    pub(crate) aa: Option<AntiAliasing>,

    /// Estimated root-mean-square error of the picture, in levels of 255, to get below; rays go where they reduce it most.
    /// With --crop that of the part, so the part then equals the whole picture only if both end at the same squared error
    /// per ray, which is reported; adaptive:ERROR has no such catch
    #[arg(long, value_name = "E", value_parser = parse_error, allow_negative_numbers = true)]
    pub(crate) max_error: Option<f64>,

    /// Seconds from the start of the program to the written picture; the best picture that they allow, whose error is
    /// reported. It is not the same every time
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, conflicts_with = "max_error",
        allow_negative_numbers = true)]
    pub(crate) time_limit: Option<f64>,

    /// Part of the picture to render, in pixels from the upper left, half open, such as 100,50,200,80; the same pixels as in
    /// the whole picture
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_crop, allow_hyphen_values = true)]
    pub(crate) crop: Option<Tile>,

    /// Share of the picture to render, the I-th of N equal ones counted from 1, for many machines; several, such as 3/64,7/64,
    /// one after another with the scene read once. Each goes to a file of its own, named like scene-3of64.png unless
    /// --output names it; with several tiles, -3of64 is put into the name that --output gives. `whitted merge` joins them
    #[arg(long, value_name = "I/N[,I/N...]", value_parser = parse_shares, conflicts_with = "crop")]
    pub(crate) tile: Option<Shares>,

    /// Go on from the checkpoint that an interrupted render of the same picture left beside the output; from the beginning if
    /// there is none. What is finished already is not rendered again
    #[arg(long)]
    pub(crate) resume: bool,

    /// Seconds between checkpoints, beside the output with .checkpoint behind its name; it is deleted when the picture is
    /// finished. Pictures on standard output, and those with --max-error or --time-limit, have none
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, default_value = "30",
        allow_negative_numbers = true)]
    pub(crate) checkpoint: f64,

    /// PNG of the same size to measure the error against
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,

    /// Deepest level of recursion, camera rays being level 1 [default: the scene's own]
    #[arg(long, value_name = "N", value_parser = parse_depth, allow_negative_numbers = true)]
    pub(crate) depth: Option<u32>,

    /// Objects in a generated scene (spheres), from 1 to 50000000 [default: 1000]
    #[arg(long, value_name = "N", value_parser = parse_objects, allow_negative_numbers = true)]
    pub(crate) objects: Option<u32>,

    /// Threads to render with, at most 4096 [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads, allow_negative_numbers = true)]
    pub(crate) threads: Option<NonZeroUsize>,

    /// Model to add, standing at X,Y,Z on its lowest point, its largest side being SIZE; repeatable
    /// [default: on the floor in front of the scene's middle, a fitting size]
    #[arg(long = "obj", value_name = "FILE[@X,Y,Z][*SIZE]", value_parser = parse_model)]
    pub(crate) models: Vec<ModelPlace>,

    /// Where the camera is, in scene units [default: the scene's own]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    pub(crate) eye: Option<DVec3>,

    /// Point in the middle of the picture, in scene units [default: the scene's own]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    pub(crate) look_at: Option<DVec3>,

    /// Direction that is up, or x, y, z for an axis; a model alone also stands by it [default: the
    /// scene's own; y for models]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_direction, allow_hyphen_values = true)]
    pub(crate) up: Option<DVec3>,

    /// Vertical field of view in degrees, between 0 and 180 [default: the scene's own]
    #[arg(long, value_name = "DEGREES", value_parser = parse_angle, allow_negative_numbers = true)]
    pub(crate) fov: Option<f64>,

    /// Shading rules: whitted, or classic (those that ray counts of the Standard Procedural Databases
    /// are compared by: 513x513 rays through the corners of 512x512 pixels)
    #[arg(long, value_name = "RULES", value_enum, default_value_t)]
    pub(crate) rules: Rules,

    /// What would be a warning is an error
    #[arg(long)]
    pub(crate) strict: bool,

    /// Statistics to write as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,

    /// Progress on standard error
    #[arg(long, value_name = "MODE", value_enum, default_value_t)]
    pub(crate) progress: ProgressMode,

    /// Nothing on standard error but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Shares of a picture, each named once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Shares(pub(crate) Vec<Share>);

#[derive(Debug, clap::Args)]
pub(crate) struct CompareArgs {
    /// A picture: PNG
    pub(crate) a: PathBuf,

    /// Another of the same size
    pub(crate) b: PathBuf,

    /// PNG to write that shows where they differ: black up to half a level, pale from 128 levels on
    #[arg(long, value_name = "FILE")]
    pub(crate) heatmap: Option<PathBuf>,

    /// Root-mean-square difference in levels of 255 above which the exit code is 6
    #[arg(long, value_name = "RMSE", value_parser = parse_error, allow_negative_numbers = true)]
    pub(crate) fail_above: Option<f64>,

    /// The numbers as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct StudyArgs {
    /// Built-in scenes to study [default: assignment, and spheres of several numbers]
    pub(crate) scenes: Vec<String>,

    /// Folder for study.csv, study.json, study.md, index.html, plots and pictures
    #[arg(short, long, value_name = "FOLDER", default_value = "study")]
    pub(crate) output: PathBuf,

    /// Small pictures and few repeats: a first impression in less than half a minute
    #[arg(long)]
    pub(crate) quick: bool,

    /// Width and height of the pictures in pixels [default: 600x600, or 100x100 with --quick]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(crate) size: Option<[u32; 2]>,

    /// Times that each render is timed, of which the median counts [default: 5, or 1 with --quick]
    #[arg(long, value_name = "N", value_parser = parse_repeats, allow_negative_numbers = true)]
    pub(crate) repeats: Option<u32>,

    /// Threads to render with, at most 4096 [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads, allow_negative_numbers = true)]
    pub(crate) threads: Option<NonZeroUsize>,

    /// Nothing on standard error but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

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
    /// JSON objects, one a line, up to ten a second
    Json,
    /// Lines for Open Job Description, at most one a second
    Openjd,
    /// No progress
    None,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn clap_finds_no_fault_with_the_flags() {
        Args::command().debug_assert();
    }
}
