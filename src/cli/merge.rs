//! `whitted merge`: one picture of parts.

use whitted::film::{MergeError, OutputFile, merge};

use super::args::MergeArgs;
use super::failure::Failure;
use super::streams;
use super::target::check_spared;

/// Joins the parts that `args` name.
pub(crate) fn run(args: &MergeArgs) -> Result<(), Failure> {
    let output = OutputFile::prepare(&args.output)?;
    check_spared("--output", output.file(), "which is one of the parts", &args.parts)?;
    let [width, height] = merge(&args.parts, &output).map_err(|error| match error {
        MergeError::NoParts | MergeError::TooFewBits { .. } => Failure::usage(error),
        MergeError::NoLabel { .. }
        | MergeError::Unfinished { .. }
        | MergeError::Differs { .. }
        | MergeError::Overlap { .. }
        | MergeError::Gap { .. } => Failure::mismatch(error),
        other => other.into(),
    })?;
    if !args.quiet {
        streams::note(&format!(
            "wrote {}: {width}x{height} pixels of {} part{}",
            output.file().path().display(),
            args.parts.len(),
            if args.parts.len() == 1 { "" } else { "s" }
        ));
    }
    Ok(())
}
