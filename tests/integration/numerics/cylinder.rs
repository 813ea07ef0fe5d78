//! Rays that are hard on cylinders.

use glam::DVec3;
use whitted::geometry::{Ends, Ray};

use super::random::{Random, tenth};
use super::score::sweep;
use super::subject::Subject;

/// The unit circle's point in the plane of x and z.
pub(crate) fn on_circle(random: &mut Random) -> DVec3 {
    let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
    DVec3::new(cos, 0.0, sin)
}

struct Made {
    subject: Subject,
    base: DVec3,
    height: f64,
    radius: f64,
}

/// An upright cylinder.
fn any_cylinder(random: &mut Random) -> Made {
    let base = random.in_cube();
    let top = base + DVec3::Y * random.between(0.1, 2.0);
    let radius = random.between(0.1, 1.0);
    let ends = random.pick(&[Ends::Open, Ends::Closed]);
    let subject = Subject::Cylinder { base, top, radius, ends };
    Made { subject, base, height: top.y - base.y, radius }
}

/// Scores rays that `make` makes for cylinders, ever harder.
fn cylinders(family: &'static str, mut make: impl FnMut(f64, &Made, &mut Random) -> Ray) {
    sweep(family, 4, 1..=14, 1000, |k, random, tally| {
        let made = any_cylinder(random);
        let ray = make(tenth(k), &made, random);
        tally.score(&made.subject, ray);
    });
}

#[test]
fn tangent() {
    cylinders("cylinder: tangent, relative miss 10^-k", |miss, made, random| {
        let normal = on_circle(random);
        let along = normal.cross(DVec3::Y);
        let dir = (along + DVec3::Y * random.between(-0.5, 0.5)).normalize();
        let offset = made.radius * (1.0 + random.sign() * miss);
        let foot = made.base + DVec3::Y * (made.height * random.unit()) + normal * offset;
        Ray::new(foot - dir * random.between(-1.0, 6.0), dir)
    });
}

#[test]
fn start_near_the_side() {
    cylinders("cylinder: start 10^-k r inside or outside", |gap, made, random| {
        let out = on_circle(random) * made.radius * (1.0 + random.sign() * gap);
        let origin = made.base + out + DVec3::Y * made.height * random.between(-0.1, 1.1);
        Ray::new(origin, random.direction())
    });
}

#[test]
fn nearly_parallel() {
    cylinders("cylinder: angle to the axis 10^-k", |angle, made, random| {
        let out = on_circle(random) * (made.radius * random.between(0.0, 1.2));
        let dir = (DVec3::Y + on_circle(random) * angle) * random.sign();
        Ray::new(made.base + out - dir * random.between(-1.0, 5.0), dir)
    });
}

#[test]
fn parallel() {
    cylinders("cylinder: parallel to the axis, 10^-k r from the side", |gap, made, random| {
        let out = on_circle(random) * made.radius * (1.0 + random.sign() * gap);
        let dir = DVec3::new(random.sign() * 0.0, random.sign(), random.sign() * 0.0);
        Ray::new(made.base + out - dir * random.between(-1.0, 5.0), dir)
    });
}

#[test]
fn rim() {
    cylinders("cylinder: aimed 10^-k from the rim", |miss, made, random| {
        let end = made.height * f64::from(u8::from(random.flip()));
        let rim = made.base + on_circle(random) * made.radius + DVec3::Y * end;
        let target = rim + random.direction() * miss;
        let origin = made.base + random.in_cube() * 4.0;
        Ray::new(origin, target - origin)
    });
}

/// Scores rays at needles and coins: `subject` has this radius, and its axis goes from the origin to (0, 1, 0).
pub(crate) fn aspects(family: &'static str, seed: u64, subject: impl Fn(f64, Ends) -> Subject) {
    sweep(family, seed, (-8..=8).step_by(2), 1000, |k, random, tally| {
        let (height, radius) = (1.0, 10.0_f64.powi(k));
        let size = DVec3::new(radius, height, radius);
        let subject = subject(radius, random.pick(&[Ends::Open, Ends::Closed]));
        let target = random.in_cube() * size * 1.1;
        let origin = random.in_cube() * size * 3.0 + random.in_cube() * size.max_element();
        tally.score(&subject, Ray::new(origin, target - origin));
    });
}

#[test]
fn aspect() {
    let (base, top) = (DVec3::ZERO, DVec3::Y);
    aspects("cylinder: radius/height 10^k", 5, |radius, ends| Subject::Cylinder {
        base,
        top,
        radius,
        ends,
    });
}
