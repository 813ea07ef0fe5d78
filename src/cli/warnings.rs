//! What a render warns of.

use std::sync::{Mutex, PoisonError};

use super::args::{ProgressMode, RenderArgs};
use super::failure::{Failure, escaped};
use super::streams;

/// Where all warnings of a render go: to the user at once, or under `--strict` into the error that they are.
pub(crate) struct Warnings {
    manner: Manner,
    /// Those that are errors.
    held: Mutex<Vec<String>>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Manner {
    Strict,
    Quiet,
    Json,
    Plain,
}

impl Warnings {
    pub(crate) fn new(args: &RenderArgs) -> Self {
        let manner = match args.progress {
            _ if args.strict => Manner::Strict,
            _ if args.quiet => Manner::Quiet,
            ProgressMode::Json => Manner::Json,
            _ => Manner::Plain,
        };
        Self { manner, held: Mutex::default() }
    }

    /// Tells the user of it, or keeps it for [`Self::check`].
    pub(crate) fn add(&self, warning: String) {
        match self.manner {
            Manner::Strict => {
                self.held.lock().unwrap_or_else(PoisonError::into_inner).push(warning);
            }
            Manner::Quiet => {}
            Manner::Json => {
                streams::note(&serde_json::json!({ "warning": warning }).to_string());
            }
            Manner::Plain => streams::note(&escaped(&format!("warning: {warning}"))),
        }
    }

    /// Fails under `--strict` if there was a warning.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        if held.is_empty() { Ok(()) } else { Err(Failure::strict(held.join("; "))) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strict_warnings_are_one_error() {
        let warnings = |manner| Warnings { manner, held: Mutex::default() };
        let strict = warnings(Manner::Strict);
        assert!(strict.check().is_ok());
        for warning in ["no room", "too late"] {
            strict.add(warning.to_owned());
        }
        assert_eq!(strict.check().expect_err("two").line(), "error: no room; too late");
        let quiet = warnings(Manner::Quiet);
        quiet.add("no room".to_owned());
        assert!(quiet.check().is_ok());
    }
}
