//! The circular cone about any axis, from its apex to its base, open (side only) or closed by the base disc.
//!
//! In its own frame the apex is the origin, the axis is y and the base lies at y = −h: with R the base radius, the
//! side is x² + z² = (R/h)² y², −h ≤ y ≤ 0. The equation has a second nappe, above the apex, which
//! is no part of the cone.
//!
//! **Intersection.** Scaled by (h, R, h), the cone is part of the unit cone X² + Z² = Y² (`unit_cone`). Of the points
//! where the ray meets that, those with −R h ≤ Y ≤ 0 count.
//!
//! **Normal.** Put a point of the side at the angle a about the axis and let t be the angle by which the normal rises
//! above the horizontal. The generator falls by h over R, so tan t = R/h, and the gradient of
//! x² + z² − (R/h)² y² gives
//!
//! n = (sin a cos t, sin t, cos a cos t), with sin a = x/ρ, cos a = z/ρ, ρ = √(x² + z²),
//!
//! that is (h x, R ρ, h z) normalised. At the apex, where there is no normal, the axis is taken.

use glam::DVec3;

use super::{
    Bounds, Ends, Similarity,
    cylinder::disc_reach,
    hit::{Crossing, Crossings, NO_CROSSINGS, Surface},
    ray::{Departure, Ray},
    shape_error::ShapeError,
    solid::{Interval, leaving},
    unit_cone::{self, Root, SideRoots, flip},
};
use crate::math::{Frame, compensated::hypot, dot, scale};

/// The faces of a cone.
const SIDE: u8 = 0;
const BASE: u8 = 1;

/// A circular cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    base: DVec3,
    apex: DVec3,
    frame: Frame,
    height: f64,
    radius: f64,
    /// How far below the apex the cone begins: 0, unless it is truncated.
    cut: f64,
    ends: Ends,
}

impl Cone {
    /// The cone with a disc of `radius` about `base` for its base.
    ///
    /// # Errors
    /// A radius that is not positive and finite, or a base and apex that are not finite or not apart.
    pub fn try_new(base: DVec3, apex: DVec3, radius: f64, ends: Ends) -> Result<Self, ShapeError> {
        ShapeError::check_length("radius", radius)?;
        let (axis, height) = ShapeError::check_axis(("base", base), ("apex", apex))?;
        Ok(Self { base, apex, frame: Frame::around(axis), height, radius, cut: 0.0, ends })
    }

    /// The open side of a truncated cone, with these radii about `base` and `top`, either of which may be the larger.
    ///
    /// The missing tip may be far away: where the radii agree to n digits, the ends are placed with n digits less, so
    /// nearly equal radii are better made a cylinder.
    ///
    /// # Errors
    /// Radii that are not positive, finite and different, or ends that are not finite or not apart, or an apex beyond
    /// all numbers.
    pub fn truncated(
        base: DVec3,
        top: DVec3,
        base_radius: f64,
        top_radius: f64,
    ) -> Result<Self, ShapeError> {
        ShapeError::check_length("base_radius", base_radius)?;
        ShapeError::check_length("top_radius", top_radius)?;
        if top_radius > base_radius {
            return Self::truncated(top, base, top_radius, base_radius);
        }
        let (axis, part) = ShapeError::check_axis(("base", base), ("top", top))?;
        let narrowing = base_radius - top_radius;
        ShapeError::check_length("difference of the radii", narrowing)?;
        let height = part * (base_radius / narrowing);
        let apex = base + axis * height;
        ShapeError::check_point("apex", apex)?;
        let (frame, cut) = (Frame::around(axis), part * (top_radius / narrowing));
        Ok(Self { base, apex, frame, height, radius: base_radius, cut, ends: Ends::Open })
    }

    /// The middle of the base, and the apex.
    pub fn axis_points(&self) -> [DVec3; 2] {
        [self.base, self.apex]
    }

    /// The radius of the base.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The middle of where it ends towards the apex, and the radius there.
    pub(crate) fn top(&self) -> (DVec3, f64) {
        (self.apex - self.frame.axis() * self.cut, self.radius * (self.cut / self.height))
    }

    /// Whether it is closed.
    pub fn ends(&self) -> Ends {
        self.ends
    }

    pub(crate) fn bounds(&self) -> Bounds {
        let reach = disc_reach(self.frame.axis()) * self.radius;
        let upper = reach * (self.cut / self.height);
        let (top, _) = self.top();
        Bounds::of_points([self.base - reach, self.base + reach, top - upper, top + upper])
    }

    pub(crate) fn mapped(&self, map: &Similarity) -> Self {
        Self {
            base: map.point(self.base),
            apex: map.point(self.apex),
            height: map.length(self.height),
            radius: map.length(self.radius),
            cut: map.length(self.cut),
            ..*self
        }
    }

