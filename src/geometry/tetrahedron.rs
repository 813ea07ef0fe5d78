//! The regular tetrahedron that stands on its base, assembled from six planes.

use glam::DVec3;

use super::{shape_error::ShapeError, triangle::Triangle};

/// The six planes of a regular tetrahedron: three sides, and the base cut in three about its centre.
///
/// `base_center` is the middle of the base, `edge` the length of every edge and `turn` the angle in radians from +z
/// towards +x at which the first corner of the base stands; the tip is above. The planes share their corners exactly,
/// so that no ray slips between two of them, and face outward.
///
/// # Errors
/// An edge that is not positive and finite, or a centre or angle that is not finite.
pub fn tetrahedron(base_center: DVec3, edge: f64, turn: f64) -> Result<[Triangle; 6], ShapeError> {
    ShapeError::check_point("base_center", base_center)?;
    ShapeError::check_length("edge", edge)?;
    let radius = edge / 3.0_f64.sqrt();
    let corner = |k: f64| {
        let angle = turn + k * std::f64::consts::TAU / 3.0;
        base_center + DVec3::new(radius * angle.sin(), 0.0, radius * angle.cos())
    };
    let (p, t) = (base_center, [corner(0.0), corner(1.0), corner(2.0)]);
    let tip = base_center + DVec3::Y * (edge * (2.0_f64 / 3.0).sqrt());
    let side = |k: usize| Triangle::try_new([t[k], t[(k + 1) % 3], tip]);
    let base = |k: usize| Triangle::try_new([p, t[(k + 1) % 3], t[k]]);
    Ok([side(0)?, side(1)?, side(2)?, base(0)?, base(1)?, base(2)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the corners that the scene's description gives, rounded to four decimals.
    #[test]
    fn corners_are_those_of_the_assignment() {
        let planes = tetrahedron(DVec3::new(17.0, 3.0, -118.0), 8.0, (-10.0_f64).to_radians())
            .expect("a tetrahedron");
        let expected = [
            [16.1980, 3.0, -113.4514],
            [21.3403, 3.0, -119.5797],
            [13.4618, 3.0, -120.9689],
            [17.0, 9.5320, -118.0],
        ];
        let [t0, t1, tip] = planes[0].vertices();
        let t2 = planes[1].vertices()[1];
        for (corner, expected) in [t0, t1, t2, tip].into_iter().zip(expected) {
            assert!(
                (corner - DVec3::from_array(expected)).abs().max_element() < 5.1e-5,
                "{corner}"
            );
        }
    }

    /// Oracle: on a closed surface every edge is met once each way, and the volume by the divergence theorem is
    /// a³/(6√2).
    #[test]
    fn six_planes_close_the_solid_and_face_outward() {
        let planes = tetrahedron(DVec3::new(1.0, -2.0, 3.0), 2.0, 0.4).expect("a tetrahedron");
        let bits = |v: DVec3| v.to_array().map(f64::to_bits);
        let mut edges = Vec::new();
        let mut volume = 0.0;
        for plane in &planes {
            let [a, b, c] = plane.vertices();
            edges.extend([(a, b), (b, c), (c, a)].map(|(p, q)| (bits(p), bits(q))));
            volume += a.dot(b.cross(c)) / 6.0;
        }
        for (p, q) in &edges {
            let count = |p, q| edges.iter().filter(|e| **e == (p, q)).count();
            assert_eq!((count(*p, *q), count(*q, *p)), (1, 1));
        }
        assert!((volume - 8.0 / (6.0 * 2.0_f64.sqrt())).abs() < 1e-12, "{volume}");
    }
}
