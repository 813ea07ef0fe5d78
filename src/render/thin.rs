//! Things thinner than a pixel, which samples would find by chance alone: where they are is known from the scene.

use glam::DVec3;

use super::hints::{Least, Marks, samples};
use crate::{camera::View, scene::Scene};

/// Wider things than this, in pixels, are found by samples.
pub(super) const WIDEST: f64 = 1.5;
/// Samples across the width of a thing.
const ACROSS: f64 = 2.0;
/// The tip of a cone that is no longer, in pixels, is left to samples; those of all but needles are.
const LONGEST_TIP: f64 = 4.0;
/// Where a thing is cut it is about [`WIDEST`].
const ROUNDING: f64 = 1e-6;
/// How many times as many samples it takes to meet what touches a pixel with a part only.
const IN_A_CORNER: f64 = 4.0;

/// Notes the least number of samples of pixels that something thin touches, as the camera sees it.
///
/// Thin are spheres, cylinders, cones and pieces of meshes where they are narrower than a pixel and a half, hidden or
/// not: two samples across their width, as even as those are, meet what lies across a pixel. As long as all met the same,
/// as many along it are taken, and more.
pub(super) fn mark_thin(scene: &Scene, view: &View, marks: &mut Marks) {
    let primitives = 0..scene.primitive_count() as u32;
    let round = primitives.filter_map(|primitive| scene.shape(primitive).axis());
    let pieces = scene.pieces().iter().map(|(axis, radius)| (*axis, [*radius; 2]));
    for (axis, radii) in round.chain(pieces) {
        let part = thin_part(view, axis, radii);
        if radii[0] == radii[1] {
            mark(part.0, radii[0], view, marks);
        } else if part.0 == axis || film_length(view, part.0) >= LONGEST_TIP {
            for (axis, radius) in slices(part) {
                mark(axis, radius, view, marks);
            }
        }
    }
}

/// Notes what is within `radius` of an axis, if that is thin.
fn mark([from, to]: [DVec3; 2], radius: f64, view: &View, marks: &mut Marks) {
    let (Some((a, pixel_a)), Some((b, pixel_b))) = (view.place(from), view.place(to)) else {
        return; // at or behind the camera
    };
    let width = 2.0 * radius / pixel_a.max(pixel_b);
    if width <= WIDEST * (1.0 + ROUNDING) && width > 0.0 {
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

/// The ends of an axis, and the radii there, between which they change evenly.
type Tapered = ([DVec3; 2], [f64; 2]);

/// The part of a thing that is thin: where it is in front of the camera, far enough for its radius. All of it, if none or
/// both of its ends are.
fn thin_part(view: &View, [from, to]: [DVec3; 2], radii: [f64; 2]) -> Tapered {
    let nearest = radii.map(|radius| 2.0 * radius / (WIDEST * view.pixel()));
    let [first, last] = [view.depth(from) - nearest[0], view.depth(to) - nearest[1]];
    let (at_nearest, radius) = at(([from, to], radii), first / (first - last));
    match [first > 0.0, last > 0.0] {
        [false, true] => ([at_nearest, to], [radius, radii[1]]),
        [true, false] => ([from, at_nearest], [radii[0], radius]),
        _ => ([from, to], radii),
    }
}

/// The place at a part of the way along, and the radius there.
fn at(([from, to], [first, last]): Tapered, part: f64) -> (DVec3, f64) {
    (from + (to - from) * part, first + (last - first) * part)
}

/// A cone in slices, and their largest radii: halved from one to the next, if it has an apex.
fn slices((axis, radii): Tapered) -> impl Iterator<Item = ([DVec3; 2], f64)> {
    let [from, to] = axis;
    let tapered =
        if radii[0] > radii[1] { (axis, radii) } else { ([to, from], [radii[1], radii[0]]) };
    [[0.0, 0.5], [0.5, 0.75], [0.75, 0.875], [0.875, 1.0]].into_iter().map(move |[near, far]| {
        let (a, radius) = at(tapered, near);
        ([a, at(tapered, far).0], radius)
    })
}

/// How long an axis is on the film, in pixels; endless if it reaches behind the camera.
fn film_length(view: &View, [from, to]: [DVec3; 2]) -> f64 {
    match (view.place(from), view.place(to)) {
        (Some((a, _)), Some((b, _))) => (b - a).length(),
        _ => f64::INFINITY,
    }
}
