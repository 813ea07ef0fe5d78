//! How far a render is, on standard error.

mod report;
mod terminal;

use std::io::{self, IsTerminal};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use whitted::render::Progress;

use super::args::ProgressMode;
use super::streams;
use report::{Report, bar_text, json_line, openjd_lines, plain_line};
use terminal::AnyStderr;

const PLAIN_INTERVAL: Duration = Duration::from_secs(5);
const JSON_INTERVAL: Duration = Duration::from_millis(100);
const OPENJD_INTERVAL: Duration = Duration::from_secs(1);
const BAR_INTERVAL: Duration = Duration::from_millis(100);

/// Tells the user how far a render is; to be called from any thread.
pub(crate) struct Reporter {
    kind: Kind,
    /// Pixels of the picture.
    pixels: f64,
    clock: Mutex<Clock>,
}

enum Kind {
    /// Says nothing.
    Silent,
    /// A bar that draws itself anew.
    Bar(ProgressBar),
    /// Lines, not too many.
    Lines(Lines),
}

/// When and from where the render went on.
struct Clock {
    started: Instant,
    /// The share that was done then.
    share: f64,
    /// The furthest report since, if there was any.
    latest: Option<Progress>,
    /// When something was shown last, and how far the render was.
    last: (Instant, u64),
}

impl Reporter {
    /// A reporter of a picture of so many pixels, whose time runs from now; it shows nothing until the first report.
    pub(crate) fn new(mode: ProgressMode, pixels: f64) -> Self {
        let terminal = io::stderr().is_terminal();
        let can_draw = std::env::var_os("TERM").is_none_or(|name| name != "dumb");
        let kind = match mode {
            ProgressMode::None => Kind::Silent,
            ProgressMode::Auto if terminal && can_draw => bar(ProgressDrawTarget::stderr()),
            ProgressMode::Bar if terminal => bar(ProgressDrawTarget::stderr()),
            ProgressMode::Bar => bar(ProgressDrawTarget::term_like(Box::new(AnyStderr))),
            ProgressMode::Auto | ProgressMode::Plain => Kind::Lines(Lines {
                format: plain_line,
                interval: PLAIN_INTERVAL,
                tells_end: false,
                repeats: true,
            }),
            ProgressMode::Json => Kind::Lines(Lines {
                format: json_line,
                interval: JSON_INTERVAL,
                tells_end: true,
                repeats: false,
            }),
            ProgressMode::Openjd => Kind::Lines(Lines {
                format: openjd_lines,
                interval: OPENJD_INTERVAL,
                tells_end: true,
                repeats: false,
            }),
        };
        let started = Instant::now();
        Self {
            kind,
            pixels,
            clock: Mutex::new(Clock { started, share: 0.0, latest: None, last: (started, 0) }),
        }
    }

    /// The render begins now, and a share of it was done before.
    pub(crate) fn begin(&self, share: f64) {
        let mut clock = self.clock.lock().unwrap_or_else(PoisonError::into_inner);
        *clock = Clock { started: Instant::now(), share, ..*clock };
    }

    /// Takes note of a report from the render.
    pub(crate) fn report(&self, progress: &Progress) {
        let due = |interval, tells_end| self.due(progress, interval, tells_end, Instant::now());
        match &self.kind {
            Kind::Silent => {}
            Kind::Bar(bar) => {
                if let Some(report) = due(BAR_INTERVAL, true) {
                    bar.set_length(report.total);
                    bar.set_position(report.done);
                    bar.set_message(bar_text(&report));
                }
            }
            Kind::Lines(lines) => {
                if let Some(report) = due(lines.interval, lines.tells_end) {
                    streams::note(&(lines.format)(&report));
                }
            }
        }
    }

    /// Shows the last report again where that is due; to be called now and then.
    pub(crate) fn tick(&self) {
        if let Kind::Lines(lines) = &self.kind
            && lines.repeats
            && let Some(report) = self.overdue(lines.interval, Instant::now())
        {
            streams::note(&(lines.format)(&report));
        }
    }

    /// Takes the bar away, to make room for what is said at the end.
    pub(crate) fn end(&self) {
        if let Kind::Bar(bar) = &self.kind {
            bar.finish_and_clear();
        }
    }

    /// The report due at the moment `now`, if any; `tells_end` is whether the last one comes although the pause is not
    /// over.
    fn due(
        &self,
        progress: &Progress,
        interval: Duration,
        tells_end: bool,
        now: Instant,
    ) -> Option<Report> {
        let &Progress { done, total } = progress;
        // A thread that died while it held the lock left numbers that are still good.
        let mut clock = self.clock.lock().unwrap_or_else(PoisonError::into_inner);
        // Reports of several threads may overtake each other.
        if clock.latest.is_none_or(|latest| latest.done < done) {
            clock.latest = Some(*progress);
        }
        let is_end = tells_end && done >= total;
        let is_due = now.saturating_duration_since(clock.last.0) >= interval;
        if done <= clock.last.1 || !(is_due || is_end) {
            return None;
        }
        Some(self.take(&mut clock, now))
    }

    /// The last report once more, if nothing was shown for so long.
    fn overdue(&self, interval: Duration, now: Instant) -> Option<Report> {
        let mut clock = self.clock.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = now.saturating_duration_since(clock.last.0) >= interval;
        is_due.then(|| self.take(&mut clock, now))
    }

