//! Procedural patterns, fixed in space.

use glam::DVec3;

use crate::{color::Rgb, geometry::Similarity};

/// A number of a pair of whole numbers that tells it from its neighbours, and from those that are skipped where a pixel
/// is wider than a cell. Never 0, which is the number of what has no cells.
#[inline(always)]
fn number([a, b]: [f64; 2]) -> u32 {
    let word = |x: f64| (x as i64) as u32;
    (word(a).wrapping_mul(0x9e37_79b1) ^ word(b).wrapping_mul(0x85eb_ca77)).max(1)
}

/// Squares in the plane of x and z: the colour is `even` where ⌊(x − oₓ)/s⌋ + ⌊(z − o_z)/s⌋ is even.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker {
    /// The colour of even squares, the one at the origin among them.
    pub even: Rgb,
    /// The colour of odd squares.
    pub odd: Rgb,
    /// A corner of a square.
    pub origin: DVec3,
    /// The side of a square.
    pub size: f64,
}

impl Checker {
    /// The colour at a point, and a number of its square.
    #[inline(always)]
    pub fn at(&self, p: DVec3) -> (Rgb, u32) {
        let cell = ((p - self.origin) / self.size).floor();
        let half = (cell.x + cell.z) * 0.5;
        let color = if half == half.floor() { self.even } else { self.odd };
        (color, number([cell.x, cell.z]))
    }

    pub(super) fn mapped(self, map: &Similarity) -> Self {
        Self { origin: map.point(self.origin), size: map.length(self.size), ..self }
    }
}

/// Two sets of diagonal stripes in the plane of x and y, each one cell in three wide.
///
/// With x and y from the origin in cells, s₁ = 1 where ⌊x + y⌋ mod 3 = 0, and s₂ the same with ⌊x − y⌋; the colour is
/// `ground`, `mixed` or `stripe` where s₁ + s₂ is 0, 1 or 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plaid {
    /// The colour where there is no stripe.
    pub ground: Rgb,
    /// The colour where one stripe lies on the ground.
    pub mixed: Rgb,
    /// The colour where two stripes cross.
    pub stripe: Rgb,
    /// Where both sets of stripes begin.
    pub origin: DVec3,
    /// The size of a cell along x and y.
    pub size: f64,
}

impl Plaid {
    /// The colour at a point, and a number of the stripes, and the gaps between them, that it is on.
    #[inline(always)]
    pub fn at(&self, p: DVec3) -> (Rgb, u32) {
        let q = (p - self.origin) / self.size;
        // Stripe k begins at 3 k, the gap behind it at 3 k + 1.
        let band = |cell: f64| {
            let (cell, stripe) = (cell.floor(), (cell / 3.0).floor());
            let is_stripe = cell - 3.0 * stripe < 0.5;
            (is_stripe, 2.0 * stripe + if is_stripe { 0.0 } else { 1.0 })
        };
        let ((one, first), (two, second)) = (band(q.x + q.y), band(q.x - q.y));
        let color = match (one, two) {
            (true, true) => self.stripe,
            (false, false) => self.ground,
            _ => self.mixed,
        };
        (color, number([first, second]))
    }

    pub(super) fn mapped(self, map: &Similarity) -> Self {
        Self { origin: map.point(self.origin), size: map.length(self.size), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Rgb = Rgb::X;
    const B: Rgb = Rgb::Y;
    const C: Rgb = Rgb::Z;

    /// Oracle: the formula of the assignment in integers, k = ⌊(x + 2.5)/5⌋ + ⌊(z + 2.5)/5⌋, at points off the borders.
    #[test]
    fn checker_is_that_of_the_assignment() {
        let checker = Checker { even: A, odd: B, origin: DVec3::new(-2.5, 0.0, -2.5), size: 5.0 };
        for i in -40..40_i32 {
            for j in -40..40_i32 {
                let k = (2 * i + 5).div_euclid(10) + (2 * j + 5).div_euclid(10); // x = i + 0.01
                let p = DVec3::new(f64::from(i) + 0.01, 7.0, f64::from(j) + 0.01);
                assert_eq!(checker.at(p).0, if k.rem_euclid(2) == 0 { A } else { B }, "{p}");
            }
        }
        assert_eq!(checker.at(DVec3::new(-3.0, 0.0, 0.0)).0, B);
        assert_ne!(checker.at(DVec3::ZERO).1, 0);
        assert_eq!(checker.at(DVec3::new(-3.0, 0.0, -3.0)).0, A);
    }

    /// Oracle: the formula of the assignment in integers, with ⌊x + y − 5⌋ and ⌊x − y − 5⌋, negative coordinates
    /// included.
    #[test]
    fn plaid_is_that_of_the_assignment() {
        let plaid =
            Plaid { ground: A, mixed: B, stripe: C, origin: DVec3::new(5.0, 0.0, 0.0), size: 1.0 };
        for i in -30..30_i32 {
            for j in -30..30_i32 {
                let p = DVec3::new(f64::from(i) + 0.5, f64::from(j) + 0.25, -118.0);
                let count = u8::from((i + j - 5).rem_euclid(3) == 0)
                    + u8::from((i - j - 5).rem_euclid(3) == 0);
                assert_eq!(plaid.at(p).0, [A, B, C][usize::from(count)], "{p}"); // sums end in .75 and .25
            }
        }
    }
}
