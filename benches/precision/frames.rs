//! Whole frames: how many tests they take, and what the robust tests cost in them.

use std::{num::NonZeroUsize, sync::Mutex};

use image::RgbImage;
use whitted::{
    aa::AntiAliasing,
    accel::study::{Counts, Leaves, set_leaves, take_counts},
    film::{Difference, encode},
    render::{Progress, RenderOptions, Rendering, render},
    scene::{Scene, load_builtin, load_builtin_of},
};

/// Frames of each kind, in turns; the ratio is that of their medians.
const ROUNDS: usize = 15;

/// A scene's frame.
pub(crate) struct Frame {
    pub(crate) name: String,
    /// Rays in all.
    pub(crate) rays: u64,
    /// The tests of its leaves.
    pub(crate) counts: Counts,
    /// Processor seconds of one thread with robust tests, and with naive ones.
    pub(crate) robust: f64,
    pub(crate) naive: f64,
    /// The middle half of the ratios of neighbouring frames.
    pub(crate) ratios: [f64; 2],
    /// Root mean square of the difference between the two pictures, in levels of 255.
    pub(crate) difference: f64,
}

fn rays(rendering: &Rendering) -> u64 {
    let r = &rendering.rays;
    r.camera + r.reflected + r.refracted + r.transmitted + r.shadow
}

/// A frame by one thread, and the seconds that thread worked.
fn frame(scene: &Scene, leaves: Leaves) -> (Rendering, f64) {
    set_leaves(leaves);
    let (aa, threads) = (AntiAliasing::None, NonZeroUsize::new(1));
    let options = RenderOptions { aa, threads, ..Default::default() };
    let worked = Mutex::new(None);
    // Called by the thread that renders, which is a new one for every frame.
    let progress = |progress: Progress| {
        if progress.done == progress.total {
            *worked.lock().expect("one thread") = thread_seconds();
        }
    };
    let rendering = render(scene, &options, &progress).expect("one thread");
    set_leaves(Leaves::Robust);
    let seconds = worked.into_inner().expect("one thread").unwrap_or(rendering.seconds);
    (rendering, seconds)
}

/// The time this thread has had of a processor, where the system tells.
fn thread_seconds() -> Option<f64> {
    let times = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    times.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| nanoseconds * 1e-9)
}

fn quantile(sorted: &[f64], q: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * q).round() as usize]
}

fn study(name: String, scene: &Scene) -> Frame {
    take_counts();
    let (counted, _) = frame(scene, Leaves::Counted);
    let counts = take_counts();
    let (naive_picture, _) = frame(scene, Leaves::Naive);
    let difference = difference(&counted, &naive_picture);
    let (mut robust, mut naive, mut ratios) = (vec![], vec![], vec![]);
    for round in 0..ROUNDS {
        let order = [Leaves::Robust, Leaves::Naive];
        let mut seconds = [0.0; 2];
        for k in [round % 2, 1 - round % 2] {
            (_, seconds[k]) = frame(scene, order[k]);
        }
        robust.push(seconds[0]);
        naive.push(seconds[1]);
        ratios.push(seconds[0] / seconds[1]);
    }
    for times in [&mut robust, &mut naive, &mut ratios] {
        times.sort_unstable_by(f64::total_cmp);
    }
    Frame {
        name,
        rays: rays(&counted),
        counts,
        robust: quantile(&robust, 0.5),
        naive: quantile(&naive, 0.5),
        ratios: [quantile(&ratios, 0.25), quantile(&ratios, 0.75)],
        difference,
    }
}

fn difference(a: &Rendering, b: &Rendering) -> f64 {
    let picture = |r: &Rendering| {
        let bytes = encode::to_srgb8(&r.film);
        RgbImage::from_raw(r.film.width(), r.film.height(), bytes).expect("three bytes a pixel")
    };
    Difference::between(&picture(a), &picture(b)).expect("of the same size").rmse
}

/// The frames of the assignment scene and of the stress scenes.
pub(crate) fn frames() -> Vec<Frame> {
    let mut frames =
        vec![study("assignment".to_owned(), &load_builtin("assignment").expect("a scene"))];
    for objects in [1_000, 10_000, 100_000] {
        let scene = load_builtin_of("spheres", Some(objects)).expect("a scene");
        frames.push(study(format!("spheres, {objects}"), &scene));
    }
    frames
}
