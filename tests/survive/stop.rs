//! Signals and sudden death at any moment.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::{done, folder, json, names_in, read, refused, run, said, whitted};

/// A picture of many small blocks that takes a moment.
pub(crate) const PICTURE: [&str; 5] = ["render", "--size", "400x300", "--aa", "adaptive:1.5,4096"];
/// One that goes to and fro over all of it.
const TOWARDS_ERROR: [&str; 5] = ["render", "--size", "400x300", "--max-error", "0.4"];

/// The undivided picture, for comparing.
pub(crate) fn reference(at: &Path, picture: &[&str], kind: &str) -> Vec<u8> {
    let name = format!("reference.{kind}");
    done(&run(at, &[picture, &["-o", &name, "--quiet", "--stats", "reference.json"]].concat()));
    let bytes = read(at, &name);
    fs::remove_file(at.join(name)).expect("there");
    bytes
}

pub(crate) fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([name, &id]).stderr(Stdio::null()).status();
    sent.expect("kill is there");
}

/// Waits until every thread of a child to which that was signalled has stopped, or ended.
pub(crate) fn wait_until_it_sleeps(child: &Child) {
    let id = child.id().to_string();
    loop {
        let told = Command::new("ps")
            .args(["-L", "-o", "stat=", "-p", &id])
            .output()
            .expect("ps is there");
        let threads = String::from_utf8_lossy(&told.stdout);
        if threads.lines().all(|state| state.trim_start().starts_with(['T', 'Z'])) {
            return;
        }
    }
}

/// Starts a render that tells its progress, and waits until at least `share` of it is done, or it ended.
pub(crate) fn until(at: &Path, share: f64, more: &[&str]) -> Child {
    let arguments = [&PICTURE[..], &["--progress", "json"], more].concat();
    let mut child = whitted(at, &arguments).stderr(Stdio::piped()).spawn().expect("it runs");
    let mut lines = BufReader::new(child.stderr.take().expect("piped"));
    let mut line = String::new();
    while lines.read_line(&mut line).is_ok_and(|length| length > 0) {
        if line.starts_with('{') {
            let told = json(line.as_bytes());
            let number = |name: &str| told[name].as_f64().expect("a number");
            if number("done") >= share * number("total") {
                break;
            }
        }
        line.clear();
    }
    // What is still to come is read for it, or it would find nobody there.
    child.stderr = Some(lines.into_inner());
    child
}

pub(crate) fn end(child: Child) -> Output {
    child.wait_with_output().expect("it ends")
}

/// Nothing is in the folder but what is documented: `a.png`, if it is there, is whole and opens; beside it are at most its checkpoint, the
/// figures of the undivided render, and what a killed program was writing, under a temporary name.
#[track_caller]
fn assert_sound(at: &Path) {
    for name in names_in(at) {
        let temporary = name.strip_prefix(".whitted-").and_then(|rest| rest.strip_suffix(".part"));
        match name.as_str() {
            "a.png" => drop(image::open(at.join(name)).expect("a whole picture")),
            "a.png.checkpoint" | "reference.json" => {}
            _ => assert!(temporary.is_some(), "{name} in {:?}", names_in(at)),
        }
    }
}

