//! The frame of the tree: its primitives within [−1, 1]³, where single precision is enough to find candidates.
//!
//! A ray is brought here in double precision. One that starts far away first walks to the ball about the tree, so that
//! its single-precision origin is never further than 2 from the centre and the roundings of origin, direction and
//! box planes move no ray by more than half of [`BOX_PAD`]. Whatever this frame answers is only "perhaps": what is hit
//! is decided in double precision and world coordinates.

use glam::DVec3;

use crate::{
    geometry::{Bounds, Ray},
    math::scale,
};

/// By how much boxes are enlarged on every side. A quarter of it was just enough for a ray's roundings on adversarial
/// rays (tangent, through vertices, along faces); the other three are margin.
const BOX_PAD: f64 = 1.0 / (1 << 19) as f64;

/// Rays from afar that pass the centre at a greater distance (squared) miss the ball about [−1, 1]³, whose radius is
/// √3.
const BALL_SQUARED: f64 = 3.05;

/// How much later than computed an end may be, in the parameter of the tree's frame, for a ray that walked here.
const ARRIVAL_SLACK: f64 = 1.0 / (1 << 20) as f64;

/// Beyond this distance (in the tree's frame, squared) a ray walks to the ball first.
const NEAR_SQUARED: f64 = 4.0;

/// Beyond this distance (in the tree's frame, squared) the rounding of "origin − centre" in double precision, which
/// every primitive does for itself, is no longer small against the pads.
const FAR_SQUARED: f64 = ((1_u64 << 28) * (1_u64 << 28)) as f64;

/// The change from world coordinates to those of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    center: DVec3,
    scale: f64,
    pad: f64,
}

/// A ray in the frame of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeRay {
    /// Where it starts, or arrives.
    pub(super) origin: [f32; 3],
    /// Its direction, the largest component in [1, 2].
    pub(super) dir: [f32; 3],
    /// Lengths of the direction here for each length of the direction in the world; a power of two.
    pub(super) rate: f64,
    /// The parameter (here) at which it arrives.
    pub(super) arrival: f64,
    /// How much later than computed an end may be.
    pub(super) slack: f64,
}

/// What becomes of a ray on its way into the frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Entry {
    /// It certainly meets nothing in the tree.
    Miss,
    /// It arrives.
    Ray(TreeRay),
    /// It starts too far away, or its direction is too extreme, to be represented here.
    Extreme,
}

impl Frame {
    /// The frame in which `bounds` is within [−1, 1]³; `None` if they are not finite, or so far from the coordinates' origin that
    /// roundings there are as large as they are.
    pub(super) fn new(bounds: &Bounds) -> Option<Self> {
        let half = bounds.size() / 2.0;
        let center = bounds.center();
        if !(half.is_finite() && center.is_finite()) {
            return None;
        }
        let scale = if half > 0.0 { scale::power_of_two(-1 - scale::exponent(half)) } else { 1.0 };
        // Far from the coordinates' origin the primitives' own roundings count too.
        let roundings = bounds.largest_coordinate() * scale * 16.0 * f64::EPSILON;
        let pad = BOX_PAD + roundings;
        (pad < 1.0).then_some(Self { center, scale, pad })
    }

    /// The box about `bounds` in this frame, enlarged by the pad and rounded outward.
    pub(super) fn outer_box(&self, bounds: &Bounds) -> ([f32; 3], [f32; 3]) {
        let min = (bounds.min - self.center) * self.scale - self.pad;
        let max = (bounds.max - self.center) * self.scale + self.pad;
        (min.to_array().map(below), max.to_array().map(above))
    }

    /// A length in this frame.
    pub(super) fn length(&self, x: f64) -> f64 {
        x * self.scale
    }

