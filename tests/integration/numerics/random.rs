//! Seeded random numbers and the numbers of rays.

use std::f64::consts::TAU;

use glam::DVec3;

/// SplitMix64 (Steele, Lea & Flood 2014), a generator small enough to read.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub(crate) fn flip(&mut self) -> bool {
        self.bits() >> 63 == 1
    }

    pub(crate) fn sign(&mut self) -> f64 {
        if self.flip() { 1.0 } else { -1.0 }
    }

    pub(crate) fn pick<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
    }

    /// A point of [−1, 1]³.
    pub(crate) fn in_cube(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.between(-1.0, 1.0)))
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }

    /// A unit vector at right angles to `n`, up to rounding.
    pub(crate) fn across(&mut self, n: DVec3) -> DVec3 {
        loop {
            let v = self.direction();
            if let Some(u) = (v - n * (v.dot(n) / n.length_squared())).try_normalize() {
                return u;
            }
        }
    }

    /// A point of [−1, 1]³ on a grid of 2⁻¹⁰, so that it can be moved far without rounding.
    pub(crate) fn on_grid(&mut self) -> DVec3 {
        (self.in_cube() * 1024.0).round() / 1024.0
    }
}

/// `count` rays, times the environment's `WHITTED_RAYS` for a longer run.
pub(crate) fn rays(count: usize) -> usize {
    let factor = std::env::var("WHITTED_RAYS").map_or(Ok(1.0), |v| v.parse::<f64>());
    let factor = factor.expect("WHITTED_RAYS is a number");
    (count as f64 * factor).ceil() as usize
}

/// 10⁻ᵏ: how hard a family is.
pub(crate) fn tenth(k: i32) -> f64 {
    10.0_f64.powi(-k)
}
