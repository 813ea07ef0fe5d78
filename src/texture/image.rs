//! Pictures as textures: decoded to linear light when they are loaded, bilinear between texels.

use std::{io::Cursor, sync::OnceLock};

use glam::DVec2;
use thiserror::Error;

use super::pyramid::Pyramid;
use crate::{
    color::{Rgb, srgb_to_linear},
    decode::decode,
};

/// The longest side and the largest number of texels of a texture that is accepted.
const LARGEST_SIDE: u32 = 1 << 15;
const MOST_TEXELS: u64 = 1 << 26;

/// The memory that decoding may take, in bytes: four channels of 16 bits a texel.
const LARGEST_MEMORY: u64 = MOST_TEXELS * 8;

/// A picture, its rows from top to bottom, as bytes that are decoded to linear light when they are looked up.
#[derive(Clone, Debug)]
pub struct Image {
    width: usize,
    height: usize,
    texels: Vec<[u8; 3]>,
    /// Made when it is first asked for.
    pyramid: OnceLock<Pyramid>,
}

impl PartialEq for Image {
    fn eq(&self, other: &Self) -> bool {
        self.width == other.width && self.texels == other.texels
    }
}

/// What goes on beyond the edges of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beyond {
    Edge,
    Again,
}

impl Beyond {
    /// The two of `count` entries between which place `x` is, entry 0 being at 0, and how far it is on the way.
    #[inline(always)]
    fn between(self, x: f64, count: usize) -> (usize, usize, f32) {
        let first = x.floor();
        let entry = |i: f64| match self {
            Self::Edge => i.clamp(0.0, (count - 1) as f64) as usize, // NaN is 0
            Self::Again => (i.rem_euclid(count as f64) as usize).min(count - 1),
        };
        (entry(first), entry(first + 1.0), (x - first) as f32)
    }
}

/// Why a picture cannot be used as a texture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImageTextureError {
    /// The bytes are no picture of a known kind, or a broken or absurdly large one.
    #[error("texture `{name}` cannot be decoded as PNG or JPEG: {source}")]
    Decode {
        /// What the texture is called.
        name: String,
        /// The decoder's reason.
        source: ::image::ImageError,
    },
    /// The picture is larger than is accepted.
    #[error("texture `{name}` is {width}x{height} texels, more than the {most} that are read")]
    TooLarge {
        /// What the texture is called.
        name: String,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// The largest number of texels.
        most: u64,
    },
}

/// Where in the picture `uv` is, if it is repeated.
fn repeated(uv: DVec2) -> DVec2 {
    let uv = uv - uv.floor();
    if uv.is_finite() { uv } else { DVec2::ZERO }
}

/// The linear values of the 256 levels of a texel.
fn levels() -> &'static [f32; 256] {
    static LEVELS: OnceLock<[f32; 256]> = OnceLock::new();
    LEVELS.get_or_init(|| std::array::from_fn(|byte| srgb_to_linear(byte as f64 / 255.0) as f32))
}

impl Image {
    /// The picture in the bytes of a PNG or JPEG file, whose values are taken as sRGB; transparency is ignored.
    ///
    /// # Errors
    /// Bytes that cannot be decoded, or a picture of more than 32768 texels a side or 2²⁶ in all. The size is looked at
    /// before memory is taken for it.
    pub fn decode(name: &str, bytes: &[u8]) -> Result<Self, ImageTextureError> {
        let error = |source| ImageTextureError::Decode { name: name.to_owned(), source };
        let mut limits = ::image::Limits::default();
        limits.max_image_width = Some(LARGEST_SIDE);
        limits.max_image_height = Some(LARGEST_SIDE);
        limits.max_alloc = Some(LARGEST_MEMORY);
        let reader = || {
            ::image::ImageReader::new(Cursor::new(bytes))
                .with_guessed_format()
                .map_err(|source| error(source.into()))
        };
        let sides = reader()?;
        let (width, height) = decode(|| sides.into_dimensions()).map_err(error)?;
        if u64::from(width) * u64::from(height) > MOST_TEXELS {
            let (name, most) = (name.to_owned(), MOST_TEXELS);
            return Err(ImageTextureError::TooLarge { name, width, height, most });
        }
        let mut reader = reader()?;
        reader.limits(limits);
        let picture = decode(|| reader.decode()).map_err(error)?.into_rgb8();
        Ok(Self {
            width: picture.width() as usize,
            height: picture.height() as usize,
            texels: picture.pixels().map(|p| p.0).collect(),
            pyramid: OnceLock::new(),
        })
    }

    /// A picture of so many columns and rows, by the levels of its texels.
    #[cfg(test)]
    pub(super) fn from_levels([width, height]: [usize; 2], levels: &[u8]) -> Self {
        let texels = levels.as_chunks().0.to_vec();
        assert_eq!(texels.len(), width * height);
        Self { width, height, texels, pyramid: OnceLock::new() }
    }

