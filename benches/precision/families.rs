//! Families of rays that get harder in steps, as in the tests.

use std::f64::consts::TAU;

use glam::DVec3;
use whitted::geometry::{Ends, Ray};

use super::forms::Primitive;
use super::numerics::random::Random;
use super::numerics::subject::Subject;

/// How single-precision forms get their inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Input {
    /// Rounded before the question is asked, so that only the formula is to blame.
    Rounded,
    /// As a user would: the question is about the scene as described, in double precision.
    User,
}

/// A family: a ray and a subject for every severity.
pub(crate) struct Family {
    pub(crate) primitive: Primitive,
    pub(crate) name: &'static str,
    pub(crate) severities: Vec<i32>,
    pub(crate) input: Input,
    pub(crate) make: fn(Primitive, i32, &mut Random) -> (Subject, Ray),
}

fn tenth(k: i32) -> f64 {
    10.0_f64.powi(-k)
}

fn on_circle(random: &mut Random) -> DVec3 {
    let (sin, cos) = random.between(0.0, TAU).sin_cos();
    DVec3::new(cos, 0.0, sin)
}

/// A primitive of size about 1 near the origin, on a grid of 2⁻¹⁰; cylinders and cones are upright and open.
pub(crate) fn any(primitive: Primitive, random: &mut Random) -> Subject {
    let on_grid = |x: f64| (x * 1024.0).round() / 1024.0;
    let radius = on_grid(random.between(0.1, 1.0));
    let up = DVec3::Y * on_grid(random.between(0.2, 1.5));
    let [p, q, s] = [(); 3].map(|()| random.on_grid());
    let ends = Ends::Open;
    match primitive {
        Primitive::Sphere => Subject::Sphere { center: p, radius },
        Primitive::Cylinder => Subject::Cylinder { base: p, top: p + up, radius, ends },
        Primitive::Cone => Subject::Cone { base: p, apex: p + up, radius, ends },
        Primitive::Quad => Subject::Quad { corner: p, edge1: q, edge2: s },
        Primitive::Triangle => Subject::Triangle { vertices: [p, p + q, p + s] },
    }
}

/// A ray that starts `distance` sizes away and passes at up to a little more than the subject's size.
pub(crate) fn towards(subject: &Subject, distance: f64, random: &mut Random) -> Ray {
    let bounds = subject.shape().bounds();
    let target = bounds.center() + random.in_cube() * bounds.size() * 0.6;
    let origin = bounds.center() + random.direction() * (bounds.size() * distance);
    Ray::new(origin, target - origin)
}

fn scale(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let ray = towards(&subject, random.between(0.0, 4.0), random);
    let scale = 2.0_f64.powi((f64::from(k) * 10.0_f64.log2()).round() as i32);
    (subject.placed(DVec3::ZERO, scale), Ray::new(ray.origin * scale, ray.dir.normalize()))
}

fn translation(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let ray = towards(&subject, random.between(0.0, 4.0), random);
    let shift = (DVec3::new(1.0, -1.0, 1.0) * 10.0_f64.powi(k)).round();
    (subject.placed(shift, 1.0), Ray::new(ray.origin + shift, ray.dir))
}

fn distance(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let ray = towards(&subject, 10.0_f64.powi(k), random);
    (subject, Ray::new(ray.origin, ray.dir.normalize()))
}

fn pebble(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let shift = (random.on_grid() * 10.0_f64.powi(k)).round();
    let scale = 2.0_f64.powi((-3.322 * f64::from(k)).round() as i32);
    let subject = subject.placed(shift, scale);
    let bounds = subject.shape().bounds();
    let origin = random.in_cube();
    let target = bounds.center() + random.in_cube() * bounds.size() * 0.6;
    (subject, Ray::new(origin, (target - origin).normalize()))
}

/// The base or centre, height or 0, and radius.
fn parts(subject: &Subject) -> (DVec3, f64, f64) {
    match *subject {
        Subject::Sphere { center, radius } => (center, 0.0, radius),
        Subject::Cylinder { base, top, radius, .. } => (base, top.y - base.y, radius),
        Subject::Cone { base, apex, radius, .. } => (base, apex.y - base.y, radius),
        _ => (DVec3::ZERO, 0.0, 0.0),
    }
}

