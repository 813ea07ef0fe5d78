//! Long renders: stopped, killed, resumed, cut into tiles and joined, and told about.
#![cfg(feature = "cli")]

mod damage;
#[cfg(unix)]
mod disk;
mod files;
mod goals;
mod parts;
#[path = "../program/mod.rs"]
mod program;
#[cfg(unix)]
mod signals;
#[cfg(unix)]
mod stop;
mod strict;
mod tell;

use std::process::Output;

use program::{done, folder, json, names_in, read, run, said, whitted};

/// It ended with `code`, and what it said holds all of `parts`.
#[track_caller]
fn refused(output: &Output, code: i32, parts: &[&str]) {
    let message = said(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for part in parts {
        assert!(message.contains(part), "no `{part}` in {message}");
    }
}
