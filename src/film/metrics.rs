//! How far two 8-bit pictures are apart.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use image::{ImageReader, RgbImage};

use super::{ImageError, similarity::ssim};
use crate::decode::decode;

/// The difference of two pictures in levels of 255, over all pixels and channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Root of the mean squared channel difference.
    pub rmse: f64,
    /// Mean absolute channel difference.
    pub mean: f64,
    /// The largest channel difference and the first pixel (row by row) that has it.
    pub worst: Worst,
    /// Share, from 0 to 1, of the pixels with a channel off by more than 8 levels.
    pub share_over_8: f64,
}

impl Difference {
    /// The peak signal-to-noise ratio in decibels, 20 log₁₀(255/rmse); infinite for equal pictures.
    pub fn psnr(&self) -> f64 {
        20.0 * (255.0 / self.rmse).log10()
    }
}

/// The structural similarity of two pictures of the same size, from -1 to 1, which only pictures of equal luma
/// reach.
///
/// # Errors
///
/// As [`Difference::between`].
pub fn structural_similarity(a: &RgbImage, b: &RgbImage) -> Result<f64, ImageError> {
    Difference::between(a, b).map(|_| ssim(a, b))
}

/// The largest channel difference of each pixel in levels of 255, row by row; of pictures of the same size.
pub fn channel_differences(a: &RgbImage, b: &RgbImage) -> Vec<f32> {
    let largest = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| {
        let differences = a.0.iter().zip(&b.0).map(|(a, b)| a.abs_diff(*b));
        f32::from(differences.max().unwrap_or(0))
    };
    a.pixels().zip(b.pixels()).map(largest).collect()
}

/// The pixel where two pictures differ most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Worst {
    /// Its largest channel difference, in levels of 255.
    pub levels: u8,
    /// Its column, from 0 at the left.
    pub x: u32,
    /// Its row, from 0 at the top.
    pub y: u32,
}

impl Difference {
    /// Compares two pictures of the same size; the order does not matter.
    ///
    /// # Errors
    ///
    /// [`ImageError::SizesDiffer`], or [`ImageError::Empty`] if there are no pixels.
    pub fn between(a: &RgbImage, b: &RgbImage) -> Result<Self, ImageError> {
        if a.dimensions() != b.dimensions() {
            return Err(ImageError::SizesDiffer {
                a: a.dimensions().into(),
                b: b.dimensions().into(),
            });
        }
        if a.is_empty() {
            return Err(ImageError::Empty);
        }
        let mut worst = Worst { levels: 0, x: 0, y: 0 };
        let (mut sum, mut squares, mut over_8) = (0_u64, 0_u64, 0_u64); // exact for 2⁴⁶ pixels
        for ((x, y, pixel_a), pixel_b) in a.enumerate_pixels().zip(b.pixels()) {
            let mut largest = 0;
            for (&channel_a, &channel_b) in pixel_a.0.iter().zip(&pixel_b.0) {
                let levels = channel_a.abs_diff(channel_b);
                sum += u64::from(levels);
                squares += u64::from(levels) * u64::from(levels);
                largest = largest.max(levels);
            }
            over_8 += u64::from(largest > 8);
            if largest > worst.levels {
                worst = Worst { levels: largest, x, y };
            }
        }
        let pixels = f64::from(a.width()) * f64::from(a.height());
        Ok(Self {
            rmse: (squares as f64 / (3.0 * pixels)).sqrt(),
            mean: sum as f64 / (3.0 * pixels),
            worst,
            share_over_8: over_8 as f64 / pixels,
        })
    }
}

/// How every PNG file begins.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Reads a PNG file as 8-bit RGB: grey is spread to three channels, 16-bit rounded to 8, alpha
/// left out.
///
/// # Errors
///
/// [`ImageError::Read`] if there is no readable file, [`ImageError::NotPng`] or [`ImageError::Decode`] if it is no sound PNG.
pub fn read_png_rgb8(path: impl AsRef<Path>) -> Result<RgbImage, ImageError> {
    let path = path.as_ref();
    let file =
        File::open(path).map_err(|source| ImageError::Read { path: path.to_owned(), source })?;
    decode_png_rgb8(BufReader::new(file), path)
}