fn tangent(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (base, height, radius) = parts(&subject);
    let beside = random.sign() * tenth(k);
    let (foot, dir) = match primitive {
        Primitive::Sphere => {
            let normal = random.direction();
            (base + normal * radius * (1.0 + beside), random.across(normal))
        }
        Primitive::Cylinder => {
            let normal = on_circle(random);
            let dir = normal.cross(DVec3::Y) + DVec3::Y * random.between(-0.5, 0.5);
            let foot = normal * radius * (1.0 + beside) + DVec3::Y * (height * random.unit());
            (base + foot, dir.normalize())
        }
        _ => {
            let out = on_circle(random);
            let generator = out * radius - DVec3::Y * height;
            let normal = (out * height + DVec3::Y * radius).normalize();
            let across = normal.cross(generator).normalize();
            let dir = generator.normalize() * random.between(-1.0, 1.0) + across;
            let on_side = DVec3::Y * height + generator * random.between(-0.1, 1.1);
            (base + on_side + normal * (radius * beside), dir.normalize())
        }
    };
    (subject, Ray::new(foot - dir * random.between(-2.0, 6.0), dir))
}

fn start_near(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (base, height, radius) = parts(&subject);
    let gap = 1.0 + random.sign() * tenth(k);
    let start = match primitive {
        Primitive::Sphere => random.direction() * radius * gap,
        Primitive::Cylinder => {
            on_circle(random) * radius * gap + DVec3::Y * height * random.between(-0.1, 1.1)
        }
        _ => {
            let out = on_circle(random);
            let normal = (out * height + DVec3::Y * radius).normalize();
            let generator = out * radius - DVec3::Y * height;
            let on_side = DVec3::Y * height + generator * random.between(-0.1, 1.1);
            on_side + normal * (radius * (gap - 1.0))
        }
    };
    (subject, Ray::new(base + start, random.direction()))
}

fn planet(_: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let radius = 6.4e6;
    let height = radius * tenth(k);
    let dip = (radius / (radius + height)).acos();
    let angle = dip + random.sign() * 10.0_f64.powf(random.between(-12.0, 0.0));
    let dir = on_circle(random) * angle.cos() - DVec3::Y * angle.sin();
    let subject = Subject::Sphere { center: DVec3::new(0.0, -radius, 0.0), radius };
    (subject, Ray::new(DVec3::new(0.0, height, 0.0), dir))
}

fn nearly_parallel(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (base, _, radius) = parts(&subject);
    let out = on_circle(random) * (radius * random.between(0.0, 1.2));
    let dir = (DVec3::Y + on_circle(random) * tenth(k)) * random.sign();
    (subject, Ray::new(base + out - dir * random.between(-1.0, 5.0), dir))
}

fn rim(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (base, height, radius) = parts(&subject);
    let end = if primitive == Primitive::Cylinder && random.flip() { height } else { 0.0 };
    let rim = base + on_circle(random) * radius + DVec3::Y * end;
    let target = rim + random.direction() * tenth(k);
    let origin = base + random.in_cube() * 4.0;
    (subject, Ray::new(origin, target - origin))
}

fn aspect(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let radius = 10.0_f64.powi(k);
    let size = DVec3::new(radius, 1.0, radius);
    let (base, top, ends) = (DVec3::ZERO, DVec3::Y, Ends::Open);
    let subject = match primitive {
        Primitive::Cylinder => Subject::Cylinder { base, top, radius, ends },
        _ => Subject::Cone { base, apex: top, radius, ends },
    };
    let target = random.in_cube() * size * 1.1;
    let origin = random.in_cube() * size * 3.0 + random.in_cube() * size.max_element();
    (subject, Ray::new(origin, (target - origin).normalize()))
}

fn apex(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (base, height, _) = parts(&subject);
    let apex = base + DVec3::Y * height;
    let target = apex + random.direction() * tenth(k);
    let origin = apex + random.in_cube() * 4.0;
    (subject, Ray::new(origin, target - origin))
}

fn generator(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (base, height, radius) = parts(&subject);
    let out = on_circle(random);
    let generator = out * radius - DVec3::Y * height;
    let normal = (out * height + DVec3::Y * radius).normalize();
    let dir = (generator.normalize() + random.direction() * tenth(k)) * random.sign();
    let on_side = DVec3::Y * height + generator * random.unit();
    let point = base + on_side + normal * random.between(-0.5, 0.5);
    (subject, Ray::new(point - dir * random.between(-1.0, 5.0), dir))
}

