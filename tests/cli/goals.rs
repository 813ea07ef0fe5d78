//! Goals, parts and references.

use std::fmt::Write;
use std::fs;

use serde_json::Value;

use super::{assert_picture, assert_refused};
use crate::program::{done, folder, json, read, run, said};

#[test]
fn a_part_is_cut_from_the_same_picture() {
    let folder = folder();
    let size = ["render", "--size", "40x30", "--quiet"];
    done(&run(folder.path(), &[&size[..], &["-o", "whole.png"]].concat()));
    done(&run(folder.path(), &[&size[..], &["-o", "part.png", "--crop", "7,9,33,30"]].concat()));
    let read = |name| image::open(folder.path().join(name)).expect("a PNG").into_rgb8();
    let cut = image::imageops::crop_imm(&read("whole.png"), 7, 9, 26, 21).to_image();
    assert_eq!(read("part.png"), cut);
}

#[test]
fn an_error_is_aimed_at_measured_and_missed_with_a_warning() {
    let folder = folder();
    let small = ["render", "--size", "40x30"];
    done(&run(folder.path(), &[&small[..], &["--aa", "sobol:64", "-o", "truth.png"]].concat()));
    let goal = ["--max-error", "5", "--reference", "truth.png", "--stats", "-"];
    let output = run(folder.path(), &[&small[..], &goal].concat());
    done(&output);
    assert!(!said(&output).contains("warning"), "{}", said(&output));
    let stats: Value = json(&output.stdout);
    let error = |key: &str| stats["error"][key].as_f64().expect("a number");
    assert!(error("estimated_rmse") <= 5.0 && error("squared_per_ray") > 0.0, "{stats}");
    assert_eq!(stats["error"]["goal_reached"], true);
    assert!(error("measured_rmse") < 10.0 && error("measured_rmse") > 2.0, "{stats}");
    let output =
        run(folder.path(), &[&small[..], &["--max-error", "0.5", "--aa", "adaptive:0,8"]].concat());
    done(&output);
    assert!(said(&output).starts_with("warning: --max-error 0.5 is not reached"));
    assert!(said(&output).contains("allow more, such as --aa adaptive:0,4096\n"));
    for (error, aa, advice) in [
        ("0.01", "adaptive:0,5000", "allow more, such as --aa adaptive:0,80000\n"),
        ("1e-300", "adaptive:0,64", "--max-error 1e-300 is not reached"),
        ("0.0001", "adaptive:0,400000", "allow more, such as --aa adaptive:0,1048576\n"),
        ("0.00001", "adaptive:0,1048576", "allow a larger one, such as --max-error 0."),
        ("0", "adaptive:0,16", "allow a larger one, such as --max-error "),
    ] {
        // A pixel with an edge in it, which no number of rays gets right to the last bit.
        let pixel = ["--crop", "14,15,15,16", "--max-error", error, "--aa", aa];
        let output = run(folder.path(), &[&small[..], &pixel].concat());
        done(&output);
        assert!(said(&output).contains(advice), "{}", said(&output));
        assert!(!said(&output).contains(" 0.0000 squared"), "{}", said(&output));
    }
    let advised = ["--crop", "14,15,15,16", "--max-error", "0.01", "--aa", "adaptive:0,80000"];
    let output = run(folder.path(), &[&small[..], &advised].concat());
    done(&output);
    assert!(!said(&output).contains("warning"), "{}", said(&output));
    let output = run(folder.path(), &["render", "--size", "41x30", "--reference", "truth.png"]);
    assert_refused(&output, 2, &["--reference", "41x30", "40x30"]);
    assert_refused(&run(folder.path(), &["render", "--reference", "no.png"]), 1, &["no.png"]);
}

/// Whatever the machine, there is a picture, and it is said if there was no time for more than a ray in each pixel.
#[test]
fn a_time_limit_ends_in_a_picture() {
    let folder = folder();
    let output = run(folder.path(), &["render", "--size", "64x48", "--time-limit", "0.000001"]);
    done(&output);
    assert!(said(&output).contains("warning: --time-limit 0.000001 is too short"));
    assert!(
        said(&output).contains(" s of loading, before ")
            && said(&output).contains(" s of writing)\n")
    );
    assert_picture(&read(folder.path(), "assignment.png"), 64, 48);
    let output = run(folder.path(), &["render", "--size", "160x120", "--time-limit", "0.3"]);
    done(&output);
    assert!(said(&output).contains("adaptive until the time was up"));
    // Few rays a pixel, which are spent long before the hour is over.
    let few = ["render", "--size", "12x8", "--time-limit", "3600", "--aa", "adaptive:0,16"];
    let output = run(folder.path(), &few);
    done(&output);
    assert!(
        said(&output).contains("with all rays worth casting that adaptive:0,16 allows, before")
    );
    // Many, but none that is worth it.
    let enough = ["render", "--size", "6x4", "--time-limit", "3600"];
    let output = run(folder.path(), &enough);
    done(&output);
    assert!(said(&output).contains("with all rays worth casting that adaptive:0,"));
}

