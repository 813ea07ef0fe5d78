//! Ctrl-C and SIGTERM: the first one asks, the second one ends the program at once.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};

/// What signals have come.
#[derive(Clone, Debug)]
pub(crate) struct Signals {
    /// Whether a signal ends the program at once; each one makes it so for the next.
    at_once: Arc<AtomicBool>,
    /// The last one that came, 0 before.
    last: Arc<AtomicUsize>,
}

impl Signals {
    /// From now on signals end the program with 128 and their number for its exit code, as shells do.
    pub(crate) fn watch() -> io::Result<Self> {
        let signals =
            Self { at_once: Arc::new(AtomicBool::new(true)), last: Arc::new(AtomicUsize::new(0)) };
        for signal in [SIGINT, SIGTERM] {
            // In this order: the first one to come finds the flag as it was before.
            flag::register_conditional_shutdown(
                signal,
                128 + signal,
                Arc::clone(&signals.at_once),
            )?;
            flag::register_usize(signal, Arc::clone(&signals.last), signal as usize)?;
            flag::register(signal, Arc::clone(&signals.at_once))?;
        }
        Ok(signals)
    }

    /// From now on the first signal only sets the flag that is returned.
    pub(crate) fn defer(&self) -> &AtomicBool {
        self.at_once.store(false, Ordering::SeqCst);
        &self.at_once
    }

    /// The signal that came, if any did.
    pub(crate) fn received(&self) -> Option<u8> {
        match self.last.load(Ordering::SeqCst) {
            0 => None,
            signal => Some(signal as u8),
        }
    }
}
