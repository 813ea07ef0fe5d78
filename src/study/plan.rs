//! What a study measures.

use std::num::NonZeroUsize;

use super::Mode;
use crate::{aa::AntiAliasing, accel::Preset};

/// The mode in which pictures of several depths are rendered.
pub(super) const DEPTH_MODE: Mode = Mode::Plain(AntiAliasing::Adaptive { error: 1.0, most: 64 });
/// How many depths are rendered, as far as the time left is concerned: those of the assignment.
const DEPTHS: f64 = 6.0;

/// What to measure, and how thoroughly.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The scenes whose error is plotted against time.
    pub scenes: Vec<String>,
    /// Their modes.
    pub modes: Vec<Mode>,
    /// The numbers of spheres for the cost by objects.
    pub objects: Vec<u32>,
    /// The modes for it, and for the sizes.
    pub few_modes: Vec<Mode>,
    /// The numbers of spheres for which trees are built by each preset.
    pub builds: Vec<u32>,
    /// The scene for depths and sizes.
    pub depth_scene: String,
    /// The sizes.
    pub sizes: Vec<[u32; 2]>,
    /// The size of the pictures of `scenes`, and that of the others.
    pub size: [u32; 2],
    /// The size of the pictures of `objects`, `builds` and depths.
    pub small_size: [u32; 2],
    /// How many rays each pixel of a converged picture has.
    pub reference_rays: u32,
    /// How many times a render is timed: once in each round of those that it is compared with.
    pub repeats: u32,
    /// How many threads render.
    pub threads: Option<NonZeroUsize>,
}

fn plain(texts: &[&str]) -> Vec<Mode> {
    let mode =
        |text: &&str| text.parse::<AntiAliasing>().expect("the plans name modes that there are");
    texts.iter().map(mode).map(Mode::Plain).collect()
}

impl Plan {
    /// Pictures of 600 × 600 against 1024 rays per pixel, up to a million objects.
    pub fn full() -> Self {
        let mut modes = plain(&["none", "grid:2", "grid:3", "grid:4", "grid:6"]);
        modes.extend(plain(&[
            "adaptive:32",
            "adaptive:16",
            "adaptive:8",
            "adaptive:4",
            "adaptive:2",
            "adaptive:1",
            "adaptive:0.5",
        ]));
        modes.extend([4.0, 2.0, 1.0, 0.7].map(Mode::MaxError));
        Self {
            scenes: vec!["assignment".to_owned(), "spheres:10000".to_owned()],
            modes,
            objects: (0..=6).map(|power| 10_u32.pow(power)).collect(),
            few_modes: plain(&["none", "grid:2", "grid:4", "adaptive:16", "adaptive:4"]),
            builds: (4..=6).map(|power| 10_u32.pow(power)).collect(),
            depth_scene: "assignment".to_owned(),
            sizes: vec![[150, 150], [300, 300], [600, 600]],
            size: [600, 600],
            small_size: [300, 300],
            reference_rays: 1024,
            repeats: 5,
            threads: None,
        }
    }

    /// Small pictures against 256 rays per pixel, up to ten thousand objects, each timed once.
    pub fn quick() -> Self {
        let mut modes = plain(&["none", "grid:2", "grid:3", "grid:4"]);
        modes.extend(plain(&["adaptive:16", "adaptive:8", "adaptive:4", "adaptive:2"]));
        modes.extend([4.0, 2.0].map(Mode::MaxError));
        Self {
            modes,
            objects: (0..=4).map(|power| 10_u32.pow(power)).collect(),
            few_modes: plain(&["none", "grid:2", "adaptive:16", "adaptive:4"]),
            builds: (3..=5).map(|power| 10_u32.pow(power)).collect(),
            sizes: vec![[40, 40], [80, 80]],
            size: [100, 100],
            small_size: [60, 60],
            reference_rays: 256,
            repeats: 1,
            ..Self::full()
        }
    }

    /// The work of all of it, in rays through pixels.
    pub(super) fn work(&self) -> f64 {
        let repeats = f64::from(self.repeats);
        let weight = |modes: &[Mode]| {
            f64::from(self.reference_rays) + repeats * modes.iter().map(|m| m.weight()).sum::<f64>()
        };
        let scenes = self.scenes.len() as f64 * pixels(self.size) * weight(&self.modes);
        let few = weight(&self.few_modes);
        let objects = self.objects.len() as f64 * pixels(self.small_size) * few;
        let sizes: f64 = self.sizes.iter().map(|size| pixels(*size) * few).sum();
        let depths = pixels(self.small_size)
            * (f64::from(self.reference_rays) + repeats * DEPTHS * DEPTH_MODE.weight());
        let presets = repeats * Preset::ALL.len() as f64;
        let builds = self.builds.iter().map(|count| {
            pixels(self.small_size) * f64::from(self.reference_rays)
                + presets * build_work(*count as usize, self.small_size)
        });
        scenes + objects + sizes + depths + builds.sum::<f64>()
    }
}

/// The work of a tree over so many primitives, each as a ray, and of a picture through it.
pub(super) fn build_work(primitives: usize, size: [u32; 2]) -> f64 {
    primitives as f64 + pixels(size)
}

pub(super) fn pixels([width, height]: [u32; 2]) -> f64 {
    f64::from(width) * f64::from(height)
}
