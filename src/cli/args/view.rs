//! The flags of `whitted view`.

use std::num::NonZeroUsize;

use clap::Args;
use whitted::aa::AntiAliasing;

use super::super::parse::{parse_depth, parse_size, parse_threads};
use super::SceneArgs;

/// What mouse and keys do.
pub(crate) const CONTROLS: &str = "  left button, arrows     orbit around what is in the middle
  right button            move sideways
  wheel, + and -          move nearer, farther
  a                       next anti-aliasing mode: none, grid:2, adaptive, and that of --aa
  d, shift d              one level of recursion fewer, more
  s                       save what is shown as a PNG, and print the camera
  r                       back to the first view
  h                       less text, more text
  q, Escape               quit";

#[derive(Debug, Args)]
#[command(after_help = format!("\
Mouse and keys:
{CONTROLS}

Saved pictures are called scene-view-1.png, -2 and so on, in the current folder. Once all passes
are done, they are byte for byte what `whitted render` writes with the printed camera.

Examples:
  whitted view
  whitted view spheres --objects 100000 --aa none
  whitted view model.obj --size 800x600"))]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) seen: SceneArgs,

    /// Width and height of the window in pixels, such as 640x480 [default: the scene's own]
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true, help_heading = "Picture")]
    pub(crate) size: Option<[u32; 2]>,

    /// Anti-aliasing of the last pass, as for `whitted render` [default: the scene's own, or adaptive]
    #[arg(long, value_name = "MODE", help_heading = "Quality")]
    pub(crate) aa: Option<AntiAliasing>,

    /// Deepest level of recursion, camera rays being level 1 [default: the scene's own]
    #[arg(long, value_name = "N", value_parser = parse_depth, allow_negative_numbers = true, help_heading = "Quality")]
    pub(crate) depth: Option<u32>,

    /// Threads to render with, at most 4096 [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads, allow_negative_numbers = true)]
    pub(crate) threads: Option<NonZeroUsize>,

    /// Treat warnings as errors
    #[arg(long)]
    pub(crate) strict: bool,

    /// Print only errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}
