//! The flags and their help texts.

mod render;
mod scene;
mod view;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Parser, Subcommand};
use clap_complete::Shell;

pub(crate) use self::render::{ProgressMode, RenderArgs, Rules, Shares};
pub(crate) use self::scene::SceneArgs;
#[cfg(feature = "view")]
pub(crate) use self::view::CONTROLS;
pub(crate) use self::view::ViewArgs;
use super::parse::{parse_error, parse_repeats, parse_size, parse_studied, parse_threads};

/// The first screen: what people start with, then all there is.
const FIRST_STEPS: &str = "\
{about}

To start with:
  whitted render                           the assignment scene, to assignment.png
  whitted render model.obj -o model.png    a model on a floor under two lights
  whitted view spheres                     a window to look around in
  whitted scenes                           what can be rendered without a file
  whitted inspect model.obj                what a model holds, and what was repaired
  whitted study --quick                    what accuracy costs: tables and plots in ./study

{usage-heading} {usage}

{all-args}

Every command lists its flags with --help, and `whitted man COMMAND | man -l -` shows them as a page.";

/// A Whitted-style recursive ray tracer
#[derive(Debug, Parser)]
#[command(name = "whitted", version, subcommand_required = true, arg_required_else_help = true)]
#[command(help_template = FIRST_STEPS)]
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
    /// Measure how much two pictures differ
    Compare(CompareArgs),
    /// Show what a scene or model holds, what was repaired, what is missing
    Inspect(InspectArgs),
    /// Join the parts of a picture that were rendered with --tile or --crop
    Merge(MergeArgs),
    /// List the built-in scenes, or show one
    Scenes(ScenesArgs),
    /// Look around in a scene, in a window
    View(Box<ViewArgs>),
    /// Print a script that completes commands and flags in a shell
    Completions(CompletionsArgs),
    /// Print a manual page, or write all of them
    Man(ManArgs),
}

impl Command {
    /// How many threads the user wants to work.
    pub(crate) fn threads(&self) -> Option<NonZeroUsize> {
        match self {
            Self::Render(args) => args.threads,
            Self::Study(args) => args.threads,
            Self::View(args) => args.threads,
            _ => None,
        }
    }
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  whitted completions bash > ~/.local/share/bash-completion/completions/whitted
  whitted completions zsh > ~/.zfunc/_whitted       (a folder in fpath)
  whitted completions fish > ~/.config/fish/completions/whitted.fish")]
pub(crate) struct CompletionsArgs {
    /// Shell to write the script for
    #[arg(value_name = "SHELL", value_enum)]
    pub(crate) shell: Shell,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  whitted man | man -l -
  whitted man render | man -l -
  whitted man --folder ~/.local/share/man/man1")]
pub(crate) struct ManArgs {
    /// Command to describe [default: all of them, briefly]
    #[arg(value_name = "COMMAND", conflicts_with = "folder")]
    pub(crate) about: Option<String>,

    /// Folder to write the pages of all commands to (whitted.1, whitted-render.1 and so on); created if it is missing
    #[arg(long, value_name = "FOLDER")]
    pub(crate) folder: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  whitted merge big-*of64.png -o big.png")]
pub(crate) struct MergeArgs {
    /// Parts that together make the whole picture: .png or .exr files written by `render --tile` or `--crop`
    #[arg(value_name = "PART", required = true)]
    pub(crate) parts: Vec<PathBuf>,

    /// Picture to write: .png, .exr (from .exr parts) or .ppm, - for a PNG on standard output; the same bytes as those
    /// of an undivided render
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,

    /// Print only errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  whitted scenes --show assignment > scene.toml     a scene to start from
  whitted scenes --schema > scene.schema.json")]
pub(crate) struct ScenesArgs {
    /// Print this scene as TOML, to edit and render
    #[arg(long, value_name = "NAME", conflicts_with = "schema")]
    pub(crate) show: Option<String>,

    /// Print the JSON schema of the scene format, for editors
    #[arg(long)]
    pub(crate) schema: bool,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  whitted inspect model.obj
  whitted inspect scene.toml --json")]
pub(crate) struct InspectArgs {
    /// File to inspect (.obj, .nff or .toml), a built-in scene, or - for a .toml or .nff from standard input
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Print one JSON object instead of text
    #[arg(long)]
    pub(crate) json: bool,

    /// Treat warnings as errors
    #[arg(long)]
    pub(crate) strict: bool,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  whitted compare a.png b.png --heatmap difference.png
  whitted compare a.png b.png --fail-above 0.5     exit code 6 if they differ by more")]
pub(crate) struct CompareArgs {
    /// First picture (PNG), or - for standard input; colours are compared, alpha is not
    pub(crate) a: PathBuf,

    /// Second picture (PNG), of the same size, or -
    pub(crate) b: PathBuf,

    /// PNG to write that shows where they differ: black up to half a level, pale from 128 levels up; - is standard
    /// output, and the numbers then go to standard error
    #[arg(long, value_name = "FILE")]
    pub(crate) heatmap: Option<PathBuf>,

    /// Root-mean-square difference in levels of 255 above which the exit code is 6
    #[arg(long, value_name = "RMSE", value_parser = parse_error, allow_negative_numbers = true)]
    pub(crate) fail_above: Option<f64>,

    /// Print the numbers as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  whitted study --quick                   less than half a minute
  whitted study assignment -o results --repeats 9")]
pub(crate) struct StudyArgs {
    /// Scenes to study: built-in ones, spheres:N, or files [default: assignment and spheres:10000]
    #[arg(value_parser = parse_studied)]
    pub(crate) scenes: Vec<String>,

    /// Folder for study.csv, study.json, study.md, index.html, plots and pictures
    #[arg(short, long, value_name = "FOLDER", default_value = "study")]
    pub(crate) output: PathBuf,

    /// Use small pictures and few repeats: a first impression in less than half a minute
    #[arg(long)]
    pub(crate) quick: bool,

    /// Width and height of the pictures in pixels [default: 600x600, or 100x100 with --quick]
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    pub(crate) size: Option<[u32; 2]>,

    /// Timed repeats of each render, which takes turns with those that it is compared with; the median counts
    /// [default: 5, or 1 with --quick]
    #[arg(long, value_name = "N", value_parser = parse_repeats, allow_negative_numbers = true)]
    pub(crate) repeats: Option<u32>,

    /// Threads to render with, at most 4096 [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads, allow_negative_numbers = true)]
    pub(crate) threads: Option<NonZeroUsize>,

    /// Print only errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
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
