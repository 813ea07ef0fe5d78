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

/// `v · 2^e` for `e` from −2044 to 2046, rounded only where the result is subnormal.
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

/// The largest component, in magnitude; without a branch, for loops over lanes.
#[inline(always)]
pub(crate) fn largest(v: DVec3) -> f64 {
    let size = v.abs();
    let largest = if size.x > size.y { size.x } else { size.y };
    if largest > size.z { largest } else { size.z }
}

/// The unit vector along `v`, or `other` if the largest component is below 2^−1022, from 2^1023 up or infinite; without a
/// branch, for loops over lanes.
#[inline(always)]
pub(crate) fn unit_or(v: DVec3, other: DVec3) -> DVec3 {
    let exponent = largest(v).to_bits() >> 52; // biased
    let w = v * f64::from_bits(2046_u64.wrapping_sub(exponent) << 52);
    let unit = w * w.length_recip();
    let is_ordinary = (1..2046).contains(&exponent);
    let pick = |x: f64, y: f64| if is_ordinary { x } else { y };
    DVec3::new(pick(unit.x, other.x), pick(unit.y, other.y), pick(unit.z, other.z))
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

    /// Oracle: [`unit`], which takes the same steps for numbers of any size.
    #[test]
    fn unit_or_is_unit_for_ordinary_vectors() {
        for e in [-1021, -500, -1, 0, 1, 60, 1000] {
            for v in [DVec3::new(0.3, -0.1, 0.9), DVec3::Z, DVec3::new(-1.7, 1e-9, 1.7)] {
                let v = v * power_of_two(e);
                assert_eq!(Some(unit_or(v, DVec3::NAN)), unit(v), "{v}");
            }
        }
        for v in [DVec3::ZERO, DVec3::splat(5e-324), DVec3::new(f64::INFINITY, 1.0, 0.0)] {
            assert_eq!(unit_or(v, DVec3::Y), DVec3::Y, "{v}");
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
