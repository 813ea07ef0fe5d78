//! Where light that a surface gives on comes from: the mirror direction, and the one behind the surface.

use glam::DVec3;

use super::RayCounts;
use crate::geometry::{Surface, reflect, refract};

/// The direction in which a ray goes on behind a surface, and counts it; `None` if it is totally reflected, which
/// transmits nothing.
#[inline(always)]
pub(super) fn transmitted(
    counts: &mut RayCounts,
    dir: DVec3,
    surface: &Surface,
    ior: f64,
    inside: bool,
) -> Option<DVec3> {
    if ior == 1.0 {
        counts.transmitted += 1;
        return Some(dir);
    }
    let (from, to) = if inside { (ior, 1.0) } else { (1.0, ior) };
    let refracted = refracted(dir, surface, inside, from, to)?;
    counts.refracted += 1;
    Some(refracted)
}

/// The mirror direction of `dir` by the shading normal. Where that points below the surface, as it may at a grazing
/// view of a coarse mesh, it is mirrored up again.
#[inline(always)]
pub(super) fn mirrored(dir: DVec3, surface: &Surface, inside: bool) -> DVec3 {
    let side = if inside { -1.0 } else { 1.0 };
    let onward = reflect(dir, surface.shading * side);
    if surface.shading != surface.normal && !(onward.dot(surface.normal) * side > 0.0) {
        return reflect(onward, surface.normal * side);
    }
    onward
}

/// The refracted direction by the shading normal, or by the surface's own where the other faces away from the ray or
/// sends it back to its side; `None` if it is totally reflected.
#[inline(always)]
fn refracted(dir: DVec3, surface: &Surface, inside: bool, from: f64, to: f64) -> Option<DVec3> {
    let side = if inside { -1.0 } else { 1.0 };
    let (normal, shading) = (surface.normal * side, surface.shading * side);
    if shading == normal || !(dir.dot(shading) < 0.0) {
        return refract(dir, normal, from, to);
    }
    let onward = refract(dir, shading, from, to)?;
    if onward.dot(normal) < 0.0 { Some(onward) } else { refract(dir, normal, from, to) }
}
