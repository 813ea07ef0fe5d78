//! Tests of the whole library against answers that it did not compute.

mod determinism;
mod extremes;
mod objects;
mod references;
mod support;
