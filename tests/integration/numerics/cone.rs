//! Rays that are hard on cones.

use glam::DVec3;
use whitted::geometry::{Ends, Ray};

use super::cylinder::{aspects, on_circle};
use super::random::{Random, tenth};
use super::score::{assert_right, sweep};
use super::subject::Subject;

struct Made {
    subject: Subject,
    apex: DVec3,
    height: f64,
    radius: f64,
}

impl Made {
    /// From the apex down a generator, as long as the cone's side.
    fn generator(&self, random: &mut Random) -> (DVec3, DVec3) {
        let out = on_circle(random);
        (out, out * self.radius - DVec3::Y * self.height)
    }

    /// The outward normal beside that generator.
    fn normal(&self, out: DVec3) -> DVec3 {
        (out * self.height + DVec3::Y * self.radius).normalize()
    }
}

/// An upright cone.
fn any_cone(random: &mut Random) -> Made {
    let apex = random.in_cube();
    let base = apex - DVec3::Y * random.between(0.1, 2.0);
    let radius = random.between(0.1, 1.0);
    let ends = random.pick(&[Ends::Open, Ends::Closed]);
    let subject = Subject::Cone { base, apex, radius, ends };
    Made { subject, apex, height: apex.y - base.y, radius }
}

/// Scores rays that `make` makes for cones, ever harder.
fn cones(family: &'static str, mut make: impl FnMut(f64, &Made, &mut Random) -> Ray) {
    sweep(family, 6, 1..=14, 1000, |k, random, tally| {
        let made = any_cone(random);
        let ray = make(tenth(k), &made, random);
        tally.score(&made.subject, ray);
    });
}

#[test]
fn tangent() {
    cones("cone: tangent, relative miss 10^-k", |miss, made, random| {
        let (out, generator) = made.generator(random);
        let normal = made.normal(out);
        let point = made.apex + generator * random.between(-0.1, 1.1);
        let beside = random.between(-1.0, 1.0);
        let dir =
            (generator.normalize() * beside + normal.cross(generator).normalize()).normalize();
        let offset = normal * (made.radius * random.sign() * miss);
        Ray::new(point + offset - dir * random.between(-1.0, 6.0), dir)
    });
}

#[test]
fn start_near_the_side() {
    cones("cone: start 10^-k r inside or outside", |gap, made, random| {
        let (out, generator) = made.generator(random);
        let offset = made.normal(out) * (made.radius * random.sign() * gap);
        Ray::new(made.apex + generator * random.between(-0.1, 1.1) + offset, random.direction())
    });
}

#[test]
fn apex() {
    cones("cone: miss of the apex 10^-k", |miss, made, random| {
        let target = made.apex + random.direction() * miss;
        let origin = made.apex + random.in_cube() * 4.0;
        Ray::new(origin, target - origin)
    });
}

#[test]
fn generator() {
    cones("cone: angle to a generator 10^-k", |angle, made, random| {
        let (out, generator) = made.generator(random);
        let dir = (generator.normalize() + random.direction() * angle) * random.sign();
        let beside = made.normal(out) * random.between(-0.5, 0.5);
        let point = made.apex + generator * random.unit() + beside;
        Ray::new(point - dir * random.between(-1.0, 5.0), dir)
    });
}

/// The doubles next to a generator of a cone whose slope is a ratio of integers.
#[test]
fn nearest_double_to_a_generator() {
    sweep("cone: k doubles beside a generator", 7, 0..=4, 1000, |k, random, tally| {
        let (radius, height) = (3.0, 4.0);
        let ends = random.pick(&[Ends::Open, Ends::Closed]);
        let (base, apex) = (DVec3::ZERO, DVec3::Y * height);
        let subject = Subject::Cone { base, apex, radius, ends };
        let nudge =
            |x: f64, up: bool| (0..k).fold(x, |x, _| if up { x.next_up() } else { x.next_down() });
        let down = nudge(-height, random.flip());
        let dir = random.pick(&[
            DVec3::new(radius, down, 0.0),
            DVec3::new(0.0, down, -radius),
            DVec3::new(-1.8, down, 2.4),
        ]);
        let origin = apex + random.in_cube() * 2.0 - dir * random.between(0.0, 3.0);
        tally.score(&subject, Ray::new(origin, dir));
    });
}

/// Rays that meet the mirror image of the cone above its apex.
#[test]
fn phantom_nappe() {
    cones("cone: through the upper nappe, 10^-k above", |above, made, random| {
        let (_, generator) = made.generator(random);
        let target = made.apex - generator * above + random.direction() * (above * random.unit());
        let origin = made.apex + random.in_cube() * 3.0;
        Ray::new(origin, target - origin)
    });
}

#[test]
fn rim() {
    cones("cone: aimed 10^-k from the rim", |miss, made, random| {
        let (_, generator) = made.generator(random);
        let target = made.apex + generator + random.direction() * miss;
        let origin = made.apex + random.in_cube() * 4.0;
        Ray::new(origin, target - origin)
    });
}

#[test]
fn aspect() {
    let (base, apex) = (DVec3::ZERO, DVec3::Y);
    aspects("cone: radius/height 10^k", 8, |radius, ends| Subject::Cone {
        base,
        apex,
        radius,
        ends,
    });
}

/// A ray exactly parallel to a generator has one root; here that is on the upper nappe, and the cone itself is missed.
#[test]
fn parallel_to_a_generator_beside_the_cone() {
    for (ends, x) in [(Ends::Open, 10.0), (Ends::Closed, 10.0), (Ends::Closed, 3.5)] {
        let (base, apex) = (DVec3::ZERO, DVec3::Y * 4.0);
        let subject = Subject::Cone { base, apex, radius: 3.0, ends };
        for dir in [DVec3::new(3.0, -4.0, 0.0), DVec3::new(-3.0, 4.0, 0.0)] {
            let origin = DVec3::new(x, 4.0, 0.0) - dir * 2.0;
            assert_right(&subject, &Ray::new(origin, dir));
        }
    }
}