    /// A point in this frame.
    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) * self.scale
    }

    /// By how much the boxes are enlarged.
    pub(super) fn pad(&self) -> f64 {
        self.pad
    }

    /// How many times as much as usual that is.
    pub(super) fn coarseness(&self) -> f64 {
        self.pad / BOX_PAD
    }

    /// The ray in this frame.
    #[inline(always)]
    pub(super) fn enter(&self, ray: &Ray) -> Entry {
        let (dir, rate, fits) = self.shrunk(ray.dir);
        if !fits {
            return Entry::Extreme;
        }
        let mut origin = self.point(ray.origin);
        let distance_squared = origin.length_squared();
        let (mut arrival, mut slack) = (0.0, 0.0);
        if !(distance_squared <= NEAR_SQUARED) {
            if !(distance_squared <= FAR_SQUARED) {
                return Entry::Extreme;
            }
            let Some((point, t)) = arrive(origin, dir) else { return Entry::Miss };
            (origin, arrival, slack) = (point, t, ARRIVAL_SLACK);
        }
        Entry::Ray(TreeRay::new(origin, dir, rate, arrival, slack))
    }

    /// The direction scaled so that its largest component is in [1, 2], the rate of the parameters, and whether both
    /// are ordinary numbers: directions that are zero, subnormal or not finite go elsewhere.
    #[inline(always)]
    fn shrunk(&self, dir: DVec3) -> (DVec3, f64, bool) {
        let size = dir.abs();
        let exponent = scale::largest(dir).to_bits() >> 52; // biased
        let shrink = f64::from_bits(2046_u64.wrapping_sub(exponent) << 52);
        let rate = self.scale / shrink;
        let is_finite =
            (size.x < f64::INFINITY) & (size.y < f64::INFINITY) & (size.z < f64::INFINITY);
        let is_normal = (f64::MIN_POSITIVE..f64::INFINITY).contains(&rate);
        (dir * shrink, rate, (1..2046).contains(&exponent) & is_normal & is_finite)
    }
}

/// A point of the line of a ray from afar between 1.92 and 2 from the centre, before the ball about the frame, and its
/// parameter; `None` if the line passes by or the ball is behind.
///
/// The foot of the perpendicular from the centre, o + t d, is as exact as the origin, as product and sum are rounded
/// once: an error of t only moves it along the line. At the distance √f from the centre, it is y = 1.98 − f/3 beyond
/// the point, which is outside the ball and not too far, as √(3.02 − f) ≤ y ≤ √(4 − f) for f up to [`BALL_SQUARED`].
#[inline(always)]
fn arrive(origin: DVec3, dir: DVec3) -> Option<(DVec3, f64)> {
    let a = dir.length_squared();
    let t = -origin.dot(dir) / a;
    let foot = DVec3::new(
        dir.x.mul_add(t, origin.x),
        dir.y.mul_add(t, origin.y),
        dir.z.mul_add(t, origin.z),
    );
    let offset = foot.length_squared();
    let step = (1.98 - offset * (1.0 / 3.0)) / a.sqrt();
    (offset <= BALL_SQUARED && t > 0.0).then(|| (foot - dir * step, t - step))
}

impl TreeRay {
    #[inline(always)]
    fn new(origin: DVec3, dir: DVec3, rate: f64, arrival: f64, slack: f64) -> Self {
        let origin = [origin.x as f32, origin.y as f32, origin.z as f32];
        let dir = [dir.x as f32, dir.y as f32, dir.z as f32];
        Self { origin, dir, rate, arrival, slack }
    }

    /// The squared length of the direction.
    #[inline(always)]
    pub(super) fn square(&self) -> f32 {
        let [x, y, z] = self.dir;
        x * x + (y * y + z * z)
    }

    /// The world's parameter `t` here, rounded up and with room for the error of the arrival.
    #[inline(always)]
    pub(super) fn end_above(&self, t: f64) -> f32 {
        above(t * self.rate - self.arrival + self.slack)
    }

    /// The world's parameter `t` here, rounded down likewise.
    #[inline(always)]
    pub(super) fn end_below(&self, t: f64) -> f32 {
        below(t * self.rate - self.arrival - self.slack)
    }

