//! The exact change of coordinates that brings a scene to ordinary size.

use glam::DVec3;

use super::{
    bounds::Bounds,
    hit::Surface,
    ray::{Departure, Ray},
};
use crate::math::{compensated::two_sum, scale};

/// The map `p → (p − origin) · 2^exponent`.
///
/// The scale is a power of two, so it rounds nothing unless a value becomes subnormal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    origin: DVec3,
    exponent: i32,
}

/// The power of two between a ray's parameter and that of its image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterScale(i32);

impl ParameterScale {
    /// The parameter on the ray, given that on its image.
    pub fn apply(self, t: f64) -> f64 {
        scale::scaled(DVec3::splat(t), self.0).x
    }

    /// The parameter of a hit on the ray, given that on its image. A hit is ahead, even one so near in lengths of a long
    /// direction that its distance underflows.
    pub fn of_hit(self, t: f64) -> f64 {
        self.apply(t).max(f64::from_bits(1))
    }

    /// The parameter on the image, given that on the ray.
    pub fn revert(self, t: f64) -> f64 {
        scale::scaled(DVec3::splat(t), -self.0).x
    }
}

impl Similarity {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self { origin: DVec3::ZERO, exponent: 0 };

    /// The map `p → (p − origin) · 2^exponent`.
    pub fn new(origin: DVec3, exponent: i32) -> Self {
        Self { origin, exponent }
    }

    /// The map that brings `bounds` to a radius between 1/2 and 1, about the origin where that rounds nothing.
    ///
    /// The centre of `bounds`, rounded to the grid of its largest coordinate, becomes the origin if all of `points`
    /// can be moved there exactly; else the origin stays. With empty bounds the map is the identity.
    pub fn normalizing(bounds: &Bounds, mut points: impl Iterator<Item = DVec3>) -> Self {
        let largest = bounds.largest_coordinate();
        if bounds.is_empty() || !largest.is_finite() || largest == 0.0 {
            return Self::IDENTITY;
        }
        let grid = scale::power_of_two(scale::exponent(largest) - 52);
        let center = (bounds.center() / grid).round() * grid;
        let is_exact = |p: DVec3| (0..3).all(|k| two_sum(p[k], -center[k]).1 == 0.0);
        let (origin, radius) = if grid > f64::MIN_POSITIVE && points.all(is_exact) {
            let corner = (bounds.max - center).abs().max((bounds.min - center).abs());
            (center, scale::normalized(corner))
        } else {
            (DVec3::ZERO, scale::normalized(bounds.max.abs().max(bounds.min.abs())))
        };
        let (corner, e) = radius; // the corner's largest component in [1, 2)
        Self::new(origin, e - scale::exponent(corner.length()) - 1)
    }

    /// The map about the origin that brings lengths up to `largest` below 1.
    pub fn scaling(largest: f64) -> Self {
        let exponent =
            if largest > 0.0 && largest.is_finite() { -1 - scale::exponent(largest) } else { 0 };
        Self { origin: DVec3::ZERO, exponent }
    }

    /// The image of a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        scale::scaled(p - self.origin, self.exponent)
    }

    /// The image of a vector.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        scale::scaled(v, self.exponent)
    }

    /// The image of a length.
    pub fn length(&self, x: f64) -> f64 {
        self.vector(DVec3::splat(x)).x
    }

    /// The point whose image is `p`.
    pub fn point_back(&self, p: DVec3) -> DVec3 {
        scale::scaled(p, -self.exponent) + self.origin
    }

    /// The length whose image is `x`.
    pub fn length_back(&self, x: f64) -> f64 {
        scale::scaled(DVec3::splat(x), -self.exponent).x
    }

    /// The image of a ray, its direction brought to ordinary length, and how its parameters are to be read.
    pub fn ray(&self, ray: &Ray) -> (Ray, ParameterScale) {
        let (dir, e) = scale::normalized(ray.dir);
        let from = ray.from.map(|from| Departure {
            local: self.vector(from.local),
            point: self.point(from.point),
            point_rest: self.vector(from.point_rest),
            ..from
        });
        (Ray { origin: self.point(ray.origin), dir, from }, ParameterScale(e - self.exponent))
    }

    /// The surface point whose image is `surface`.
    pub fn surface_back(&self, surface: &Surface) -> Surface {
        Surface {
            point: self.point_back(surface.point),
            point_rest: scale::scaled(surface.point_rest, -self.exponent),
            local: scale::scaled(surface.local, -self.exponent),
            error: self.length_back(surface.error),
            ..*surface
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: scaling by a power of two commutes with normalising, bit for bit.
    #[test]
    fn normalising_undoes_a_power_of_two() {
        let corners = [DVec3::new(-50.0, -15.0, -200.0), DVec3::new(50.3, 51.67, -40.1)];
        let image = |e: i32| {
            let points = corners.map(|p| scale::scaled(p, e));
            let map = Similarity::normalizing(&Bounds::of_points(points), points.into_iter());
            points.map(|p| map.point(p))
        };
        let unit = image(0);
        let radius = (unit[1] - unit[0]).length() / 2.0;
        assert!((0.25..=1.0).contains(&radius), "{radius}");
        for e in [-498, -300, -20, -1, 1, 20, 300, 498] {
            assert_eq!(image(e), unit, "2^{e}");
        }
    }

    /// Oracle: an exact shift of quantised geometry changes no coordinate after normalising.
    #[test]
    fn normalising_undoes_an_exact_shift() {
        let corners = [DVec3::new(-1.0, -2.0, -4.5), DVec3::new(1.0, 2.25, 4.0)];
        let image = |shift: DVec3| {
            let points = corners.map(|p| p + shift);
            let map = Similarity::normalizing(&Bounds::of_points(points), points.into_iter());
            points.map(|p| map.point(p))
        };
        for e in [10, 20, 30, 40] {
            let shifted = image(DVec3::new(1.0, -1.0, 1.0) * scale::power_of_two(e));
            assert_eq!(shifted[1] - shifted[0], (corners[1] - corners[0]) / 8.0, "2^{e}");
        }
    }
}