/// A goal that is missed is a warning to people, a line and a statistic to programs, and an error under `--strict`; the picture is
/// written all the same.
#[test]
fn a_missed_goal_is_told_in_every_way() {
    let goals = [
        (&["--max-error", "0.1", "--aa", "adaptive:0,8"][..], "--max-error 0.1 is not reached"),
        (&["--time-limit", "0.000001"], "--time-limit 0.000001 is too short"),
    ];
    for (goal, message) in goals {
        let folder = folder();
        let render = |more: &[&str]| {
            run(folder.path(), &[&["render", "--size", "40x30"], goal, more].concat())
        };
        let output = render(&["--strict", "--quiet"]);
        assert_refused(&output, 4, &[message]);
        assert_picture(&read(folder.path(), "assignment.png"), 40, 30);
        let output = render(&["--strict"]);
        assert_eq!(output.status.code(), Some(4));
        let lines: Vec<&str> = said(&output).lines().collect();
        assert!(lines[0].starts_with("wrote assignment.png"), "{lines:?}");
        assert!(lines[2].starts_with("error: ") && lines[2].contains(message), "{lines:?}");
        let output = render(&["--progress", "json", "--stats", "-"]);
        done(&output);
        let stats: Value = json(&output.stdout);
        assert_eq!(stats["error"]["goal_reached"], false);
        let lines: Vec<Value> = said(&output).lines().map(|line| json(line.as_bytes())).collect();
        let warnings = lines.iter().filter_map(|line| line["warning"].as_str());
        assert_eq!(warnings.filter(|warning| warning.starts_with(message)).count(), 1, "{lines:?}");
    }
}

/// A wavy sheet whose every vertex has a colour of its own, as an OBJ file.
fn tinted_sheet(side: usize) -> String {
    let mut text = String::new();
    for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
        let [u, v] = [x, y].map(|k| k as f64 / (side - 1) as f64);
        let height = 0.3 * (9.0 * u).sin() * (7.0 * v).cos();
        let odd = f64::from(u8::try_from((x * 7 + y * 3) % 5).expect("small")) / 4.0;
        writeln!(text, "v {u} {} {height} {u} {odd} {v}", 1.0 - v + height).expect("in memory");
    }
    for (y, x) in (1..side).flat_map(|y| (1..side).map(move |x| (x, y))) {
        let corner = |x: usize, y: usize| y * side + x + 1;
        let [a, b, c, d] =
            [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(i, j)| corner(x - 1 + i, y - 1 + j));
        writeln!(text, "f {a} {b} {c} {d}").expect("in memory");
    }
    text
}

/// Oracle: the whole picture by one thread, of which every other way must have the same pixels.
#[test]
fn colours_of_vertices_are_the_same_in_the_whole_in_parts_and_by_any_threads() {
    let folder = folder();
    fs::write(folder.path().join("tinted.obj"), tinted_sheet(24)).expect("written");
    let render = |aa: &str, more: &[&str]| {
        let flags =
            ["render", "tinted.obj", "--size", "93x71", "--aa", aa, "--quiet", "-o", "a.png"];
        done(&run(folder.path(), &[&flags[..], more].concat()));
        image::load_from_memory(&read(folder.path(), "a.png")).expect("a PNG").into_rgb8()
    };
    for aa in ["none", "grid:2", "adaptive:1"] {
        let whole = render(aa, &["--threads", "1"]);
        let bytes = read(folder.path(), "a.png");
        let vivid = |p: &&image::Rgb<u8>| {
            let [r, g, b] = p.0.map(i32::from);
            r.max(g).max(b) - r.min(g).min(b) > 60
        };
        assert!(whole.pixels().filter(vivid).count() > 93 * 71 / 20, "{aa}: the colours are seen");
        for threads in ["2", "5"] {
            render(aa, &["--threads", threads]);
            assert!(read(folder.path(), "a.png") == bytes, "{aa}, {threads} threads");
        }
        for [x0, y0, x1, y1] in
            [[0, 0, 47, 71], [47, 0, 93, 29], [47, 29, 93, 71], [31, 30, 32, 31]]
        {
            let part = render(aa, &["--crop", &format!("{x0},{y0},{x1},{y1}")]);
            let cut = image::imageops::crop_imm(&whole, x0, y0, x1 - x0, y1 - y0).to_image();
            assert!(part == cut, "{aa}: the part from {x0},{y0} to {x1},{y1}");
        }
    }
}
