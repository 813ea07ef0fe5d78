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
    errors: Vec<f32>,
    outcome: Outcome,
    /// By number, so that they are added up in the same order whatever the threads do.
    accounts: Vec<(usize, Account)>,
}

impl<'a> Whole<'a> {
    /// No block yet.
    pub(super) fn new(part: &Tile, progress: &'a (dyn Fn(Progress) + Sync)) -> Self {
        let film = Film::new(part.width(), part.height());
        let errors = vec![0.0; film.pixels().len()];
        let state = State { film, errors, outcome: Outcome::default(), accounts: Vec::new() };
        Self { part: *part, progress, state: Mutex::new(state) }
    }

    /// The whole picture.
    pub(super) fn into_rendering(self, effort: &Effort) -> Rendering {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let State { film, errors, outcome, mut accounts } = state;
        accounts.sort_unstable_by_key(|(number, _)| *number);
        let accounts = accounts.iter().map(|(_, account)| account);
        Rendering::of_blocks(film, errors, accounts, outcome, effort)
    }
}

impl Sink for Whole<'_> {
    fn put(&self, block: Block) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let place = block.place.minus(&self.part);
        state.film.blit(&place, &block.colors, &block.samples);
        let (all, width) = (self.part.width() as usize, place.width() as usize);
        for (y, row) in (place.y0 as usize..).zip(block.errors.chunks_exact(width)) {
            let start = y * all + place.x0 as usize;
            state.errors[start..start + width].copy_from_slice(row);
        }
        state.accounts.push((block.number, block.account));
        state.outcome = block.outcome;
    }

    fn report(&self, progress: Progress) {
        (self.progress)(progress);
    }
}
