//! The directions in which a ray leaves a smooth surface: mirrored, and bent by a change of the index of refraction.

use glam::DVec3;

use crate::math::{
    compensated::{dot_parts, two_product, two_sum},
    cross,
};

/// The mirror image of `dir` in the plane square to `normal`, both of any length: d − 2 (d·n)/(n·n) n.
///
/// Errors that a single bounce does not show add up over a hundred thousand of them. The division is there because
/// normals are of unit length only up to a rounding, which would make a ray steeper at each bounce. And every component
/// is rounded but once, so that a direction that goes to and fro between two mirrors settles instead of drifting.
#[inline(always)]
pub fn reflect(dir: DVec3, normal: DVec3) -> DVec3 {
    let (s, s_rest) = dot_parts(dir, normal);
    let (n, n_rest) = dot_parts(normal, normal);
    let along = -2.0 * (s / n);
    let along_rest = (along.mul_add(-n, -2.0 * s) - 2.0 * s_rest - along * n_rest) / n;
    let component = |d: f64, n: f64| {
        let (step, step_rest) = two_product(along, n);
        let (sum, sum_rest) = two_sum(d, step);
        sum + (sum_rest + along_rest.mul_add(n, step_rest))
    };
    DVec3::new(component(dir.x, normal.x), component(dir.y, normal.y), component(dir.z, normal.z))
}

/// The unit direction in which light of unit direction `dir` goes on behind a surface, by Snell's law; `None` if it is
/// totally reflected.
///
/// `normal` is the unit normal on the side that the light comes from; `eta_incident` and `eta_transmitted` are the
/// indices of refraction before and behind the surface. Equal indices leave the direction as it is, bit for bit.
///
/// With s the sine of the angle of incidence, from n × d and not from n·d, the squared cosine behind the surface is
/// (n₂ − n₁s)(n₂ + n₁s)/n₂², whose first factor decides about total reflection. The usual 1 − (n₁/n₂)²(1 − cos²)
/// cancels twice, at normal incidence and at the critical angle.
#[inline(always)]
pub fn refract(
    dir: DVec3,
    normal: DVec3,
    eta_incident: f64,
    eta_transmitted: f64,
) -> Option<DVec3> {
    if eta_incident == eta_transmitted {
        return Some(dir);
    }
    let turn = cross(normal, dir);
    let sine = turn.length();
    let gap = (-eta_incident).mul_add(sine, eta_transmitted);
    if !(gap >= 0.0) {
        return None; // NaN too
    }
    let cosine = (gap * eta_incident.mul_add(sine, eta_transmitted)).sqrt(); // times n₂
    let tangent = cross(turn, normal); // of length s
    (tangent * eta_incident - normal * cosine).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: Snell's law with 30 degrees in, n = 1.5: the sine behind the surface is 1/3.
    #[test]
    fn sine_shrinks_by_the_index() {
        let dir = DVec3::new(0.5, -(0.75_f64.sqrt()), 0.0);
        let bent = refract(dir, DVec3::Y, 1.0, 1.5).expect("into the denser medium");
        assert!((bent - DVec3::new(1.0 / 3.0, -(8.0_f64.sqrt()) / 3.0, 0.0)).length() < 1e-15);
        let back = refract(bent, DVec3::Y, 1.5, 1.0).expect("as it came");
        assert!((back - dir).length() < 1e-15);
        assert_eq!(refract(DVec3::new(0.8, -0.6, 0.0), DVec3::Y, 1.5, 1.0), None);
    }

    #[test]
    fn mirror_image_is_exact_on_an_axis() {
        let dir = DVec3::new(0.1, -0.7, 1e-300);
        assert_eq!(reflect(dir, DVec3::Y * 1e-5), DVec3::new(0.1, 0.7, 1e-300));
    }
}
