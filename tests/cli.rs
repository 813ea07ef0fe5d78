//! The program as a user meets it: what it says, what it writes, and the codes it ends with.
#![cfg(feature = "cli")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The arguments of a picture that takes no time.
const SMALL: [&str; 5] = ["render", "--size", "8x6", "--aa", "grid:2"];

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// The program, to be run in `folder`.
fn whitted(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_whitted"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    whitted(folder, arguments).output().expect("the program runs")
}

/// Runs a small render with further arguments.
fn render(folder: &Path, arguments: &[&str]) -> Output {
    run(folder, &[&SMALL, arguments].concat())
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[track_caller]
fn assert_done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// The program ended with `code`, one line on standard error that holds all of `parts`, and
/// nothing on standard output.
#[track_caller]
fn assert_refused(output: &Output, code: i32, parts: &[&str]) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.starts_with("error: ") && message.ends_with('\n'), "{message:?}");
    assert_eq!(message.lines().count(), 1, "{message:?}");
    for part in parts {
        assert!(message.contains(part), "no `{part}` in {message:?}");
    }
    assert!(output.stdout.is_empty(), "{:?}", text(&output.stdout));
}

#[track_caller]
fn assert_picture(bytes: &[u8], width: u32, height: u32) {
    let picture = image::load_from_memory_with_format(bytes, image::ImageFormat::Png);
    let picture = picture.expect("a PNG");
    assert_eq!((picture.width(), picture.height()), (width, height));
    assert_eq!(picture.color(), image::ColorType::Rgb8);
}

// Pictures.

#[test]
fn render_writes_the_scene_under_its_name_and_says_so() {
    let folder = folder();
    let output = render(folder.path(), &[]);
    assert_done(&output);
    assert_eq!(names_in(folder.path()), ["assignment.png"]);
    assert_picture(&fs::read(folder.path().join("assignment.png")).expect("readable"), 8, 6);
    let summary = text(&output.stderr);
    assert_eq!(summary.lines().count(), 2, "{summary}");
    for part in ["assignment.png", "8x6", "grid:2", " rays", " s"] {
        assert!(summary.contains(part), "{summary}");
    }
    assert!(output.stdout.is_empty());
}

#[test]
fn render_replaces_an_existing_picture() {
    let folder = folder();
    let path = folder.path().join("picture.png");
    fs::write(&path, "old").expect("written");
    assert_done(&render(folder.path(), &["-o", "picture.png"]));
    assert_picture(&fs::read(path).expect("readable"), 8, 6);
    assert_eq!(names_in(folder.path()), ["picture.png"]);
}

#[test]
fn render_pipes_the_picture_to_standard_output() {
    let folder = folder();
    let output = render(folder.path(), &["--output", "-"]);
    assert_done(&output);
    assert_picture(&output.stdout, 8, 6);
    assert_eq!(names_in(folder.path()), [""; 0]);
    assert_done(&render(folder.path(), &["-o", "file.png"]));
    assert_eq!(fs::read(folder.path().join("file.png")).expect("readable"), output.stdout);
}

#[test]
fn quiet_says_nothing_but_errors() {
    let folder = folder();
    let output = render(folder.path(), &["--quiet", "--progress", "json"]);
    assert_done(&output);
    assert!(output.stderr.is_empty() && output.stdout.is_empty());
    assert_refused(&render(folder.path(), &["--quiet", "-o", "no/a.png"]), 1, &["no"]);
}

#[test]
fn a_render_does_not_depend_on_its_threads() {
    let folder = folder();
    for threads in ["1", "3"] {
        let name = format!("{threads}.png");
        let size = ["render", "--size", "150x100", "--threads", threads, "-o", &name];
        assert_done(&run(folder.path(), &size));
    }
    let [one, three] = ["1.png", "3.png"].map(|name| fs::read(folder.path().join(name)));
    assert_eq!(one.expect("readable"), three.expect("readable"));
}

// Wrong usage: one line, code 2, nothing written.