    /// What there is to show at the moment `now`, which is noted.
    fn take(&self, clock: &mut Clock, now: Instant) -> Report {
        let elapsed = now.saturating_duration_since(clock.started).as_secs_f64();
        let Progress { done, total } = clock.latest.unwrap_or(Progress { done: 0, total: 0 });
        clock.last = (now, done);
        let share = if total == 0 { clock.share } else { done as f64 / total as f64 };
        Report { done, total, share, elapsed, fresh: share - clock.share, pixels: self.pixels }
    }
}

fn bar(target: ProgressDrawTarget) -> Kind {
    let bar = ProgressBar::with_draw_target(None, target);
    let color = if streams::wants_color() { ":.cyan" } else { "" };
    let template = format!("{{wide_bar{color}}} {{percent:>3}} %  {{msg}}");
    let style = ProgressStyle::with_template(&template);
    bar.set_style(style.expect("a template indicatif knows"));
    Kind::Bar(bar)
}

/// The bar goes when the render ends, however it ends, to make room for what is said then.
impl Drop for Reporter {
    fn drop(&mut self) {
        self.end();
    }
}

/// Progress as lines with a pause between them.
struct Lines {
    format: fn(&Report) -> String,
    interval: Duration,
    tells_end: bool,
    /// Whether a line comes after the pause even if there is nothing new, as on a long step of a render towards a goal.
    repeats: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines that reports of `(seconds, done)` out of 100 give, of which a share was done before.
    fn lines_of(mode: ProgressMode, share: f64, reports: &[(f64, u64)]) -> Vec<String> {
        let reporter = Reporter::new(mode, 1e6);
        reporter.begin(share);
        let started = reporter.clock.lock().expect("no panic").started;
        let Kind::Lines(lines) = &reporter.kind else { panic!("lines") };
        let line = |&(seconds, done): &(f64, u64)| {
            let now = started + Duration::from_secs_f64(seconds);
            let progress = Progress { done, total: 100 };
            reporter
                .due(&progress, lines.interval, lines.tells_end, now)
                .map(|r| (lines.format)(&r))
        };
        reports.iter().filter_map(line).collect()
    }

    #[test]
    fn plain_lines_keep_their_pause() {
        let reports =
            [(0.1, 1), (4.9, 9), (5.1, 10), (5.2, 11), (9.9, 39), (10.2, 40), (12.0, 100)];
        let expected =
            ["10 % after 5 s, 46 s left, 20 kpixels/s", "40 % after 10 s, 15 s left, 39 kpixels/s"];
        assert_eq!(lines_of(ProgressMode::Plain, 0.0, &reports), expected);
    }

    /// A step of a render towards a goal may take minutes, in which there is nothing to report.
    #[test]
    fn plain_lines_come_where_nothing_is_new() {
        let reporter = Reporter::new(ProgressMode::Plain, 1e6);
        reporter.begin(0.0);
        let started = reporter.clock.lock().expect("no panic").started;
        let at = |seconds: f64| started + Duration::from_secs_f64(seconds);
        let overdue = |seconds| Some(plain_line(&reporter.overdue(PLAIN_INTERVAL, at(seconds))?));
        let reported = |seconds, done| {
            let progress = Progress { done, total: 100 };
            Some(plain_line(&reporter.due(&progress, PLAIN_INTERVAL, false, at(seconds))?))
        };
        assert_eq!(overdue(4.9), None);
        assert_eq!(overdue(5.1).as_deref(), Some("0 % after 5 s, 0 pixels/s"));
        assert_eq!((reported(7.0, 50), overdue(9.0)), (None, None));
        assert_eq!(overdue(10.2).as_deref(), Some("50 % after 10 s, 10 s left, 49 kpixels/s"));
        assert_eq!((reported(11.0, 50), reported(15.1, 50)), (None, None));
        assert_eq!(overdue(20.0).as_deref(), Some("50 % after 20 s, 20 s left, 25 kpixels/s"));
        assert!(reported(25.5, 60).is_some() && overdue(26.0).is_none());
    }

    #[test]
    fn late_reports_of_slow_threads_are_left_out() {
        let expected = ["50 % after 10 s, 10 s left, 50 kpixels/s"];
        let reports = [(10.0, 50), (20.0, 49), (30.0, 50)];
        assert_eq!(lines_of(ProgressMode::Plain, 0.0, &reports), expected);
    }

    /// What was done before says nothing about how fast this machine is.
    #[test]
    fn the_time_left_is_that_of_what_was_done_since_the_program_began() {
        let expected = ["90 % after 10 s, 10 s left, 10 kpixels/s"];
        assert_eq!(lines_of(ProgressMode::Plain, 0.8, &[(10.0, 90)]), expected);
    }

    /// In pixels, of which there are a million, whatever the render counts in.
    #[test]
    fn json_lines_tell_the_end() {
        let reports = [(0.05, 10), (0.11, 20), (0.15, 100), (0.2, 90)];
        let written = lines_of(ProgressMode::Json, 0.0, &reports);
        let parsed: Vec<serde_json::Value> =
            written.iter().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        assert_eq!(parsed.len(), 2, "{written:?}");
        assert_eq!((&parsed[0]["done"], &parsed[0]["total"]), (&200_000.into(), &1_000_000.into()));
        assert_eq!(
            (&parsed[1]["done"], &parsed[1]["seconds_left"]),
            (&1_000_000.into(), &0.0.into())
        );
    }

    #[test]
    fn openjd_lines_are_a_percentage_and_a_status() {
        let written = lines_of(ProgressMode::Openjd, 0.0, &[(2.0, 25), (2.1, 26), (2.5, 100)]);
        assert_eq!(written[0], "openjd_progress: 25.0\nopenjd_status: 125 kpixels/s, 6 s left");
        assert!(written[1].starts_with("openjd_progress: 100.0\n"), "{written:?}");
    }
}
