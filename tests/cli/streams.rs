//! Standard streams: progress, help, lists, and readers that have left.

use std::fs::{self, File};
use std::path::Path;

use serde_json::Value;

use super::{SMALL, render};
use crate::program::{done, folder, json, run, said, text, whitted};

#[test]
fn a_reader_that_has_left_loses_results_but_no_lists() {
    let folder = folder();
    let picture = [&SMALL[..], &["-o", "-"]].concat();
    let stats = [&SMALL[..], &["--stats", "-"]].concat();
    let unread = |arguments: &[&str]| {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = whitted(folder.path(), arguments).stdout(writer).output();
        output.expect("the program runs")
    };
    for arguments in [&["scenes"][..], &["--help"], &["--version"]] {
        let output = unread(arguments);
        done(&output);
        assert!(!said(&output).contains("error"), "{}", said(&output));
    }
    for arguments in [&picture, &stats] {
        let output = unread(arguments);
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        assert!(
            said(&output).contains("standard output could not be written"),
            "{}",
            said(&output)
        );
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
    done(&output);
    let lines: Vec<Value> =
        said(&output).lines().map(|line| serde_json::from_str(line).expect("an object")).collect();
    let last = lines.last().expect("at least the end");
    assert_eq!((&last["done"], &last["total"]), (&48.into(), &48.into()));
}

#[test]
fn bar_is_drawn_on_demand_and_not_by_itself() {
    let folder = folder();
    let bar = render(folder.path(), &["--progress", "bar"]);
    done(&bar);
    assert!(text(&bar.stderr).contains('\x1b'), "{:?}", text(&bar.stderr));
    for mode in ["auto", "plain", "none"] {
        let output = render(folder.path(), &["--progress", mode]);
        done(&output);
        assert!(!said(&output).contains('\x1b'), "{mode}: {:?}", said(&output));
    }
}

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = folder();
    let output = run(folder.path(), &["--version"]);
    done(&output);
    assert_eq!(text(&output.stdout), format!("whitted {}\n", env!("CARGO_PKG_VERSION")));
    let output = run(folder.path(), &["render", "--help"]);
    done(&output);
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
        done(&output);
        let stats: Value = json(&output.stdout);
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
    done(&output);
    let names: Vec<&str> =
        text(&output.stdout).lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.contains(&"assignment"), "{names:?}");
    for name in names {
        let line = text(&output.stdout).lines().find(|line| line.starts_with(name));
        assert!(line.expect("its line").len() > name.len() + 2, "{name} has a description");
        done(&run(folder.path(), &["render", name, "--size", "4x3"]));
        assert!(folder.path().join(format!("{name}.png")).is_file(), "{name}");
    }
}

/// Oracle: the same scenes as files.
#[test]
fn a_scene_may_come_from_standard_input() {
    let rings = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formats/spd/rings.nff");
    let folder = folder();
    let toml = run(folder.path(), &["scenes", "--show", "assignment"]);
    done(&toml);
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, &toml.stdout).expect("written");
    for file in [scene.as_path(), Path::new(rings)] {
        let given = || File::open(file).expect("readable");
        let small = ["--size", "12x9", "-q"];
        let name = file.to_str().expect("UTF-8");
        done(&run(folder.path(), &[&["render", name, "-o", "file.png"], &small[..]].concat()));
        let piped = [&["render", "-"], &small[..]].concat();
        done(&whitted(folder.path(), &piped).stdin(given()).output().expect("runs"));
        let read = |name: &str| fs::read(folder.path().join(name)).expect("written");
        assert!(read("file.png") == read("stdin.png"), "{name}");
        let inspected = whitted(folder.path(), &["inspect", "-"]).stdin(given()).output();
        let inspected = inspected.expect("runs");
        done(&inspected);
        let inspected = text(&inspected.stdout);
        assert!(inspected.starts_with("stdin\n") && inspected.contains("spheres"), "{inspected}");
    }
    for (given, said_of) in
        [("", "standard input"), ("v\nfrom here", "standard input:2"), ("[", "standard input:1")]
    {
        let file = folder.path().join("bad");
        fs::write(&file, given).expect("written");
        let bad = whitted(folder.path(), &["render", "-"])
            .stdin(File::open(&file).expect("readable"))
            .output();
        let bad = bad.expect("runs");
        assert_eq!(bad.status.code(), Some(3), "{}", said(&bad));
        assert!(said(&bad).contains(said_of), "{}", said(&bad));
    }
    let model = folder.path().join("model");
    fs::write(&model, "# a model\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    let model = whitted(folder.path(), &["render", "-"])
        .stdin(File::open(&model).expect("readable"))
        .output()
        .expect("runs");
    assert_eq!(model.status.code(), Some(3), "{}", said(&model));
    assert!(said(&model).contains("standard input: this is an OBJ"), "{}", said(&model));
    for refused in [
        &["study", "-"][..],
        &["render", "--obj", "-"],
        &["render", "-", "--reference", "-"],
        &["merge", "-", "-o", "a.png"],
    ] {
        let output = run(folder.path(), refused);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains("name a file"), "{}", said(&output));
    }
}

/// Oracle: the undivided render.
#[test]
fn a_whole_of_parts_may_go_to_standard_output() {
    let folder = folder();
    let parts = ["top.png", "bottom.png"];
    for (part, tile) in parts.into_iter().zip(["1/2", "2/2"]) {
        done(&render(folder.path(), &["-o", part, "--tile", tile]));
    }
    done(&render(folder.path(), &["-o", "whole.png"]));
    let merged = run(folder.path(), &[&["merge"], &parts[..], &["-o", "-"]].concat());
    done(&merged);
    assert!(merged.stdout == fs::read(folder.path().join("whole.png")).expect("written"));
    let none = run(folder.path(), &["merge", parts[0], "-o", "-"]);
    assert!(!none.status.success() && none.stdout.is_empty());
}
