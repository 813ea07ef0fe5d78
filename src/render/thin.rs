//! Things thinner than a pixel, which samples would find by chance alone: where they are is known from the scene.

use glam::{DVec2, DVec3};

use super::{
    crew::Least,
    plane::{Area, Plane},
};
use crate::{camera::View, scene::Scene};

/// Wider things than this, in pixels, are found by samples.
const WIDEST: f64 = 1.5;
/// Samples across the width of a thing.
const ACROSS: f64 = 2.0;
/// How many times as many samples it takes to meet what touches a pixel with a part only.
const IN_A_CORNER: f64 = 4.0;

/// The least number of samples of pixels that something thin touches, as the camera sees it; 0 elsewhere.
///
/// Thin are spheres, cylinders, cones and pieces of meshes narrower than a pixel and a half, hidden or not: two samples across their
/// width, as even as those are, meet what lies across a pixel. As long as all met the same, as many along it are taken, and more. None if there is nothing thin.
pub(super) fn least_samples(scene: &Scene, view: &View, area: &Area) -> Option<Plane<Least>> {
    let mut least: Option<Plane<Least>> = None;
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
            let rounded = |samples: f64| samples.ceil().min(f64::from(u32::MAX)) as u32;
            let (across, length) = (ACROSS / width, ((b - a).length() + width).min(1.0));
            // Where nothing of it was met it may be short, such as a sphere, or in a corner.
            let if_alike = across * (ACROSS / length).max(1.0) * IN_A_CORNER;
            let samples = Least { samples: rounded(across), if_alike: rounded(if_alike) };
            let least = least.get_or_insert_with(|| Plane::new(*area, Least::default()));
            mark(least, a, b, reach, samples);
        }
    }
    least
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

/// Marks all pixels that come within `reach` of the way from `a` to `b`.
fn mark(least: &mut Plane<Least>, a: DVec2, b: DVec2, reach: f64, samples: Least) {
    let area = *least.area();
    let clip = |x: f64, low: i64, high: i64| (x.floor() as i64).clamp(low, high);
    let (low, high) = (a.min(b) - reach, a.max(b) + reach);
    for y in clip(low.y, area.y0, area.y1)..clip(high.y + 1.0, area.y0, area.y1) {
        // The part of the way that comes near the row, and the columns that it crosses there.
        let (top, bottom) = (y as f64 - reach, y as f64 + 1.0 + reach);
        let at = |row: f64| ((row - a.y) / (b.y - a.y)).clamp(0.0, 1.0);
        let (s, t) = if a.y == b.y { (0.0, 1.0) } else { (at(top), at(bottom)) };
        let (p, q) = (a.x + (b.x - a.x) * s, a.x + (b.x - a.x) * t);
        let (left, right) = (p.min(q) - reach, p.max(q) + reach);
        for x in clip(left, area.x0, area.x1)..clip(right + 1.0, area.x0, area.x1) {
            let least = least.at_mut(x, y);
            *least = least.max(samples);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the distance of each pixel's points to the way, on a fine grid of them.
    #[test]
    fn every_pixel_that_is_touched_is_marked_and_few_others() {
        let area = Area { x0: 0, y0: 0, x1: 20, y1: 16 };
        for (a, b, reach) in [
            (DVec2::new(3.3, 2.2), DVec2::new(3.3, 2.2), 0.3),
            (DVec2::new(1.5, 3.0), DVec2::new(18.2, 3.9), 0.02),
            (DVec2::new(4.1, -3.0), DVec2::new(5.3, 30.0), 0.4),
            (DVec2::new(15.0, 14.0), DVec2::new(2.0, 1.0), 0.1),
        ] {
            let mut least = Plane::new(area, Least::default());
            let seven = Least { samples: 7, if_alike: 9 };
            mark(&mut least, a, b, reach, seven);
            let mut touched = 0;
            for (x, y) in area.pixels() {
                let near = (0..400).any(|k| {
                    let p = DVec2::new(
                        x as f64 + f64::from(k % 20) / 19.0,
                        y as f64 + f64::from(k / 20) / 19.0,
                    );
                    let t =
                        ((p - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
                    p.distance(a + (b - a) * t) < reach
                });
                touched += usize::from(near);
                assert!(!near || *least.at(x, y) == seven, "{a} {b}: {x}, {y}");
            }
            let marked = least.values().iter().filter(|n| n.is_some()).count();
            assert!(marked <= 2 * touched + 8, "{marked} for {touched}");
        }
    }
}
