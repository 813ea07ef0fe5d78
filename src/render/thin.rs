//! Things thinner than a pixel, which samples would find by chance alone: where they are is known from the scene.

use glam::{DVec2, DVec3};

use super::hints::{Least, Marks, samples};
use crate::{camera::View, geometry::Brick, scene::Scene};

/// Wider things than this, in pixels, are found by samples.
pub(super) const WIDEST: f64 = 1.5;
/// Narrower things, in pixels, change no colour by a quarter of a level, not even white ones on black, where the encoding is
/// steepest (12.92).
const NARROWEST: f64 = 1.0 / (1 << 14) as f64;
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
/// Thin are spheres, cylinders, cones and pieces of meshes and of flat shapes where they are narrower than a pixel and a
/// half, hidden or not: two samples across their width, as even as those are, meet what lies across a pixel. As long as
/// all met the same, as many along it are taken, and more.
pub(super) fn mark_thin(scene: &Scene, view: &View, marks: &mut Marks) {
    for primitive in 0..scene.primitive_count() as u32 {
        let Some((axis, radii)) = scene.shape(primitive).axis() else { continue };
        let is_disc =
            axis[0].distance(axis[1]) < 2.0 * radii[0].max(radii[1]) && axis[0] != axis[1];
        let sight = axis[0] - view.eye();
        if !is_disc || !mark_brick(&Brick::about(axis, radii[0].max(radii[1]), sight), view, marks)
        {
            mark_round((axis, radii), view, marks);
        }
    }
    for brick in scene.pieces() {
        if !mark_brick(brick, view, marks) {
            let Brick { middle, halves: [long, wide, high] } = *brick;
            let radius = (wide + high).length();
            mark_round(([middle - long, middle + long], [radius; 2]), view, marks);
        }
    }
}

/// Notes a brick, if all of it is in front of the camera and thin; returns whether it is.
fn mark_brick(brick: &Brick, view: &View, marks: &mut Marks) -> bool {
    let [a, b, c] = brick.halves.map(DVec3::length);
    // A ball fits into it.
    let widest_pixel = view.pixel() * (view.depth(brick.middle) + a + b + c);
    if 2.0 * a.min(b).min(c) > WIDEST * widest_pixel {
        return false;
    }
    let corners = brick.corners().map(|corner| view.place(corner));
    if corners.contains(&None) {
        return false;
    }
    let corners = corners.map(|corner| corner.map_or(DVec2::ZERO, |(place, _)| place));
    // What a box hides is narrowest across one of its edges.
    let strips = [1, 2, 4].map(|edge| strip(&corners, corners[edge] - corners[0]));
    let strip = strips.into_iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1));
    let Some((ends, width)) = strip.filter(|(_, width)| *width <= WIDEST) else { return false };
    note(ends, width, width / 2.0, marks);
    true
}

/// The strip along a direction that holds all places: the ends of its middle line, and its width. None if there is no direction.
fn strip(places: &[DVec2], direction: DVec2) -> Option<([DVec2; 2], f64)> {
    let along = direction.try_normalize()?;
    let range = |of: DVec2| {
        let numbers = places.iter().map(|place| place.dot(of));
        numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let ([from, to], [low, high]) = (range(along), range(along.perp()));
    let middle = along.perp() * low.midpoint(high);
    Some(([along * from + middle, along * to + middle], high - low))
}

/// Notes the thin part of what is round about an axis.
fn mark_round(tapered: Tapered, view: &View, marks: &mut Marks) {
    let (axis, radii) = tapered;
    let part = thin_part(view, axis, radii);
    if radii[0] == radii[1] {
        mark(part.0, radii[0], view, marks);
    } else if part.0 == axis || film_length(view, part.0) >= LONGEST_TIP {
        for (axis, radius) in slices(part) {
            mark(axis, radius, view, marks);
        }
    }
}

/// Notes what is within `radius` of an axis, if that is thin.
fn mark([from, to]: [DVec3; 2], radius: f64, view: &View, marks: &mut Marks) {
    let (Some((a, pixel_a)), Some((b, pixel_b))) = (view.place(from), view.place(to)) else {
        return; // at or behind the camera
    };
    let width = 2.0 * radius / pixel_a.max(pixel_b);
    if width <= WIDEST * (1.0 + ROUNDING) {
        note([a, b], width, radius / pixel_a.min(pixel_b), marks);
    }
}

/// Notes what has a width and is within `reach` of a line on the film, all in pixels.
fn note([a, b]: [DVec2; 2], width: f64, reach: f64, marks: &mut Marks) {
    if width < NARROWEST {
        return;
    }
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
