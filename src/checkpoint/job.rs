//! A render whose finished blocks are kept, in memory and from time to time on disk.

use std::{
    path::Path,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use super::{Checkpoint, CheckpointError, record::Record};
use crate::{
    color::Rgb,
    film::{FileError, Film, Label, Tile},
    render::{Account, Block, Effort, Outcome, Progress, Rendering, Sink},
};

/// The least time between two looks at a picture towards a goal, which are copies of all of it.
const BETWEEN_LOOKS: Duration = Duration::from_millis(250);

/// A picture in the making.
pub struct Job<'a> {
    label: Label,
    places: Vec<Tile>,
    stop: &'a AtomicBool,
    progress: &'a (dyn Fn(Progress) + Sync),
    state: Mutex<State>,
}

struct State {
    film: Film,
    /// Of each block that is finished.
    accounts: Vec<Option<Account>>,
    /// Finished blocks that are not in the checkpoint yet.
    unsaved: Vec<usize>,
    outcome: Outcome,
    /// When a picture towards a goal was looked at last.
    looked: Instant,
}

impl<'a> Job<'a> {
    /// A picture of which nothing is finished: the part that `label` names, in blocks at `places`. No block is begun once `stop`
    /// is set.
    pub fn new(
        label: Label,
        places: Vec<Tile>,
        stop: &'a AtomicBool,
        progress: &'a (dyn Fn(Progress) + Sync),
    ) -> Self {
        let part = label.place();
        let state = State {
            film: Film::new(part.width(), part.height()),
            accounts: vec![None; places.len()],
            unsaved: Vec::new(),
            outcome: Outcome::default(),
            looked: Instant::now(),
        };
        Self { label, places, stop, progress, state: Mutex::new(state) }
    }

    /// Takes the blocks of the checkpoint at `path`.
    ///
    /// # Errors
    /// As [`Checkpoint::open`].
    pub fn resume(&self, path: &Path) -> Result<Checkpoint, CheckpointError> {
        Checkpoint::open(path, &self.label, &self.places, |record| self.restore(&record))
    }

    fn restore(&self, record: &Record) {
        let mut state = self.state();
        let place = self.places[record.number].minus(&self.label.place());
        state.film.blit(&place, &record.colors, &record.samples);
        state.accounts[record.number] = Some(record.account);
    }

    /// Writes what is finished but not in `checkpoint` yet, which is made if there is none, and made anew if it was deleted.
    ///
    /// # Errors
    /// The file cannot be written; what it had is kept, and nothing is forgotten.
    pub fn save(&self, checkpoint: &mut Option<Checkpoint>, path: &Path) -> Result<(), FileError> {
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
            return Ok(());
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
        let checkpoint = match checkpoint {
            Some(checkpoint) => checkpoint,
            None => checkpoint.insert(Checkpoint::create(path, &self.label)?),
        };
        let error = |source| FileError::Write { path: path.to_owned(), source };
        while let Some((number, rest)) = numbers.split_first() {
            if let Some(record) = self.record(*number) {
                checkpoint.append(&record).map_err(error)?;
            }
            *numbers = rest;
        }
        checkpoint.sync().map_err(error)
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

    /// What the picture's file says of itself, as it is now.
    pub fn label(&self) -> Label {
        Label { missing: self.missing(), ..self.label.clone() }
    }

    /// The picture as it is now, to be looked at while nothing else is asked of the job.
    pub fn with_film<T>(&self, look: impl FnOnce(&Film) -> T) -> T {
        look(&self.state().film)
    }

    /// The picture; the errors of single pixels were not kept.
    pub fn into_rendering(self, effort: &Effort) -> Rendering {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let State { film, accounts, outcome, .. } = state;
        let sum = Account::sum(accounts.iter().flatten());
        Rendering {
            estimated_rmse: (sum.squared_error / film.pixels().len().max(1) as f64).sqrt(),
            outcome: Outcome { unsettled: sum.unsettled as usize, ..outcome },
            rays: sum.rays,
            threads: effort.threads,
            seconds: effort.seconds,
            depth: effort.depth,
            film,
            errors: Vec::new(),
        }
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
        let mut state = self.state();
        let place = block.place.minus(&self.label.place());
        state.film.blit(&place, &block.colors, &block.samples);
        state.outcome = block.outcome;
        if !block.samples.contains(&0) {
            state.accounts[block.number] = Some(block.account);
            state.unsaved.push(block.number);
        }
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

    fn report(&self, progress: Progress) {
        (self.progress)(progress);
    }
}
