//! Rays, and what a ray remembers of the surface it leaves.

use glam::DVec3;

/// A half-line `origin + t · dir`, `t > 0`; `t` counts lengths of `dir`, which need not be a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: DVec3,
    /// Where it goes; any finite vector but zero.
    pub dir: DVec3,
    /// The surface it leaves, if it does.
    pub from: Option<Departure>,
}

/// The surface that a ray leaves: which, where, and to which side.
///
/// The side is chosen once, when the ray is made, and never found again from a rounded point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// The primitive.
    pub primitive: u32,
    /// The face of the primitive, as in [`Hit::face`](super::Hit::face).
    pub face: u8,
    /// Whether the ray goes against the outward normal, into a solid.
    pub inward: bool,
    /// The point left, in the primitive's own coordinates, as in [`Surface::local`](super::Surface::local).
    pub local: DVec3,
    /// The point left. The ray's origin is beside it, to find out what is met; where that is, is then computed from
    /// here, so that the steps aside of many bounces do not add up.
    pub point: DVec3,
    /// What rounding took from `point`, as in [`Surface::point_rest`](super::Surface::point_rest).
    pub point_rest: DVec3,
}

impl Ray {
    /// A ray that starts in free space.
    pub fn new(origin: DVec3, dir: DVec3) -> Self {
        Self { origin, dir, from: None }
    }

    /// The point at `t`.
    #[inline(always)]
    pub fn at(&self, t: f64) -> DVec3 {
        DVec3::new(
            self.dir.x.mul_add(t, self.origin.x),
            self.dir.y.mul_add(t, self.origin.y),
            self.dir.z.mul_add(t, self.origin.z),
        )
    }
}
