//! The command line: the only code that prints, exits, or knows clap.

mod args;
mod compare;
mod completions;
mod failure;
mod finished;
mod goal;
mod inspect;
mod inspect_scene;
mod job;
mod man;
mod memory;
mod merge;
mod options;
mod parse;
mod preview;
mod progress;
mod render;
mod scenes;
mod signals;
mod stats;
mod streams;
mod study;
mod target;
mod threads;
mod view;
mod warnings;
mod watch;

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;

use args::{Args, Command};
use failure::Failure;

/// Runs the command that the program was started with, and says on one line what went wrong.
pub(crate) fn run() -> ExitCode {
    let started = Instant::now();
    let done = match Args::try_parse() {
        Ok(args) => perform(&args.command, started),
        Err(error) if error.use_stderr() => Err(Failure::from_clap(&error)),
        Err(help_or_version) => streams::print(help_or_version.to_string().as_bytes()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            streams::note(&failure.line());
            failure.exit_code()
        }
    }
}

fn perform(command: &Command, started: Instant) -> Result<(), Failure> {
    threads::limit(command.threads())?;
    match command {
        Command::Render(args) => render::run(args, started),
        Command::Compare(args) => compare::run(args),
        Command::Study(args) => study::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Scenes(args) => scenes::run(args),
        Command::View(args) => view::run(args),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => man::run(args),
    }
}
