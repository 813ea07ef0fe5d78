//! Rays through the pixels of a scene's picture.

use std::sync::Mutex;

use glam::DVec2;

use super::{
    RayCounts,
    crew::{Sampler, lock},
    hints::Hint,
    plane::Plane,
};
use crate::{
    aa::Sample,
    camera::View,
    scene::Scene,
    trace::{BATCH, ENOUGH, Tracer},
};

/// More places at once would gain little, and be long without a look at the clock.
const MOST_AT_ONCE: usize = 1 << 16;

/// One place at once for so many primitives.
const PRIMITIVES: usize = 4;

/// How many places of a picture of `scene` are best sampled at once: enough for shadow rays from neighbours in the
/// picture that are far from each other in space to find others that go their way.
pub(super) fn places_at_once(scene: &Scene) -> usize {
    let count = (scene.primitive_count() / PRIMITIVES).min(MOST_AT_ONCE);
    if count < ENOUGH { BATCH } else { count }
}

/// Samples a scene through its camera; what it traces is added to `counts`.
pub(super) struct Worker<'a> {
    pub(super) tracer: Tracer<'a>,
    pub(super) view: View,
    pub(super) at_once: usize,
    /// What is known to be in pixels, if there is anything.
    pub(super) hints: Option<&'a Plane<Hint>>,
    pub(super) counts: &'a Mutex<RayCounts>,
}

impl Sampler for Worker<'_> {
    fn hint(&self, x: u32, y: u32) -> Hint {
        self.hints.map_or(Hint::default(), |known| *known.at(i64::from(x), i64::from(y)))
    }

    fn has_hints(&self) -> bool {
        self.hints.is_some()
    }

    fn at_once(&self) -> usize {
        self.at_once
    }

    fn sample(&mut self, places: &[DVec2], samples: &mut Vec<Sample>) {
        // Where hits do not wait for each other, short lists stay in the caches.
        let at_once = if self.at_once > BATCH { places.len().max(1) } else { BATCH };
        for some in places.chunks(at_once) {
            let dirs = some.iter().map(|place| self.view.direction(*place));
            self.tracer.trace(self.view.eye(), dirs, samples);
        }
        let mut counts = lock(self.counts);
        *counts = *counts + self.tracer.take_counts();
    }
}
