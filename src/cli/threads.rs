//! How many threads work.

use std::num::NonZeroUsize;

use anyhow::anyhow;
use rayon::ThreadPoolBuilder;

use super::failure::Failure;

/// Has scenes be read and built, and files be compressed, by so many threads instead of one for each core.
///
/// A render starts as many of its own, while these sleep. Only once in a program, before anything else.
pub(crate) fn limit(threads: Option<NonZeroUsize>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    ThreadPoolBuilder::new()
        .num_threads(threads.get())
        .build_global()
        .map_err(|error| anyhow!("{threads} threads cannot be started: {error}").into())
}
