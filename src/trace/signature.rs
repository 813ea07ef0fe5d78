//! What a ray tree met, as a hash.
//!
//! Each hit is hashed with the branches that led to it; a sample's signature is the sum over its hits, which does not depend
//! on the order they come in.

use crate::{geometry::Hit, light::Light};

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

    fn mix(self, word: u32) -> Self {
        Self(hash(self.0 ^ word.wrapping_mul(0x85eb_ca6b)))
    }

    pub(super) fn branch(self, branch: Branch) -> Self {
        self.mix(1 + branch as u32)
    }

    pub(super) fn hit(self, hit: &Hit, inside: bool) -> Self {
        self.mix(hit.primitive).mix(u32::from(hit.face) << 1 | u32::from(inside))
    }

    /// A light that arrives, through bodies whose crossings hash to `passed`.
    pub(super) fn light(self, light: &Light, passed: u32) -> Self {
        let position = light.position.to_array().map(f64::to_bits);
        let word = position
            .into_iter()
            .fold(passed, |word, bits| word.rotate_left(7) ^ (bits >> 21) as u32);
        self.mix(word)
    }

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

/// A hash of 32 bits in which every bit depends on all.
///
/// Source: Wellons, "Prospecting for Hash Functions" (2018), `lowbias32`.
pub(super) fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}
