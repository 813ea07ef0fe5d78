//! Sums of products that do not cancel, or little.
//!
//! Every function here relies on the fused multiply-add: `mul_add` is the machine's instruction where the
//! calling code was compiled for it and an exact library call elsewhere, with the same result.

use glam::DVec3;

/// `a b − c d` with a relative error of at most two unit roundoffs, barring underflow; so its sign is right.
///
/// Source: W. Kahan's algorithm; Jeannerod, Louvet & Muller, "Further analysis of Kahan's algorithm for the
/// accurate computation of 2×2 determinants", *Math. Comp.* 82 (2013).
#[inline(always)]
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let error = (-c).mul_add(d, cd);
    a.mul_add(b, -cd) + error
}

/// The cross product `a × b`, each component a [`difference_of_products`].
#[inline(always)]
pub fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}

/// The dot product `a · b` as if computed in twice the precision and rounded once.
///
/// Source: Ogita, Rump & Oishi, "Accurate sum and dot product", *SIAM J. Sci. Comput.* 26 (2005), algorithm 5.3.
#[inline(always)]
pub fn dot(a: DVec3, b: DVec3) -> f64 {
    let (sum, rest) = dot_parts(a, b);
    sum + rest
}

/// The dot product in two parts, which add up to twice the precision.
#[inline(always)]
pub(crate) fn dot_parts(a: DVec3, b: DVec3) -> (f64, f64) {
    let (p, error_p) = two_product(a.x, b.x);
    let (h, error_h) = two_product(a.y, b.y);
    let (s, error_s) = two_sum(p, h);
    let (k, error_k) = two_product(a.z, b.z);
    let (sum, error_sum) = two_sum(s, k);
    (sum, (error_p + (error_h + error_s)) + (error_k + error_sum))
}

/// The dot product with three roundings instead of five; it may cancel.
#[inline(always)]
pub(crate) fn fused_dot(a: DVec3, b: DVec3) -> f64 {
    a.x.mul_add(b.x, a.y.mul_add(b.y, a.z * b.z))
}

/// `√(a² + b²)`; squares may overflow, which normalised coordinates rule out.
#[inline(always)]
pub fn hypot(a: f64, b: f64) -> f64 {
    a.mul_add(a, b * b).sqrt()
}

/// The rounded product and its rounding error, exactly `a b` together.
#[inline(always)]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// The rounded sum and its rounding error, exactly `a + b` together (Knuth's).
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: integers below 2⁵³ whose products are exact in `i128`.
    #[test]
    fn difference_of_products_survives_cancellation() {
        let n = (1_i64 << 52) + 1;
        let (a, b, c, d) = (n, n, n + 1, n - 1); // a b − c d = 1
        assert_eq!(i128::from(a) * i128::from(b) - i128::from(c) * i128::from(d), 1);
        let value = difference_of_products(a as f64, b as f64, c as f64, d as f64);
        assert_eq!(
            value.to_bits(),
            1.0_f64.to_bits(),
            "naive: {}",
            a as f64 * b as f64 - c as f64 * d as f64
        );
    }

    /// Oracle: the exact value 1 of a dot product whose terms are 2¹⁰⁴ times as large.
    #[test]
    fn dot_survives_cancellation() {
        let big = (1_i64 << 52) as f64;
        let value = dot(DVec3::new(big, 1.0, -big), DVec3::new(big, 1.0, big));
        assert_eq!(value.to_bits(), 1.0_f64.to_bits());
    }
}
