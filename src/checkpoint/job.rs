//! A render whose finished blocks are kept, in memory and from time to time on disk.

use std::{
    io,
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use super::{
    Checkpoint, CheckpointError,
    record::{Entry, Record},
};
use crate::{
    color::Rgb,
    film::{FileError, Film, Label, Tile},
    render::{Account, Block, Effort, Outcome, Progress, Rendering, Sink, Unfinished},
};

/// The least time between two looks at a picture towards a goal, which are copies of all of it.
const BETWEEN_LOOKS: Duration = Duration::from_millis(250);

/// How long the blocks at which work goes on have to be finished, once no further one is begun.
const TO_FINISH: Duration = Duration::from_secs(5);

/// How many times as long as writing an unfinished picture took, it is not written again.
const REST: u32 = 50;

/// A picture in the making.
pub struct Job<'a> {
    label: Label,
    places: Vec<Tile>,
    stop: &'a AtomicBool,
    /// When it was first seen that `stop` was set.
    stopped: OnceLock<Instant>,
    progress: &'a (dyn Fn(Progress) + Sync),
    state: Mutex<State>,
    /// Whether an unfinished picture is to be written.
    is_due: AtomicBool,
    kept: Mutex<Kept>,
}

struct State {
    film: Film,
    /// Of each block that is finished.
    accounts: Vec<Option<Account>>,
    /// Finished blocks that are not in the checkpoint yet.
    unsaved: Vec<usize>,
    outcome: Outcome,
    /// When a picture towards a goal was looked at last, and its estimated error when it was read or stopped.
    looked: Instant,
    rmse: Option<f64>,
}

/// What is on disk.
struct Kept {
    /// Where the checkpoint is to be; nowhere if none is kept.
    path: Option<PathBuf>,
    checkpoint: Option<Checkpoint>,
    /// An unfinished picture that was read.
    unfinished: Option<Unfinished>,
    /// The next one is not written before.
    next: Instant,
    /// Why the last one was not written.
    failure: Option<FileError>,
}

impl<'a> Job<'a> {
    /// A picture of which nothing is finished: the part that `label` names, in blocks at `places`, whose checkpoint is
    /// at `path`. No block is begun once `stop` is set, and those that take five seconds more are abandoned.
    pub fn new(
        label: Label,
        places: Vec<Tile>,
        path: Option<PathBuf>,
        stop: &'a AtomicBool,
        progress: &'a (dyn Fn(Progress) + Sync),
    ) -> Self {
        let part = label.place();
        let now = Instant::now();
        let state = State {
            film: Film::new(part.width(), part.height()),
            accounts: vec![None; places.len()],
            unsaved: Vec::new(),
            outcome: Outcome::default(),
            looked: now,
            rmse: None,
        };
        let (is_due, state) = (AtomicBool::new(false), Mutex::new(state));
        let kept = Kept { path, checkpoint: None, unfinished: None, next: now, failure: None };
        let stopped = OnceLock::new();
        Self { label, places, stop, stopped, progress, state, is_due, kept: Mutex::new(kept) }
    }

    /// Takes what is in the checkpoint.
    ///
    /// # Errors
    /// As [`Checkpoint::open`].
    pub fn resume(&self) -> Result<(), CheckpointError> {
        let mut kept = self.kept();
        let Some(path) = &kept.path else { return Ok(()) };
        let mut unfinished = None;
        let opened = Checkpoint::open(path, &self.label, &self.places, |entry| match entry {
            Entry::Block(record) => self.restore(&record),
            Entry::Unfinished(it) => unfinished = Some(*it),
        })?;
        kept.checkpoint = Some(opened);
        self.state().rmse = unfinished.as_ref().and_then(Unfinished::estimated_rmse);
        kept.unfinished = unfinished;
        Ok(())
    }

    /// Whether the file where the checkpoint is to be is one to go on from.
    ///
    /// # Errors
    /// As [`Checkpoint::check`].
    pub fn check_checkpoint(&self) -> Result<(), CheckpointError> {
        self.checkpoint_path().map_or(Ok(()), |path| Checkpoint::check(&path, &self.label))
    }

    fn restore(&self, record: &Record) {
        let mut state = self.state();
        let place = self.places[record.number].minus(&self.label.place());
        state.film.blit(&place, &record.colors, &record.samples);
        state.accounts[record.number] = Some(record.account);
    }

    /// Where its blocks are, by their numbers.
    pub fn places(&self) -> &[Tile] {
        &self.places
    }

    /// Where the checkpoint is to be.
    pub fn checkpoint_path(&self) -> Option<PathBuf> {
        self.kept().path.clone()
    }

    /// Whether there is a checkpoint to go on from.
    pub fn has_checkpoint(&self) -> bool {
        self.kept().checkpoint.is_some()
    }

    /// Deletes the checkpoint.
    ///
    /// # Errors
    /// Those of the system.
    pub fn remove_checkpoint(&self) -> io::Result<()> {
        let checkpoint = self.kept().checkpoint.take().filter(Checkpoint::is_there);
        checkpoint.map_or(Ok(()), Checkpoint::remove)
    }

