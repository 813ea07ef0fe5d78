//! Warnings of long renders: told, or errors under `--strict`.

use std::fs;
use std::sync::atomic::AtomicBool;

use whitted::checkpoint::{Checkpoint, Job};
use whitted::render::{Goal, RenderOptions, blocks, render_blocks};
use whitted::scene::load_builtin;

use super::damage::{first, label, quiet};
use super::stop::{PICTURE, end, signal, until};
use super::{done, folder, json, names_in, read, refused, run, said};

const SMALL: [&str; 5] = ["render", "--size", "40x30", "-o", "a.png"];

#[test]
fn a_checkpoint_that_is_in_the_way_is_a_warning_or_an_error() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("a.png.checkpoint"), "left").expect("written");
    let left = "a.png.checkpoint is in the way of a checkpoint";
    for more in [&["--strict"][..], &["--strict", "--quiet"], &["--strict", "--progress", "json"]] {
        refused(&run(at, &[&SMALL[..], more].concat()), 4, &["error: ", left, ".old"]);
        assert_eq!(names_in(at), ["a.png.checkpoint"], "nothing is rendered");
    }
    assert_eq!(read(at, "a.png.checkpoint"), b"left");
    let output = run(at, &SMALL);
    done(&output);
    assert!(said(&output).starts_with(&format!("warning: {left}")), "{}", said(&output));
    let output = run(at, &[&SMALL[..], &["--progress", "json"]].concat());
    done(&output);
    let first = said(&output).lines().next().expect("a line");
    assert!(json(first.as_bytes())["warning"].as_str().is_some_and(|text| text.starts_with(left)));
    let output = run(at, &[&SMALL[..], &["--quiet"]].concat());
    done(&output);
    assert_eq!(said(&output), "");
}

#[test]
fn a_checkpoint_in_the_way_is_told_from_that_of_another_picture() {
    let folder = folder();
    let at = folder.path();
    let scene = load_builtin("assignment").expect("built in");
    let path = at.join("a.png.checkpoint");
    Checkpoint::create(&path, &label(&scene, "aa=none depth=6"), &first()).expect("written");
    let output = run(at, &[&SMALL[..], &["--strict"]].concat());
    refused(&output, 4, &["of another picture (", "size: 40x30 here, 200x150 there", ".old"]);
    assert!(!said(&output).contains("--resume"), "{}", said(&output));
    fs::remove_file(&path).expect("there");
    let child = until(at, 0.3, &["-o", "a.png", "--checkpoint", "0.02"]);
    signal(&child, "-INT");
    refused(&end(child), 130, &["checkpoint: a.png.checkpoint"]);
    let output = run(at, &[&PICTURE[..], &["-o", "a.png", "--strict"]].concat());
    refused(&output, 4, &["is left from an interrupted render", "--resume"]);
}

/// Oracle: the first render.
#[test]
fn a_finished_picture_that_missed_its_goal_says_so_again() {
    let folder = folder();
    let at = folder.path();
    let goals = [
        (&["--max-error", "0.1", "--aa", "adaptive:0,8"][..], "--max-error 0.1 is not reached"),
        (&["--time-limit", "0.000001"], "--time-limit 0.000001 is too short"),
    ];
    for ((goal, message), name) in goals.into_iter().flat_map(|g| [(g, "a.png"), (g, "a.exr")]) {
        let render = |more: &[&str]| {
            run(at, &[&["render", "--size", "40x30", "-o", name, "--resume"], goal, more].concat())
        };
        refused(&render(&["--strict"]), 4, &[message, "wrote"]);
        let picture = read(at, name);
        refused(&render(&["--strict"]), 4, &[message, "is finished already"]);
        let output = render(&["--strict", "--quiet"]);
        refused(&output, 4, &[message]);
        assert_eq!(said(&output).lines().count(), 1, "{}", said(&output));
        let output = render(&[]);
        done(&output);
        let lines: Vec<&str> = said(&output).lines().collect();
        assert!(lines[0].starts_with(&format!("warning: {message}")), "{lines:?}");
        assert_eq!(lines[1..], [format!("{name} is finished already")]);
        assert!(read(at, name) == picture, "it is not rendered again");
        fs::remove_file(at.join(name)).expect("deleted");
    }
    let reached = [&SMALL[..], &["--max-error", "9", "--resume", "--strict"]].concat();
    done(&run(at, &reached));
    let output = run(at, &reached);
    done(&output);
    assert_eq!(said(&output), "a.png is finished already\n");
}

/// A picture of parts of which one missed its goal has missed it too.
#[test]
fn joined_parts_keep_the_warning() {
    let folder = folder();
    let at = folder.path();
    let goal = ["--max-error", "0.1", "--aa", "adaptive:0,8"];
    let small = [&["render", "--size", "40x30", "--quiet"][..], &goal].concat();
    for (crop, name) in [("0,0,40,9", "top.png"), ("0,9,40,30", "rest.png")] {
        done(&run(at, &[&small[..], &["--crop", crop, "-o", name]].concat()));
    }
    done(&run(at, &["merge", "rest.png", "top.png", "-o", "all.png"]));
    let resumed = run(at, &[&small[..], &["-o", "all.png", "--resume", "--strict"]].concat());
    refused(&resumed, 4, &["--max-error 0.1 is not reached"]);
}

/// A picture that was finished when the disk was full is in its checkpoint, and what it missed with it.
#[test]
fn a_picture_that_only_has_to_be_written_says_what_it_missed() {
    let folder = folder();
    let at = folder.path();
    let scene = load_builtin("assignment").expect("built in");
    let aa = "adaptive:0,8".parse().expect("a mode");
    let goal = Goal::Error(0.1);
    let options = RenderOptions { size: Some([200, 150]), aa, goal, ..RenderOptions::default() };
    let places = blocks(&scene, &options).expect("whole");
    let label = label(&scene, "aa=adaptive:0,8 depth=6 max-error=0.1");
    let path = at.join("a.png.checkpoint");
    let never = AtomicBool::new(false);
    let job = Job::new(label, places, Some(path), &never, &quiet);
    render_blocks(&scene, &options, job.places(), &job).expect("rendered");
    job.save().expect("written");
    let goal = ["--max-error", "0.1", "--aa", "adaptive:0,8", "--resume", "--strict"];
    let render = [&["render", "--size", "200x150", "-o", "a.png"][..], &goal].concat();
    let messages = ["with 100 % done", "wrote a.png", "error: --max-error 0.1 is not reached"];
    refused(&run(at, &render), 4, &messages);
    assert_eq!(names_in(at), ["a.png"]);
}

/// Oracle: the message that other runs give. All lines are JSON.
#[test]
fn warnings_of_a_scene_are_told_to_programs_too() {
    let folder = folder();
    let at = folder.path();
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/broken/obj/duplicate_face.obj");
    let small = ["render", model, "--size", "8x6", "-o", "a.png"];
    let output = run(at, &small);
    done(&output);
    let warning = said(&output).lines().find_map(|line| line.strip_prefix("warning: "));
    let output = run(at, &[&small[..], &["--progress", "json"]].concat());
    done(&output);
    let lines: Vec<_> = said(&output).lines().map(|line| json(line.as_bytes())).collect();
    let told: Vec<&str> = lines.iter().filter_map(|line| line["warning"].as_str()).collect();
    assert_eq!(told, [warning.expect("a warning")]);
}
