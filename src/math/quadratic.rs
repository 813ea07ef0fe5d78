//! The roots of `a t² + 2 b t + c`.

/// The two roots of a quadratic, in no order.
///
/// `stable` is the one that is never a difference of nearly equal numbers, `q / a`; `other` is `c / q`. With
/// `a = 0` the first is infinite, which is simply out of every range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roots {
    /// The root `q / a`.
    pub stable: f64,
    /// The root `c / q`.
    pub other: f64,
}

impl Roots {
    /// The roots from the coefficients and the root of the discriminant `√(b² − a c)`, which the caller knows how
    /// to get without cancellation.
    ///
    /// `q = −(b + sign(b) √D)` adds numbers of one sign. If `q = 0`, both roots are `−b / a`, which is zero or (with
    /// `a = 0`) undefined; NaN is a miss for every caller.
    ///
    /// Source: Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. (2002), section 1.8.
    #[inline(always)]
    pub fn new(a: f64, b: f64, c: f64, root_of_discriminant: f64) -> Self {
        let q = -(b + root_of_discriminant.copysign(b));
        let stable = q / a;
        let other = if q == 0.0 { stable } else { c / q };
        Self { stable, other }
    }

    /// The roots in ascending order; a NaN makes its place NaN.
    #[inline(always)]
    pub fn sorted(self) -> (f64, f64) {
        if self.stable <= self.other {
            (self.stable, self.other)
        } else {
            (self.other, self.stable)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: chosen roots. (t − 1e−9)(t − 1e9) has a small root that the textbook formula loses.
    #[test]
    fn small_root_is_not_lost() {
        let (small, large) = (1e-9, 1e9);
        let (b, c) = (-(small + large) / 2.0, small * large);
        let root_of_discriminant = (large - small) / 2.0;
        let (t0, t1) = Roots::new(1.0, b, c, root_of_discriminant).sorted();
        assert!((t0 - small).abs() <= 4.0 * f64::EPSILON * small, "{t0}");
        assert!((t1 - large).abs() <= 4.0 * f64::EPSILON * large, "{t1}");
    }

    #[test]
    fn linear_equation_has_one_finite_root() {
        let roots = Roots::new(0.0, 2.0, -8.0, 2.0); // 4 t − 8
        assert!((roots.other - 2.0).abs() < 1e-15);
        assert!(roots.stable.is_infinite());
    }
}
