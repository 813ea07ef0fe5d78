//! One picture from its first block to its file: checkpoints on the way, and what is left when it is stopped.

use std::{
    panic::resume_unwind,
    path::Path,
    time::{Duration, Instant},
};

use whitted::checkpoint::{Checkpoint, CheckpointError, Job};
use whitted::film::Label;
use whitted::render::{
    Effort, Goal, Progress, RenderError, RenderOptions, Rendering, blocks, render_blocks,
};
use whitted::scene::Scene;

use super::args::{ProgressMode, RenderArgs};
use super::failure::Failure;
use super::preview::Preview;
use super::progress::Reporter;
use super::signals::Signals;
use super::streams;
use super::target::Picture;
use super::watch::{Course, Kept, Watcher};

/// What is said of a picture towards a goal that was interrupted.
pub(crate) const NO_CHECKPOINT: &str = "nothing goes on from it: --max-error and --time-limit keep no checkpoint, --aa adaptive:ERROR does";

/// What is rendered, and where to.
pub(crate) struct Order<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) options: &'a RenderOptions,
    pub(crate) label: &'a Label,
    pub(crate) picture: &'a Picture,
    pub(crate) signals: &'a Signals,
}

/// A picture in its file.
pub(crate) struct Finished {
    pub(crate) rendering: Rendering,
    /// The time that writing took, in seconds.
    pub(crate) write: f64,
    /// The signal that ended it before its goal.
    pub(crate) interrupted: Option<u8>,
}

/// Renders a picture and writes it; if it is stopped, writes what there is of it, and fails with the signal.
pub(crate) fn run(
    order: &Order,
    args: &RenderArgs,
    preview: &mut Preview,
) -> Result<Finished, Failure> {
    let Order { options, label, picture, signals, .. } = order;
    let mode = match args.progress {
        _ if args.quiet => ProgressMode::None,
        // The line below the picture tells it.
        ProgressMode::Auto | ProgressMode::Bar | ProgressMode::Plain
            if matches!(preview, Preview::Terminal(_)) =>
        {
            ProgressMode::None
        }
        mode => mode,
    };
    let pixels = f64::from(label.place().width()) * f64::from(label.place().height());
    let reporter = Reporter::new(mode, pixels);
    let places = blocks(&label.place(), options.aa, options.goal);
    let stop = signals.defer();
    let course = Course::default();
    let report = |progress: Progress| {
        course.report(progress);
        reporter.report(&progress);
    };
    let job = Job::new((*label).clone(), places, stop, &report);
    let path = picture.path().filter(|_| options.goal == Goal::Mode).map(Checkpoint::path_for);
    let mut kept = Kept { path, checkpoint: None };
    if let Some(path) = &kept.path {
        kept.checkpoint = find(&job, path, args)?;
    }
    reporter.begin(job.share_done());
    let watcher = Watcher {
        job: &job,
        course: &course,
        stop,
        interval: Duration::from_secs_f64(args.checkpoint),
        stopping: match options.goal {
            Goal::Mode => "stopping: blocks in work are finished; once more stops at once",
            _ => "stopping: the picture is written as it is; once more stops at once",
        },
        note: &|line| note(args, line),
    };
    let effort = render(order, &job, &watcher, &mut kept, preview)?;
    reporter.end();
    if !job.is_complete() {
        return Err(leave(order, &job, kept));
    }
    let writing = Instant::now();
    let interrupted = signals.received().filter(|_| job.outcome().cut);
    finish(order, &job, kept, interrupted.is_some())?;
    let write = writing.elapsed().as_secs_f64();
    Ok(Finished { rendering: job.into_rendering(&effort), write, interrupted })
}

/// Writes a line that is not an error, unless nobody or only a program reads it.
fn note(args: &RenderArgs, line: &str) {
    if !args.quiet && args.progress != ProgressMode::Json {
        streams::note(line);
    }
}

/// The checkpoint to go on from, if that is wanted and there is one.
fn find(job: &Job, path: &Path, args: &RenderArgs) -> Result<Option<Checkpoint>, Failure> {
    match (path.exists(), args.resume) {
        (false, false) => Ok(None),
        (false, true) => {
            note(
                args,
                &format!("{}: there is no checkpoint; starting from the beginning", path.display()),
            );
            Ok(None)
        }
        (true, false) => {
            note(
                args,
                &format!(
                    "warning: {} is left from an interrupted render; --resume goes on from it (without, its name gets .old at \
                 the first new checkpoint)",
                    path.display()
                ),
            );
            Ok(None)
        }
        (true, true) => match job.resume(path) {
            Ok(checkpoint) => {
                let percent = 100.0 * job.share_done();
                note(args, &format!("going on from {} with {percent:.0} % done", path.display()));
                Ok(Some(checkpoint))
            }
            Err(error @ CheckpointError::Read { .. }) => Err(error.into()),
            Err(error) => Err(Failure::mismatch(error)),
        },
    }
}