/// The same of a file that is open already; `path` is for messages.
///
/// # Errors
///
/// As [`read_png_rgb8`].
pub fn decode_png_rgb8(mut file: impl BufRead + Seek, path: &Path) -> Result<RgbImage, ImageError> {
    let start =
        file.fill_buf().map_err(|source| ImageError::Read { path: path.to_owned(), source })?;
    // Of a shorter start the decoder says what is missing.
    if start.len() >= SIGNATURE.len() && !start.starts_with(&SIGNATURE) {
        return Err(ImageError::NotPng { path: path.to_owned() });
    }
    let mut reader = ImageReader::with_format(file, image::ImageFormat::Png);
    // The largest picture the program writes is beyond the decoder's usual limit.
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(16 << 30);
    reader.limits(limits);
    match decode(|| reader.decode()) {
        Ok(picture) => Ok(picture.into_rgb8()),
        Err(image::ImageError::IoError(source)) if source.raw_os_error().is_some() => {
            Err(ImageError::Read { path: path.to_owned(), source })
        }
        Err(source) => Err(ImageError::Decode { path: path.to_owned(), source }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, Luma, Rgb, Rgba};

    /// Oracle: worked by hand for a 5 x 2 picture, 30 channels.
    #[test]
    fn difference_is_that_worked_out_by_hand() {
        let a = RgbImage::from_pixel(5, 2, Rgb([100, 100, 100]));
        let mut b = a.clone();
        b.put_pixel(1, 0, Rgb([108, 100, 100])); // 8, not over 8
        b.put_pixel(3, 0, Rgb([91, 103, 100])); // 9 and 3
        b.put_pixel(4, 1, Rgb([100, 88, 112])); // 12 and 12
        b.put_pixel(0, 1, Rgb([100, 100, 112])); // 12, first in its row
        let difference = Difference::between(&a, &b).expect("same size");
        let squares = 64.0 + 81.0 + 9.0 + 3.0 * 144.0;
        assert!((difference.rmse - f64::sqrt(squares / 30.0)).abs() < 1e-14, "{difference:?}");
        assert!((difference.mean - 56.0 / 30.0).abs() < 1e-14, "{difference:?}");
        assert_eq!(difference.worst, Worst { levels: 12, x: 0, y: 1 });
        assert!((difference.share_over_8 - 0.3).abs() < 1e-15, "{difference:?}");
        assert_eq!(Difference::between(&b, &a).expect("same size"), difference);
    }

    #[test]
    fn pictures_of_another_kind_are_told_from_broken_ones() {
        let decode = |bytes: &[u8]| {
            let decoded = decode_png_rgb8(std::io::Cursor::new(bytes), Path::new("a.exr"));
            decoded.expect_err("no picture").to_string()
        };
        for other in [&b"P6 1 1 255 abc"[..], b"\x76\x2f\x31\x01\x02\0\0\0"] {
            assert!(decode(other).starts_with("a.exr: not a PNG file, and no other"));
        }
        for broken in [&SIGNATURE[..], &SIGNATURE[..3], b""] {
            assert!(decode(broken).starts_with("a.exr: not a valid PNG file ("));
        }
    }

    #[test]
    fn equal_pictures_do_not_differ_and_opposite_ones_differ_fully() {
        let [black, white] = [0, 255].map(|level| RgbImage::from_pixel(3, 4, Rgb([level; 3])));
        let same = Difference::between(&white, &white).expect("same size");
        let worst = Worst { levels: 0, x: 0, y: 0 };
        assert_eq!(same, Difference { rmse: 0.0, mean: 0.0, worst, share_over_8: 0.0 });
        let opposite = Difference::between(&black, &white).expect("same size");
        let worst = Worst { levels: 255, x: 0, y: 0 };
        assert_eq!(opposite, Difference { rmse: 255.0, mean: 255.0, worst, share_over_8: 1.0 });
    }

    /// Oracle: limits that follow from the definition, and a closed form for two constant pictures: they do not vary, so that the factor
    /// of contrast and structure is c₂/c₂, and (2·100·120 + c₁)/(100² + 120² + c₁) is left.
    #[test]
    fn similarity_is_one_for_equal_luma_only() {
        let wave = |phase: u32| {
            RgbImage::from_fn(40, 30, |x, y| {
                Rgb([(127.0 + 100.0 * f64::from(x + phase + y).sin()) as u8; 3])
            })
        };
        let ssim = |a: &RgbImage, b: &RgbImage| structural_similarity(a, b).expect("same size");
        assert!((ssim(&wave(0), &wave(0)) - 1.0).abs() < 1e-12);
        assert!(ssim(&wave(0), &wave(3)) < 0.0); // nearly half a period
        let grey = |level| RgbImage::from_pixel(20, 9, Rgb([level; 3]));
        let expected = (2.0 * 12_000.0 + 6.5025) / (10_000.0 + 14_400.0 + 6.5025);
        assert!((ssim(&grey(100), &grey(120)) - expected).abs() < 1e-9);
        let green = RgbImage::from_pixel(20, 9, Rgb([111, 101, 66])); // 0.299 R + 0.587 G + 0.114 B is 100
        assert!((ssim(&grey(100), &green) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn decibels_follow_the_error() {
        let [black, white] = [0, 255].map(|level| RgbImage::from_pixel(3, 4, Rgb([level; 3])));
        assert_eq!(Difference::between(&black, &white).expect("same size").psnr(), 0.0);
        assert_eq!(Difference::between(&black, &black).expect("same size").psnr(), f64::INFINITY);
        assert_eq!(channel_differences(&black, &white), [255.0; 12]);
    }

    #[test]
    fn pictures_of_different_size_or_none_do_not_compare() {
        let of = |width, height| RgbImage::new(width, height);
        let error = Difference::between(&of(3, 2), &of(2, 3)).expect_err("sizes differ");
        assert!(error.to_string().starts_with("the pictures are 3x2 and 2x3 pixels"), "{error}");
        let empty = Difference::between(&of(0, 7), &of(0, 7));
        assert!(matches!(empty, Err(ImageError::Empty)));
    }

    #[test]
    fn other_kinds_of_png_become_8_bit_rgb() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("picture.png");
        let kinds: [DynamicImage; 3] = [
            image::ImageBuffer::from_pixel(2, 1, Luma([77_u8])).into(),
            image::ImageBuffer::from_pixel(2, 1, Rgba([77_u8, 77, 77, 3])).into(),
            image::ImageBuffer::from_pixel(2, 1, Rgb([77_u16 * 257 + 100; 3])).into(),
        ];
        for kind in kinds {
            kind.save(&path).expect("written");
            let read = read_png_rgb8(&path).expect("readable");
            assert_eq!((read.dimensions(), read.into_raw()), ((2, 1), vec![77; 6]), "{kind:?}");
        }
    }

    #[test]
    fn what_is_no_png_is_refused_by_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("picture.png");
        assert!(matches!(read_png_rgb8(&path), Err(ImageError::Read { .. })));
        assert!(matches!(read_png_rgb8(folder.path()), Err(ImageError::Read { .. })));
        RgbImage::new(50, 50).save(&path).expect("written");
        let whole = std::fs::read(&path).expect("readable");
        for damaged in [&b""[..], &whole[..whole.len() / 2], &whole[..40]] {
            std::fs::write(&path, damaged).expect("written");
            let error = read_png_rgb8(&path).expect_err("damaged");
            assert!(matches!(error, ImageError::Decode { .. }), "{error:?}");
            assert!(error.to_string().contains("picture.png"), "{error}");
        }
    }
}
