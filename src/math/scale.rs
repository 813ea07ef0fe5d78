//! Powers of two, by which lengths are scaled without rounding.

use glam::DVec3;

/// The exponent `e` with `2^e ≤ |x| < 2^(e+1)`, for finite `x ≠ 0` of any size, subnormal numbers included.
pub fn exponent(x: f64) -> i32 {
    let biased = |x: f64| ((x.to_bits() >> 52) & 0x7ff) as i32;
    match biased(x) {
        0 => biased(x * power_of_two(64)) - 1023 - 64,
        e => e - 1023,
    }
}

/// `2^e`, for `e` from −1022 to 1023; beyond that the nearest of these.
pub fn power_of_two(e: i32) -> f64 {
    let biased = (e.clamp(-1022, 1023) + 1023) as u64;
    f64::from_bits(biased << 52)
}

/// `v · 2^e` for any `e`, rounded only where the result is subnormal.
pub fn scaled(v: DVec3, e: i32) -> DVec3 {
    let half = e / 2;
    v * power_of_two(half) * power_of_two(e - half)
}

/// `v` scaled by the power of two that brings its largest component into `[1, 2)`, and the exponent of that power.
///
/// A zero vector, or one that is not finite, comes back as it is, with exponent 0.
pub fn normalized(v: DVec3) -> (DVec3, i32) {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return (v, 0);
    }
    let e = -exponent(largest);
    (scaled(v, e), e)
}

/// The unit vector along `v`, however short or long that is; `None` for a zero vector or one that is not finite.
pub fn unit(v: DVec3) -> Option<DVec3> {
    normalized(v).0.try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the definition, over every exponent of `f64`.
    #[test]
    fn exponent_is_floor_of_log2() {
        for e in -1074..=1023_i32 {
            let x = if e >= -1022 { power_of_two(e) } else { f64::from_bits(1 << (e + 1074)) };
            assert_eq!(exponent(x), e);
            assert_eq!(exponent(-x), e);
            assert_eq!(exponent(x * 1.5), if e == -1074 { -1073 } else { e });
        }
    }

    #[test]
    fn normalized_brings_the_largest_component_into_one_to_two() {
        for v in [
            DVec3::new(5e-324, 0.0, 0.0),
            DVec3::new(-1e308, 3.0, 1e-300),
            DVec3::new(0.3, 0.1, -0.9),
        ] {
            let (w, e) = normalized(v);
            let largest = w.abs().max_element();
            assert!((1.0..2.0).contains(&largest), "{v} -> {w}");
            assert_eq!(scaled(w, -e).abs().max_element(), v.abs().max_element());
        }
        assert_eq!(normalized(DVec3::ZERO), (DVec3::ZERO, 0));
    }
}
