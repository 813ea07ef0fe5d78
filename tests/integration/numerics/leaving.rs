//! Rays that leave a surface: none may meet it again by accident, none may get out of a solid unseen, and the far
//! side is met where it is.
//!
//! Oracle: the stored local point is moved onto the exact surface in 640 bits; the ray from there crosses the exact
//! surface at 0 and once more. On the surface's own equation a distance depends on the inputs as −2b/a does, without the
//! constant term, so that is how K is taken.

use glam::DVec3;
use whitted::geometry::{Ends, Ray, Shape, Surface};

use super::big::{Big, BigVec, big, big_vec};
use super::everywhere::{any_subject, ray_towards};
use super::oracle::{Answer, Crossing, UNIT};
use super::random::Random;
use super::score::{K_MAX, Tally, Verdict, sweep};
use super::subject::{Question, Subject, axes_about, vector};

/// The number of the primitive.
const SELF: u32 = 3;

/// The stored local point in the axes of the world, about the shape's anchor.
fn turned_back(subject: &Subject, local: DVec3) -> BigVec {
    let Some(axis) = subject.axis() else { return big_vec(local) };
    let [x, y, z] = axes_about(&axis);
    let part = |axis: &BigVec, along: f64| axis.scaled(&big(along));
    part(&x, local.x).plus(&part(&y, local.y)).plus(&part(&z, local.z))
}

/// The nearest point of the exact face.
fn onto_face(subject: &Subject, question: &Question, face: u8) -> BigVec {
    let (q, r, h) = (&question.local.f, &question.local.r, &question.local.h);
    let rho = (q.0[0].square() + q.0[2].square()).sqrt();
    let at = |radius: &Big, y: &Big| {
        let onto = if rho.is_zero() { big(0.0) } else { radius / &rho };
        BigVec([&q.0[0] * &onto, y.clone(), &q.0[2] * &onto])
    };
    match (subject, face) {
        (Subject::Sphere { .. }, _) => q.scaled(&(r / q.length())),
        (Subject::Cylinder { .. }, 0) => at(r, &q.0[1]),
        (Subject::Cylinder { .. }, 1) => at(&rho, &big(0.0)),
        (Subject::Cylinder { .. }, _) => at(&rho, h),
        (Subject::Cone { .. }, 0) => {
            let along = (r * &rho - h * &q.0[1]) / (r.square() + h.square());
            at(&(r * &along), &-&(h * &along))
        }
        (Subject::Cone { .. }, _) => at(&rho, &-h),
        _ => q.clone(),
    }
}

/// Σ |xᵢ ∂t/∂xᵢ| of t = −2b/a, the way across the side of a solid from a point of it.
fn spread_across(subject: &Subject, question: &Question, t: f64) -> f64 {
    let local = &question.local;
    let (r, h) = (local.r.f64(), local.h.f64());
    let beta = match subject {
        Subject::Sphere { .. } => [1.0; 3],
        Subject::Cylinder { .. } => [1.0, 0.0, 1.0],
        _ => [h * h, -r * r, h * h],
    };
    let d = local.d.f64().to_array();
    let [mut a, mut by_b, mut by_a] = [0.0; 3];
    for k in 0..3 {
        let (f, d_size) = (local.sizes[k].abs(), local.sizes[3 + k].abs());
        a += beta[k] * d[k] * d[k];
        by_b += (beta[k] * f * d_size).abs();
        by_a += (beta[k] * d_size * d_size).abs();
    }
    (4.0 * by_b + 2.0 * t * by_a) / a.abs()
}

/// What the ray must find ahead.
enum Ahead {
    Nothing,
    Far(Crossing),
    Undecidable,
}

/// What the ray from `question`, a point of `face`, must find ahead on the same shape.
fn ahead(subject: &Subject, question: &Question, face: u8, inward: bool) -> Ahead {
    let flat = !matches!(
        subject,
        Subject::Sphere { .. } | Subject::Cylinder { .. } | Subject::Cone { .. }
    );
    if flat || !inward {
        return Ahead::Nothing; // flat, or convex
    }
    let closed = match subject.clone() {
        Subject::Cylinder { base, top, radius, .. } => {
            Subject::Cylinder { base, top, radius, ends: Ends::Closed }
        }
        Subject::Cone { base, apex, radius, .. } => {
            Subject::Cone { base, apex, radius, ends: Ends::Closed }
        }
        other => other,
    };
    // An open shape is left through its ends unseen.
    let Some(mut exit) = closed.answer_to(question).crossings.pop() else {
        return Ahead::Undecidable;
    };
    if exit.faces[0] == 0 && face == 0 {
        exit.spread = spread_across(subject, question, exit.t.f64());
    }
    let at_the_rim = !subject.is_closed() && exit.faces.len() > 1;
    if exit.margin() < Answer::DECIDABLE || at_the_rim {
        Ahead::Undecidable
    } else if subject.is_closed() || exit.faces[0] == 0 {
        Ahead::Far(exit)
    } else {
        Ahead::Nothing
    }
}

