//! Pictures in files and on standard output.

use std::fs;

use super::{assert_picture, assert_refused, render};
use crate::program::{done, folder, names_in, read, run, said, whitted};

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

/// Oracle: the threads that the system counts while a scene is built and rendered and a file compressed, on what seems to be a
/// machine of 64 cores.
#[cfg(target_os = "linux")]
#[test]
fn no_more_threads_work_than_are_wanted() {
    let folder = folder();
    let arguments = [
        "render",
        "spheres",
        "--objects",
        "20000",
        "--size",
        "64x48",
        "--threads",
        "2",
        "-o",
        "a.exr",
    ];
    let mut program = whitted(folder.path(), &arguments);
    let mut program = program.env("RAYON_NUM_THREADS", "64").spawn().expect("the program runs");
    let (tasks, mut most) = (format!("/proc/{}/task", program.id()), 0);
    while program.try_wait().expect("it runs").is_none() {
        // Nobody to count, if it ends just now.
        most = most.max(fs::read_dir(&tasks).map_or(0, Iterator::count));
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    assert!(program.wait().expect("it ended").success());
    assert!((3..32).contains(&most), "{most} threads");
}
