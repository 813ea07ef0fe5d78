//! Where a line meets the unit cone X² + Z² = Y², both of its nappes.
//!
//! The line F + t E meets it where
//!
//! (Eₓ² − E_y² + E_z²) t² + 2 (FₓEₓ − F_yE_y + F_zE_z) t + (Fₓ² − F_y² + F_z²) = 0.
//!
//! Three cancellations lurk here. The discriminant b² − ac is |(F×E)ₓ|² + |(F×E)_z|² − |(F×E)_y|², a difference of
//! squares: it is taken as (m − |w|)(m + |w|). The coefficients vanish near the cone: they are summed with
//! compensation. And near the apex, Y = F_y + t E_y loses everything: with p₁ = FₓE_y − F_yEₓ, p₂ = F_zE_y − F_yE_z
//! and N = Eₓp₁ + E_zp₂, the heights of the two roots are (−N ∓ E_y √D)/a and their product is (p₁² + p₂²)/a, so the
//! one is a sum of like signs and the other a quotient.

use glam::DVec3;

use super::solid::Interval;
use crate::math::{Roots, compensated::hypot, difference_of_products, dot};

/// Where a line meets the cone: its parameter and the height above the apex.
#[derive(Clone, Copy)]
pub(super) struct Root {
    pub(super) t: f64,
    pub(super) y: f64,
}

/// What a line and the cone have in common.
#[derive(Clone, Copy)]
pub(super) struct SideRoots {
    /// The leading coefficient: positive if the line crosses one nappe twice (or none), negative if it crosses both.
    a: f64,
    pub(super) near: Root,
    pub(super) far: Root,
}

impl SideRoots {
    /// The interval of the line inside the lower nappe; `dy` is how far its direction goes up.
    #[inline(always)]
    pub(super) fn below_apex(self, dy: f64) -> Option<Interval> {
        let SideRoots { a, near, far } = self;
        if a > 0.0 {
            (near.y <= 0.0 && far.y <= 0.0).then(|| Interval::new(near.t, far.t))
        } else {
            // Between the roots the line is outside; it enters or leaves the lower nappe once, at the finite root
            // there.
            let through = if dy < 0.0 {
                if far.t.is_finite() { far } else { near }
            } else if near.t.is_finite() {
                near
            } else {
                far
            };
            if a == 0.0 && through.y > 0.0 {
                return None; // parallel to a generator, the one root on the upper nappe
            }
            Some(if dy < 0.0 {
                Interval::new(through.t, f64::INFINITY)
            } else {
                Interval::new(f64::NEG_INFINITY, through.t)
            })
        }
    }
}

/// What the line through `f` along `e` has in common with the cone; `None` if it passes by.
#[inline(always)]
pub(super) fn crossed(f: DVec3, e: DVec3) -> Option<SideRoots> {
    let p1 = difference_of_products(f.x, e.y, f.y, e.x);
    let p2 = difference_of_products(f.z, e.y, f.y, e.z);
    let w = difference_of_products(f.x, e.z, f.z, e.x).abs();
    let m = hypot(p1, p2);
    let a = dot(flip(e), e);
    // A line within the cone's slope (a < 0) always meets it; only rounding can say otherwise.
    let gap = if a < 0.0 { (m - w).max(0.0) } else { m - w };
    if !(gap >= 0.0) {
        return None; // NaN is a miss
    }
    let (b, c) = (dot(flip(f), e), dot(flip(f), f));
    let root = (gap * (m + w)).sqrt();
    let roots = Roots::new(a, b, c, root);
    let n = difference_of_products(e.x, p1, -e.z, p2);
    let s = e.y * root.copysign(b);
    let (stable, other) = (-n - s, s - n); // a times the heights of the two roots
    let product = p1.mul_add(p1, p2 * p2); // a times the product of the heights
    let apex = |y: f64| if y.is_nan() { 0.0 } else { y }; // 0/0: the line through the apex
    let (y_stable, y_other) = if stable.abs() >= other.abs() {
        (stable / a, apex(product / stable))
    } else {
        (apex(product / other), other / a)
    };
    let (u, v) = (Root { t: roots.stable, y: y_stable }, Root { t: roots.other, y: y_other });
    Some(if u.t <= v.t {
        SideRoots { a, near: u, far: v }
    } else {
        SideRoots { a, near: v, far: u }
    })
}

/// The vector whose dot product with another is the quadratic form x² − y² + z² of the unit cone.
#[inline(always)]
pub(super) fn flip(v: DVec3) -> DVec3 {
    DVec3::new(v.x, -v.y, v.z)
}