/// The first corner and the two edges there.
fn plane(subject: &Subject) -> (DVec3, DVec3, DVec3) {
    match *subject {
        Subject::Quad { corner, edge1, edge2 } => (corner, edge1, edge2),
        Subject::Triangle { vertices: [a, b, c] } => (a, b - a, c - a),
        _ => unreachable!("a flat subject"),
    }
}

fn grazing(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (corner, edge1, edge2) = plane(&subject);
    let normal = edge1.cross(edge2).normalize();
    let dir = random.across(normal) + normal * (tenth(k) * random.sign());
    let target = corner + edge1 * random.between(-0.1, 1.1) + edge2 * random.between(-0.1, 1.1);
    (subject, Ray::new(target - dir * random.between(0.1, 5.0), dir))
}

fn edge(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let subject = any(primitive, random);
    let (corner, edge1, edge2) = plane(&subject);
    let (along, beside) = (random.between(-0.1, 1.1), random.sign() * tenth(k));
    let (u, v) = if random.flip() { (along, beside) } else { (beside, along) };
    let target = corner + edge1 * u + edge2 * v;
    let origin = corner + random.in_cube() * 4.0;
    (subject, Ray::new(origin, target - origin))
}

fn sliver(primitive: Primitive, k: i32, random: &mut Random) -> (Subject, Ray) {
    let width = 2.0_f64.powi((-3.322 * f64::from(k)).round() as i32);
    // At the origin, so that corners of any width are single-precision numbers.
    let (corner, edge1) = (DVec3::ZERO, random.on_grid());
    let edge2 = random.on_grid() * width;
    let subject = match primitive {
        Primitive::Quad => Subject::Quad { corner, edge1, edge2 },
        _ => Subject::Triangle { vertices: [corner, edge1, edge2] },
    };
    let target = edge1 * random.between(-0.1, 1.1) + edge2 * random.between(-0.1, 1.1);
    let origin = random.in_cube() * 4.0;
    (subject, Ray::new(origin, target - origin))
}

/// All families of a primitive.
pub(crate) fn families(primitive: Primitive) -> Vec<Family> {
    let family = |name, severities: Vec<i32>, make| Family {
        primitive,
        name,
        severities,
        input: Input::Rounded,
        make,
    };
    let up_to = |n: i32| (1..=n).collect::<Vec<i32>>();
    let tens = |sign: i32| [10, 20, 30, 40, 80, 100, 140].map(|k| sign * k).to_vec();
    let mut all = vec![
        family("scale 10^k, k < 0", tens(-1), scale as fn(Primitive, i32, &mut Random) -> _),
        family("scale 10^k, k > 0", tens(1), scale),
        Family {
            input: Input::User,
            ..family("translation by 10^k sizes (user)", up_to(11), translation)
        },
        family("distance/size 10^k", up_to(12), distance),
        family("pebble of 10^-k in a unit scene", up_to(12), pebble),
    ];
    match primitive {
        Primitive::Sphere | Primitive::Cylinder | Primitive::Cone => {
            all.push(family("tangent, relative miss 10^-k", up_to(14), tangent));
            all.push(family("start 10^-k beside the surface", up_to(14), start_near));
        }
        Primitive::Quad | Primitive::Triangle => {
            all.push(family("grazing at 10^-k", up_to(14), grazing));
            all.push(family("aimed 10^-k from an edge", up_to(14), edge));
            all.push(family("sliver of width 10^-k", up_to(12), sliver));
        }
    }
    match primitive {
        Primitive::Sphere => {
            all.push(family("planet, eye 10^-k R above it", (0..=12).collect(), planet));
        }
        Primitive::Cylinder => {
            all.push(family("within 10^-k of parallel", up_to(14), nearly_parallel));
        }
        Primitive::Cone => {
            all.push(family("apex, miss distance 10^-k", up_to(14), apex));
            all.push(family("within 10^-k of a generator", up_to(14), generator));
        }
        _ => {}
    }
    if matches!(primitive, Primitive::Cylinder | Primitive::Cone) {
        all.push(family("aimed 10^-k from the rim", up_to(14), rim));
        all.push(family(
            "radius/height 10^k, k < 0",
            up_to(8).iter().map(|k| -k).collect(),
            aspect,
        ));
        all.push(family("radius/height 10^k, k > 0", up_to(8), aspect));
    }
    all
}
