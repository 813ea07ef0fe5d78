//! Wrong usage: one line, code 2, nothing written.

use std::fs;

use super::assert_refused;
use crate::program::{done, folder, json, names_in, run, whitted};

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
        (&["--obj", "a.obj*0"], &["--obj", "size is 0"]),
        (&["--obj", "a.obj*"], &["--obj", "a place and a size"]),
        (&["--obj", "a.obj@8,-15"], &["--obj", "a place and a size"]),
        (&["--obj", "a.OBJ*4@1,2,3"], &["--obj", "a place and a size"]),
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
        (&["nowhere", "--objects", "7"], &["unknown scene `nowhere`", "assignment"]),
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

/// Oracle: what the system says is free, of which a film of 22 bytes a pixel takes a third and all that is kept on the way to an error
/// more than there is.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_towards_an_error_that_no_memory_holds_is_refused() {
    let table = std::fs::read_to_string("/proc/meminfo").expect("Linux");
    let line = table.lines().find(|line| line.starts_with("MemAvailable")).expect("there");
    let free: f64 = line.split_whitespace().nth(1).expect("a number").parse().expect("in KiB");
    // No more than what is refused at once whatever there is; a machine with more than that says nothing here.
    let pixels = (free * 1024.0 / 66.0).min(16.0 * f64::from(1 << 30) / 23.0);
    if pixels * 120.0 < free * 1024.0 {
        return;
    }
    let side = (pixels.sqrt() as u32).to_string();
    let folder = folder();
    let size = format!("{side}x{side}");
    let output = run(folder.path(), &["render", "--max-error", "1", "--size", &size]);
    let words = [&*size, "free", "--size", "--aa adaptive:ERROR"];
    assert_refused(&output, 1, &words);
    assert_eq!(names_in(folder.path()), [""; 0]);
}

/// Oracle: the model's own size, of which the scene says nothing.
#[test]
fn a_model_may_be_all_there_is_but_not_without_end() {
    let folder = folder();
    let model = |size: &str| {
        let text = format!(
            "v {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nv 0 0 0\nf 1 2 3\nf 1 2 4\nf 1 3 4\n"
        );
        fs::write(folder.path().join("a.obj"), text).expect("written");
    };
    let scene = "resolution = [20, 20]\ndepth = 2\nbackground = [1, 0, 0]\n\
        camera = { eye = [0.3, 0.2, 9], look_at = [0.3, 0.2, 0], up = [0, 1, 0], vertical_fov = 30 }\n\
        light = [{ position = [5, 5, 5], intensity = 1 }]\n";
    fs::write(folder.path().join("empty.toml"), scene).expect("written");
    model("1");
    let render = ["render", "empty.toml", "--obj", "a.obj", "--aa", "none", "--stats", "-"];
    let output = run(folder.path(), &render);
    done(&output);
    let hit = json(&output.stdout)["rays"]["camera_hit"].as_u64().expect("a number");
    assert!((5..100).contains(&hit), "{hit} of 400 rays hit it");
    model("1e160");
    let output = run(folder.path(), &["render", "a.obj"]);
    assert_refused(&output, 3, &["a.obj: there can be no floor", "too large"]);
}

/// The name with replacement characters may be another file's.
#[cfg(unix)]
#[test]
fn a_scene_whose_name_is_not_utf8_is_not_looked_for_by_another() {
    use std::os::unix::ffi::OsStrExt as _;

    let folder = folder();
    let mut inspect = whitted(folder.path(), &["inspect"]);
    inspect.arg(std::ffi::OsStr::from_bytes(b"a\xff.toml"));
    let output = inspect.output().expect("it runs");
    assert_refused(&output, 2, &["must be UTF-8"]);
}
