//! The circular cylinder about any axis, open (side only) or closed by two discs.
//!
//! In its own frame the base is centred on the origin and the axis is y: the side is x² + z² = r², 0 ≤ y ≤ h.
//!
//! **Intersection.** The point f + t d of the ray lies on the infinite cylinder where
//! (fₓ + t dₓ)² + (f_z + t d_z)² = r², a quadratic a t² + 2 b t + c = 0 with a = dₓ² + d_z²,
//! b = fₓdₓ + f_z d_z, c = fₓ² + f_z² − r²: the circle's equation in the plane of x and z. Of the
//! roots, those with 0 ≤ f_y + t d_y ≤ h count. A ray along the axis has a = 0 and meets no open side.
//!
//! **Normal.** The gradient of x² + z² − r² is (2x, 0, 2z): n = (x, 0, z)/r, or n = (sin a, 0, cos a) at the angle a.
//! It is the cone's normal (sin a cos t, sin t, cos a cos t) for a slope of t = 0.

use glam::DVec3;

use super::{
    Bounds, Ends, Similarity,
    hit::{Crossing, Crossings, NO_CROSSINGS, Surface},
    ray::{Departure, Ray},
    shape_error::ShapeError,
    solid::{Interval, leaving},
};
use crate::math::{Frame, Roots, compensated::hypot, difference_of_products, scale};

/// The faces of a cylinder.
const SIDE: u8 = 0;
const BASE: u8 = 1;
const TOP: u8 = 2;

/// A circular cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    base: DVec3,
    top: DVec3,
    frame: Frame,
    height: f64,
    radius: f64,
    ends: Ends,
}

impl Cylinder {
    /// The cylinder whose axis goes from the middle of the `base` to the middle of the `top`.
    ///
    /// # Errors
    /// A radius that is not positive and finite, or a base and top that are not finite or not apart.
    pub fn try_new(base: DVec3, top: DVec3, radius: f64, ends: Ends) -> Result<Self, ShapeError> {
        ShapeError::check_length("radius", radius)?;
        let (axis, height) = ShapeError::check_axis(("base", base), ("top", top))?;
        Ok(Self { base, top, frame: Frame::around(axis), height, radius, ends })
    }

    /// The middle of the base and of the top.
    pub fn axis_points(&self) -> [DVec3; 2] {
        [self.base, self.top]
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether it is closed.
    pub fn ends(&self) -> Ends {
        self.ends
    }

    pub(crate) fn bounds(&self) -> Bounds {
        let reach = disc_reach(self.frame.axis()) * self.radius;
        Bounds::of_points([
            self.base - reach,
            self.base + reach,
            self.top - reach,
            self.top + reach,
        ])
    }

    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        Self {
            base: map.point(self.base),
            top: map.point(self.top),
            height: map.length(self.height),
            radius: map.length(self.radius),
            ..*self
        }
    }

    /// The crossings of the line of `ray`.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let (f, d) = (self.frame.to_local(ray.origin - self.base), self.frame.to_local(ray.dir));
        match self.ends {
            Ends::Open => self.open(f, d),
            Ends::Closed => self.closed(f, d),
        }
    }

    /// The interval of the ray within the infinite cylinder; `None` if it passes by.
    #[inline(always)]
    fn within_side(&self, f: DVec3, d: DVec3) -> Option<Interval> {
        let reach = hypot(d.x, d.z);
        let distance = hypot(f.x, f.z);
        if reach == 0.0 {
            return (distance <= self.radius).then_some(Interval::ALL);
        }
        let (reach_r, offset) =
            (self.radius * reach, difference_of_products(f.x, d.z, f.z, d.x).abs());
        let gap = reach_r - offset;
        if !(gap >= 0.0) {
            return None; // NaN is a miss
        }
        let a = d.x.mul_add(d.x, d.z * d.z);
        let b = f.x.mul_add(d.x, f.z * d.z);
        let c = (distance - self.radius) * (distance + self.radius);
        let (t0, t1) = Roots::new(a, b, c, (gap * (reach_r + offset)).sqrt()).sorted();
        Some(Interval::new(t0, t1))
    }

    #[inline(always)]
    fn open(&self, f: DVec3, d: DVec3) -> Crossings {
        match self.within_side(f, d) {
            Some(side) => [self.on_side(f, d, side.enter.t), self.on_side(f, d, side.exit.t)],
            None => NO_CROSSINGS,
        }
    }

    /// The crossing of the side at `t`, if that lies between the ends.
    #[inline(always)]
    fn on_side(&self, f: DVec3, d: DVec3, t: f64) -> Crossing {
        let y = t.mul_add(d.y, f.y);
        if y >= 0.0 && y <= self.height { Crossing::at(t) } else { Crossing::NONE }
    }

    #[inline(always)]
    fn closed(&self, f: DVec3, d: DVec3) -> Crossings {
        let inside = self.within_side(f, d).and_then(|side| self.between_ends(side, f, d));
        inside.map_or(NO_CROSSINGS, Interval::crossings)
    }

    #[inline(always)]
    fn between_ends(&self, side: Interval, f: DVec3, d: DVec3) -> Option<Interval> {
        side.above(f.y, d.y, BASE)?.above(self.height - f.y, -d.y, TOP)
    }

    /// The crossings of a ray that leaves this cylinder.
    ///
    /// Outward none, as it is convex. Inward from the side, the far side is at −2b/a, without a subtraction.
    #[inline(always)]
    pub(crate) fn crossings_from(&self, ray: &Ray, from: &Departure) -> Crossings {
        if !from.inward {
            return NO_CROSSINGS;
        }
        let (q, d) = (from.local, self.frame.to_local(ray.dir));
        let far = match from.face {
            SIDE => {
                let b = q.x.mul_add(d.x, q.z * d.z);
                (-2.0 * b / d.x.mul_add(d.x, d.z * d.z)).max(f64::MIN_POSITIVE)
            }
            _ => self
                .within_side(q, d)
                .map_or(f64::MIN_POSITIVE, |side| side.exit.t.max(f64::MIN_POSITIVE)),
        };
        match self.ends {
            Ends::Open => [self.on_side(q, d, far), Crossing::NONE],
            Ends::Closed => leaving(self.between_ends(Interval::new(0.0, far), q, d)),
        }
    }

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, t: f64, face: u8, own: Option<&Departure>) -> Surface {
        let start =
            own.map_or_else(|| self.frame.to_local(ray.origin - self.base), |from| from.local);
        let mut q = start + self.frame.to_local(ray.dir) * t;
        q.y = q.y.clamp(0.0, self.height);
        let normal = match face {
            SIDE => {
                // On the axis only if the cylinder is of no width in the scene.
                let out = scale::unit(DVec3::new(q.x, 0.0, q.z)).unwrap_or(DVec3::X);
                (q.x, q.z) = (out.x * self.radius, out.z * self.radius);
                out
            }
            BASE => {
                q.y = 0.0;
                DVec3::NEG_Y
            }
            _ => {
                q.y = self.height;
                DVec3::Y
            }
        };
        let point = self.base + self.frame.to_world(q);
        let normal = self.frame.to_world(normal);
        let error = Surface::error_bound(normal, point.abs() + self.radius + self.height);
        Surface { local: q, ..Surface::plain(point, normal, error) }
    }
}

/// How far a disc of radius 1 about the origin, square to `axis`, reaches along each coordinate axis.
pub(super) fn disc_reach(axis: DVec3) -> DVec3 {
    DVec3::new(axis.y.hypot(axis.z), axis.z.hypot(axis.x), axis.x.hypot(axis.y))
}