#[test]
fn bad_values_are_refused_on_one_line_before_anything_is_written() {
    let whole = "give a whole number from 1";
    let cases: &[(&[&str], &[&str])] = &[
        (&["--size", "0x0"], &["--size", "at least 1x1"]),
        (&["--size", "640"], &["--size", "such as 640x480"]),
        (&["--size", "ax4"], &["--size", "such as 640x480"]),
        (&["--size=-4x4"], &["--size", "such as 640x480"]),
        (&["--size", "100000x100000"], &["--size", "204.9 GiB", "at most 16.0 GiB"]),
        (&["--size", "99999999999999999999x2"], &["--size", "more than", "at most 16.0 GiB"]),
        (&["--aa", "grid:0"], &["--aa", "grid:0"]),
        (&["--aa", "grid:65"], &["--aa", "64"]),
        (&["--aa", "grid:99999999999"], &["--aa", "64"]),
        (&["--aa", "grid:"], &["--aa"]),
        (&["--aa", "blur"], &["--aa", "none", "grid"]),
        (&["--threads", "0"], &["--threads", whole]),
        (&["--threads", "99999999"], &["--threads", whole, "4096"]),
        (&["--threads", "-1"], &["--threads", whole]),
        (&["--depth", "0"], &["--depth", whole]),
        (&["--depth", "x"], &["--depth", whole]),
        (&["--aa", "adaptive:-1"], &["--aa", "adaptive:-1", "zero or more"]),
        (&["--aa", "adaptive:nan"], &["--aa", "error in levels"]),
        (&["--aa", "adaptive:1,0"], &["--aa", "from 1 to"]),
        (&["--max-error", "-1"], &["--max-error", "from 0 to 255"]),
        (&["--max-error", "nan"], &["--max-error", "from 0 to 255"]),
        (&["--max-error", "1", "--aa", "grid:2"], &["--max-error", "grid:2", "adaptive"]),
        (&["--max-error", "1", "--time-limit", "1"], &["--max-error", "--time-limit"]),
        (&["--time-limit", "0"], &["--time-limit", "above 0"]),
        (&["--time-limit", "inf"], &["--time-limit", "above 0"]),
        (&["--time-limit", "1", "--aa", "none"], &["--time-limit", "none", "adaptive"]),
        (&["--crop", "1,2,3"], &["--crop", "four whole numbers"]),
        (&["--crop", "5,5,5,9"], &["--crop", "empty"]),
        (&["--crop=-1,0,5,5"], &["--crop", "four whole numbers"]),
        (&["--crop", "0,0,601,5"], &["--crop", "601", "600x600"]),
        (&["--objects", "0"], &["--objects", whole]),
        (&["--objects", "-5"], &["--objects", whole]),
        (&["--objects", "50000001"], &["--objects", "50000000"]),
        (&["--objects", "7"], &["assignment", "fixed number", "spheres"]),
        (
            &["--progress", "plan"],
            &["--progress", "auto, bar, plain, json, openjd, none", "'plain'"],
        ),
        (&["--sise", "8x8"], &["--sise", "'--size'"]),
        (&["--output"], &["--output"]),
        (&["--quiet", "--quiet"], &["--quiet"]),
        (&["one", "two"], &["two"]),
        (&["nowhere"], &["nowhere", "assignment"]),
        (&["two\nlines"], &["two\\nlines"]),
        (&["-o", "picture"], &["picture", ".png"]),
        (&["-o", "picture.tif"], &["picture.tif", ".png"]),
        (&["-o", "-", "--stats", "-"], &["--output", "--stats"]),
        (&["-o", "a.png", "--stats", "./a.png"], &["--output", "--stats", "same file"]),
    ];
    let folder = folder();
    for (arguments, parts) in cases {
        let arguments = [&["render"], *arguments].concat();
        assert_refused(&run(folder.path(), &arguments), 2, parts);
    }
    assert_eq!(names_in(folder.path()), [""; 0]);
}

#[test]
fn without_a_command_or_with_an_unknown_one_the_next_step_is_named() {
    let folder = folder();
    assert_refused(&run(folder.path(), &[]), 2, &["whitted render", "--help"]);
    assert_refused(&run(folder.path(), &["rendr"]), 2, &["rendr", "'render'"]);
    assert_refused(&run(folder.path(), &["zzz"]), 2, &["zzz", "--help"]);
}

// Places that cannot be written: one line, code 1, nothing written.

