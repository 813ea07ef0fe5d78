//! Closed convex solids as intervals of the ray: the side's, cut by that of the slab between the flat ends.
//!
//! One comparison, enter ≤ exit, decides whether there is a hit, so no ray slips between side and rim; and the
//! bound that won is the face.

use super::hit::{Crossing, Crossings, NO_CROSSINGS};

/// The interval of the ray inside a convex set, with the faces that bound it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub(super) enter: Crossing,
    pub(super) exit: Crossing,
}

impl Interval {
    /// The whole line.
    pub(super) const ALL: Self = Self {
        enter: Crossing { t: f64::NEG_INFINITY, face: 0 },
        exit: Crossing { t: f64::INFINITY, face: 0 },
    };

    #[inline(always)]
    pub(super) fn new(enter: f64, exit: f64) -> Self {
        Self { enter: Crossing::at(enter), exit: Crossing::at(exit) }
    }

    /// The part with `y ≥ 0` if the ray starts at height `y` and rises by `dy`; the plane is `face`. `None` if nothing
    /// is left whatever the rest.
    #[inline(always)]
    pub(super) fn above(self, y: f64, dy: f64, face: u8) -> Option<Self> {
        let t = -y / dy;
        if dy > 0.0 {
            let enter = if t > self.enter.t { Crossing { t, face } } else { self.enter };
            Some(Self { enter, ..self })
        } else if dy < 0.0 {
            let exit = if t < self.exit.t { Crossing { t, face } } else { self.exit };
            Some(Self { exit, ..self })
        } else if y >= 0.0 {
            Some(self)
        } else {
            None // parallel and outside, or NaN
        }
    }

    /// The two crossings, if the interval holds anything.
    #[inline(always)]
    pub(super) fn crossings(self) -> Crossings {
        if self.enter.t <= self.exit.t { [self.enter, self.exit] } else { NO_CROSSINGS }
    }
}

/// The crossing of a ray that starts on the surface of a convex solid and goes into it: the end of the interval
/// `ahead`, which starts at the ray's origin. A chord of no length, of a ray that grazes, is still crossed.
#[inline(always)]
pub(super) fn leaving(ahead: Option<Interval>) -> Crossings {
    let exit = |interval: Interval| Crossing {
        t: interval.exit.t.max(f64::MIN_POSITIVE),
        ..interval.exit
    };
    [ahead.map_or(Crossing::at(f64::MIN_POSITIVE), exit), Crossing::NONE]
}
