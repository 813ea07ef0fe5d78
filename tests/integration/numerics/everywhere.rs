//! What every shape must bear: any scale, any length of the direction, any shift, any distance.

use glam::DVec3;
use whitted::geometry::{Ends, Ray};

use super::random::Random;
use super::score::sweep;
use super::subject::Subject;

/// A convex outline on integers.
const OCTAGON: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [2.0, 0.0],
    [3.0, 1.0],
    [3.0, 2.0],
    [2.0, 3.0],
    [1.0, 3.0],
    [0.0, 2.0],
    [0.0, 1.0],
];

/// A shape of size about 1 near the origin, on a grid of 2⁻¹⁰.
pub(crate) fn any_subject(random: &mut Random) -> Subject {
    let ends = random.pick(&[Ends::Open, Ends::Closed]);
    let on_grid = |x: f64| (x * 1024.0).round() / 1024.0;
    let radius = on_grid(random.between(0.1, 1.0));
    let upright = random.flip();
    let [p, q, s] = [(); 3].map(|()| random.on_grid());
    let axis = match random.below(4) {
        0 => DVec3::new(0.0, 0.5 + p.y.abs(), 0.0),
        1 => random.pick(&[DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y]),
        _ => q + DVec3::splat(0.25),
    };
    match random.below(6) {
        0 => Subject::Sphere { center: p, radius },
        1 => Subject::Cylinder { base: p, top: p + axis, radius, ends },
        2 => Subject::Cone { base: p, apex: p + axis, radius, ends },
        3 => Subject::Quad { corner: p, edge1: q, edge2: s },
        4 if upright => Subject::Triangle { vertices: [p, p + q, p + DVec3::new(s.x, q.y, s.z)] },
        4 => Subject::Triangle { vertices: [p, q, s] },
        _ => {
            let vertices = OCTAGON.map(|[u, v]| p + q * u + s * v);
            Subject::Polygon { vertices: vertices.to_vec() }
        }
    }
}

/// The middle of a shape and a length that reaches from there to all of it.
fn ball(subject: &Subject) -> (DVec3, f64) {
    let bounds = subject.shape().bounds();
    (bounds.center(), bounds.size())
}

/// A ray that starts `distance` sizes away and passes the shape at up to a little more than its size.
pub(crate) fn ray_towards(subject: &Subject, distance: f64, random: &mut Random) -> Ray {
    let (center, size) = ball(subject);
    let target = center + random.in_cube() * size * 0.6;
    let origin = center + random.direction() * (size * distance);
    Ray::new(origin, target - origin)
}

#[test]
fn scale() {
    let exponents = (-6..=6).map(|k| k * 83);
    sweep("every shape: scale 2^k", 0x5eed, exponents, 1200, |k, random, tally| {
        let subject = any_subject(random);
        let ray = ray_towards(&subject, random.between(0.0, 4.0), random);
        let scale = 2.0_f64.powi(k);
        tally.score(&subject.placed(DVec3::ZERO, scale), Ray::new(ray.origin * scale, ray.dir));
    });
}

#[test]
fn direction_length() {
    let exponents = (-6..=6).map(|k| k * 25);
    sweep("every shape: |d| = 10^k", 0x5eed, exponents, 800, |k, random, tally| {
        let subject = any_subject(random);
        let ray = ray_towards(&subject, random.between(0.0, 4.0), random);
        tally.score(&subject, Ray::new(ray.origin, ray.dir.normalize() * 10.0_f64.powi(k)));
    });
}

/// Powers of two, so that the shape moves without rounding.
#[test]
fn translation() {
    let exponents = (0..=40).step_by(4);
    sweep("every shape: shifted by 2^k sizes", 0x5eed, exponents, 1000, |k, random, tally| {
        let subject = any_subject(random);
        let ray = ray_towards(&subject, random.between(0.0, 4.0), random);
        let shift = DVec3::new(1.0, -1.0, 1.0) * 2.0_f64.powi(k);
        tally.score(&subject.placed(shift, 1.0), Ray::new(ray.origin + shift, ray.dir));
    });
}

#[test]
fn distance() {
    sweep("every shape: distance/size 10^k", 0x5eed, 1..=12, 1000, |k, random, tally| {
        let subject = any_subject(random);
        let ray = ray_towards(&subject, 10.0_f64.powi(k), random);
        tally.score(&subject, ray);
    });
}

#[test]
fn pebble() {
    sweep("every shape: size 10^-k in a unit scene", 0x5eed, 1..=12, 1000, |k, random, tally| {
        let subject = any_subject(random);
        let shift = (random.on_grid() * 10.0_f64.powi(k)).round();
        let scale = 2.0_f64.powi((-3.322 * f64::from(k)).round() as i32);
        let subject = subject.placed(shift, scale);
        let (center, size) = ball(&subject);
        let origin = random.in_cube();
        let target = center + random.in_cube() * size * 0.6;
        tally.score(&subject, Ray::new(origin, target - origin));
    });
}
