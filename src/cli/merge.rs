//! `whitted merge`: one picture of parts.

use std::fs::File;
use std::io;
use std::path::Path;

use anyhow::{Context, anyhow};
use whitted::film::{MergeError, OutputFile, merge};
use whitted::scene::STANDARD_INPUT;

use super::args::MergeArgs;
use super::failure::Failure;
use super::streams;
use super::target::{Picture, check_spared};

/// Joins the parts that `args` name.
pub(crate) fn run(args: &MergeArgs) -> Result<(), Failure> {
    if args.parts.iter().any(|part| part == Path::new(STANDARD_INPUT)) {
        return Err(Failure::usage(anyhow!("a part cannot come from standard input; name a file")));
    }
    let picture = Picture::prepare(Some(&args.output), "", None, false)?;
    let [width, height] = match &picture {
        Picture::File(output) => {
            check_spared("--output", output.file(), "which is one of the parts", &args.parts)?;
            join(args, output)?
        }
        Picture::Stdout => to_stdout(args)?,
    };
    if !args.quiet {
        streams::note(&format!(
            "wrote {}: {width}x{height} pixels of {} part{}",
            picture.name(),
            args.parts.len(),
            if args.parts.len() == 1 { "" } else { "s" }
        ));
    }
    Ok(())
}

/// Joins the parts in a temporary file, since the whole may be larger than the memory, and copies that.
fn to_stdout(args: &MergeArgs) -> Result<[u32; 2], Failure> {
    let folder = tempfile::tempdir().context("there is no place for temporary files")?;
    let whole = folder.path().join("whole.png");
    let size = join(args, &OutputFile::prepare(&whole)?)?;
    let mut whole = File::open(&whole).context("the temporary file cannot be read")?;
    streams::to_stdout(|stdout| io::copy(&mut whole, stdout).map(drop))?;
    Ok(size)
}

fn join(args: &MergeArgs, output: &OutputFile) -> Result<[u32; 2], Failure> {
    merge(&args.parts, output).map_err(|error| match error {
        MergeError::NoParts | MergeError::TooFewBits { .. } => Failure::usage(error),
        MergeError::NoLabel { .. }
        | MergeError::Unfinished { .. }
        | MergeError::Differs { .. }
        | MergeError::Overlap { .. }
        | MergeError::Gap { .. } => Failure::mismatch(error),
        other => other.into(),
    })
}
