//! What is done beside a render: checkpoints, what is said of a signal, the preview in a terminal.

use std::{
    sync::{
        Condvar, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use whitted::checkpoint::Job;
use whitted::render::Progress;

use super::preview::Terminal;
use super::warnings::Warnings;

/// How often a signal is looked for.
const WATCH: Duration = Duration::from_millis(100);
/// How often the preview is drawn.
const PREVIEW: Duration = Duration::from_millis(300);

/// How far a render is, for whoever shows it.
#[derive(Debug, Default)]
pub(crate) struct Course {
    percent: AtomicU64,
    has_ended: Mutex<bool>,
    ended: Condvar,
}

impl Course {
    pub(crate) fn report(&self, progress: Progress) {
        self.percent.store(100 * progress.done / progress.total.max(1), Ordering::Relaxed);
    }

    pub(crate) fn percent(&self) -> u64 {
        self.percent.load(Ordering::Relaxed)
    }

    /// What, when it is dropped, tells that the render is over; a panic drops it too.
    pub(crate) fn end_of(&self) -> End<'_> {
        End(self)
    }

    #[cfg(feature = "view")]
    pub(crate) fn has_ended(&self) -> bool {
        *self.has_ended.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the end, but not longer than `time`; whether it came.
    fn wait(&self, time: Duration) -> bool {
        let guard = self.has_ended.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.ended.wait_timeout_while(guard, time, |has_ended| !*has_ended);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

/// The end of a render.
pub(crate) struct End<'a>(&'a Course);

impl Drop for End<'_> {
    fn drop(&mut self) {
        *self.0.has_ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.ended.notify_all();
    }
}

/// Who looks after a render.
pub(crate) struct Watcher<'a> {
    pub(crate) job: &'a Job<'a>,
    pub(crate) course: &'a Course,
    /// Whether a signal came.
    pub(crate) stop: &'a AtomicBool,
    /// Between two checkpoints.
    pub(crate) interval: Duration,
    /// What is said when a signal comes.
    pub(crate) stopping: &'a str,
    /// Tells the user.
    pub(crate) note: &'a (dyn Fn(&str) + Sync),
    pub(crate) warnings: &'a Warnings,
    /// Tells how far it is, where nothing new has told that for long.
    pub(crate) tick: &'a (dyn Fn() + Sync),
}

impl Watcher<'_> {
    /// Watches until the render ends.
    pub(crate) fn watch(&self, mut terminal: Option<&mut Terminal>) {
        let (mut saved, mut drawn) = (Instant::now(), Instant::now());
        let (mut has_told, mut has_failed) = (false, false);
        while !self.course.wait(WATCH) {
            if let Some(terminal) = terminal.as_deref_mut()
                && drawn.elapsed() >= PREVIEW
            {
                terminal.draw(self.job, self.course.percent());
                drawn = Instant::now();
            }
            if !self.stop.load(Ordering::Relaxed) {
                (self.tick)();
            } else if !has_told {
                has_told = true;
                (self.note)(self.stopping);
            }
            if saved.elapsed() >= self.interval {
                let done = self.job.save();
                saved = Instant::now();
                if let Err(error) = &done
                    && !has_failed
                {
                    self.warnings.add(format!("no checkpoint for now: {error}"));
                }
                has_failed = done.is_err();
            }
        }
        if let Some(terminal) = terminal {
            terminal.draw(self.job, self.course.percent());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whoever waits for the end of a render would otherwise wait for ever.
    #[test]
    fn a_panic_ends_a_render() {
        let course = Course::default();
        assert!(!course.wait(Duration::ZERO));
        let panic = std::panic::catch_unwind(|| {
            let _end = course.end_of();
            panic!("a render that fails");
        });
        assert!(panic.is_err() && course.wait(Duration::ZERO));
    }
}
