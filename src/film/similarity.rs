//! How alike two pictures look: structure instead of levels.

use image::RgbImage;

/// The standard deviation of the window in pixels, and how far it reaches.
const SIGMA: f64 = 1.5;
const REACH: usize = 5;
/// The squares of 0.01 and 0.03 of the full range keep the quotients from dividing by nothing.
const C1: f64 = 6.5025;
const C2: f64 = 58.5225;

/// The structural similarity of two pictures of one size, from -1 to 1, which only pictures of equal
/// luma reach.
///
/// The mean over all pixels of (2 μ₁μ₂ + c₁)(2 σ₁₂ + c₂) / ((μ₁² + μ₂² + c₁)(σ₁² + σ₂² + c₂)) on the luma (Rec. 601) of
/// the levels, within a Gaussian window of 11 × 11 pixels, cut off at the pictures' edges.
///
/// Source: Wang, Bovik, Sheikh & Simoncelli, "Image quality assessment: from error visibility to structural
/// similarity", *IEEE Trans. Image Processing* 13(4) (2004).
pub(super) fn ssim(a: &RgbImage, b: &RgbImage) -> f64 {
    let (width, height) = (a.width() as usize, a.height() as usize);
    let (a, b) = (luma(a), luma(b));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
    let blurred = |values: Vec<f64>| blur(&values, width, height);
    let (aa, bb, ab) =
        (blurred(product(&a, &a)), blurred(product(&b, &b)), blurred(product(&a, &b)));
    let (ma, mb) = (blurred(a), blurred(b));
    let sum: f64 = (0..width * height)
        .map(|i| {
            let (square_a, square_b, both) = (ma[i] * ma[i], mb[i] * mb[i], ma[i] * mb[i]);
            let (va, vb, covariance) = (aa[i] - square_a, bb[i] - square_b, ab[i] - both);
            (2.0 * both + C1) * (2.0 * covariance + C2)
                / ((square_a + square_b + C1) * (va + vb + C2))
        })
        .sum();
    sum / (width * height) as f64
}

fn luma(picture: &RgbImage) -> Vec<f64> {
    let weigh = |p: &image::Rgb<u8>| {
        0.299 * f64::from(p.0[0]) + 0.587 * f64::from(p.0[1]) + 0.114 * f64::from(p.0[2])
    };
    picture.pixels().map(weigh).collect()
}

/// The Gaussian mean about each pixel, of what lies in the picture.
fn blur(values: &[f64], width: usize, height: usize) -> Vec<f64> {
    let weights: Vec<f64> =
        (0..=REACH).map(|k| (-((k * k) as f64) / (2.0 * SIGMA * SIGMA)).exp()).collect();
    let pass = |values: &[f64], along: usize, count: usize, step: usize, x: usize, start: usize| {
        let (from, to) = (along.saturating_sub(REACH), (along + REACH).min(count - 1));
        let (mut sum, mut all) = (0.0, 0.0);
        for k in from..=to {
            let weight = weights[k.abs_diff(along)];
            sum += weight * values[start + k * step + x];
            all += weight;
        }
        sum / all
    };
    let index = 0..width * height;
    let rows: Vec<f64> =
        index.clone().map(|i| pass(values, i % width, width, 1, 0, i - i % width)).collect();
    index.map(|i| pass(&rows, i / width, height, width, i % width, 0)).collect()
}
