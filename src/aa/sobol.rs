//! The places of a pixel's samples: Sobol's sequence in two dimensions, scrambled anew for each pixel.

use glam::DVec2;

use crate::math::random::SplitMix64;

/// A pixel's own sequence of places in the unit square.
///
/// The first 2ᵏ places hit every elementary interval (2⁻ᵃ wide, 2⁻ᵇ high, a + b = k) exactly once, for every k: each
/// beginning of a length that is a power of two is as even as that many places can be. Owen's scrambling keeps that and
/// makes every place uniform, so that means are without bias and pixels independent.
///
/// Source: Sobol' (1967); Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences" (1995); the hash in place of
/// Owen's permutations: Laine & Karras, "Stratified sampling for stochastic transparency" (2011), and Burley,
/// "Practical hash-based Owen scrambling", *JCGT* 9(4) (2020).
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    seeds: [u32; 2],
}

impl Sequence {
    /// The sequence of the pixel with this number, row by row over the whole picture.
    pub fn of_pixel(pixel: u64, seed: u64) -> Self {
        let bits = hash(pixel ^ hash(seed ^ 0x5EED_0F5A_3B1E_5EED));
        Self { seeds: [bits as u32, (bits >> 32) as u32] }
    }

    /// The place with this number, from 0; in `[0, 1)` both ways.
    pub fn place(&self, index: u32) -> DVec2 {
        let y = match SECOND.get(index as usize) {
            Some(y) => *y,
            None => second_dimension(index).reverse_bits(),
        };
        let x = index;
        let unit = |reversed: u32, seed| {
            f64::from(permute(reversed, seed).reverse_bits()) / 4_294_967_296.0
        };
        DVec2::new(unit(x, self.seeds[0]), unit(y, self.seeds[1]))
    }
}

/// The reversed digits of the second dimension's beginning.
const SECOND: [u32; 64] = {
    let mut second = [0; 64];
    let mut index = 0;
    while index < second.len() {
        second[index] = second_dimension(index as u32).reverse_bits();
        index += 1;
    }
    second
};

/// A number that looks random for each `x`.
pub(crate) fn hash(x: u64) -> u64 {
    SplitMix64::new(x).next_u64()
}

/// Sobol's second dimension, whose direction numbers come from the polynomial x + 1.
const fn second_dimension(index: u32) -> u32 {
    let (mut direction, mut result, mut bits) = (1_u32 << 31, 0, index);
    while bits != 0 {
        if bits & 1 == 1 {
            result ^= direction;
        }
        direction ^= direction >> 1;
        bits >>= 1;
    }
    result
}

/// A permutation in which each bit depends on the lower ones alone: of the reversed digits, a scrambling after Owen.
fn permute(x: u32, seed: u32) -> u32 {
    let x = x ^ x.wrapping_mul(0x3d20_adea);
    let x = x.wrapping_add(seed);
    let x = x.wrapping_mul((seed >> 16) | 1);
    let x = x ^ x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the definition of a (0, k, 2)-net, counted.
    #[test]
    fn beginnings_hit_every_elementary_interval_once() {
        for pixel in [0, 1, 2, 599, 360_000, u64::MAX] {
            for seed in [0, 1] {
                let sequence = Sequence::of_pixel(pixel, seed);
                for k in 0..=10_u32 {
                    let places: Vec<DVec2> = (0..1 << k).map(|i| sequence.place(i)).collect();
                    for a in 0..=k {
                        let (columns, rows) = (1_usize << a, 1_usize << (k - a));
                        let mut hits = vec![0; columns * rows];
                        for p in &places {
                            let column = (p.x * columns as f64) as usize;
                            let row = (p.y * rows as f64) as usize;
                            hits[row * columns + column] += 1;
                        }
                        assert!(
                            hits.iter().all(|&n| n == 1),
                            "{pixel}, {seed}: 2^{k}, 2^{a} columns"
                        );
                    }
                }
            }
        }
    }

    /// Oracle: a uniform number has mean 1/2 and variance 1/12; two independent ones have no covariance.
    #[test]
    fn first_places_of_pixels_are_uniform_and_independent() {
        let count = 40_000_u32;
        let (mut mean, mut square, mut product, mut neighbours) =
            (DVec2::ZERO, DVec2::ZERO, 0.0, 0.0);
        let mut last = DVec2::ZERO;
        for pixel in 0..count {
            let p = Sequence::of_pixel(pixel.into(), 0).place(pixel % 4) - 0.5;
            mean += p;
            square += p * p;
            product += p.x * p.y;
            neighbours += p.dot(last);
            last = p;
        }
        let n = f64::from(count);
        let tolerance = 5.0 / n.sqrt() / 12.0_f64.sqrt();
        assert!((mean / n).abs().max_element() < tolerance, "{mean}");
        assert!((square / n - 1.0 / 12.0).abs().max_element() < tolerance, "{square}");
        assert!((product / n).abs() < tolerance && (neighbours / n).abs() < tolerance);
    }
}
