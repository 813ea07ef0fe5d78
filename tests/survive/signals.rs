//! Which signals ask, and which end the program at once.

use std::fs;
use std::io::Read;
use std::process::Stdio;
use std::time::{Duration, Instant};

use super::stop::{PICTURE, end, reference, signal, until, wait_until_it_sleeps};
use super::{done, folder, names_in, read, run, said, whitted};

/// Signals to a program that sleeps come at the same moment when it wakes, as the two of `timeout` do.
#[test]
fn signals_that_come_together_are_one() {
    let folder = folder();
    let at = folder.path();
    let expected = reference(at, &PICTURE, "png");
    let child = until(at, 0.3, &["-o", "a.png"]);
    signal(&child, "-STOP");
    wait_until_it_sleeps(&child);
    for name in ["-INT", "-TERM", "-CONT"] {
        signal(&child, name);
    }
    let output = end(child);
    assert!(matches!(output.status.code(), Some(130 | 143)), "{}", said(&output));
    assert!(said(&output).contains("checkpoint: a.png.checkpoint"), "{}", said(&output));
    done(&run(at, &[&PICTURE[..], &["-o", "a.png", "--resume"]].concat()));
    assert!(read(at, "a.png") == expected);
}

/// One block of 16 x 16 pixels with a million rays each: it does not end before a signal comes that is late enough to
/// end it at once.
#[test]
fn a_later_signal_stops_at_once_and_leaves_old_files_whole() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("a.png"), "old").expect("written");
    let endless = ["render", "--size", "16x16", "--aa", "sobol:1048576", "-o", "a.png"];
    let mut child = whitted(at, &endless).stderr(Stdio::piped()).spawn().expect("it runs");
    std::thread::sleep(Duration::from_millis(700));
    signal(&child, "-INT");
    let mut told = [0; 9];
    let mut pipe = child.stderr.take().expect("piped");
    pipe.read_exact(&mut told).expect("it says something");
    assert_eq!(&told, b"stopping:");
    let started = Instant::now();
    let code = loop {
        signal(&child, "-TERM");
        if let Some(status) = child.try_wait().expect("a child") {
            break status.code();
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    assert_eq!(code, Some(143));
    assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());
    assert_eq!(read(at, "a.png"), b"old");
    assert_eq!(names_in(at), ["a.png"]);
}

/// While the scene is read there is nothing to keep.
#[test]
fn a_signal_before_the_render_ends_the_program_with_its_code() {
    let folder = folder();
    let scene = ["render", "spheres", "--objects", "3000000", "--size", "8x8"];
    let child = whitted(folder.path(), &scene).stderr(Stdio::null()).spawn().expect("it runs");
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    assert_eq!(end(child).status.code(), Some(130));
    assert_eq!(names_in(folder.path()), [""; 0]);
}
