//! What samples show of pictures that are finer than them.

use serde::{Deserialize, Serialize};

use crate::color::Rgb;

/// How far a sample is off because pictures on surfaces have more detail than a ray sees: its squared error, in levels of
/// 255, as the mean over what it stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Detail(u32);

/// Squared errors are added up in whole numbers, whose sum does not depend on their order, of so many squared levels.
const UNIT: f32 = 1.0 / 256.0;

/// Set if nothing but the picture is seen.
const WHOLE: u32 = 1 << 31;

impl Detail {
    /// The same, and that of another picture that is seen.
    #[inline(always)]
    #[must_use]
    pub fn and(self, squared_error: f32) -> Self {
        if !(squared_error > 0.0) {
            return self;
        }
        let units = (self.0 & !WHOLE).saturating_add((squared_error / UNIT) as u32);
        Self(units.min(!WHOLE) | self.0 & WHOLE)
    }

    /// The same, if the sample shows a picture and what is mirrored or shines through it does not count.
    #[must_use]
    pub fn whole(self) -> Self {
        Self(self.0 | WHOLE)
    }

    /// The same, of what gets so much light: levels go with its square root, about.
    #[inline(always)]
    #[must_use]
    pub fn lit(self, light: Rgb) -> Self {
        if self.0 & !WHOLE == 0 {
            return self;
        }
        Self(self.0 & WHOLE).and(self.squared_error() * light.max_element())
    }

    /// The squared error.
    #[inline(always)]
    pub fn squared_error(self) -> f32 {
        (self.0 & !WHOLE) as f32 * UNIT
    }

    /// Whether all that is finer than the sample is in a picture.
    #[inline(always)]
    pub fn is_whole(self) -> bool {
        self.0 & WHOLE != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn details_add_up_and_stay_whole() {
        let some = Detail::default().and(2.5).and(0.25);
        assert_eq!((some.squared_error(), some.is_whole()), (2.75, false));
        let whole = some.whole().and(1.0);
        assert_eq!((whole.squared_error(), whole.is_whole()), (3.75, true));
        let half = whole.lit(Rgb::new(0.1, 0.5, 0.2));
        assert_eq!((half.squared_error(), half.is_whole()), (1.875, true));
        let most = whole.and(f32::INFINITY).and(1.0).and(f32::NAN);
        assert!(most.is_whole() && most.squared_error() > 8e6);
        assert!(Detail::default().and(f32::INFINITY) == Detail::default().and(1e30));
    }
}
