//! Numbers as colours: rays per pixel, errors.

use std::io::{self, Write};

use super::write_rgb8;

/// From black over violet and orange to pale yellow, even steps to the eye; sRGB.
///
/// Source: nine entries of the map `inferno` of matplotlib (van der Walt & Smith, CC0).
const RAMP: [[u8; 3]; 9] = [
    [0, 0, 4],
    [31, 12, 72],
    [85, 15, 109],
    [136, 34, 106],
    [186, 54, 85],
    [227, 89, 51],
    [249, 140, 10],
    [249, 201, 50],
    [252, 255, 164],
];

/// How numbers become places on the ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The number that is black, and all below.
    pub low: f32,
    /// The number that is palest, and all above.
    pub high: f32,
    /// Whether equal ratios are equal steps; else equal differences. `low` is then above zero.
    pub logarithmic: bool,
}

impl Scale {
    /// The scale for differences of pictures: 0.5 to 128 levels by ratio.
    pub const LEVELS: Self = Self { low: 0.5, high: 128.0, logarithmic: true };

    /// The scale for rays per pixel, 1 to at least `most`, by ratio.
    pub fn rays(most: u32) -> Self {
        Self { low: 1.0, high: most.max(2) as f32, logarithmic: true }
    }

    /// The colour of a number; sRGB. What is not a number is black.
    pub fn color(&self, value: f32) -> [u8; 3] {
        let place = if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        // False on NaN.
        let place = if place > 0.0 { place.min(1.0) * (RAMP.len() - 1) as f32 } else { 0.0 };
        let entry = (place as usize).min(RAMP.len() - 2);
        let part = place - entry as f32;
        let mix = |k: usize| {
            let (from, to) = (f32::from(RAMP[entry][k]), f32::from(RAMP[entry + 1][k]));
            (from + (to - from) * part).round() as u8
        };
        [mix(0), mix(1), mix(2)]
    }
}

/// Writes `values`, row by row in rows of `width`, as a PNG.
///
/// # Errors
/// Those of the writer, and a number of values that is no multiple of `width` or zero.
pub fn write_heatmap(
    values: &[f32],
    width: u32,
    scale: &Scale,
    writer: impl Write,
) -> io::Result<()> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| scale.color(*value)).collect();
    let height = (values.len() / width.max(1) as usize) as u32;
    write_rgb8(&bytes, width, height, writer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle_are_those_of_the_ramp() {
        let scale = Scale { low: 1.0, high: 256.0, logarithmic: true };
        for (value, expected) in [
            (0.0, RAMP[0]),
            (1.0, RAMP[0]),
            (16.0, RAMP[4]),
            (256.0, RAMP[8]),
            (1e9, RAMP[8]),
            (f32::NAN, RAMP[0]),
        ] {
            assert_eq!(scale.color(value), expected, "{value}");
        }
        let linear = Scale { low: 0.0, high: 8.0, logarithmic: false };
        assert_eq!(linear.color(3.0), RAMP[3]);
        assert_eq!(linear.color(-3.0), RAMP[0]);
    }

    /// Oracle: the `image` crate decodes it.
    #[test]
    fn heatmaps_are_pictures_of_their_size() {
        let mut file = Vec::new();
        write_heatmap(&[0.0, 1.0, 5.0, 300.0, 1.0, 2.0], 3, &Scale::LEVELS, &mut file)
            .expect("written");
        let picture = image::load_from_memory(&file).expect("a PNG").into_rgb8();
        assert_eq!(picture.dimensions(), (3, 2));
        assert_eq!(picture.get_pixel(0, 1).0, RAMP[8]);
        assert!(write_heatmap(&[], 0, &Scale::LEVELS, &mut Vec::new()).is_err());
    }
}
