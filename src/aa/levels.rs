//! Colours in display levels: how far apart two colours are to the eye of a picture file.

use std::sync::LazyLock;

use glam::Vec3;

use crate::color::{Rgb, linear_to_srgb};

/// Below this the encoding is a straight line.
const LINEAR_END: f32 = 0.003_130_8;
/// Buckets share the exponent and the first six bits of the fraction.
const BUCKET_SHIFT: u32 = 17;
/// 2⁻⁹, the power of two below [`LINEAR_END`].
const FIRST: u32 = (1.0_f32 / 512.0).to_bits() >> BUCKET_SHIFT;
const BUCKETS: usize = ((1.0_f32.to_bits() >> BUCKET_SHIFT) - FIRST + 1) as usize;

/// The formula at the lower end of each bucket, and its slope to the upper one.
static TABLE: LazyLock<[(f32, f32); BUCKETS]> = LazyLock::new(|| {
    let end = |bucket: usize| f32::from_bits((FIRST + bucket as u32) << BUCKET_SHIFT);
    let level = |value: f32| (linear_to_srgb(f64::from(value)) * 255.0) as f32;
    std::array::from_fn(|bucket| {
        let (lower, upper) = (end(bucket), end(bucket + 1));
        (level(lower), (level(upper) - level(lower)) / (upper - lower))
    })
});

/// The sRGB encoding of a linear colour in levels of 255, not rounded; channels are clamped to `[0, 1]` first.
///
/// A table with straight lines between its entries: off by at most 0.002 levels.
#[inline(always)]
pub fn levels(color: Rgb) -> Vec3 {
    let table = &*TABLE;
    let channel = |value: f32| {
        // False on NaN, which becomes 0.
        if !(value > LINEAR_END) {
            return 12.92 * 255.0 * value.max(0.0);
        }
        let value = value.min(1.0);
        let bucket = value.to_bits() >> BUCKET_SHIFT;
        let lower = f32::from_bits(bucket << BUCKET_SHIFT);
        let (level, slope) = table[(bucket - FIRST) as usize];
        level + slope * (value - lower)
    };
    Vec3::new(channel(color.x), channel(color.y), channel(color.z))
}

/// The squared difference of two colours in levels, as the mean of the three channels.
#[inline]
pub fn squared_distance(a: Vec3, b: Vec3) -> f32 {
    (a - b).length_squared() / 3.0
}

/// The squared error in levels of a colour whose light is off by so much, one way or the other.
pub fn error_of_light(color: Rgb, off: Rgb) -> f32 {
    squared_distance(levels(color + off), levels(color - off)) / 4.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the formula.
    #[test]
    fn levels_are_those_of_the_formula() {
        for bits in (0..=0x4000_0000_u32).step_by(7919) {
            let value = f32::from_bits(bits);
            let expected = linear_to_srgb(f64::from(value.min(1.0))) * 255.0;
            let level = levels(Rgb::new(value, 0.0, 1.0));
            assert!((f64::from(level.x) - expected).abs() < 0.002, "{value:e}: {level}");
            assert!(level.y == 0.0 && (level.z - 255.0).abs() < 1e-4, "{level}");
        }
        assert_eq!(
            levels(Rgb::new(f32::NAN, -1.0, f32::INFINITY)).round(),
            Vec3::new(0.0, 0.0, 255.0)
        );
    }
}