#[test]
fn unwritable_places_are_refused_for_picture_and_statistics() {
    let folder = folder();
    fs::write(folder.path().join("plain"), "kept").expect("written");
    fs::create_dir(folder.path().join("dir.png")).expect("created");
    let before = names_in(folder.path());
    let long = format!("{}.png", "n".repeat(300));
    for (place, part) in [
        ("missing/a.png", "there is no folder missing"),
        ("plain/a.png", "plain is not a folder"),
        ("dir.png", "is a folder"),
        ("dir.png/", "is a folder"),
        ("new.png/", "is a folder"),
        (&long, "cannot be created"),
    ] {
        assert_refused(&render(folder.path(), &["-o", place]), 1, &[place, part]);
        let stats = render(folder.path(), &["--stats", place]);
        assert_refused(&stats, 1, &["--stats", place, part]);
    }
    assert_eq!(names_in(folder.path()), before);
    assert_eq!(fs::read(folder.path().join("plain")).expect("readable"), b"kept");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_refused() {
    let folder = folder(); // even root creates nothing in /proc
    let output = render(folder.path(), &["-o", "/proc/whitted.png"]);
    assert_refused(&output, 1, &["/proc/whitted.png", "cannot be created", "writable folder"]);
}

#[test]
fn a_write_protected_picture_stays() {
    let folder = folder();
    let path = folder.path().join("picture.png");
    fs::write(&path, "kept").expect("written");
    let mut permissions = fs::metadata(&path).expect("there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).expect("changed");
    let output = render(folder.path(), &["-o", "picture.png"]);
    assert_refused(&output, 1, &["picture.png", "write-protected"]);
    assert_eq!(fs::read(&path).expect("readable"), b"kept");
}

/// The statistics are refused before the render, so the picture they belong to is not touched.
#[test]
fn a_refused_render_keeps_the_picture_of_the_last_one() {
    let folder = folder();
    let path = folder.path().join("assignment.png");
    fs::write(&path, "kept").expect("written");
    for arguments in [["--stats", "no/s.json"], ["--aa", "grid:0"], ["--size", "0x1"]] {
        let output = run(folder.path(), &[&["render"][..], &arguments].concat());
        assert_ne!(output.status.code(), Some(0));
        assert_eq!(fs::read(&path).expect("readable"), b"kept");
    }
    assert_eq!(names_in(folder.path()), ["assignment.png"]);
}

// Statistics.

/// The dotted names of all values that are not objects.
fn keys(value: &Value, prefix: &str, into: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| keys(value, &format!("{prefix}.{key}"), into));
        }
        _ => into.push(prefix.trim_start_matches('.').to_owned()),
    }
}

