//! How many rays a picture took.

use std::ops::{Add, Sub};

use serde::{Deserialize, Serialize};

/// How many rays of each kind were cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RayCounts {
    /// Rays from the camera.
    pub camera: u64,
    /// Rays in the mirror direction.
    pub reflected: u64,
    /// Rays bent by Snell's law.
    pub refracted: u64,
    /// Rays that go straight on through a body of index 1.
    pub transmitted: u64,
    /// Rays towards a light, one for each light and shaded hit that faces it.
    pub shadow: u64,
    /// Camera rays that hit anything.
    pub camera_hit: u64,
}

impl RayCounts {
    /// The rays of all kinds.
    pub fn all(&self) -> u64 {
        self.camera + self.reflected + self.refracted + self.transmitted + self.shadow
    }

    fn combine(self, other: Self, op: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            camera: op(self.camera, other.camera),
            reflected: op(self.reflected, other.reflected),
            refracted: op(self.refracted, other.refracted),
            transmitted: op(self.transmitted, other.transmitted),
            shadow: op(self.shadow, other.shadow),
            camera_hit: op(self.camera_hit, other.camera_hit),
        }
    }
}

impl Add for RayCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.combine(other, u64::add)
    }
}

impl Sub for RayCounts {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.combine(other, u64::sub)
    }
}