    /// One over the direction, finite: a component that is zero keeps its sign and counts as tiny, and the pads keep
    /// the box planes away from the ray.
    #[inline(always)]
    pub(super) fn inverse(&self) -> [f32; 3] {
        self.dir.map(|d| 1.0 / if d.abs() < 1e-30 { 1e-30_f32.copysign(d) } else { d })
    }
}

/// A single-precision number not below `x`.
#[inline(always)]
pub(super) fn above(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_up() } else { y }
}

/// A single-precision number not above `x`.
#[inline(always)]
pub(super) fn below(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) > x { y.next_down() } else { y }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Frame {
        Frame::new(&Bounds { min: DVec3::NEG_ONE, max: DVec3::ONE }).expect("finite")
    }

    /// Oracle: a ray aimed at a chosen point arrives on the line to that point, from any distance.
    #[test]
    fn arrival_keeps_to_the_line_from_afar() {
        let frame = unit();
        for distance in [3.0, 1e3, 1e6, 1e8] {
            for (target, dir) in [
                (DVec3::new(0.3, -0.2, 0.1), DVec3::new(1.0, 2.0, -3.0)),
                (DVec3::new(-0.4, 0.25, 0.0), DVec3::new(0.0, -0.0, 1.0)),
                (DVec3::new(0.0, 0.45, 0.25), DVec3::new(-1e-3, 1.0, 1e-9)),
            ] {
                let dir = dir.normalize();
                let ray = Ray::new(target - dir * distance, dir);
                let Entry::Ray(local) = frame.enter(&ray) else { panic!("{distance}: no entry") };
                let origin = DVec3::from_array(local.origin.map(f64::from));
                let goal = frame.point(target);
                assert!(origin.length() <= 2.0, "{distance:e}");
                let slip = (goal - origin).cross(dir).length();
                let rounding = distance * f64::EPSILON + 4.0 * f64::from(f32::EPSILON);
                assert!(slip <= rounding, "{distance:e}: {slip:e}");
                // The end at the target is just beyond it.
                let gap = f64::from(local.end_above(distance))
                    * DVec3::from_array(local.dir.map(f64::from)).length()
                    - (goal - origin).length();
                assert!((0.0..1e-5).contains(&(gap + 1e-6)), "{distance:e}: {gap:e}");
            }
        }
    }

    #[test]
    fn rays_that_pass_by_or_go_away_miss() {
        let frame = unit();
        for (origin, dir) in [
            (DVec3::new(5.0, 0.0, 0.0), DVec3::X),
            (DVec3::new(-1e6, 4.0, 0.0), DVec3::X),
            (DVec3::new(0.0, 1e7, 0.0), DVec3::new(1.0, -0.5, 0.0)),
        ] {
            assert!(matches!(frame.enter(&Ray::new(origin, dir)), Entry::Miss), "{origin} {dir}");
        }
    }

    #[test]
    fn extreme_directions_are_turned_away() {
        let frame = unit();
        for dir in [
            DVec3::ZERO,
            DVec3::splat(f64::NAN),
            DVec3::new(f64::NAN, 1.0, 0.0),
            DVec3::new(f64::INFINITY, 0.0, 0.0),
            DVec3::splat(5e-324),
        ] {
            assert!(matches!(frame.enter(&Ray::new(DVec3::ZERO, dir)), Entry::Extreme), "{dir}");
        }
        let nowhere = Ray::new(DVec3::splat(f64::NAN), DVec3::X);
        assert!(matches!(frame.enter(&nowhere), Entry::Extreme));
    }

    #[test]
    fn rounding_is_outward() {
        for x in [0.1, -0.1, 1.0, 1e-60, -1e-60, 3.3e300, f64::INFINITY] {
            assert!(f64::from(above(x)) >= x && f64::from(below(x)) <= x, "{x}");
        }
    }
}
