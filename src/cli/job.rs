//! One picture from its first block to its file: checkpoints on the way, and what is left when it is stopped.

use std::{
    ffi::OsStr,
    panic::resume_unwind,
    sync::atomic::Ordering,
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
use super::target::Picture;
use super::warnings::Warnings;
use super::watch::{Course, Watcher};
use super::{goal, streams};

/// What is rendered, and where to.
pub(crate) struct Order<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) options: &'a RenderOptions,
    pub(crate) label: &'a Label,
    pub(crate) picture: &'a Picture,
    pub(crate) signals: &'a Signals,
    pub(crate) warnings: &'a Warnings,
}

/// A picture in its file.
pub(crate) struct Finished {
    pub(crate) rendering: Rendering,
    /// What it aimed at but did not reach.
    pub(crate) missed: Option<String>,
    /// The time that writing took, in seconds.
    pub(crate) write: f64,
}

/// Renders a picture and writes it; if it is stopped, writes what there is of it, and fails with the signal.
pub(crate) fn run(
    order: &Order,
    args: &RenderArgs,
    preview: &mut Preview,
) -> Result<Finished, Failure> {
    let Order { scene, options, label, picture, signals, warnings, .. } = order;
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
    let places = blocks(scene, options)?;
    let stop = signals.defer();
    let course = Course::default();
    let report = |progress: Progress| {
        // All blocks of a picture towards a goal are put down as they are when it is stopped, which does not finish it.
        if options.goal != Goal::Mode && stop.load(Ordering::Relaxed) {
            return;
        }
        course.report(progress);
        reporter.report(&progress);
    };
    let path = picture.path().map(Checkpoint::path_for);
    let job = Job::new((*label).clone(), places, path, stop, &report);
    find(&job, args, warnings)?;
    warnings.check()?;
    reporter.begin(if job.has_checkpoint() { job.share_done() } else { 0.0 });
    let watcher = Watcher {
        job: &job,
        course: &course,
        stop,
        interval: Duration::from_secs_f64(args.checkpoint),
        stopping: match options.goal {
            Goal::Mode => {
                "stopping: finishing the blocks in progress; interrupt again to stop at once"
            }
            _ => "stopping: keeping the picture as it is; interrupt again to stop at once",
        },
        note: &|line| note(args, line),
        warnings,
        tick: &|| reporter.tick(),
    };
    let effort = render(order, &job, &watcher, preview)?;
    reporter.end();
    if !job.is_complete() {
        return Err(leave(order, &job));
    }
    let missed = goal::missed(args, options.aa, &job.outcome(), job.estimated_rmse());
    let label = Label { warning: missed.clone(), ..(*label).clone() };
    let writing = Instant::now();
    finish(order, &label, &job)?;
    let write = writing.elapsed().as_secs_f64();
    Ok(Finished { rendering: job.into_rendering(&effort), missed, write })
}

/// Writes a line that is not an error, unless nobody or only a program reads it.
fn note(args: &RenderArgs, line: &str) {
    if !args.quiet && args.progress != ProgressMode::Json {
        streams::note(line);
    }
}

/// Takes what is in the checkpoint, if that is wanted and there is one.
fn find(job: &Job, args: &RenderArgs, warnings: &Warnings) -> Result<(), Failure> {
    let Some(path) = job.checkpoint_path() else { return Ok(()) };
    let name = path.display();
    match (path.exists(), args.resume) {
        (false, false) => {}
        (false, true) => {
            note(args, &format!("{name}: there is no checkpoint; starting from the beginning"));
        }
        (true, false) => warnings.add(match job.check_checkpoint() {
            Ok(()) => format!(
                "{name} is left from an interrupted render; --resume goes on from it (otherwise it is renamed to .old at \
                 the first new checkpoint)"
            ),
            Err(CheckpointError::Differs { what, .. }) => format!(
                "{name} is left from an interrupted render of another picture ({what}); it is renamed to .old at the \
                 first new checkpoint"
            ),
            Err(_) => format!(
                "{name} is in the way of a checkpoint; it is renamed to .old at the first one"
            ),
        }),
        (true, true) => match job.resume() {
            Ok(()) => note(args, &format!("going on from {name} {}", so_far(job))),
            Err(error @ CheckpointError::Read { .. }) => return Err(error.into()),
            Err(error) => return Err(Failure::mismatch(error)),
        },
    }
    Ok(())
}

