//! Who looks after a picture while it is rendered.

use std::sync::Mutex;

use super::{RayCounts, Sink, adaptive::Adaptive, crew::lock, goal::Unfinished, plane::Area};
use crate::film::Tile;

/// What the sink of a block wants to know of it on its way.
pub(super) struct Watch<'a> {
    pub(super) sink: &'a dyn Sink,
    pub(super) place: &'a Tile,
    /// The rays of all workers.
    pub(super) rays: &'a Mutex<RayCounts>,
}

impl Watch<'_> {
    /// Whether work is to pause, at least until [`Watch::keeps`].
    pub(super) fn interrupts(&self) -> bool {
        self.sink.is_stopped() || self.sink.wants_unfinished()
    }

    /// Keeps the picture as it is, if that is wanted or it is stopped; returns whether it is stopped.
    pub(super) fn keeps(&self, unfinished: &mut Unfinished) -> bool {
        let is_stopped = self.sink.is_stopped();
        if is_stopped || self.sink.wants_unfinished() {
            unfinished.rays = *lock(self.rays);
            self.sink.keep(unfinished);
        }
        is_stopped
    }

    /// The picture as it was kept, if it was.
    pub(super) fn kept(&self) -> Option<Unfinished> {
        let area = Area::of(self.place);
        let unfinished = self.sink.unfinished().filter(|kept| kept.adaptive.is_of(&area))?;
        *lock(self.rays) = unfinished.rays;
        Some(unfinished)
    }

    pub(super) fn show(&self, adaptive: &Adaptive) {
        let (colors, samples) = adaptive.shown();
        self.sink.show(self.place, colors, samples);
    }
}