/// Renders what the job has not, while others look after it. A window has to be on the thread that the program began with.
fn render(
    order: &Order,
    job: &Job,
    watcher: &Watcher,
    kept: &mut Kept,
    preview: &mut Preview,
) -> Result<Effort, RenderError> {
    let course = watcher.course;
    let work = || {
        let effort = render_blocks(order.scene, order.options, job);
        course.end();
        effort
    };
    std::thread::scope(|scope| {
        let (terminal, window) = match preview {
            Preview::None => (None, None),
            Preview::Terminal(terminal) => (Some(terminal), None),
            Preview::Window(window) => (None, Some(window)),
        };
        scope.spawn(|| watcher.watch(kept, terminal));
        let Some(window) = window else { return work() };
        let work = scope.spawn(work);
        window.show(job, course);
        work.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Keeps what there is of a stopped picture, and says how to go on.
fn leave(order: &Order, job: &Job, mut kept: Kept) -> Failure {
    let Some(signal) = order.signals.received() else {
        return anyhow::anyhow!("the render ended early without a reason").into();
    };
    let done = job.share_done();
    if done == 0.0 {
        return Failure::stopped(signal, "before anything was finished; nothing is written");
    }
    let mut lines = vec![format!("with {:.0} % done", 100.0 * done)];
    let mut can_resume = false;
    if let Some(path) = &kept.path {
        match job.save(&mut kept.checkpoint, path) {
            Ok(()) => {
                lines.push(format!("checkpoint: {}", path.display()));
                can_resume = true;
            }
            Err(error) => {
                lines.push(format!("no further checkpoint: {error}"));
                can_resume = kept.checkpoint.is_some();
            }
        }
    }
    let label = job.label();
    match job.with_film(|film| order.picture.write(film, &label)) {
        Ok(()) => lines.push(format!("picture so far: {}", order.picture.name())),
        Err(failure) => lines.push(format!("the picture so far is not written: {failure}")),
    }
    if can_resume {
        lines.push(format!("go on with: {}", resuming_command()));
    }
    if order.options.goal != Goal::Mode {
        lines.push(NO_CHECKPOINT.to_owned());
    }
    Failure::stopped(signal, &lines.join("\n  "))
}

/// Writes the picture and deletes its checkpoint; if it cannot be written, brings the checkpoint up to date instead.
fn finish(order: &Order, job: &Job, mut kept: Kept, interrupted: bool) -> Result<(), Failure> {
    let mut label = order.label.clone();
    if interrupted {
        // Not the picture of its other options, whatever its goal.
        label.options.push_str(" interrupted=yes");
    }
    let written = job.with_film(|film| order.picture.write(film, &label));
    let Err(failure) = written else {
        if let Some(checkpoint) = kept.checkpoint.filter(Checkpoint::is_there) {
            let path = checkpoint.path().display().to_string();
            if let Err(error) = checkpoint.remove() {
                streams::note(&format!("warning: {path}: not deleted ({error})"));
            }
        }
        return Ok(());
    };
    let Some(path) = &kept.path else { return Err(failure) };
    let saved = job.save(&mut kept.checkpoint, path);
    if saved.is_ok() || kept.checkpoint.is_some() {
        let how = if saved.is_ok() { "all" } else { "a part" };
        streams::note(&format!(
            "{how} of the picture is kept in {}; when there is room for it, go on with: {}",
            path.display(),
            resuming_command()
        ));
    }
    Err(failure)
}

/// The command that was given, as a shell takes it, with `--resume`.
fn resuming_command() -> String {
    let mut words: Vec<String> =
        std::env::args_os().map(|word| quoted(&word.to_string_lossy())).collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".to_owned());
    }
    words.join(" ")
}

/// A word in single quotes if a shell would take it for anything else.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=@%+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the shell itself.
    #[cfg(unix)]
    #[test]
    fn quoted_words_are_words_to_a_shell() {
        for word in ["plain", "", "two words", "it's", "$HOME*;", "a\nb", "--tile=1/2,3/4", "ü"] {
            let command = format!("printf %s {}", quoted(word));
            let output = std::process::Command::new("sh").args(["-c", &command]).output();
            assert_eq!(output.expect("a shell").stdout, word.as_bytes(), "{word}");
        }
    }
}
