//! Rays that are hard on spheres.

use glam::DVec3;
use whitted::geometry::Ray;

use super::random::{Random, rays, tenths};
use super::score::Tally;
use super::subject::Subject;

fn any_sphere(random: &mut Random) -> (Subject, DVec3, f64) {
    let (center, radius) = (random.in_cube(), random.between(0.1, 1.0));
    (Subject::Sphere { center, radius }, center, radius)
}

#[test]
fn tangent() {
    let mut tally = Tally::new("sphere: tangent, relative miss 10^-k");
    let mut random = Random::new(1);
    for (k, miss) in tenths(14) {
        tally.severity(&k);
        for _ in 0..rays(1000) {
            let (subject, center, radius) = any_sphere(&mut random);
            let normal = random.direction();
            let dir = random.across(normal);
            let offset = radius * (1.0 + random.sign() * miss);
            let origin = center + normal * offset - dir * random.between(-2.0, 10.0);
            tally.score(&subject, Ray::new(origin, dir));
        }
    }
    tally.finish();
}

#[test]
fn start_near_the_surface() {
    let mut tally = Tally::new("sphere: start 10^-k r inside or outside");
    let mut random = Random::new(2);
    for (k, gap) in tenths(14) {
        tally.severity(&k);
        for _ in 0..rays(1000) {
            let (subject, center, radius) = any_sphere(&mut random);
            let origin = center + random.direction() * radius * (1.0 + random.sign() * gap);
            tally.score(&subject, Ray::new(origin, random.direction()));
        }
    }
    tally.finish();
}

/// An eye 10⁻ᵏ radii above a planet, rays within 10⁻ᵏ of the horizon.
#[test]
fn planet() {
    let mut tally = Tally::new("planet: eye 10^-k R above it, at the horizon");
    let mut random = Random::new(3);
    let radius = 6.4e6;
    let subject = Subject::Sphere { center: DVec3::new(0.0, -radius, 0.0), radius };
    for k in 0..=12 {
        let height = radius * 10.0_f64.powi(-k);
        tally.severity(&k);
        for _ in 0..rays(1000) {
            let dip = (radius / (radius + height)).acos();
            let angle = dip + random.sign() * 10.0_f64.powf(random.between(-12.0, 0.0));
            let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
            let flat = DVec3::new(cos, 0.0, sin);
            let dir = flat * angle.cos() - DVec3::Y * angle.sin();
            tally.score(&subject, Ray::new(DVec3::new(0.0, height, 0.0), dir));
        }
    }
    tally.finish();
}