#[test]
fn statistics_hold_every_key_and_what_was_asked_for() {
    let folder = folder();
    let output = render(folder.path(), &["--depth", "3", "--threads", "1", "--stats", "s.json"]);
    assert_done(&output);
    assert_eq!(names_in(folder.path()), ["assignment.png", "s.json"]);
    let stats = fs::read_to_string(folder.path().join("s.json")).expect("readable");
    let stats: Value = serde_json::from_str(&stats).expect("JSON");
    let mut found = Vec::new();
    keys(&stats, "", &mut found);
    found.sort();
    let expected = "aa bvh.bytes bvh.nodes depth error.estimated_rmse error.measured_rmse error.squared_per_ray height \
        lights peak_memory_bytes primitives rays.camera rays.camera_hit rays.reflected \
        rays.refracted rays.shadow rays.transmitted samples_per_pixel.max samples_per_pixel.mean \
        samples_per_pixel.min scene seconds.build seconds.load seconds.render seconds.total \
        seconds.write threads version width";
    assert_eq!(found.join(" "), expected);

    assert_eq!(stats["scene"], "assignment");
    assert_eq!(stats["aa"], "grid:2");
    assert_eq!(stats["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!((&stats["width"], &stats["height"]), (&8.into(), &6.into()));
    assert_eq!((&stats["depth"], &stats["threads"]), (&3.into(), &1.into()));
    assert_eq!(stats["rays"]["camera"], 4 * 8 * 6);
    assert_eq!(stats["samples_per_pixel"], serde_json::json!({ "min": 4, "mean": 4.0, "max": 4 }));
    assert!(stats["error"]["estimated_rmse"].as_f64().expect("a number") > 0.0);
    assert_eq!(stats["error"]["measured_rmse"], Value::Null);
    for step in ["load", "build", "render", "write", "total"] {
        assert!(stats["seconds"][step].as_f64().expect("a number") >= 0.0, "{step}");
    }
    for count in ["reflected", "refracted", "transmitted", "shadow", "camera_hit"] {
        assert!(stats["rays"][count].is_u64(), "{count}");
    }
    if cfg!(target_os = "linux") {
        assert!(stats["peak_memory_bytes"].as_u64().expect("known") > 0);
    }
}

#[test]
fn statistics_go_to_standard_output_on_request() {
    let folder = folder();
    let output = render(folder.path(), &["--stats", "-", "--aa", "none"]);
    // The flag was given twice: SMALL has one.
    assert_refused(&output, 2, &["--aa"]);
    let output = run(folder.path(), &["render", "--size", "4x4", "--aa", "none", "--stats", "-"]);
    assert_done(&output);
    let stats: Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
    assert_eq!(stats["rays"]["camera"], 16);
    assert_eq!(names_in(folder.path()), ["assignment.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_after_the_picture_is_safe() {
    let folder = folder();
    let output = render(folder.path(), &["--stats", "/dev/full"]);
    assert_refused(&output, 1, &["--stats", "/dev/full", "could not be written"]);
    assert_picture(&fs::read(folder.path().join("assignment.png")).expect("readable"), 8, 6);
    let full = fs::File::options().write(true).open("/dev/full").expect("it opens");
    let output = whitted(folder.path(), &[&SMALL[..], &["-o", "-"]].concat()).stdout(full).output();
    assert_refused(&output.expect("the program runs"), 1, &["standard output"]);
}

// Standard streams.

#[test]
fn a_reader_that_has_left_is_no_error() {
    let folder = folder();
    let picture = [&SMALL[..], &["-o", "-"]].concat();
    let stats = [&SMALL[..], &["--stats", "-"]].concat();
    for arguments in [&["scenes"][..], &["--help"], &["--version"], &picture, &stats] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = whitted(folder.path(), arguments).stdout(writer).output();
        let output = output.expect("the program runs");
        assert_done(&output);
        assert!(!text(&output.stderr).contains("error"), "{}", text(&output.stderr));
    }
}

#[test]
fn nobody_at_standard_error_is_no_error() {
    let folder = folder();
    for progress in ["auto", "bar", "json"] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let arguments = [&SMALL[..], &["--progress", progress]].concat();
        let status = whitted(folder.path(), &arguments).stderr(writer).status();
        assert_eq!(status.expect("the program runs").code(), Some(0), "{progress}");
    }
}

#[test]
fn json_progress_is_one_object_a_line_up_to_the_end() {
    let folder = folder();
    let output = render(folder.path(), &["--progress", "json"]);
    assert_done(&output);
    let lines: Vec<Value> = text(&output.stderr)
        .lines()
        .map(|line| serde_json::from_str(line).expect("an object"))
        .collect();
    let last = lines.last().expect("at least the end");
    assert_eq!((&last["done"], &last["total"]), (&48.into(), &48.into()));
}

#[test]
fn bar_is_drawn_on_demand_and_not_by_itself() {
    let folder = folder();
    let bar = render(folder.path(), &["--progress", "bar"]);
    assert_done(&bar);
    assert!(text(&bar.stderr).contains('\x1b'), "{:?}", text(&bar.stderr));
    for mode in ["auto", "plain", "none"] {
        let output = render(folder.path(), &["--progress", mode]);
        assert_done(&output);
        assert!(!text(&output.stderr).contains('\x1b'), "{mode}: {:?}", text(&output.stderr));
    }
}

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = folder();
    let output = run(folder.path(), &["--version"]);
    assert_done(&output);
    assert_eq!(text(&output.stdout), format!("whitted {}\n", env!("CARGO_PKG_VERSION")));
    let output = run(folder.path(), &["render", "--help"]);
    assert_done(&output);
    for flag in ["output", "size", "aa", "depth", "threads", "stats", "progress", "quiet"]
        .map(|f| format!("--{f}"))
    {
        assert!(text(&output.stdout).contains(&flag), "{flag}");
    }
}

#[test]
fn spheres_come_in_any_number() {
    let folder = folder();
    for (objects, primitives) in [(&["--objects", "12"][..], 13), (&[], 1001)] {
        let small = ["render", "spheres", "--size", "6x4", "--stats", "-", "--quiet"];
        let output = run(folder.path(), &[&small[..], objects].concat());
        assert_done(&output);
        let stats: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(
            (&stats["scene"], &stats["primitives"]),
            (&"spheres".into(), &primitives.into())
        );
    }
}

#[test]
fn scenes_are_listed_one_a_line_and_each_renders() {
    let folder = folder();
    let output = run(folder.path(), &["scenes"]);
    assert_done(&output);
    let names: Vec<&str> =
        text(&output.stdout).lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.contains(&"assignment"), "{names:?}");
    for name in names {
        let line = text(&output.stdout).lines().find(|line| line.starts_with(name));
        assert!(line.expect("its line").len() > name.len() + 2, "{name} has a description");
        assert_done(&run(folder.path(), &["render", name, "--size", "4x3"]));
        assert!(folder.path().join(format!("{name}.png")).is_file(), "{name}");
    }
}

// Goals, parts and references.

#[test]
fn a_part_is_cut_from_the_same_picture() {
    let folder = folder();
    let size = ["render", "--size", "40x30", "--quiet"];
    assert_done(&run(folder.path(), &[&size[..], &["-o", "whole.png"]].concat()));
    assert_done(&run(
        folder.path(),
        &[&size[..], &["-o", "part.png", "--crop", "7,9,33,30"]].concat(),
    ));
    let read = |name| image::open(folder.path().join(name)).expect("a PNG").into_rgb8();
    let cut = image::imageops::crop_imm(&read("whole.png"), 7, 9, 26, 21).to_image();
    assert_eq!(read("part.png"), cut);
}

