//! Rays through the pixels of a scene's picture.

use std::sync::{Mutex, PoisonError};

use glam::DVec2;

use super::{RayCounts, crew::Sampler, hints::Hint, plane::Plane};
use crate::{
    aa::Sample,
    camera::View,
    color::Rgb,
    scene::Scene,
    trace::{self, BATCH, ENOUGH, Tracer},
};

/// Places that are sampled at once at most.
const MOST_AT_ONCE: usize = 1 << 16;

/// So many times as often does each thread sample a share of the picture at least, so that all end about the same time.
const SHARES: usize = 6;

/// For so many primitives a place is sampled beside those that are sampled at once.
const PRIMITIVES: usize = 4;

/// How many places are best sampled at once in a picture of so many pixels by so many threads: enough for shadow rays
/// that leave neighbours in the picture for different things to find others that go their way.
pub(super) fn places_at_once(scene: &Scene, pixels: usize, threads: usize) -> usize {
    let dense = (scene.primitive_count() / PRIMITIVES).min(MOST_AT_ONCE);
    let count = dense.min(pixels / (SHARES * threads));
    if count < ENOUGH { BATCH } else { count }
}

/// Samples a scene through its camera; what it traced is added to `counts` in the end.
pub(super) struct Worker<'a> {
    pub(super) tracer: Tracer<'a>,
    pub(super) view: View,
    pub(super) traced: Vec<trace::Sample>,
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
        for some in places.chunks(self.at_once) {
            let dirs = some.iter().map(|place| self.view.direction(*place));
            self.tracer.trace(self.view.eye(), dirs, &mut self.traced);
            samples.extend(self.traced.iter().map(|traced| Sample {
                // A NaN, which no valid scene has, would be black.
                color: traced.color.max(Rgb::ZERO).min(Rgb::ONE),
                signature: traced.signature,
                cell: traced.cell,
                rays: traced.rays,
            }));
        }
    }
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        *counts = *counts + self.tracer.counts();
    }
}
