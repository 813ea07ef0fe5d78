//! The flags, their help texts, and what their values may be.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};
use glam::DVec3;
use whitted::aa::AntiAliasing;
use whitted::film::Tile;
use whitted::scene::ModelPlace;
use whitted::scene::generators::MOST_OBJECTS;

use super::memory;

/// The longest time limit: about eleven days.
const MOST_SECONDS: f64 = 1e6;

/// The most threads one may ask for: more than machines have, fewer than they refuse to start.
const MOST_THREADS: usize = 4096;

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
    /// List the built-in scenes, or show one
    Scenes(ScenesArgs),
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

    /// Picture to write: .png (8-bit sRGB), or - for a PNG on standard output [default: the scene's
    /// name with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Width and height in pixels, such as 640x480; at most what 16 GiB of memory hold [default: the
    /// scene's own]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
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
    /// No progress
    None,
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let shape = || "give width and height in pixels, such as 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(shape)?;
    let side = |digits: &str| -> Result<u32, String> {
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(shape());
        }
        // A side that does not fit is too long for the memory as well.
        Ok(digits.parse().unwrap_or(u32::MAX))
    };
    let (width, height) = (side(width)?, side(height)?);
    if width == 0 || height == 0 {
        return Err("a picture has at least 1x1 pixels".to_owned());
    }
    let bytes = memory::picture_bytes(width, height);
    if bytes > memory::MOST_BYTES {
        let more = if width == u32::MAX || height == u32::MAX { "more than " } else { "" };
        let (needed, most) = (memory::readable(bytes), memory::readable(memory::MOST_BYTES));
        return Err(format!(
            "needs {more}{needed} of memory; choose a size that needs at most {most}"
        ));
    }
    Ok([width, height])
}

fn parse_error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(error) if (0.0..=255.0).contains(&error) => Ok(error),
        _ => Err("give a number of levels from 0 to 255".to_owned()),
    }
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 && seconds <= MOST_SECONDS => Ok(seconds),
        _ => Err(format!("give a number of seconds, above 0 and at most {MOST_SECONDS}")),
    }
}

fn parse_crop(text: &str) -> Result<Tile, String> {
    let numbers: Vec<u32> = text.split(',').filter_map(|number| number.parse().ok()).collect();
    match *numbers {
        [x0, y0, x1, y1] if text.split(',').count() == 4 => {
            if x0 < x1 && y0 < y1 {
                Ok(Tile { x0, y0, x1, y1 })
            } else {
                Err("the part is empty; X1 and Y1 are the first pixels outside".to_owned())
            }
        }
        _ => Err("give four whole numbers, such as 100,50,200,80".to_owned()),
    }
}

fn parse_depth(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(depth) if depth > 0 => Ok(depth),
        _ => Err(format!("give a whole number from 1 (camera rays only) to {}", u32::MAX)),
    }
}

fn parse_objects(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(objects @ 1..=MOST_OBJECTS) => Ok(objects),
        _ => Err(format!("give a whole number from 1 to {MOST_OBJECTS}")),
    }
}

fn parse_repeats(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(repeats @ 1..=1000) => Ok(repeats),
        _ => Err("give a whole number from 1 to 1000".to_owned()),
    }
}

fn parse_threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(threads) if threads.get() <= MOST_THREADS => Ok(threads),
        _ => Err(format!("give a whole number from 1 to {MOST_THREADS}")),
    }
}

/// A file name with numbers behind it; what is not numeric belongs to the name.
fn parse_model(text: &str) -> Result<ModelPlace, String> {
    let (mut name, mut size, mut at) = (text, None, None);
    if let Some((rest, number)) = name.rsplit_once('*')
        && let Ok(number) = number.parse::<f64>()
    {
        if !(number > 0.0 && number.is_finite()) {
            return Err(format!("the size is {number}, but must be positive and finite"));
        }
        (name, size) = (rest, Some(number));
    }
    if let Some((rest, place)) = name.rsplit_once('@')
        && let Ok(place) = parse_vector(place)
    {
        (name, at) = (rest, Some(place));
    }
    if name.is_empty() {
        return Err("give a file, such as model.obj or model.obj@0,0,-80*5".to_owned());
    }
    Ok(ModelPlace { path: PathBuf::from(name), at, size })
}

fn parse_vector(text: &str) -> Result<DVec3, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()))
        .collect::<Option<_>>()
        .unwrap_or_default();
    match numbers.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        _ => Err("give three numbers, such as 1,2.5,-3".to_owned()),
    }
}

