//! From linear light to 8-bit sRGB and to PNG.

use std::io::{self, Write};
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

/// Writes the film as an 8-bit sRGB PNG with an `sRGB` chunk (perceptual rendering intent).
///
/// The same film always gives the same bytes.
///
/// # Errors
///
/// Those of the writer; a film without pixels is [`io::ErrorKind::InvalidInput`], since PNG has no
/// such picture.
pub fn write_png<W: Write>(film: &Film, writer: W) -> io::Result<()> {
    write_png_parts(film, writer).map_err(|error| match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidInput, other.to_string()),
    })
}

fn write_png_parts<W: Write>(film: &Film, writer: W) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(writer, film.width(), film.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&to_srgb8(film))?;
    writer.finish()
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

    /// A film whose 8-bit form is known by construction: pixel `i` is level `i % 256` of sRGB.
    fn ramp(width: u32, height: u32) -> (Film, Vec<u8>) {
        let levels: Vec<u8> = (0..width * height).map(|i| (i % 256) as u8).collect();
        let pixels: Vec<Rgb> = levels
            .iter()
            .map(|&level| Rgb::splat(srgb_to_linear(f64::from(level) / 255.0) as f32))
            .collect();
        let mut film = Film::new(width, height);
        let tile = Tile { x0: 0, y0: 0, x1: width, y1: height };
        film.blit(&tile, &pixels, &vec![1; levels.len()]);
        (film, levels.into_iter().flat_map(|level| [level; 3]).collect())
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

    /// Oracle: levels chosen first, decoded by the `image` crate.
    #[test]
    fn png_decodes_to_the_levels_it_was_made_of() {
        for (width, height) in [(1, 1), (1, 300), (300, 1), (64, 33)] {
            let (film, levels) = ramp(width, height);
            assert_eq!(to_srgb8(&film), levels);
            let mut file = Vec::new();
            write_png(&film, &mut file).expect("written to memory");
            let decoded = image::load_from_memory(&file).expect("a PNG");
            assert_eq!(decoded.color(), image::ColorType::Rgb8);
            assert_eq!((decoded.width(), decoded.height()), (width, height));
            assert_eq!(decoded.into_rgb8().into_raw(), levels, "{width} x {height}");
        }
    }

    /// Oracle: the PNG specification, section 11.3.2.5 (one byte, 0 is perceptual, before the data).
    #[test]
    fn png_says_that_it_is_srgb() {
        let mut file = Vec::new();
        write_png(&ramp(4, 4).0, &mut file).expect("written to memory");
        let place = |name: &[u8]| file.windows(name.len()).position(|bytes| bytes == name);
        let srgb = place(b"\0\0\0\x01sRGB\0").expect("an sRGB chunk of one byte, 0");
        assert!(srgb < place(b"IDAT").expect("picture data"));
    }

    #[test]
    fn a_film_without_pixels_is_no_png() {
        let error = write_png(&Film::new(0, 5), &mut Vec::new()).expect_err("no pixels");
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
    }

    /// The writer's own error arrives, not the encoder's view of it.
    #[test]
    fn a_full_disk_is_reported_as_such() {
        let (film, _) = ramp(64, 64);
        let error = write_png(&film, &mut [0_u8; 100][..]).expect_err("too little room");
        assert_eq!(error.kind(), io::ErrorKind::WriteZero);
    }
}
