//! `whitted man`: the help texts as manual pages.

use std::fs;

use anyhow::{Context, anyhow};
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use whitted::film::WholeFile;

use super::args::{Args, ManArgs};
use super::failure::Failure;
use super::streams;

pub(crate) fn run(args: &ManArgs) -> Result<(), Failure> {
    let mut program = Args::command().disable_help_subcommand(true);
    program.build();
    if let Some(folder) = &args.folder {
        fs::create_dir_all(folder)
            .with_context(|| format!("{}: the folder cannot be created", folder.display()))?;
        for command in std::iter::once(&program).chain(program.get_subcommands()) {
            let page = page(command)?;
            let file = WholeFile::prepare(folder.join(format!("{}.1", name(command))))?;
            file.commit(|writer| writer.write_all(&page))?;
        }
        return Ok(());
    }
    let Some(about) = &args.about else { return streams::print(&page(&program)?) };
    let command = program.find_subcommand(about).ok_or_else(|| {
        let known: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
        Failure::usage(anyhow!("there is no command `{about}`; choose one of {}", known.join(", ")))
    })?;
    streams::print(&page(command)?)
}

/// The name of a command's page.
fn name(command: &Command) -> String {
    command.get_display_name().unwrap_or(command.get_name()).to_owned()
}

fn page(command: &Command) -> Result<Vec<u8>, Failure> {
    let mut page = Vec::new();
    Man::new(command.clone()).title(name(command).to_uppercase()).render(&mut page)?;
    Ok(page)
}