    /// The crossings of the line of `ray`.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let (f, d) = (self.frame.to_local(ray.origin - self.apex), self.frame.to_local(ray.dir));
        match self.ends {
            Ends::Open => self.open(f, d),
            Ends::Closed => {
                let above_base = self.frame.axis().dot(ray.origin - self.base);
                self.inside(f, d, above_base).map_or(NO_CROSSINGS, Interval::crossings)
            }
        }
    }

    /// The vector `v` of the cone's frame where the cone is the unit cone.
    #[inline(always)]
    fn scaled_to_unit(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.height * v.x, self.radius * v.y, self.height * v.z)
    }

    #[inline(always)]
    fn side_roots(&self, f: DVec3, d: DVec3) -> Option<SideRoots> {
        unit_cone::crossed(self.scaled_to_unit(f), self.scaled_to_unit(d))
    }

    #[inline(always)]
    fn on_side(&self, root: Root) -> Crossing {
        if root.y <= -self.radius * self.cut && root.y >= -self.radius * self.height {
            Crossing::at(root.t)
        } else {
            Crossing::NONE
        }
    }

    #[inline(always)]
    fn open(&self, f: DVec3, d: DVec3) -> Crossings {
        self.side_roots(f, d)
            .map_or(NO_CROSSINGS, |roots| [self.on_side(roots.near), self.on_side(roots.far)])
    }

    /// The interval of the ray inside the closed cone, `above_base` being the height of its origin above the base.
    #[inline(always)]
    fn inside(&self, f: DVec3, d: DVec3, above_base: f64) -> Option<Interval> {
        let roots = self.side_roots(f, d)?;
        roots.below_apex(d.y)?.above(above_base, d.y, BASE)
    }

    /// The crossings of a ray that leaves this cone.
    ///
    /// Outward none, as it is convex. Inward from the side, the far side is at −2b/a, without a subtraction.
    #[inline(always)]
    pub(crate) fn crossings_from(&self, ray: &Ray, from: &Departure) -> Crossings {
        if !from.inward {
            return NO_CROSSINGS;
        }
        let (q, d) = (from.local, self.frame.to_local(ray.dir));
        let (f, e) = (self.scaled_to_unit(q), self.scaled_to_unit(d));
        let above_base = self.height + q.y;
        if from.face == BASE {
            let ahead = self.inside(q, d, above_base.max(0.0));
            return leaving(ahead);
        }
        let (a, b) = (dot(flip(e), e), dot(flip(f), e));
        let far = if a > 0.0 { (-2.0 * b / a).max(f64::MIN_POSITIVE) } else { f64::INFINITY };
        match self.ends {
            Ends::Closed => leaving(Interval::new(0.0, far).above(above_base, d.y, BASE)),
            Ends::Open => [self.on_side(Root { t: far, y: far.mul_add(e.y, f.y) }), Crossing::NONE],
        }
    }

    #[inline(always)]
    pub(crate) fn surface(&self, ray: &Ray, t: f64, face: u8, own: Option<&Departure>) -> Surface {
        let start =
            own.map_or_else(|| self.frame.to_local(ray.origin - self.apex), |from| from.local);
        let mut q = start + self.frame.to_local(ray.dir) * t;
        let normal = if face == SIDE {
            q = self.onto_side(q);
            let (q, size) = (scale::normalized(q).0, self.height.max(self.radius));
            let (height, radius) = (self.height / size, self.radius / size);
            scale::unit(DVec3::new(height * q.x, radius * hypot(q.x, q.z), height * q.z))
                .unwrap_or(DVec3::Y)
        } else {
            q.y = -self.height;
            DVec3::NEG_Y
        };
        let point = self.apex + self.frame.to_world(q);
        let normal = self.frame.to_world(normal);
        let error = Surface::error_bound(normal, point.abs() + self.radius + self.height);
        Surface { local: q, ..Surface::plain(point, normal, error) }
    }

    /// The point of the side nearest to `q`.
    #[inline(always)]
    fn onto_side(&self, q: DVec3) -> DVec3 {
        let rho = hypot(q.x, q.z);
        if rho == 0.0 {
            return DVec3::ZERO; // the apex
        }
        // In the half-plane of q the generator goes along (R, −h); how far along it is the foot of the perpendicular?
        let size = self.height.max(self.radius);
        let (height, radius) = (self.height / size, self.radius / size);
        let slant_squared = radius.mul_add(radius, height * height);
        let along = (radius * rho - height * q.y) / size / slant_squared;
        let along = along.clamp(0.0, 1.0);
        let onto = self.radius * along / rho;
        DVec3::new(q.x * onto, -self.height * along, q.z * onto)
    }
}
