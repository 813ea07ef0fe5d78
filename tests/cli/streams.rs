//! Standard streams: progress, help, lists, and readers that have left.

use serde_json::Value;

use super::{SMALL, render};
use crate::program::{done, folder, json, run, said, text, whitted};

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
        done(&output);
        assert!(!said(&output).contains("error"), "{}", said(&output));
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
