//! A shape that is seen from inside only, as the Neutral File Format knows it.

use glam::DVec3;

use super::{
    Bounds, Shape, Similarity,
    hit::{Crossing, Crossings, Hit, Surface},
    ray::{Departure, Ray},
};

/// A shape that only rays from inside meet; to all others it is not there, to those of shadows neither.
///
/// The inside is the side that [`Surface::normal`] points away from. Of a round shape a ray from outside thus meets the
/// far wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Inward {
    shape: Shape,
}

// The shapes' methods are inlined wherever they are called; those here call them in turn, and so are not.
impl Inward {
    /// What is seen of `shape` from inside.
    pub fn new(shape: Shape) -> Self {
        Self { shape }
    }

    /// The shape as it would be seen from both sides.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    pub(crate) fn bounds(&self) -> Bounds {
        self.shape.bounds()
    }

    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        Self::new(self.shape.mapped(map))
    }

    /// The crossings of the line of `ray`.
    #[inline(never)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        self.shape.crossings(ray).map(|crossing| {
            let hit = Hit { t: crossing.t, primitive: 0, face: crossing.face };
            let is_met = crossing.t.is_finite()
                && self.shape.surface_at(ray, &hit, None, DVec3::ZERO).is_met_from_inside(ray.dir);
            if is_met { crossing } else { Crossing::NONE }
        })
    }

    /// The crossings of a ray that leaves this shape: one that goes inward comes to the wall from inside.
    #[inline(never)]
    pub(crate) fn crossings_from(&self, ray: &Ray, from: &Departure) -> Crossings {
        self.shape.crossings_from(ray, from)
    }

    #[inline(never)]
    pub(crate) fn surface(
        &self,
        ray: &Ray,
        hit: &Hit,
        own: Option<&Departure>,
        rest: DVec3,
    ) -> Surface {
        self.shape.surface_at(ray, hit, own, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Cone, Cylinder, Ends, Sphere};

    /// A shape about the y axis, and a function that is positive outside it.
    type Case = (Shape, fn(DVec3) -> f64);

    fn cases() -> [Case; 4] {
        let middle = DVec3::Y * 2.0;
        let cone = Cone::try_new(DVec3::ZERO, middle, 1.0, Ends::Open);
        let stump = Cone::truncated(DVec3::ZERO, DVec3::Y, 1.0, 0.5);
        let tip = |p: DVec3| p.x.hypot(p.z) - 0.5 * (2.0 - p.y);
        [
            (Sphere::try_new(middle, 1.0).expect("valid").into(), |p| {
                p.distance(DVec3::Y * 2.0) - 1.0
            }),
            (Cylinder::try_new(DVec3::ZERO, middle, 1.0, Ends::Open).expect("valid").into(), |p| {
                p.x.hypot(p.z) - 1.0
            }),
            (cone.expect("valid").into(), tip),
            (stump.expect("valid").into(), tip),
        ]
    }

    /// Oracle: what the ray comes from is told by the sign of the shape's equation on both sides of the crossing.
    #[test]
    fn crossings_are_those_that_lead_out() {
        let at = |k: u32, scale: f64| (f64::from(k % 7) - 2.9) * scale;
        for (shape, outside) in cases() {
            let inward = Shape::from(Inward::new(shape.clone()));
            assert_eq!(inward.bounds(), shape.bounds());
            let (mut seen, mut passed) = (0, 0);
            for k in 0..7_u32.pow(4) {
                let origin = DVec3::new(at(k, 0.6), 0.7, at(k / 7, 0.5));
                let dir = DVec3::new(at(k / 49, 0.4), at(k / 343, 0.3), 1.1);
                let ray = Ray::new(origin, dir);
                for (all, one) in shape.crossings(&ray).iter().zip(inward.crossings(&ray)) {
                    if all.t.is_nan() {
                        assert!(one.t.is_nan());
                        continue;
                    }
                    let (before, after) = (ray.at(all.t - 1e-6), ray.at(all.t + 1e-6));
                    let leads_out = outside(before) < outside(after);
                    assert_eq!(one.t.to_bits() == all.t.to_bits(), leads_out, "{shape:?} {ray:?}");
                    *(if leads_out { &mut seen } else { &mut passed }) += 1;
                }
            }
            assert!(seen > 100 && passed > 100, "{shape:?}: {seen}, {passed}");
        }
    }

    /// Oracle: the chord of a circle, from a point of it at 45 degrees to the radius, is the radius times the root of
    /// two.
    #[test]
    fn a_ray_that_is_mirrored_inside_comes_to_the_next_place_of_the_wall() {
        let shape =
            Shape::from(Inward::new(Sphere::try_new(DVec3::ZERO, 1.0).expect("valid").into()));
        let ray = Ray::new(DVec3::new(-9.0, 0.5_f64.sqrt(), 0.0), DVec3::X);
        let (hit, surface) = shape.first_hit(0, &ray).expect("the far wall");
        assert!((hit.t - 9.0 - 0.5_f64.sqrt()).abs() < 1e-15 * 16.0, "{hit:?}");
        let inside = surface.leave(&hit, DVec3::NEG_Y, true);
        let (next, _) = shape.first_hit(0, &inside).expect("the wall below");
        assert!((next.t - 2.0_f64.sqrt()).abs() < 1e-14, "{next:?}");
        let outside = surface.leave(&hit, DVec3::X, false);
        assert_eq!(shape.first_hit(0, &outside), None);
    }
}
