//! The library from outside: one binary, a module for each behaviour.

#![allow(clippy::print_stdout, reason = "a test's table is read with --nocapture")]

mod numerics;
