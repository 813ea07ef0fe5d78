//! Two surfaces close to each other, touching, or in the same place; and shells of glass.

use glam::DVec3;
use whitted::accel::brute;
use whitted::geometry::{Ends, Hit, Ray, Shape, Surface, reflect, refract};

use super::big::{big, big_vec};
use super::oracle::UNIT;
use super::random::{Random, rays};
use super::subject::{Subject, vector};

/// The next surface on the way, with what it is known by.
fn next(shapes: &[Shape], ray: &Ray) -> Option<(Hit, Surface)> {
    let hit = brute::nearest(shapes, ray, f64::INFINITY)?;
    Some((hit, shapes[hit.primitive as usize].surface(ray, &hit)))
}

/// A pair of surfaces, the second inside or behind the first by `gap`.
fn pair(kind: usize, gap: f64, random: &mut Random) -> [Subject; 2] {
    let (p, ends) = (random.on_grid(), Ends::Closed);
    match kind {
        0 => [1.0 + gap, 1.0].map(|radius| Subject::Sphere { center: p, radius }),
        1 => [1.0 + gap, 1.0].map(|radius| Subject::Cylinder {
            base: p - DVec3::Y * radius,
            top: p + DVec3::Y * radius,
            radius,
            ends,
        }),
        2 => [1.0 + gap, 1.0].map(|r| {
            // A cone's incentre stays if it is scaled about that; for 3-4-5 it is 3/2 above the base.
            let (base, apex) = (p - DVec3::Y * (1.5 * r), p + DVec3::Y * (2.5 * r));
            Subject::Cone { base, apex, radius: 3.0 * r, ends }
        }),
        _ => {
            let (edge1, edge2) = (DVec3::new(2.0, 4.0, 4.0), DVec3::new(4.0, 2.0, -4.0));
            let normal = DVec3::new(2.0, -2.0, 1.0); // of length 3, against e1 × e2
            let corner = |q: DVec3| q - (edge1 + edge2) * 0.5;
            [p + normal * gap, p].map(|q| Subject::Quad {
                corner: corner(q),
                edge1: edge2,
                edge2: edge1,
            })
        }
    }
}

/// A ray goes in through the outer surface, meets the inner one across the gap, turns back there, and gets out again:
/// four hits, or two if it leaves at once. The way across the gap is as long as the angle says.
#[test]
fn gaps() {
    let mut random = Random::new(25);
    let mut tried = 0;
    for k in [10, 15, 20, 25, 30, 35, 40] {
        let gap = 2.0_f64.powi(-k);
        for n in 0..rays(4000) {
            let subjects = pair(n % 4, gap, &mut random);
            let shapes = subjects.each_ref().map(Subject::shape);
            let ray = {
                let target = shapes[1].bounds().center() + random.in_cube() * 0.5;
                let origin = target + random.direction() * 10.0;
                Ray::new(origin, target - origin)
            };
            let repeat = || {
                let [outer, inner] = &subjects;
                format!("[{outer}, {inner}], Ray::new({}, {})", vector(ray.origin), vector(ray.dir))
            };
            let Some((hit, at)) = next(&shapes, &ray) else { continue };
            let quads = n % 4 == 3;
            if quads && hit.primitive == 1 {
                continue; // from behind
            }
            assert_eq!(hit.primitive, 0, "2^-{k}: {}", repeat());
            // Back out: nothing there.
            let out = at.leave(&hit, reflect(ray.dir, at.normal), false);
            assert!(next(&shapes, &out).is_none(), "acne, 2^-{k}: {}", repeat());
            // In, steeply enough to reach the inner surface not far from here, except round a rim.
            let dir = -at.normal + random.across(at.normal) * random.between(0.0, 1.0);
            let Some((inner, below)) = next(&shapes, &at.leave(&hit, dir, true)) else {
                assert!(quads, "leak, 2^-{k}: {}", repeat());
                continue;
            };
            let way = (below.point - at.point).length() / dir.length();
            let curved = n % 4 != 3;
            if inner.primitive != 1 || (curved && hit.face != inner.face) {
                assert!(way > gap * 0.9 || n % 4 != 0, "2^-{k}: passed by {}", repeat());
                continue;
            }
            tried += 1;
            let [outer_at, inner_at] = [&at, &below].map(|s| big_vec(s.point));
            let depth = inner_at.minus(&outer_at).dot(&big_vec(at.normal)).f64().abs();
            let bound = gap * if n % 4 > 1 { 3.0 } else { 1.0 };
            let rounding = 64.0 * UNIT * (at.point.abs().max_element() + 8.0);
            assert!(
                depth >= 0.5 * gap.min(bound) - rounding,
                "2^-{k}: {depth:e} deep, {}",
                repeat()
            );
            // Reflected by the inner surface back to the outer one, from within.
            let back = below.leave(&inner, reflect(dir, below.normal), false);
            let Some((hit, at)) = next(&shapes, &back) else {
                assert!(quads, "leak, 2^-{k}: {}", repeat());
                continue;
            };
            assert_eq!(hit.primitive, 0, "2^-{k}: {}", repeat());
            let out = at.leave(&hit, back.dir, false);
            assert!(next(&shapes, &out).is_none(), "acne, 2^-{k}: {}", repeat());
        }
    }
    println!("gaps of 2^-10 to 2^-40: {tried} crossed");
    assert!(tried > rays(10_000));
}

