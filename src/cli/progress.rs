//! How far a render is, on standard error.

use std::io::{self, IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, TermLike};
use whitted::render::Progress;

use super::args::ProgressMode;
use super::streams;

const PLAIN_INTERVAL: Duration = Duration::from_secs(5);
const JSON_INTERVAL: Duration = Duration::from_millis(100);

/// Tells the user how far a render is; to be called from any thread.
pub(crate) enum Reporter {
    /// Says nothing.
    Silent,
    /// A bar that draws itself anew.
    Bar(ProgressBar),
    /// Lines, not too many.
    Lines(Lines),
}

impl Reporter {
    /// A reporter whose time runs from now; it shows nothing until the first report.
    pub(crate) fn new(mode: ProgressMode) -> Self {
        let terminal = io::stderr().is_terminal();
        match mode {
            ProgressMode::None => Self::Silent,
            ProgressMode::Auto | ProgressMode::Bar if terminal => {
                Self::bar(ProgressDrawTarget::stderr())
            }
            ProgressMode::Bar => Self::bar(ProgressDrawTarget::term_like(Box::new(AnyStderr))),
            ProgressMode::Auto | ProgressMode::Plain => {
                Self::Lines(Lines::new(plain_line, PLAIN_INTERVAL, false))
            }
            ProgressMode::Json => Self::Lines(Lines::new(json_line, JSON_INTERVAL, true)),
        }
    }

    fn bar(target: ProgressDrawTarget) -> Self {
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %, {eta} left");
        bar.set_style(style.expect("a template indicatif knows"));
        Self::Bar(bar)
    }

    /// Takes note of a report from the render.
    pub(crate) fn report(&self, progress: &Progress) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                if bar.length() != Some(progress.total) {
                    bar.set_length(progress.total);
                }
                // Reports of several threads may overtake each other.
                if progress.done > bar.position() {
                    bar.set_position(progress.done);
                }
            }
            Self::Lines(lines) => lines.report(progress),
        }
    }
}

/// The bar goes when the render ends, however it ends, to make room for what is said then.
impl Drop for Reporter {
    fn drop(&mut self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Progress as lines with a pause between them.
pub(crate) struct Lines {
    format: fn(&Report) -> String,
    interval: Duration,
    /// Whether the last report becomes a line although the pause is not over.
    tells_end: bool,
    started: Instant,
    /// When the last line came, and how far it said the render was.
    last: Mutex<(Instant, u64)>,
}

/// One line's content.
struct Report {
    done: u64,
    total: u64,
    elapsed: f64,
}

impl Report {
    /// Seconds until the end if the rest takes its time like what is done; unknown at the start.
    fn seconds_left(&self) -> Option<f64> {
        let left = self.total.saturating_sub(self.done) as f64;
        (self.done > 0).then(|| self.elapsed * left / self.done as f64)
    }
}

impl Lines {
    fn new(format: fn(&Report) -> String, interval: Duration, tells_end: bool) -> Self {
        let started = Instant::now();
        Self { format, interval, tells_end, started, last: Mutex::new((started, 0)) }
    }

    fn report(&self, progress: &Progress) {
        if let Some(line) = self.line(progress, Instant::now()) {
            streams::note(&line);
        }
    }

    /// The line due at the moment `now`, if any.
    fn line(&self, progress: &Progress, now: Instant) -> Option<String> {
        let &Progress { done, total } = progress;
        // A thread that died while it held the lock left two numbers that are still good.
        let mut last = self.last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let is_end = self.tells_end && done >= total;
        let is_due = now.saturating_duration_since(last.0) >= self.interval;
        if done <= last.1 || !(is_due || is_end) {
            return None;
        }
        *last = (now, done);
        let elapsed = now.saturating_duration_since(self.started).as_secs_f64();
        Some((self.format)(&Report { done, total, elapsed }))
    }
}

fn plain_line(report: &Report) -> String {
    let percent = 100.0 * report.done as f64 / report.total.max(1) as f64;
    let left = report.seconds_left().map_or_else(String::new, |left| format!(", {left:.0} s left"));
    format!("{percent:.0} % after {:.0} s{left}", report.elapsed)
}

fn json_line(report: &Report) -> String {
    serde_json::json!({
        "done": report.done,
        "total": report.total,
        "seconds": report.elapsed,
        "seconds_left": report.seconds_left(),
    })
    .to_string()
}

/// Standard error as indicatif draws on it, terminal or not, for whoever asks for the bar by name.
#[derive(Debug)]
struct AnyStderr;

impl AnyStderr {
    fn send(text: &str) -> io::Result<()> {
        io::stderr().write_all(text.as_bytes())
    }

    fn step(letter: char, n: usize) -> io::Result<()> {
        if n == 0 { Ok(()) } else { Self::send(&format!("\x1b[{n}{letter}")) }
    }
}

impl TermLike for AnyStderr {
    fn width(&self) -> u16 {
        80
    }

    fn move_cursor_up(&self, n: usize) -> io::Result<()> {
        Self::step('A', n)
    }

    fn move_cursor_down(&self, n: usize) -> io::Result<()> {
        Self::step('B', n)
    }

    fn move_cursor_right(&self, n: usize) -> io::Result<()> {
        Self::step('C', n)
    }

    fn move_cursor_left(&self, n: usize) -> io::Result<()> {
        Self::step('D', n)
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        Self::send(&format!("{text}\n"))
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        Self::send(text)
    }

    fn clear_line(&self) -> io::Result<()> {
        Self::send("\r\x1b[2K")
    }

    fn flush(&self) -> io::Result<()> {
        io::stderr().flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines that reports of `(seconds, done)` out of 100 give.
    fn lines_of(lines: &Lines, reports: &[(f64, u64)]) -> Vec<String> {
        let line = |&(seconds, done): &(f64, u64)| {
            let now = lines.started + Duration::from_secs_f64(seconds);
            lines.line(&Progress { done, total: 100 }, now)
        };
        reports.iter().filter_map(line).collect()
    }

    #[test]
    fn plain_lines_keep_their_pause() {
        let lines = Lines::new(plain_line, PLAIN_INTERVAL, false);
        let reports =
            [(0.1, 1), (4.9, 9), (5.0, 10), (5.1, 11), (9.9, 39), (10.0, 40), (12.0, 100)];
        let expected = ["10 % after 5 s, 45 s left", "40 % after 10 s, 15 s left"];
        assert_eq!(lines_of(&lines, &reports), expected);
    }

    #[test]
    fn late_reports_of_slow_threads_are_left_out() {
        let lines = Lines::new(plain_line, PLAIN_INTERVAL, false);
        let expected = ["50 % after 10 s, 10 s left"];
        assert_eq!(lines_of(&lines, &[(10.0, 50), (20.0, 49), (30.0, 50)]), expected);
    }

    #[test]
    fn json_lines_tell_the_end() {
        let lines = Lines::new(json_line, JSON_INTERVAL, true);
        let written = lines_of(&lines, &[(0.05, 10), (0.1, 20), (0.15, 100), (0.2, 90)]);
        let parsed: Vec<serde_json::Value> =
            written.iter().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        assert_eq!(parsed.len(), 2, "{written:?}");
        assert_eq!((&parsed[0]["done"], &parsed[0]["total"]), (&20.into(), &100.into()));
        assert_eq!((&parsed[1]["done"], &parsed[1]["seconds_left"]), (&100.into(), &0.0.into()));
    }
}
