//! What ends a command early: one line for the user, an exit code for scripts.

use std::fmt;
use std::process::ExitCode;

use clap::error::ErrorKind;
use whitted::film::ImageError;
use whitted::scene::obj::ModelError;
use whitted::scene::{SceneError, Warning};

use super::streams;

/// The exit codes for what went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    /// The render or the writing failed.
    Failed = 1,
    /// The command was not used as it should be.
    Usage = 2,
    /// The scene or a model is invalid.
    Scene = 3,
    /// What would be a warning is an error, as the user wished.
    Strict = 4,
    /// A checkpoint, or the parts of a picture, do not belong together.
    Mismatch = 5,
    /// Two pictures differ by more than they may.
    OverLimit = 6,
    /// Ctrl-C.
    Interrupted = 130,
    /// SIGTERM.
    Terminated = 143,
}

/// Why a command did not do what it should; displays as one line.
#[derive(Debug)]
pub(crate) struct Failure {
    exit: Exit,
    error: anyhow::Error,
}

impl Failure {
    /// A fault in how the command was called.
    pub(crate) fn usage(error: impl Into<anyhow::Error>) -> Self {
        Self { exit: Exit::Usage, error: error.into() }
    }

    /// A checkpoint of another picture, or parts that do not make one.
    pub(crate) fn mismatch(error: impl Into<anyhow::Error>) -> Self {
        Self { exit: Exit::Mismatch, error: error.into() }
    }

    /// A render that a signal ended; `text` goes on from "interrupted".
    pub(crate) fn stopped(signal: u8, text: &str) -> Self {
        let (exit, word) = match signal {
            2 => (Exit::Interrupted, "interrupted"),
            _ => (Exit::Terminated, "terminated"),
        };
        Self { exit, error: anyhow::anyhow!("{word} {text}") }
    }

    /// The line for the user.
    pub(crate) fn line(&self) -> String {
        match self.exit {
            // Who stops a render knows; what was kept is on lines of its own.
            Exit::Interrupted | Exit::Terminated => self.error.to_string(),
            _ => format!("error: {self}"),
        }
    }

    /// Pictures that differ by more than they may.
    pub(crate) fn over_limit(error: impl Into<anyhow::Error>) -> Self {
        Self { exit: Exit::OverLimit, error: error.into() }
    }

    /// What clap found, without its usage lines, which `--help` shows better.
    pub(crate) fn from_clap(error: &clap::Error) -> Self {
        let hint = match error.kind() {
            // No command at all: clap gives the whole help here.
            ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                return Self::usage(anyhow::anyhow!(
                    "no command given; try `whitted render`, or `whitted --help` for all commands"
                ));
            }
            ErrorKind::UnknownArgument | ErrorKind::InvalidSubcommand => "see `--help`",
            _ => "",
        };
        Self::usage(anyhow::Error::msg(one_line(&error.to_string(), hint)))
    }

    /// A warning that the user wants to be an error.
    pub(crate) fn strict(warning: String) -> Self {
        Self { exit: Exit::Strict, error: anyhow::Error::msg(warning) }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.exit as u8)
    }
}

/// Tells the user of `warnings`, or fails for them.
pub(crate) fn warn(warnings: &[Warning], strict: bool, quiet: bool) -> Result<(), Failure> {
    if strict && !warnings.is_empty() {
        let lines: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        return Err(Failure::strict(lines.join("; ")));
    }
    if !quiet {
        for warning in warnings {
            streams::note(&escaped(&format!("warning: {warning}")));
        }
    }
    Ok(())
}

/// A file name may hold anything, and a message is to stay on its line.
pub(crate) fn escaped(text: &str) -> String {
    let letters = text.trim_end().chars();
    let escape = |letter: char| {
        if letter.is_control() { letter.escape_debug().to_string() } else { letter.to_string() }
    };
    letters.map(escape).collect()
}

/// Whatever has no better code, such as a render that failed.
impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        let error = error.into();
        let exit = match (error.downcast_ref::<ImageError>(), error.downcast_ref::<SceneError>()) {
            (Some(ImageError::UnknownExtension { .. }), _)
            | (
                _,
                Some(
                    SceneError::UnknownScene { .. }
                    | SceneError::UnknownFile { .. }
                    | SceneError::NotGenerated { .. },
                ),
            ) => Exit::Usage,
            (_, Some(_)) => Exit::Scene,
            _ if error.is::<ModelError>() => Exit::Scene,
            _ => Exit::Failed,
        };
        Self { exit, error }
    }
}

impl fmt::Display for Failure {
    /// The error and its causes, as far as the text before does not name them already.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = self.error.to_string();
        for cause in self.error.chain().skip(1).map(ToString::to_string) {
            if !text.contains(&cause) {
                text = format!("{text}: {cause}");
            }
        }
        // Faults of a scene file show its lines; they come with their control characters replaced.
        if let Some(SceneError::Invalid(_)) = self.error.downcast_ref::<SceneError>() {
            return f.write_str(&text);
        }
        f.write_str(&escaped(&text))
    }
}

/// The lines of clap's message joined to one, without `error:` and the lines on usage; `hint` is
/// added where clap has no advice of its own.
fn one_line(message: &str, hint: &str) -> String {
    let mut lines = message.lines().map(str::trim).filter(|line| {
        !line.is_empty() && !line.starts_with("Usage:") && !line.starts_with("For more information")
    });
    let mut text = lines.next().unwrap_or_default().trim_start_matches("error: ").to_owned();
    let mut advised = false;
    for line in lines {
        let joint = if text.ends_with(':') || line.starts_with('[') { " " } else { "; " };
        text = format!("{text}{joint}{}", line.trim_start_matches("tip: "));
        advised = true;
    }
    if advised || hint.is_empty() { text } else { format!("{text}; {hint}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn clap_messages_become_one_line_that_keeps_the_advice() {
        let message = "error: unexpected argument '--sise' found\n\n  tip: a similar argument \
            exists: '--size'\n\nUsage: whitted render --size <WxH> [SCENE]\n\nFor more information, \
            try '--help'.\n";
        let expected = "unexpected argument '--sise' found; a similar argument exists: '--size'";
        assert_eq!(one_line(message, "see `--help`"), expected);
        assert_eq!(one_line("error: no\n\nUsage: x\n", "see `--help`"), "no; see `--help`");
        let values =
            "error: invalid value 'x' for '--progress <MODE>'\n  [possible values: a, b]\n";
        assert_eq!(
            one_line(values, ""),
            "invalid value 'x' for '--progress <MODE>' [possible values: a, b]"
        );
        let missing = "error: required arguments were not provided:\n  --output <FILE>\n";
        assert_eq!(one_line(missing, ""), "required arguments were not provided: --output <FILE>");
    }

    #[test]
    fn causes_are_named_once_and_control_characters_escaped() {
        let failure: Failure = anyhow::anyhow!("disk full").context("a\nb: not written").into();
        assert_eq!(failure.to_string(), "a\\nb: not written: disk full");
        let result: Result<(), _> = Err(anyhow::anyhow!("disk full"));
        let failure: Failure =
            result.context("not written (disk full)").expect_err("failed").into();
        assert_eq!(failure.to_string(), "not written (disk full)");
    }
}
