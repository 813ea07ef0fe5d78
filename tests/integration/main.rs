//! Tests of the whole library against answers that it did not compute: one binary, a module for each behaviour.

#![allow(clippy::print_stdout, reason = "a test's table is read with --nocapture")]

mod antialiasing;
mod determinism;
mod extremes;
mod leaks;
mod numerics;
mod objects;
mod recursion;
mod references;
#[cfg(feature = "cli")]
mod study;
mod support;
