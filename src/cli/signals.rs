//! Ctrl-C and SIGTERM: the first one asks, a later one ends the program at once.

use std::{
    io,
    sync::{
        Arc, Once,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};

/// Signals that come within this time of the first are taken for the same: `timeout` sends its signal to the program
/// and to the group that it is in.
const ONE_SIGNAL: Duration = Duration::from_millis(500);
/// How often the first signal is looked for.
const LOOK: Duration = Duration::from_millis(50);

/// What signals have come.
#[derive(Debug)]
pub(crate) struct Signals {
    /// Whether a signal ends the program at once.
    at_once: Arc<AtomicBool>,
    /// Whether one came.
    stop: Arc<AtomicBool>,
    /// The last one that came, 0 before.
    last: Arc<AtomicUsize>,
    deferred: Once,
}

impl Signals {
    /// From now on signals end the program with 128 and their number for its exit code, as shells do.
    pub(crate) fn watch() -> io::Result<Self> {
        let signals = Self {
            at_once: Arc::new(AtomicBool::new(true)),
            stop: Arc::default(),
            last: Arc::default(),
            deferred: Once::new(),
        };
        for signal in [SIGINT, SIGTERM] {
            flag::register_conditional_shutdown(
                signal,
                128 + signal,
                Arc::clone(&signals.at_once),
            )?;
            flag::register_usize(signal, Arc::clone(&signals.last), signal as usize)?;
            flag::register(signal, Arc::clone(&signals.stop))?;
        }
        Ok(signals)
    }

    /// From now on the first signal, and those that are taken for the same, only set the flag that is returned; one
    /// after them ends the program at once.
    pub(crate) fn defer(&self) -> &AtomicBool {
        self.deferred.call_once(|| {
            self.at_once.store(false, Ordering::SeqCst);
            let (at_once, stop) = (Arc::clone(&self.at_once), Arc::clone(&self.stop));
            thread::spawn(move || {
                while !stop.load(Ordering::SeqCst) {
                    thread::sleep(LOOK);
                }
                thread::sleep(ONE_SIGNAL);
                at_once.store(true, Ordering::SeqCst);
            });
        });
        &self.stop
    }

    /// The signal that came, if any did.
    pub(crate) fn received(&self) -> Option<u8> {
        match self.last.load(Ordering::SeqCst) {
            0 => None,
            signal => Some(signal as u8),
        }
    }
}