/// Judges the ray that leaves `subject`, met by `ray`, along `dir`.
fn judge(subject: &Subject, shape: &Shape, ray: &Ray, dir: DVec3, inward: bool) -> Verdict {
    let Some((hit, surface)) = shape.first_hit(SELF, ray) else { return Verdict::Undecidable };
    let leaving = surface.leave(&hit, dir, inward);
    let start = turned_back(subject, surface.local);
    let mut question = subject.question(&start, &big_vec(dir));
    question.local.f = onto_face(subject, &question, hit.face);
    let right = ahead(subject, &question, hit.face, inward);
    match (right, shape.first_hit(SELF, &leaving)) {
        (Ahead::Undecidable, _) => Verdict::Undecidable,
        (Ahead::Nothing, None) => Verdict::Right { ks: vec![] },
        (Ahead::Far(right), Some((next, at))) => {
            let k = right.k(&question.parameter(next.t));
            if k > K_MAX || !right.faces.contains(&next.face) {
                return Verdict::Wrong(format!(
                    "{next:?}, K = {k:.3e}, right t = {:e}",
                    right.t.f64()
                ));
            }
            let far =
                subject.anchor().plus(&turned_back(subject, at.local)).minus(&big_vec(at.point));
            let size = at.point.abs().max_element() + subject.size();
            if far.f64().length() > 16.0 * UNIT * size {
                return Verdict::Wrong(format!(
                    "point and local point are {:e} apart",
                    far.f64().length()
                ));
            }
            Verdict::Right { ks: vec![k] }
        }
        (Ahead::Nothing, Some((next, _))) => Verdict::Wrong(format!("acne: {next:?}")),
        (Ahead::Far(right), None) => {
            Verdict::Wrong(format!("leak: t = {:e} missed", right.t.f64()))
        }
    }
}

/// A direction at `angle` from the tangent plane, to the outside if that is positive.
fn off_tangent(surface: &Surface, angle: f64, random: &mut Random) -> DVec3 {
    random.across(surface.normal) * angle.cos() + surface.normal * angle.sin()
}

fn code(subject: &Subject, ray: &Ray, dir: DVec3, inward: bool) -> String {
    let (origin, towards, dir) = (vector(ray.origin), vector(ray.dir), vector(dir));
    format!(
        "#[test]\nfn repeats_a_wrong_answer() {{\n    assert_leaves(\n        &{subject},\n        &Ray::new({origin}, {towards}),\n        {dir},\n        {inward},\n    );\n}}\n"
    )
}

/// Fails unless the ray that leaves the shape along `dir` is answered rightly; for rays that once were not.
#[track_caller]
fn assert_leaves(subject: &Subject, ray: &Ray, dir: DVec3, inward: bool) {
    match judge(subject, &subject.shape(), ray, dir, inward) {
        Verdict::Right { .. } => {}
        Verdict::Undecidable => panic!("undecidable"),
        Verdict::Wrong(why) => panic!("{why}"),
    }
}

/// One ray onto a shape that `place` puts somewhere, and one away from it at `angle`.
fn leave_once(
    tally: &mut Tally,
    angle: f64,
    random: &mut Random,
    place: impl Fn(&Subject, &Ray, &mut Random) -> (Subject, Ray),
) {
    let subject = any_subject(random);
    let ray = ray_towards(&subject, random.between(0.0, 3.0), random);
    let (subject, ray) = place(&subject, &ray, random);
    let shape = subject.shape();
    let Some((_, surface)) = shape.first_hit(SELF, &ray) else { return };
    let inward = random.flip();
    let length = 10.0_f64.powf(random.between(-3.0, 3.0));
    let dir = off_tangent(&surface, if inward { -angle } else { angle }, random) * length;
    let verdict = judge(&subject, &shape, &ray, dir, inward);
    tally.record(verdict, || code(&subject, &ray, dir, inward));
}

#[test]
fn angles() {
    sweep("leaving every shape at 10^-k rad", 12, 0..=12, 4000, |k, random, tally| {
        let angle = 10.0_f64.powi(-k);
        leave_once(tally, angle, random, |subject, ray, _| (subject.clone(), *ray));
    });
}

#[test]
fn scales() {
    let exponents = (-6..=6).map(|k| k * 83);
    sweep("leaving every shape, scale 2^k", 13, exponents, 4000, |k, random, tally| {
        let scale = 2.0_f64.powi(k);
        let angle = 10.0_f64.powf(random.between(-12.0, 0.0));
        leave_once(tally, angle, random, |subject, ray, _| {
            (subject.placed(DVec3::ZERO, scale), Ray::new(ray.origin * scale, ray.dir * scale))
        });
    });
}

#[test]
fn shifts() {
    let exponents = (0..=40).step_by(4);
    sweep("leaving every shape, shifted by 2^k sizes", 14, exponents, 4000, |k, random, tally| {
        let shift = DVec3::new(-1.0, 1.0, 1.0) * 2.0_f64.powi(k);
        let angle = 10.0_f64.powf(random.between(-12.0, 0.0));
        leave_once(tally, angle, random, |subject, ray, _| {
            (subject.placed(shift, 1.0), Ray::new(ray.origin + shift, ray.dir))
        });
    });
}

/// A printed failure can be pasted and repeated.
#[test]
fn a_ray_across_a_sphere_leaves_it() {
    let subject = Subject::Sphere { center: DVec3::ZERO, radius: 1.0 };
    let ray = Ray::new(DVec3::X * 3.0, DVec3::NEG_X);
    assert_leaves(&subject, &ray, DVec3::new(-1.0, 0.5, 0.0), true);
    assert!(
        code(&subject, &ray, DVec3::NEG_X, true)
            .contains("&Subject::Sphere { center: DVec3::new(0.0, 0.0, 0.0), radius: 1.0 }")
    );
}