    /// Writes what is finished but not in the checkpoint yet, which is made if there is none, and made anew if it was
    /// deleted. A picture towards an error or until a time is written by the threads that render it, soon.
    ///
    /// # Errors
    /// The file cannot be written, or could not the last time; what it had is kept, and nothing is forgotten.
    pub fn save(&self) -> Result<(), FileError> {
        let mut kept = self.kept();
        let Kept { path: Some(path), checkpoint, .. } = &mut *kept else { return Ok(()) };
        let is_lost = checkpoint.as_ref().is_none_or(|checkpoint| !checkpoint.is_there());
        let numbers: Vec<usize> = {
            let mut state = self.state();
            let unsaved = std::mem::take(&mut state.unsaved);
            if is_lost {
                (0..self.places.len()).filter(|k| state.accounts[*k].is_some()).collect()
            } else {
                unsaved
            }
        };
        if numbers.is_empty() {
            self.is_due.store(Instant::now() >= kept.next, Ordering::Relaxed);
            return kept.failure.take().map_or(Ok(()), Err);
        }
        let mut left = numbers.as_slice();
        let saved = self.write(checkpoint, is_lost, path, &mut left);
        self.state().unsaved.extend(left);
        saved
    }

    /// Writes the blocks of these numbers, which are taken from the list as they are written.
    fn write(
        &self,
        checkpoint: &mut Option<Checkpoint>,
        is_lost: bool,
        path: &Path,
        numbers: &mut &[usize],
    ) -> Result<(), FileError> {
        if is_lost {
            *checkpoint = None;
        }
        let error = |source| FileError::Write { path: path.to_owned(), source };
        while let Some((number, rest)) = numbers.split_first() {
            if let Some(record) = self.record(*number) {
                match checkpoint {
                    Some(checkpoint) => checkpoint.append(&record).map_err(error)?,
                    None => *checkpoint = Some(Checkpoint::create(path, &self.label, &record)?),
                }
            }
            *numbers = rest;
        }
        checkpoint.as_ref().map_or(Ok(()), |checkpoint| checkpoint.sync().map_err(error))
    }

    /// A copy of a finished block.
    fn record(&self, number: usize) -> Option<Record> {
        let state = self.state();
        let place = self.places[number].minus(&self.label.place());
        let (colors, samples) = state.film.cut(&place);
        state.accounts[number].map(|account| Record { number, colors, samples, account })
    }

    /// Whether all blocks are finished.
    pub fn is_complete(&self) -> bool {
        self.state().accounts.iter().all(Option::is_some)
    }

    /// The share of the picture's pixels that are rendered, from 0 to 1.
    pub fn share_done(&self) -> f64 {
        let missing = self.missing() as f64;
        let part = self.label.place();
        1.0 - missing / (f64::from(part.width()) * f64::from(part.height()))
    }

    /// How many pixels are not rendered.
    pub fn missing(&self) -> u64 {
        self.state().film.missing()
    }

    /// How it ended, as far as the last block knows.
    pub fn outcome(&self) -> Outcome {
        self.state().outcome
    }

    /// The estimated error of a picture that is complete, or of one towards an error or until a time that was read or
    /// stopped, if each of its pixels has a ray: root mean square of all channels, in levels of 255.
    pub fn estimated_rmse(&self) -> Option<f64> {
        let state = self.state();
        let accounts: Option<Vec<Account>> = state.accounts.iter().copied().collect();
        let of_all = |accounts| Account::sum(&accounts).rmse(state.film.pixels().len());
        accounts.map(of_all).or(state.rmse)
    }

    /// What the picture's file says of itself, as it is now.
    pub fn label(&self) -> Label {
        Label { missing: self.missing(), ..self.label.clone() }
    }

    /// The picture as it is now, to be looked at while nothing else is asked of the job.
    pub fn with_film<T>(&self, look: impl FnOnce(&Film) -> T) -> T {
        look(&self.state().film)
    }

    /// The picture.
    pub fn into_rendering(self, effort: &Effort) -> Rendering {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let State { film, accounts, outcome, .. } = state;
        Rendering::of_blocks(film, accounts.iter().flatten(), outcome, effort)
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sink for Job<'_> {
    fn wants(&self, number: usize) -> bool {
        self.state().accounts[number].is_none()
    }

    fn put(&self, block: Block) {
        let Block { number, place, colors, samples, account, outcome } = block;
        let mut state = self.state();
        state.outcome = outcome;
        if !outcome.is_stopped {
            state.accounts[number] = Some(account);
            state.unsaved.push(number);
        } else if !samples.contains(&0) {
            state.rmse = Some(account.rmse(samples.len()));
        }
        state.film.put(&place.minus(&self.label.place()), colors, samples);
    }

    fn wants_unfinished(&self) -> bool {
        self.is_due.load(Ordering::Relaxed)
    }

    fn keep(&self, unfinished: &Unfinished) {
        let mut kept = self.kept();
        self.is_due.store(false, Ordering::Relaxed);
        let Kept { path: Some(path), checkpoint, .. } = &mut *kept else { return };
        let started = Instant::now();
        let made =
            Checkpoint::create_unfinished(path, &self.label, unfinished, checkpoint.as_ref());
        match made {
            Ok(checkpoint) => kept.checkpoint = Some(checkpoint),
            Err(error) => kept.failure = Some(error),
        }
        kept.next = Instant::now() + started.elapsed() * REST;
    }

    fn unfinished(&self) -> Option<Unfinished> {
        self.kept().unfinished.take()
    }

    fn show(&self, place: &Tile, colors: &[Rgb], samples: &[u32]) {
        let mut state = self.state();
        if state.looked.elapsed() >= BETWEEN_LOOKS {
            state.film.blit(&place.minus(&self.label.place()), colors, samples);
            state.looked = Instant::now();
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn is_abandoned(&self) -> bool {
        self.is_stopped() && self.stopped.get_or_init(Instant::now).elapsed() >= TO_FINISH
    }

    fn report(&self, progress: Progress) {
        (self.progress)(progress);
    }
}