/// Two shapes in the same place, and two that touch: a ray that leaves to the outside meets neither.
#[test]
fn coincident_and_touching() {
    let mut random = Random::new(26);
    for n in 0..rays(20_000) {
        let [subject, _] = pair(n % 4, 0.0, &mut random);
        let shape = subject.shape();
        let shapes = [shape.clone(), shape];
        let target = shapes[0].bounds().center() + random.in_cube() * 0.5;
        let origin = target + random.direction() * 8.0;
        let Some((hit, at)) = next(&shapes, &Ray::new(origin, target - origin)) else { continue };
        assert_eq!(hit.primitive, 0, "the first of two equal ones");
        let outward = at.normal.dot(origin - target) > 0.0;
        let side = if outward { at.normal } else { -at.normal };
        let dir = random.across(side) + side * 10.0_f64.powf(random.between(-3.0, 0.0));
        let again = next(&shapes, &at.leave(&hit, dir, !outward));
        assert!(
            again.is_none(),
            "{subject}, {} along {}: {again:?}",
            vector(at.point),
            vector(dir)
        );
    }
    // A ball on the ground: from the ground beside the point of touch, straight up meets the ball, sideways does not.
    let ground = Subject::Quad {
        corner: DVec3::new(-4.0, 0.0, -4.0),
        edge1: DVec3::Z * 8.0,
        edge2: DVec3::X * 8.0,
    };
    let ball = Subject::Sphere { center: DVec3::Y, radius: 1.0 };
    let shapes = [ground.shape(), ball.shape()];
    for k in 0..=7 {
        for _ in 0..rays(200) {
            let beside = random.direction().with_y(0.0).normalize() * 10.0_f64.powi(-k) * 0.9;
            let start = DVec3::new(beside.x * 2.0, 1e-3 * beside.length(), beside.z * 2.0);
            let Some((hit, at)) = next(&shapes, &Ray::new(start, beside - start)) else { continue };
            if hit.primitive == 1 {
                continue;
            }
            let (over, _) = next(&shapes, &at.leave(&hit, DVec3::Y, false)).expect("the ball");
            let rho = big_vec(at.point.with_y(0.0)).length();
            let height = big(1.0) - (big(1.0) - rho.square()).sqrt();
            assert_eq!(over.primitive, 1);
            let error = (over.t - height.f64()).abs();
            assert!(error < 64.0 * UNIT, "10^-{k}: {error:e} of {:e}", height.f64());
            let away = at.leave(&hit, beside, false);
            assert_eq!(next(&shapes, &away), None, "10^-{k}, {}", vector(at.point));
        }
    }
}

/// Fifty spheres of glass one in the other, all of one index but the outermost: straight lines within, 100 hits in the right
/// order. And with indices that differ, in and out by symmetry at the same angle.
#[test]
fn nested_glass() {
    let mut random = Random::new(27);
    for step in [0.01, 1e-6, 1e-10] {
        let radius = |k: usize| 1.0 - step * k as f64;
        let center = random.on_grid();
        let shapes: Vec<Shape> =
            (0..50).map(|k| Subject::Sphere { center, radius: radius(k) }.shape()).collect();
        for n in 0..rays(400) {
            let target = center + random.in_cube() * 0.25;
            let origin = target + random.direction() * 5.0;
            let mut ray = Ray::new(origin, (target - origin).normalize());
            let first = ray.dir;
            let equal = n % 2 == 0;
            let eta = |k: usize| if equal || k == 0 { 1.5 } else { 1.5 + 0.01 * (k % 3) as f64 };
            let [mut angle_in, mut angle_out] = [0.0; 2];
            for step in 0..100 {
                let (shell, inward) = if step < 50 { (step, true) } else { (99 - step, false) };
                let (hit, at) = next(&shapes, &ray).expect("a shell");
                assert_eq!(
                    hit.primitive as usize,
                    shell,
                    "hit {step}, {} {}",
                    vector(origin),
                    vector(first)
                );
                let outside = if shell == 0 { 1.0 } else { eta(shell - 1) };
                let (from, to) = if inward { (outside, eta(shell)) } else { (eta(shell), outside) };
                let facing = if inward { at.normal } else { -at.normal };
                if step == 0 {
                    angle_in = ray.dir.cross(at.normal).length();
                }
                let dir = refract(ray.dir, facing, from, to).expect("in by the way out");
                if step == 99 {
                    angle_out = dir.cross(at.normal).length();
                }
                ray = at.leave(&hit, dir, inward);
            }
            assert!((angle_in - angle_out).abs() < 1e-13, "{angle_in} in, {angle_out} out");
            assert_eq!(next(&shapes, &ray), None);
        }
    }
}
