//! `whitted completions`: the script that lets a shell complete commands and flags.

use clap::CommandFactory;

use super::args::{Args, CompletionsArgs};
use super::failure::Failure;
use super::streams;

pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "whitted", &mut script);
    streams::print(&script)
}
