//! How far a render is, in the words of people and of programs.

/// How far a render is.
pub(super) struct Report {
    pub(super) done: u64,
    pub(super) total: u64,
    /// The share that is done.
    pub(super) share: f64,
    /// The share that was done in the time since this program began.
    pub(super) fresh: f64,
    /// That time, in seconds.
    pub(super) elapsed: f64,
    pub(super) pixels: f64,
}

impl Report {
    /// Seconds until the end if the rest takes its time like what was done; unknown at the start.
    fn seconds_left(&self) -> Option<f64> {
        (self.fresh > 0.0).then(|| self.elapsed * (1.0 - self.share).max(0.0) / self.fresh)
    }

    /// Pixels a second.
    fn rate(&self) -> f64 {
        if self.elapsed > 0.0 { self.pixels * self.fresh.max(0.0) / self.elapsed } else { 0.0 }
    }
}

/// A time as people read it.
fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s:02} s"),
        (h, m, _) => format!("{h} h {m:02} min"),
    }
}

/// A rate as people read it.
fn readable_rate(rate: f64) -> String {
    match rate {
        0.0..1e3 => format!("{rate:.0} pixels/s"),
        1e3..1e6 => format!("{:.0} kpixels/s", rate / 1e3),
        _ => format!("{:.1} Mpixels/s", rate / 1e6),
    }
}

/// What stands behind the bar.
pub(super) fn bar_text(report: &Report) -> String {
    let left =
        report.seconds_left().map_or_else(String::new, |s| format!(", {} left", duration(s)));
    format!("{}{left}", readable_rate(report.rate()))
}

/// A line for people.
pub(super) fn plain_line(report: &Report) -> String {
    let left =
        report.seconds_left().map_or_else(String::new, |s| format!(", {} left", duration(s)));
    let rate = readable_rate(report.rate());
    format!("{:.0} % after {}{left}, {rate}", 100.0 * report.share, duration(report.elapsed))
}

/// A line for programs; what is done is in pixels.
pub(super) fn json_line(report: &Report) -> String {
    serde_json::json!({
        "done": (report.share * report.pixels).round() as u64,
        "total": report.pixels as u64,
        "seconds": report.elapsed,
        "seconds_left": report.seconds_left(),
        "pixels_per_second": report.rate(),
    })
    .to_string()
}

/// What a worker of Open Job Description takes for progress and status, from either stream.
pub(super) fn openjd_lines(report: &Report) -> String {
    let status = bar_text(report);
    format!("openjd_progress: {:.1}\nopenjd_status: {status}", 100.0 * report.share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_well() {
        let times = [0.4, 59.6, 61.0, 3599.0, 3600.0, 90_000.0].map(duration);
        assert_eq!(
            times,
            ["0 s", "1 min 00 s", "1 min 01 s", "59 min 59 s", "1 h 00 min", "25 h 00 min"]
        );
    }
}
