//! The laws of reflection and refraction.

use glam::DVec3;

use crate::math::cross;

/// The mirror direction of `dir` at a surface with the unit `normal`, on either side of it.
pub fn reflect(dir: DVec3, normal: DVec3) -> DVec3 {
    dir - normal * (2.0 * dir.dot(normal))
}

/// The direction of a ray after an interface, by Snell's law; `None` if it is totally reflected.
///
/// `dir` and `normal` are unit vectors, the normal on the side the ray comes from (`dir · normal < 0`); the indices of
/// refraction are those before and behind the interface. Equal indices return `dir` itself.
///
/// With s the sine of the angle of incidence, cos² behind is 1 − (η₁ s/η₂)² = (η₂ − η₁ s)(η₂ + η₁ s)/η₂², which keeps its
/// sign at the critical angle; s comes from the cross product, since 1 − cos² cancels at normal incidence.
pub fn refract(dir: DVec3, normal: DVec3, ior_before: f64, ior_behind: f64) -> Option<DVec3> {
    if ior_before == ior_behind {
        return Some(dir);
    }
    let sine = cross(normal, dir).length();
    let squared = (ior_behind - ior_before * sine) * (ior_behind + ior_before * sine);
    if !(squared >= 0.0) {
        return None;
    }
    let cosine = -dir.dot(normal);
    let eta = ior_before / ior_behind;
    let along = squared.sqrt() / ior_behind;
    Some((dir * eta + normal * (eta * cosine - along)).normalize())
}
