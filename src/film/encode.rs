//! From linear light to 8-bit sRGB.

use std::sync::LazyLock;

use super::Film;
use crate::Rgb;
use crate::color::{linear_to_srgb, srgb_to_linear};

/// The film as 8-bit sRGB, three bytes a pixel, row by row from the top left.
///
/// A channel is clamped to `[0, 1]`, encoded and rounded to the nearest of the 256 levels; NaN is 0.
pub fn to_srgb8(film: &Film) -> Vec<u8> {
    let mut bytes = vec![0; 3 * film.pixels().len()];
    encode_pixels(film.pixels(), &mut bytes);
    bytes
}

/// Puts the 8-bit sRGB bytes of `pixels` into `bytes`, in place of what was there.
pub(super) fn encode_row(pixels: &[Rgb], bytes: &mut Vec<u8>) {
    bytes.clear();
    bytes.resize(3 * pixels.len(), 0);
    encode_pixels(pixels, bytes);
}

fn encode_pixels(pixels: &[Rgb], bytes: &mut [u8]) {
    let table = &*TABLE;
    for (bytes, pixel) in bytes.chunks_exact_mut(3).zip(pixels) {
        bytes.copy_from_slice(&[table.level(pixel.x), table.level(pixel.y), table.level(pixel.z)]);
    }
}

/// The level of a linear value by the formula: what the table must equal.
fn level_by_formula(linear: f32) -> u8 {
    (linear_to_srgb(f64::from(linear.clamp(0.0, 1.0))) * 255.0).round() as u8 // NaN becomes 0
}

/// Values below 2⁻¹³ are level 0, which ends at 0.5 / 255 / 12.92 ≈ 1.24 · 2⁻¹³.
const LOWEST: f32 = 1.0 / 8192.0;
/// Buckets share the exponent and the first seven bits of the fraction.
const BUCKET_SHIFT: u32 = 16;
const FIRST_BUCKET: u32 = LOWEST.to_bits() >> BUCKET_SHIFT;
const BUCKETS: usize = ((1.0_f32.to_bits() >> BUCKET_SHIFT) - FIRST_BUCKET + 1) as usize;

static TABLE: LazyLock<LevelTable> = LazyLock::new(LevelTable::new);

/// The formula without its power: exact, because it only compares with the values where the
/// formula's rounded result changes.
///
/// Up to 1 the level grows by at most 255 · 1.055 / 2.4 ≈ 112 times the relative change, and a
/// bucket spans less than 1/128 of its value, so it holds at most one such value.
struct LevelTable {
    /// Level at the lower end of each bucket.
    level: [u8; BUCKETS],
    /// The least value of each level, and infinity after the last.
    threshold: [f32; 257],
}

impl LevelTable {
    fn new() -> Self {
        let mut threshold = [f32::INFINITY; 257];
        threshold[0] = 0.0;
        for level in 1..=255_u8 {
            // The inverse is right to a few ulps; the formula itself decides among those.
            let mut value = srgb_to_linear((f64::from(level) - 0.5) / 255.0) as f32;
            while level_by_formula(value) >= level {
                value = value.next_down();
            }
            while level_by_formula(value) < level {
                value = value.next_up();
            }
            threshold[usize::from(level)] = value;
        }
        let level = std::array::from_fn(|bucket| {
            level_by_formula(f32::from_bits((FIRST_BUCKET + bucket as u32) << BUCKET_SHIFT))
        });
        Self { level, threshold }
    }

    fn level(&self, linear: f32) -> u8 {
        // Written to be false on NaN, which thereby becomes the lowest.
        let value = if linear > LOWEST { linear.min(1.0) } else { LOWEST };
        let guess = self.level[((value.to_bits() >> BUCKET_SHIFT) - FIRST_BUCKET) as usize];
        guess + u8::from(value >= self.threshold[usize::from(guess) + 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Tile;

    /// A film of one row with the given grey levels, linear.
    fn row_of(values: &[f32]) -> Film {
        let width = u32::try_from(values.len()).expect("a short row");
        let mut film = Film::new(width, 1);
        let pixels: Vec<Rgb> = values.iter().map(|&value| Rgb::splat(value)).collect();
        film.blit(&Tile { x0: 0, y0: 0, x1: width, y1: 1 }, &pixels, &vec![1; values.len()]);
        film
    }

    /// Oracle: the formula. Both grow with the value, so agreement on either side of each step and
    /// at both ends of each bucket is agreement everywhere; the sweep does not rely on that.
    #[test]
    fn table_equals_the_formula() {
        let table = LevelTable::new();
        let check = |value: f32| {
            assert_eq!(table.level(value), level_by_formula(value), "{value:e}");
        };
        for &threshold in &table.threshold[1..256] {
            let bits = threshold.to_bits();
            (bits - 64..=bits + 64).for_each(|bits| check(f32::from_bits(bits)));
        }
        for bucket in 0..=BUCKETS as u32 {
            let bits = (FIRST_BUCKET + bucket) << BUCKET_SHIFT;
            (bits - 2..=bits + 2).for_each(|bits| check(f32::from_bits(bits)));
        }
        (0..=0x4000_0000).step_by(1013).for_each(|bits| check(f32::from_bits(bits)));
        for value in [0.0, -0.0, -1.0, 1.0, 1.0_f32.next_down(), 2.0, f32::MIN_POSITIVE] {
            check(value);
        }
        for value in [f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, f32::NAN, -f32::NAN] {
            check(value);
        }
    }

    #[test]
    fn table_holds_at_most_one_step_a_bucket() {
        let table = LevelTable::new();
        assert!(table.level.windows(2).all(|pair| pair[1] - pair[0] <= 1));
    }

    /// Oracle: published pairs of linear and 8-bit sRGB grey, and the ends of the range.
    #[test]
    fn known_greys_encode_to_their_levels() {
        let values = [0.0, 0.001, 0.18, 0.215_861, 0.5, 1.0, -3.0, 7.0, f32::INFINITY, f32::NAN];
        let bytes = to_srgb8(&row_of(&values));
        let greys: Vec<u8> = bytes.chunks_exact(3).map(|pixel| pixel[0]).collect();
        assert_eq!(greys, [0, 3, 118, 128, 188, 255, 0, 255, 255, 0]);
    }
}
