//! Rays that are hard on spheres.

use glam::DVec3;
use whitted::geometry::Ray;

use super::random::{Random, tenth};
use super::score::sweep;
use super::subject::Subject;

fn any_sphere(random: &mut Random) -> (Subject, DVec3, f64) {
    let (center, radius) = (random.in_cube(), random.between(0.1, 1.0));
    (Subject::Sphere { center, radius }, center, radius)
}

#[test]
fn tangent() {
    sweep("sphere: tangent, relative miss 10^-k", 1, 1..=14, 1000, |k, random, tally| {
        let miss = tenth(k);
        let (subject, center, radius) = any_sphere(random);
        let normal = random.direction();
        let dir = random.across(normal);
        let offset = radius * (1.0 + random.sign() * miss);
        let origin = center + normal * offset - dir * random.between(-2.0, 10.0);
        tally.score(&subject, Ray::new(origin, dir));
    });
}

#[test]
fn start_near_the_surface() {
    sweep("sphere: start 10^-k r inside or outside", 2, 1..=14, 1000, |k, random, tally| {
        let gap = tenth(k);
        let (subject, center, radius) = any_sphere(random);
        let origin = center + random.direction() * radius * (1.0 + random.sign() * gap);
        tally.score(&subject, Ray::new(origin, random.direction()));
    });
}

/// An eye 10⁻ᵏ radii above a planet, rays within 10⁻ᵏ of the horizon.
#[test]
fn planet() {
    let radius = 6.4e6;
    let subject = Subject::Sphere { center: DVec3::new(0.0, -radius, 0.0), radius };
    sweep("planet: eye 10^-k R above it, at the horizon", 3, 0..=12, 1000, |k, random, tally| {
        let height = radius * 10.0_f64.powi(-k);
        let dip = (radius / (radius + height)).acos();
        let angle = dip + random.sign() * 10.0_f64.powf(random.between(-12.0, 0.0));
        let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
        let flat = DVec3::new(cos, 0.0, sin);
        let dir = flat * angle.cos() - DVec3::Y * angle.sin();
        tally.score(&subject, Ray::new(DVec3::new(0.0, height, 0.0), dir));
    });
}
