//! Pictures in files and on standard output.

use std::fs;

use super::{assert_picture, assert_refused, render};
use crate::program::{done, folder, names_in, read, run, said};

#[test]
fn render_writes_the_scene_under_its_name_and_says_so() {
    let folder = folder();
    let output = render(folder.path(), &[]);
    done(&output);
    assert_eq!(names_in(folder.path()), ["assignment.png"]);
    assert_picture(&read(folder.path(), "assignment.png"), 8, 6);
    let summary = said(&output);
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
    done(&render(folder.path(), &["-o", "picture.png"]));
    assert_picture(&fs::read(path).expect("readable"), 8, 6);
    assert_eq!(names_in(folder.path()), ["picture.png"]);
}

#[test]
fn render_pipes_the_picture_to_standard_output() {
    let folder = folder();
    let output = render(folder.path(), &["--output", "-"]);
    done(&output);
    assert_picture(&output.stdout, 8, 6);
    assert_eq!(names_in(folder.path()), [""; 0]);
    done(&render(folder.path(), &["-o", "file.png"]));
    assert_eq!(read(folder.path(), "file.png"), output.stdout);
}

#[test]
fn quiet_says_nothing_but_errors() {
    let folder = folder();
    let output = render(folder.path(), &["--quiet", "--progress", "json"]);
    done(&output);
    assert!(output.stderr.is_empty() && output.stdout.is_empty());
    assert_refused(&render(folder.path(), &["--quiet", "-o", "no/a.png"]), 1, &["no"]);
}

#[test]
fn a_render_does_not_depend_on_its_threads() {
    let folder = folder();
    for threads in ["1", "3"] {
        let name = format!("{threads}.png");
        let size = ["render", "--size", "150x100", "--threads", threads, "-o", &name];
        done(&run(folder.path(), &size));
    }
    let [one, three] = ["1.png", "3.png"].map(|name| fs::read(folder.path().join(name)));
    assert_eq!(one.expect("readable"), three.expect("readable"));
}