#[test]
fn an_error_is_aimed_at_measured_and_missed_with_a_warning() {
    let folder = folder();
    let small = ["render", "--size", "40x30"];
    assert_done(&run(
        folder.path(),
        &[&small[..], &["--aa", "sobol:64", "-o", "truth.png"]].concat(),
    ));
    let goal = ["--max-error", "5", "--reference", "truth.png", "--stats", "-"];
    let output = run(folder.path(), &[&small[..], &goal].concat());
    assert_done(&output);
    assert!(!text(&output.stderr).contains("warning"), "{}", text(&output.stderr));
    let stats: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let error = |key: &str| stats["error"][key].as_f64().expect("a number");
    assert!(error("estimated_rmse") <= 5.0 && error("squared_per_ray") > 0.0, "{stats}");
    assert!(error("measured_rmse") < 10.0 && error("measured_rmse") > 2.0, "{stats}");
    let output =
        run(folder.path(), &[&small[..], &["--max-error", "0.5", "--aa", "adaptive:0,8"]].concat());
    assert_done(&output);
    assert!(text(&output.stderr).starts_with("warning: --max-error 0.5 is not reached"));
    let output = run(folder.path(), &["render", "--size", "41x30", "--reference", "truth.png"]);
    assert_refused(&output, 2, &["--reference", "41x30", "40x30"]);
    assert_refused(&run(folder.path(), &["render", "--reference", "no.png"]), 1, &["no.png"]);
}

/// Whatever the machine, there is a picture, and it is said if there was no time for more than a ray in each pixel.
#[test]
fn a_time_limit_ends_in_a_picture() {
    let folder = folder();
    let output = run(folder.path(), &["render", "--size", "64x48", "--time-limit", "0.000001"]);
    assert_done(&output);
    assert!(text(&output.stderr).contains("warning: --time-limit 0.000001 is too short"));
    assert_picture(&fs::read(folder.path().join("assignment.png")).expect("readable"), 64, 48);
    let output = run(folder.path(), &["render", "--size", "64x48", "--time-limit", "0.3"]);
    assert_done(&output);
    assert!(text(&output.stderr).contains("adaptive until the time was up"));
}

// Comparing.

#[test]
fn compare_measures_maps_and_judges() {
    let folder = folder();
    for (name, aa) in [("a.png", "none"), ("b.png", "grid:4")] {
        let small = ["render", "--size", "40x30", "--aa", aa, "-o", name];
        assert_done(&run(folder.path(), &small));
    }
    let output = run(folder.path(), &["compare", "a.png", "a.png", "--fail-above", "0"]);
    assert_done(&output);
    assert!(text(&output.stdout).contains("RMSE         0.0000"), "{}", text(&output.stdout));
    let output =
        run(folder.path(), &["compare", "a.png", "b.png", "--json", "--heatmap", "map.png"]);
    assert_done(&output);
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(
        found["rmse"].as_f64().expect("a number") > 1.0 && found["ssim"].as_f64() < Some(0.999)
    );
    assert_picture(&fs::read(folder.path().join("map.png")).expect("readable"), 40, 30);
    let output = run(folder.path(), &["compare", "a.png", "b.png", "--fail-above", "1"]);
    assert_eq!(output.status.code(), Some(6));
    assert!(text(&output.stderr).contains("more than --fail-above 1"), "{}", text(&output.stderr));
    assert_done(&run(folder.path(), &["render", "--size", "40x31", "-o", "c.png"]));
    assert_refused(&run(folder.path(), &["compare", "a.png", "c.png"]), 1, &["40x30", "40x31"]);
    assert_refused(&run(folder.path(), &["compare", "a.png", "no.png"]), 1, &["no.png"]);
    assert_refused(
        &run(folder.path(), &["compare", "a.png", "b.png", "--fail-above", "-1"]),
        2,
        &["--fail-above"],
    );
}

#[test]
fn a_study_that_cannot_be_written_is_refused_at_once() {
    let folder = folder();
    fs::write(folder.path().join("plain"), "kept").expect("written");
    assert_refused(&run(folder.path(), &["study", "--quick", "-o", "plain"]), 1, &["plain"]);
    assert_refused(&run(folder.path(), &["study", "nowhere"]), 2, &["nowhere", "assignment"]);
    assert_eq!(names_in(folder.path()), ["plain"]);
}
