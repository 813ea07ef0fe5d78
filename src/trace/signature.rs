//! What a ray tree met, as a hash.
//!
//! Each hit is hashed with the branches that led to it; a sample's signature is the sum over its hits, which does not
//! depend on the order they come in.

use crate::light::Light;

/// How a ray came from its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Branch {
    Reflected,
    Transmitted,
}

/// The hash of the way from the camera to a hit, and of what was met there so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Path(u32);

impl Path {
    pub(super) const START: Self = Self(0x9e37_79b9);

    /// The path with this signature so far.
    #[inline(always)]
    pub(super) fn of(signature: u32) -> Self {
        Self(signature)
    }

    #[inline(always)]
    fn mix(self, word: u32) -> Self {
        Self(hash(self.0 ^ word.wrapping_mul(0x85eb_ca6b)))
    }

    #[inline(always)]
    pub(super) fn branch(self, branch: Branch) -> Self {
        self.mix(1 + branch as u32)
    }

    #[inline(always)]
    pub(super) fn hit(self, primitive: u32, face: u8, inside: bool) -> Self {
        self.mix(primitive).mix(u32::from(face) << 1 | u32::from(inside))
    }

    /// A light that arrives, by its [`light_word`].
    #[inline(always)]
    pub(super) fn light(self, word: u32) -> Self {
        self.mix(word)
    }

    /// The inner part of a highlight, which is at least half as bright as its middle.
    #[inline(always)]
    pub(super) fn highlight(self) -> Self {
        self.mix(u32::MAX - 1)
    }

    #[inline(always)]
    pub(super) fn cell(self, cell: u32) -> Self {
        self.mix(cell)
    }

    pub(super) fn background(self) -> u32 {
        self.mix(u32::MAX).0
    }

    pub(super) fn signature(self) -> u32 {
        self.0
    }
}

/// What stands for a light that arrives through bodies whose crossings hash to `passed`.
#[inline(always)]
pub(super) fn light_word(light: &Light, passed: u32) -> u32 {
    let position = light.position.to_array().map(f64::to_bits);
    position.into_iter().fold(passed, |word, bits| hash(word ^ (bits ^ bits >> 32) as u32))
}

/// A hash of 32 bits in which every bit depends on all.
///
/// Source: Wellons, "Prospecting for Hash Functions" (2018), `lowbias32`.
#[inline(always)]
pub(super) fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::color::Rgb;

    /// Where one light ends and another begins, only their words differ: of mirrored places, of those that are far away in
    /// the same direction, of those with their coordinates exchanged.
    #[test]
    fn lights_in_different_places_have_different_words() {
        let numbers = [-4.0, -1.125, -1.0, -0.5, 0.0, 0.5, 1.0, 1.125, 2.0, 4.0, 1e3, 1e-300];
        let mut words = Vec::new();
        for x in numbers {
            for y in numbers {
                for z in numbers {
                    let light = Light { position: DVec3::new(x, y, z), intensity: Rgb::ONE };
                    words.push(light_word(&light, 0));
                }
            }
        }
        let count = words.len();
        words.sort_unstable();
        words.dedup();
        assert_eq!(words.len(), count);
    }
}
