//! The program as a user meets it: what it says, what it writes, and the codes it ends with.
#![cfg(feature = "cli")]

mod compare;
mod gallery;
mod goals;
mod pictures;
mod places;
#[path = "../program/mod.rs"]
mod program;
mod statistics;
mod streams;
mod usage;

use std::path::Path;
use std::process::Output;

use program::{run, said, text};

/// The arguments of a picture that takes no time.
const SMALL: [&str; 5] = ["render", "--size", "8x6", "--aa", "grid:2"];

/// Runs a small render with further arguments.
fn render(folder: &Path, arguments: &[&str]) -> Output {
    run(folder, &[&SMALL, arguments].concat())
}

/// The program ended with `code`, one line on standard error that holds all of `parts`, and
/// nothing on standard output.
#[track_caller]
fn assert_refused(output: &Output, code: i32, parts: &[&str]) {
    let message = said(output);
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