#[test]
fn a_signal_leaves_a_picture_and_a_checkpoint_from_which_it_goes_on() {
    for (name, code, kind) in [("-INT", 130, "png"), ("-TERM", 143, "exr")] {
        let folder = folder();
        let at = folder.path();
        let expected = reference(at, &PICTURE, kind);
        let file = format!("a b.{kind}");
        let child = until(at, 0.3, &["-o", &file]);
        signal(&child, name);
        let output = end(child);
        let checkpoint = format!("{file}.checkpoint");
        refused(&output, code, &["% done", "checkpoint: ", "picture so far", " --resume"]);
        let told = said(&output);
        assert!(names_in(at).contains(&checkpoint), "{:?}", names_in(at));
        if kind == "png" {
            let picture = image::open(at.join(&file)).expect("a whole PNG").into_rgba8();
            let clear = picture.pixels().filter(|pixel| pixel.0[3] == 0).count();
            assert!(clear > 0 && clear < 400 * 300, "{clear} transparent");
            assert!(picture.pixels().all(|p| p.0[3] == 255 || p.0[3] == 0));
            // The line that it gave is the one to go on with.
            let line = told.lines().find_map(|line| line.trim().strip_prefix("go on with: "));
            let line = line.expect("the command").to_owned();
            let output = Command::new("sh").args(["-c", &line]).current_dir(at).output();
            done(&output.expect("a shell"));
        } else {
            let more = ["--resume", "--quiet", "-o", &file, "--stats", "again.json"];
            done(&run(at, &[&PICTURE[..], &more].concat()));
            let (once, again) = (json(&read(at, "reference.json")), json(&read(at, "again.json")));
            assert_eq!(once["rays"], again["rays"]);
            assert_eq!(once["error"], again["error"]);
        }
        assert!(read(at, &file) == expected, "{name}");
        assert!(!names_in(at).contains(&checkpoint), "it is deleted in the end");
    }
}

/// Random moments: `WHITTED_KILLS=200` for a long run, a handful otherwise.
#[test]
fn killed_at_any_moment_it_goes_on_to_the_same_picture() {
    let rounds = std::env::var("WHITTED_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(4);
    let folder = folder();
    let at = folder.path();
    let mut random = 7_u64;
    let mut uniform = || {
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 40) as f64 / f64::from(1 << 24)
    };
    let mut tally = Tally::default();
    for picture in [&PICTURE, &TOWARDS_ERROR] {
        let started = Instant::now();
        let expected = reference(at, picture, "png");
        let took = started.elapsed();
        for round in 0..rounds / 2 {
            let _ = fs::remove_file(at.join("a.png"));
            let mut moment = || took.mul_f64(0.7 * uniform());
            tally.kill_until_done(at, picture, &mut moment);
            assert!(read(at, "a.png") == expected, "{picture:?}, round {round}");
            assert_eq!(names_in(at), ["a.png", "reference.json"], "{picture:?}, round {round}");
        }
    }
    let Tally { signals, hits, resumed } = tally;
    let told = format!("{rounds} pictures: {signals} signals, {hits} hit, {resumed} resumed\n");
    let _ = std::io::stderr().write_all(told.as_bytes());
    assert!(hits > 0, "no signal came before the end");
}

/// What became of the signals.
#[derive(Default)]
struct Tally {
    signals: usize,
    /// Those that came before the end.
    hits: usize,
    /// Renders that went on from a checkpoint.
    resumed: usize,
}

impl Tally {
    /// Renders `a.png`, killed up to three times after as long as `moment` says, then left alone.
    fn kill_until_done(
        &mut self,
        at: &Path,
        picture: &[&str],
        moment: &mut dyn FnMut() -> Duration,
    ) {
        let file = ["-o", "a.png", "--checkpoint", "0.03", "--resume"];
        let names = ["-KILL", "-INT", "-TERM", "-KILL"];
        for death in 0.. {
            let mut command = whitted(at, &[picture, &file].concat());
            let child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("runs");
            if death < 3 {
                std::thread::sleep(moment());
                signal(&child, names[self.signals % names.len()]);
                self.signals += 1;
            }
            let output = end(child);
            let told = said(&output);
            self.resumed += usize::from(told.contains("going on from"));
            assert_sound(at);
            match output.status.code() {
                Some(0) => return,
                None | Some(130 | 143) => self.hits += 1,
                Some(code) => panic!("{code}: {told}"),
            }
        }
    }
}