/// How far the picture is.
fn so_far(job: &Job) -> String {
    match job.estimated_rmse() {
        Some(error) if !job.is_complete() => {
            format!("at an estimated error of {error:.2} of 255 levels")
        }
        _ => format!("with {:.0} % done", 100.0 * job.share_done()),
    }
}

/// Renders what the job has not, while others look after it. A window has to be on the thread that the program began
/// with.
fn render(
    order: &Order,
    job: &Job,
    watcher: &Watcher,
    preview: &mut Preview,
) -> Result<Effort, RenderError> {
    let course = watcher.course;
    let work = || {
        let _end = course.end_of();
        render_blocks(order.scene, order.options, job.places(), job)
    };
    std::thread::scope(|scope| {
        let (terminal, window) = match preview {
            Preview::None => (None, None),
            Preview::Terminal(terminal) => (Some(terminal), None),
            Preview::Window(window) => (None, Some(window)),
        };
        scope.spawn(|| watcher.watch(terminal));
        let Some(window) = window else { return work() };
        let work = scope.spawn(work);
        window.show(job, course, order.warnings);
        work.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Keeps what there is of a stopped picture, and says how to go on.
fn leave(order: &Order, job: &Job) -> Failure {
    let Some(signal) = order.signals.received() else {
        return anyhow::anyhow!("the render ended early without a reason").into();
    };
    if job.share_done() == 0.0 {
        return Failure::stopped(signal, "before anything was finished; nothing is written");
    }
    let mut lines = vec![so_far(job)];
    match (job.save(), job.checkpoint_path().filter(|_| job.has_checkpoint())) {
        (Ok(()), Some(path)) => lines.push(format!("checkpoint: {}", path.display())),
        (Ok(()), None) => {}
        (Err(error), _) => lines.push(format!("no further checkpoint: {error}")),
    }
    let mut label = job.label();
    if order.options.goal != Goal::Mode {
        // Not the picture of its other options, even if each pixel has a ray.
        label.options.push_str(" interrupted=yes");
    }
    match job.with_film(|film| order.picture.write(film, &label)) {
        Ok(()) => lines.push(format!("picture so far: {}", order.picture.name())),
        Err(failure) => lines.push(format!("the picture so far could not be written: {failure}")),
    }
    if job.has_checkpoint() {
        lines.push(format!("go on with: {}", resuming_command()));
    }
    Failure::stopped(signal, &lines.join("\n  "))
}

/// Writes the picture and deletes its checkpoint; if it cannot be written, brings the checkpoint up to date instead.
fn finish(order: &Order, label: &Label, job: &Job) -> Result<(), Failure> {
    let written = job.with_film(|film| order.picture.write(film, label));
    let Some(path) = job.checkpoint_path() else { return written };
    let path = path.display();
    let Err(failure) = written else {
        if let Err(error) = job.remove_checkpoint() {
            order.warnings.add(format!("{path}: not deleted ({error})"));
        }
        return Ok(());
    };
    let saved = job.save();
    if saved.is_ok() || job.has_checkpoint() {
        let how = if saved.is_ok() { "all" } else { "a part" };
        streams::note(&format!(
            "{how} of the picture is kept in {path}; once there is room for it, go on with: {}",
            resuming_command()
        ));
    }
    Err(failure)
}

/// The command that was given, as a shell takes it, with `--resume`.
fn resuming_command() -> String {
    let mut words: Vec<String> = std::env::args_os().map(|word| quoted(&word)).collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".to_owned());
    }
    words.join(" ")
}

/// A word in quotes if a shell would take it for anything else; if it is not UTF-8, in those that take the numbers of
/// bytes.
fn quoted(word: &OsStr) -> String {
    let Some(word) = word.to_str() else {
        let bytes = word.as_encoded_bytes().iter().map(|byte| format!("\\{byte:03o}"));
        return format!("$'{}'", bytes.collect::<Vec<_>>().concat());
    };
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
        use std::os::unix::ffi::OsStrExt as _;

        for word in ["plain", "", "two words", "it's", "$HOME*;", "a\nb", "--tile=1/2,3/4", "ü"] {
            let command = format!("printf %s {}", quoted(OsStr::new(word)));
            let output = std::process::Command::new("sh").args(["-c", &command]).output();
            assert_eq!(output.expect("a shell").stdout, word.as_bytes(), "{word}");
        }
        // Not all shells know these quotes.
        let word = OsStr::from_bytes(b"it's\xff.png");
        let command = format!("printf %s {}", quoted(word));
        if let Ok(output) = std::process::Command::new("bash").args(["-c", &command]).output() {
            assert_eq!(output.stdout, word.as_encoded_bytes());
        }
    }
}
