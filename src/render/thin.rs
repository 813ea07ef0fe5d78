//! Things thinner than a pixel, which samples would find by chance alone: where they are is known from the scene.

use glam::DVec3;

use super::hints::{Least, Marks, samples};
use crate::{camera::View, scene::Scene};

/// Wider things than this, in pixels, are found by samples.
pub(super) const WIDEST: f64 = 1.5;
/// Samples across the width of a thing.
const ACROSS: f64 = 2.0;
/// How many times as many samples it takes to meet what touches a pixel with a part only.
const IN_A_CORNER: f64 = 4.0;

/// Notes the least number of samples of pixels that something thin touches, as the camera sees it.
///
/// Thin are spheres, cylinders, cones and pieces of meshes narrower than a pixel and a half, hidden or not: two samples
/// across their width, as even as those are, meet what lies across a pixel. As long as all met the same, as many along
/// it are taken, and more.
pub(super) fn mark_thin(scene: &Scene, view: &View, marks: &mut Marks) {
    let primitives = 0..scene.primitive_count() as u32;
    let round = primitives.filter_map(|primitive| scene.shape(primitive).axis());
    for (axis, radius) in round.chain(scene.pieces().iter().copied()) {
        let [from, to] = thin_part(view, axis, radius);
        let (Some((a, pixel_a)), Some((b, pixel_b))) = (view.place(from), view.place(to)) else {
            continue; // at or behind the camera
        };
        let width = 2.0 * radius / pixel_a.max(pixel_b);
        if width <= WIDEST && width > 0.0 {
            let reach = radius / pixel_a.min(pixel_b);
            let (across, length) = (ACROSS / width, ((b - a).length() + width).min(1.0));
            // Where nothing of it was met it may be short, such as a sphere, or in a corner.
            let if_alike = across * (ACROSS / length).max(1.0) * IN_A_CORNER;
            let least = Least {
                samples: samples(across),
                if_alike: samples(if_alike),
                part: (width * length).min(1.0) as f32,
            };
            marks.note([a, b], reach, |known| known.least = known.least.max(least));
        }
    }
}

/// The part of an axis where what is within `radius` of it is thin: from where it is in front of the camera, and far enough. All of
/// it, if none or both of its ends are.
fn thin_part(view: &View, [from, to]: [DVec3; 2], radius: f64) -> [DVec3; 2] {
    let nearest = 2.0 * radius / (WIDEST * view.pixel());
    let [first, last] = [from, to].map(|point| view.depth(point));
    let at_nearest = || from + (to - from) * ((nearest - first) / (last - first));
    match [first, last].map(|depth| depth > nearest) {
        [false, true] => [at_nearest(), to],
        [true, false] => [from, at_nearest()],
        _ => [from, to],
    }
}