    /// Columns and rows of texels.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// All texels, row by row from the top.
    pub(super) fn texels(&self) -> &[[u8; 3]] {
        &self.texels
    }

    /// The levels of all texels, three bytes each, row by row from the top.
    pub(crate) fn bytes(&self) -> &[u8] {
        self.texels.as_flattened()
    }

    /// The colour at `uv`, with (0, 0) the lower left corner of the picture and (1, 1) the upper right.
    ///
    /// Bilinear between the four texels around the place, whose centres lie half a texel inside the picture; beyond the
    /// outermost centres the edge goes on.
    #[inline(always)]
    pub fn sample(&self, uv: DVec2) -> Rgb {
        self.bilinear(uv, Beyond::Edge)
    }

    /// As [`Image::sample`], but the picture is repeated in all directions.
    pub fn sample_repeated(&self, uv: DVec2) -> Rgb {
        self.bilinear(repeated(uv), Beyond::Again)
    }

    /// The squared error, in levels of 255, of the colour at `uv` as the mean of what is around it, `across` which the
    /// coordinates change by so much, squared.
    #[inline(always)]
    pub(super) fn detail(&self, uv: DVec2, across: DVec2) -> f32 {
        self.detail_at(uv, across, Beyond::Edge)
    }

    /// As [`Image::detail`], but the picture is repeated in all directions.
    pub(super) fn detail_repeated(&self, uv: DVec2, across: DVec2) -> f32 {
        self.detail_at(repeated(uv), across, Beyond::Again)
    }

    #[inline(always)]
    fn detail_at(&self, uv: DVec2, across: DVec2, beyond: Beyond) -> f32 {
        let texels = DVec2::new(self.width as f64, self.height as f64);
        let square = across.dot(texels * texels);
        if !(square > 1.0) {
            return 0.0; // texels side by side, or no number
        }
        let place = DVec2::new(uv.x, 1.0 - uv.y) * texels;
        self.pyramid.get_or_init(|| Pyramid::of(self)).at(place.to_array(), square.sqrt(), beyond)
    }

    #[inline(always)]
    fn bilinear(&self, uv: DVec2, beyond: Beyond) -> Rgb {
        let x = uv.x * self.width as f64 - 0.5;
        let y = (1.0 - uv.y) * self.height as f64 - 0.5;
        let (x0, x1, p) = beyond.between(x, self.width);
        let (y0, y1, q) = beyond.between(y, self.height);
        let levels = levels();
        let texel =
            |at: usize| Rgb::from_array(self.texels[at].map(|byte| levels[usize::from(byte)]));
        let (above, below) = (y0 * self.width, y1 * self.width);
        let upper = texel(above + x0).lerp(texel(above + x1), p);
        let lower = texel(below + x0).lerp(texel(below + x1), p);
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
    fn repeated_pictures_have_no_seam() {
        let image = four_corners();
        for (uv, color) in [
            (DVec2::new(0.25, 0.75), Rgb::X),
            (DVec2::new(-3.75, 7.75), Rgb::X),
            (DVec2::new(1.0, 0.75), Rgb::new(0.5, 0.5, 0.0)), // between red and green on both sides
            (DVec2::new(5.0, -2.0), Rgb::splat(0.5)),
        ] {
            let found = image.sample_repeated(uv);
            assert!((found - color).abs().max_element() < 1e-6, "{uv}: {found}");
        }
        for far in [1e300, f64::INFINITY, f64::NAN] {
            assert!(image.sample_repeated(DVec2::splat(far)).is_finite());
        }
    }

    /// Oracle: a header that claims 60000 × 60000 texels, with nothing behind it.
    #[test]
    fn absurd_sizes_are_refused_before_memory_is_taken() {
        let mut png = Vec::new();
        let picture = ::image::RgbImage::new(1, 1);
        picture.write_to(&mut Cursor::new(&mut png), ::image::ImageFormat::Png).expect("in memory");
        for side in [60_000_u32, 30_000, 1 << 31] {
            let mut header = *b"IHDR\0\0\0\0\0\0\0\0\x08\x02\0\0\0";
            header[4..8].copy_from_slice(&side.to_be_bytes());
            header[8..12].copy_from_slice(&side.to_be_bytes());
            png[12..29].copy_from_slice(&header);
            let mut crc = !0_u32;
            for byte in header {
                crc ^= u32::from(byte);
                for _ in 0..8 {
                    crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
                }
            }
            png[29..33].copy_from_slice(&(!crc).to_be_bytes());
            let error = Image::decode("bomb", &png).expect_err("too large").to_string();
            assert!(error.contains(&side.to_string()) || side > 1 << 30, "{error}");
        }
    }

    #[test]
    fn garbage_is_an_error() {
        let error = Image::decode("noise", b"not a picture").expect_err("garbage");
        assert!(error.to_string().contains("`noise`"), "{error}");
    }
}
