//! A picture whose blocks are all kept in memory.

use std::sync::{Mutex, PoisonError};

use super::{Account, Block, Effort, Outcome, Progress, Rendering, Sink};
use crate::film::{Film, Tile};

/// What blocks become.
pub(super) struct Whole<'a> {
    part: Tile,
    progress: &'a (dyn Fn(Progress) + Sync),
    state: Mutex<State>,
}

struct State {
    film: Film,
    outcome: Outcome,
    /// By number, so that they are added up in the same order whatever the threads do.
    accounts: Vec<(usize, Account)>,
}

impl<'a> Whole<'a> {
    /// No block yet.
    pub(super) fn new(part: &Tile, progress: &'a (dyn Fn(Progress) + Sync)) -> Self {
        let film = Film::new(part.width(), part.height());
        let state = State { film, outcome: Outcome::default(), accounts: Vec::new() };
        Self { part: *part, progress, state: Mutex::new(state) }
    }

    /// The whole picture.
    pub(super) fn into_rendering(self, effort: &Effort) -> Rendering {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let State { film, outcome, mut accounts } = state;
        accounts.sort_unstable_by_key(|(number, _)| *number);
        let accounts = accounts.iter().map(|(_, account)| account);
        Rendering::of_blocks(film, accounts, outcome, effort)
    }
}

impl Sink for Whole<'_> {
    fn put(&self, block: Block) {
        let Block { number, place, colors, samples, account, outcome } = block;
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.film.put(&place.minus(&self.part), colors, samples);
        state.accounts.push((number, account));
        state.outcome = outcome;
    }

    fn report(&self, progress: Progress) {
        (self.progress)(progress);
    }
}