#[test]
fn a_checkpoint_of_other_options_is_refused() {
    let folder = folder();
    let at = folder.path();
    let child = until(at, 0.2, &["-o", "a.png"]);
    signal(&child, "-INT");
    refused(&end(child), 130, &["interrupted"]);
    let before = read(at, "a.png.checkpoint");
    let other = ["render", "--size", "400x300", "--aa", "grid:2", "-o", "a.png", "--resume"];
    refused(&run(at, &other), 5, &["a.png.checkpoint", "aa: grid:2 here, adaptive:1.5,4096 there"]);
    let other = [&PICTURE[..], &["-o", "a.png", "--resume", "--fov", "20"]].concat();
    refused(&run(at, &other), 5, &["a.png.checkpoint", "scene: "]);
    assert!(read(at, "a.png.checkpoint") == before, "a refusal changes nothing");
    // Forgetting --resume costs nothing either.
    let again = [&PICTURE[..], &["-o", "a.png", "--checkpoint", "0.01"]].concat();
    let output = run(at, &again);
    done(&output);
    assert!(said(&output).contains("--resume goes on from it"), "{}", said(&output));
    assert!(read(at, "a.png.checkpoint.old") == before);
}

/// What is written is better than one ray in each pixel, says that it is not what was asked for, and goes on.
#[test]
fn a_picture_towards_an_error_or_a_time_is_left_as_it_is() {
    let folder = folder();
    let at = folder.path();
    let small = ["render", "--size", "150x100", "--quiet"];
    for (aa, name) in [("none", "centers.png"), ("grid:8", "truth.png")] {
        done(&run(at, &[&small[..], &["--aa", aa, "-o", name]].concat()));
    }
    let error = |name: &str| {
        let output = run(at, &["compare", name, "truth.png", "--json"]);
        json(&output.stdout)["rmse"].as_f64().expect("a number")
    };
    for (goal, option) in
        [(["--max-error", "0.01"], "max-error=0.01"), (["--time-limit", "600"], "time-limit=600")]
    {
        let arguments = [&["render", "--size", "150x100", "-o", "a.png"][..], &goal].concat();
        let after = |seconds: u64| {
            let _ = fs::remove_file(at.join("a.png.checkpoint"));
            let child = whitted(at, &arguments).stderr(Stdio::piped()).spawn().expect("it runs");
            std::thread::sleep(Duration::from_secs(seconds));
            signal(&child, "-INT");
            let output = end(child);
            refused(
                &output,
                130,
                &["at an estimated error of", "so far: a.png", "a.png.checkpoint", "--resume"],
            );
        };
        // Longer if the machine has other work.
        after(1);
        for seconds in [4, 16] {
            if error("a.png") >= 0.5 * error("centers.png") {
                after(seconds);
            }
        }
        let picture = image::open(at.join("a.png")).expect("a whole PNG");
        assert_eq!(picture.color(), image::ColorType::Rgb8, "{goal:?}: all of it is there");
        assert!(error("a.png") < 0.5 * error("centers.png"), "{}", error("a.png"));
        let label = String::from_utf8_lossy(&read(at, "a.png")).into_owned();
        assert!(label.contains(&format!("{option} interrupted=yes")), "{goal:?}");
        let before = error("a.png");
        assert_eq!(names_in(at), ["a.png", "a.png.checkpoint", "centers.png", "truth.png"]);
        if goal[0] == "--time-limit" {
            // The limit is part of what is asked for, and the checkpoint that of another picture without it.
            refused(
                &run(at, &[&small[..], &["-o", "a.png", "--resume"]].concat()),
                5,
                &["time-limit: not given here"],
            );
            let child = whitted(at, &[&arguments[..], &["--resume"]].concat())
                .stderr(Stdio::piped())
                .spawn()
                .expect("it runs");
            std::thread::sleep(Duration::from_secs(1));
            signal(&child, "-INT");
            refused(&end(child), 130, &["going on from a.png.checkpoint at an estimated error of"]);
            assert!(error("a.png") < before, "{} after {before}", error("a.png"));
        }
        fs::remove_file(at.join("a.png")).expect("deleted");
        fs::remove_file(at.join("a.png.checkpoint")).expect("deleted");
    }
}

