//! Pictures as textures: decoded to linear light when they are loaded, bilinear between texels.

use std::io::Cursor;

use glam::DVec2;
use thiserror::Error;

use crate::color::{Rgb, srgb_to_linear};

/// The longest side and the largest number of texels of a texture that is accepted.
const LARGEST_SIDE: u32 = 1 << 15;
const LARGEST_MEMORY: u64 = 1 << 30;

/// A picture in linear light, its rows from top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    texels: Vec<Rgb>,
}

/// Why a picture cannot be used as a texture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImageTextureError {
    /// The bytes are no picture of a known kind, or a broken or absurdly large one.
    #[error("texture `{name}` cannot be decoded: {source}")]
    Decode {
        /// What the texture is called.
        name: String,
        /// The decoder's reason.
        source: ::image::ImageError,
    },
}

impl Image {
    /// The picture in the bytes of a PNG file, whose values are taken as sRGB; transparency is ignored.
    ///
    /// # Errors
    /// Bytes that cannot be decoded, or a picture of more than 32768 texels a side or 1 GiB.
    pub fn decode(name: &str, bytes: &[u8]) -> Result<Self, ImageTextureError> {
        let error = |source| ImageTextureError::Decode { name: name.to_owned(), source };
        let mut limits = ::image::Limits::default();
        limits.max_image_width = Some(LARGEST_SIDE);
        limits.max_image_height = Some(LARGEST_SIDE);
        limits.max_alloc = Some(LARGEST_MEMORY);
        let mut reader = ::image::ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|source| error(source.into()))?;
        reader.limits(limits);
        let picture = reader.decode().map_err(error)?.into_rgb8();
        let table: Vec<f32> =
            (0..=255_u8).map(|byte| srgb_to_linear(f64::from(byte) / 255.0) as f32).collect();
        let texels =
            picture.pixels().map(|p| Rgb::from_array(p.0.map(|byte| table[usize::from(byte)])));
        Ok(Self {
            width: picture.width() as usize,
            height: picture.height() as usize,
            texels: texels.collect(),
        })
    }

    /// The colour at `uv`, with (0, 0) the lower left corner of the picture and (1, 1) the upper right.
    ///
    /// Bilinear between the four texels around the place, whose centres lie half a texel inside the picture; beyond the
    /// outermost centres the edge goes on.
    #[inline(always)]
    pub fn sample(&self, uv: DVec2) -> Rgb {
        let x = uv.x * self.width as f64 - 0.5;
        let y = (1.0 - uv.y) * self.height as f64 - 0.5;
        let (column, row) = (x.floor(), y.floor());
        let (p, q) = ((x - column) as f32, (y - row) as f32);
        let clamped = |i: f64, count: usize| i.clamp(0.0, (count - 1) as f64) as usize; // NaN is 0
        let (x0, x1) = (clamped(column, self.width), clamped(column + 1.0, self.width));
        let (y0, y1) =
            (clamped(row, self.height) * self.width, clamped(row + 1.0, self.height) * self.width);
        let upper = self.texels[y0 + x0].lerp(self.texels[y0 + x1], p);
        let lower = self.texels[y1 + x0].lerp(self.texels[y1 + x1], p);
        upper.lerp(lower, q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::from_srgb;

    /// A picture of 2 × 2: red, green over blue, white.
    fn four_corners() -> Image {
        let bytes = [255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255_u8];
        let picture = ::image::RgbImage::from_raw(2, 2, bytes.to_vec()).expect("12 bytes");
        let mut png = Vec::new();
        picture.write_to(&mut Cursor::new(&mut png), ::image::ImageFormat::Png).expect("in memory");
        Image::decode("corners", &png).expect("a PNG")
    }

    #[test]
    fn the_corners_stand_upright() {
        let image = four_corners();
        for (uv, color) in [
            (DVec2::new(0.0, 1.0), Rgb::X),
            (DVec2::new(1.0, 1.0), Rgb::Y),
            (DVec2::new(0.0, 0.0), Rgb::Z),
            (DVec2::new(1.0, 0.0), Rgb::ONE),
            (DVec2::new(0.25, 0.75), Rgb::X), // the centre of the upper left texel
            (DVec2::new(0.5, 0.75), Rgb::new(0.5, 0.5, 0.0)),
            (DVec2::new(0.5, 0.5), Rgb::new(0.5, 0.5, 0.5)),
            (DVec2::new(-9.0, 9.0), Rgb::X),
        ] {
            assert!(
                (image.sample(uv) - color).abs().max_element() < 1e-6,
                "{uv}: {}",
                image.sample(uv)
            );
        }
    }

    #[test]
    fn texels_are_decoded_from_srgb() {
        let picture = ::image::RgbImage::from_raw(1, 1, vec![128, 10, 255]).expect("3 bytes");
        let mut png = Vec::new();
        picture.write_to(&mut Cursor::new(&mut png), ::image::ImageFormat::Png).expect("in memory");
        let color = Image::decode("grey", &png).expect("a PNG").sample(DVec2::splat(0.3));
        // Published values of the sRGB transfer function: 128 -> 0.21586, 10 -> 0.0030353.
        assert!(
            (color - Rgb::new(0.215_86, 0.003_035_3, 1.0)).abs().max_element() < 1e-5,
            "{color}"
        );
        assert!((from_srgb([128.0 / 255.0, 10.0 / 255.0, 1.0]) - color).abs().max_element() < 1e-7);
    }

    #[test]
    fn garbage_is_an_error() {
        let error = Image::decode("noise", b"not a picture").expect_err("garbage");
        assert!(error.to_string().contains("`noise`"), "{error}");
    }
}
