//! The reference: every ray against every primitive.

use std::ops::ControlFlow;

use crate::geometry::{Crossing, Hit, Ray, Shape};

/// As [`Accel::nearest`](super::Accel::nearest), over a plain list.
pub fn nearest(shapes: &[Shape], ray: &Ray, end: f64) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for (shape, primitive) in shapes.iter().zip(0..) {
        for crossing in shape.crossings_of(ray, primitive) {
            if crossing.t > 0.0 && crossing.t < best.map_or(end, |hit| hit.t) {
                best = Some(Hit { t: crossing.t, primitive, face: crossing.face });
            }
        }
    }
    best
}

/// As [`Accel::any_crossing`](super::Accel::any_crossing), over a plain list.
pub fn any_crossing(
    shapes: &[Shape],
    ray: &Ray,
    end: f64,
    mut visit: impl FnMut(u32, Crossing) -> ControlFlow<()>,
) -> bool {
    for (shape, primitive) in shapes.iter().zip(0..) {
        for crossing in shape.crossings_of(ray, primitive) {
            if crossing.t > 0.0 && crossing.t < end && visit(primitive, crossing).is_break() {
                return true;
            }
        }
    }
    false
}