/// Before each pixel has its ray there are holes, as in any other picture that is stopped.
#[test]
fn a_picture_towards_a_goal_that_is_stopped_at_once_has_holes() {
    let folder = folder();
    let at = folder.path();
    let goal = ["render", "--size", "2500x2000", "--max-error", "0.01", "-o", "a.png"];
    let arguments = [&goal[..], &["--progress", "json"]].concat();
    let mut child = whitted(at, &arguments).stderr(Stdio::piped()).spawn().expect("it runs");
    let mut lines = BufReader::new(child.stderr.take().expect("piped"));
    lines.read_line(&mut String::new()).expect("its first report");
    signal(&child, "-TERM");
    child.stderr = Some(lines.into_inner());
    refused(&end(child), 143, &["% done", "picture so far: a.png", "--resume"]);
    let picture = image::open(at.join("a.png")).expect("a whole PNG").into_rgba8();
    let clear = picture.pixels().filter(|pixel| pixel.0[3] == 0).count();
    assert!(clear > 0 && clear < 2500 * 2000, "{clear} transparent");
    assert_eq!(names_in(at), ["a.png", "a.png.checkpoint"]);
}

/// Whether a temporary file is in the folder.
fn is_written_in(at: &Path) -> bool {
    names_in(at).iter().any(|name| name.starts_with(".whitted-"))
}

/// A render of a picture that takes a moment to write, given `name` as soon as a temporary file is there.
fn signalled_while_it_writes(at: &Path, name: &str) -> Child {
    let big = ["render", "--aa", "none", "--size", "1500x1500", "-o", "a.exr", "--quiet"];
    let mut child = whitted(at, &big).spawn().expect("it runs");
    while !is_written_in(at) {
        assert!(child.try_wait().expect("known").is_none(), "it ended without a temporary file");
    }
    signal(&child, name);
    child
}

#[test]
fn what_a_killed_program_left_is_deleted_by_the_next_one() {
    let folder = folder();
    let at = folder.path();
    let small = ["render", "--size", "8x6", "-o", "b.png", "--quiet"];
    let mut left = 0;
    while left < 3 {
        let mut child = signalled_while_it_writes(at, "-KILL");
        child.wait().expect("it ends");
        // At the start, when it finds out whether it can write, there is a temporary file for but a moment.
        left += usize::from(is_written_in(at));
        done(&run(at, &small));
        assert_eq!(names_in(at), ["b.png"]);
    }
    // What one that only sleeps writes is kept.
    let mut is_kept = false;
    while !is_kept {
        let child = signalled_while_it_writes(at, "-STOP");
        wait_until_it_sleeps(&child);
        let before = names_in(at);
        is_kept = is_written_in(at);
        done(&run(at, &small));
        assert_eq!(names_in(at), before);
        signal(&child, "-CONT");
        done(&end(child));
    }
}

#[test]
fn tiles_that_are_stopped_go_on_where_they_were() {
    let folder = folder();
    let at = folder.path();
    let expected = reference(at, &PICTURE, "png");
    let tiles = ["--tile", "1/3,2/3,3/3", "-o", "a.png"];
    // The second tile is in work when the first is finished.
    let mut child = until(at, 1.0, &tiles);
    std::thread::sleep(Duration::from_millis(100));
    signal(&child, "-INT");
    let mut rest = String::new();
    let _ = child.stderr.take().expect("piped").read_to_string(&mut rest);
    assert_eq!(child.wait().expect("it ends").code(), Some(130), "{rest}");
    assert!(at.join("a-1of3.png").exists() && !at.join("a-3of3.png").exists());
    let output = run(at, &[&PICTURE[..], &tiles, &["--resume"]].concat());
    done(&output);
    assert!(said(&output).contains("a-1of3.png is finished already"), "{}", said(&output));
    done(&run(at, &["merge", "a-1of3.png", "a-2of3.png", "a-3of3.png", "-o", "all.png"]));
    assert!(read(at, "all.png") == expected);
}