fn parse_direction(text: &str) -> Result<DVec3, String> {
    match text {
        "x" | "+x" => Ok(DVec3::X),
        "y" | "+y" => Ok(DVec3::Y),
        "z" | "+z" => Ok(DVec3::Z),
        "-x" => Ok(DVec3::NEG_X),
        "-y" => Ok(DVec3::NEG_Y),
        "-z" => Ok(DVec3::NEG_Z),
        _ => match parse_vector(text) {
            Ok(vector) if vector != DVec3::ZERO => Ok(vector),
            Ok(_) => Err("the zero vector points nowhere".to_owned()),
            Err(_) => Err("give x, y, z, -x, -y, -z or three numbers, such as 0,0,1".to_owned()),
        },
    }
}

fn parse_angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("give an angle in degrees, between 0 and 180".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn clap_finds_no_fault_with_the_flags() {
        Args::command().debug_assert();
    }

    #[test]
    fn sizes_are_two_positive_whole_numbers() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        assert_eq!(parse_size("1X1"), Ok([1, 1]));
        for text in
            ["", "x", "640", "640x", "x480", "6e2x4", "-1x2", "+1x2", "1x2x3", "1.5x2", "1 x2"]
        {
            assert!(parse_size(text).expect_err(text).ends_with("such as 640x480"), "{text}");
        }
        for text in ["0x1", "1x0", "0x99999999999999999999999"] {
            assert_eq!(parse_size(text), Err("a picture has at least 1x1 pixels".to_owned()));
        }
    }

    /// Oracle: 16 bytes of film, 3 of levels, at most 3 of file make 22 a pixel; 2³⁴ / 22 pixels fit.
    #[test]
    fn sizes_are_limited_by_the_memory_they_need() {
        let fit = (1_u64 << 34) / 22;
        assert!(parse_size(&format!("{fit}x1")).is_ok());
        assert!(parse_size(&format!("1x{}", fit + 1)).is_err());
        let error = parse_size("100000x100000").expect_err("too large");
        assert_eq!(error, "needs 204.9 GiB of memory; choose a size that needs at most 16.0 GiB");
        let error = parse_size("99999999999999999999x1").expect_err("too large");
        assert!(error.starts_with("needs more than 88.0 GiB"), "{error}");
    }

    #[test]
    fn models_are_read_from_the_right() {
        let model = |text: &str| {
            let place = parse_model(text).expect(text);
            (place.path.display().to_string(), place.at.map(|v| v.to_array()), place.size)
        };
        assert_eq!(model("a.obj"), ("a.obj".to_owned(), None, None));
        assert_eq!(
            model("a.obj@1,-2,3e1*4"),
            ("a.obj".to_owned(), Some([1.0, -2.0, 30.0]), Some(4.0))
        );
        assert_eq!(model("a*b@c.obj*.5"), ("a*b@c.obj".to_owned(), None, Some(0.5)));
        assert_eq!(model("a@1,2,3@4,5,6"), ("a@1,2,3".to_owned(), Some([4.0, 5.0, 6.0]), None));
        assert_eq!(model("a*2@1,2,3"), ("a*2".to_owned(), Some([1.0, 2.0, 3.0]), None));
        assert_eq!(model("a@1,2.obj"), ("a@1,2.obj".to_owned(), None, None));
        for text in ["", "*2", "@1,2,3", "a*0", "a*-1", "a*inf"] {
            assert!(parse_model(text).is_err(), "{text}");
        }
    }

    #[test]
    fn directions_are_axes_or_vectors() {
        assert_eq!(parse_direction("z"), Ok(DVec3::Z));
        assert_eq!(parse_direction("-y"), Ok(DVec3::NEG_Y));
        assert_eq!(parse_direction("0, 1,-2"), Ok(DVec3::new(0.0, 1.0, -2.0)));
        for text in ["", "w", "0,0,0", "1,2", "1,2,3,4", "1,2,nan"] {
            assert!(parse_direction(text).is_err(), "{text}");
        }
        assert!(
            parse_angle("0").is_err() && parse_angle("180").is_err() && parse_angle("x").is_err()
        );
    }

    #[test]
    fn depth_and_threads_start_at_one() {
        assert_eq!(parse_depth("1"), Ok(1));
        assert_eq!(parse_threads("4096").map(NonZeroUsize::get), Ok(4096));
        for text in ["0", "-1", "two", "", "1.5", "99999999999999999999"] {
            assert!(parse_depth(text).is_err() && parse_threads(text).is_err(), "{text}");
        }
        assert!(parse_threads("4097").is_err());
    }
}
