//! Whether a stored hit is on the surface, at the right place, with the right normal.

use whitted::geometry::{Hit, Surface};

use super::big::{Big, BigVec, big_vec};
use super::oracle::{Crossing, UNIT};
use super::subject::{Question, Subject};

/// A point in the frame of a round shape: radius about the axis, height, and the radial direction times radius.
fn radial(q: &BigVec) -> (Big, &Big) {
    ((q.0[0].square() + q.0[2].square()).sqrt(), &q.0[1])
}

/// The distance of `q` (in the frame) from a face, and the outward normal of the face at `q`, of any length.
fn face_at(subject: &Subject, question: &Question, face: u8, q: &BigVec) -> (Big, BigVec) {
    let (r, h) = (&question.local.r, &question.local.h);
    let zero = || super::big::big(0.0);
    let up = |sign: f64| BigVec([zero(), super::big::big(sign), zero()]);
    match (subject, face) {
        (Subject::Sphere { .. }, _) => (q.length() - r, q.clone()),
        (Subject::Cylinder { .. }, 0) => {
            (radial(q).0 - r, BigVec([q.0[0].clone(), zero(), q.0[2].clone()]))
        }
        (Subject::Cylinder { .. }, 1) => (-&q.0[1], up(-1.0)),
        (Subject::Cylinder { .. }, _) => (&q.0[1] - h, up(1.0)),
        (Subject::Cone { .. }, 0) => {
            let (rho, y) = radial(q);
            let slant = (r.square() + h.square()).sqrt();
            let normal = BigVec([h * &q.0[0], r * &rho, h * &q.0[2]]);
            ((h * &rho + r * y) / slant, normal)
        }
        (Subject::Cone { .. }, _) => (-&(&q.0[1] + h), up(-1.0)),
        _ => {
            let vertices = subject.vertices();
            let edge = |k: usize| {
                big_vec(vertices[k]).minus(&big_vec(vertices[0])).shifted(question.lengths)
            };
            let normal = edge(1).cross(&edge(vertices.len() - 1));
            (normal.dot(q) / normal.length(), normal)
        }
    }
}

/// Checks `at` against the exact crossing.
pub(crate) fn check(
    subject: &Subject,
    question: &Question,
    right: &Crossing,
    hit: &Hit,
    at: &Surface,
) -> Result<(), String> {
    let world = at.point.abs().max_element() + subject.size();
    let unit = world * 2.0_f64.powi(question.lengths); // of length, in the question's scale
    let in_frame = |v: &BigVec| match &question.axes {
        Some(axes) => BigVec([0, 1, 2].map(|k| axes[k].dot(v))),
        None => v.clone(),
    };
    let q = in_frame(&big_vec(at.point).minus(&subject.anchor()).shifted(question.lengths));
    let distance = face_at(subject, question, hit.face, &q).0.abs().f64();
    if distance > 8.0 * UNIT * unit {
        return Err(format!("{:.2} u off the surface", distance / (UNIT * unit)));
    }
    let error = at.error * 2.0_f64.powi(question.lengths);
    if !(distance <= error) {
        return Err(format!("{distance:e} off the surface, but said to be within {error:e}"));
    }
    let local = &question.local;
    let exact = local.f.plus(&local.d.scaled(&right.t));
    let slack =
        32.0 * UNIT * (unit + (right.spread + right.t.abs().f64()) * local.d.length().f64());
    let apart = q.minus(&exact).length().f64();
    if apart > slack {
        return Err(format!("{apart:e} from the exact point, more than {slack:e}"));
    }
    let normal = in_frame(&big_vec(at.normal));
    let stretch = (normal.length().f64() - 1.0).abs().max((at.normal.length() - 1.0).abs() - UNIT);
    if !(stretch <= 4.0 * UNIT) {
        return Err(format!("normal of length 1 + {:.2} u", stretch / UNIT));
    }
    let (_, exact_normal) = face_at(subject, question, hit.face, &exact);
    let length = exact_normal.length();
    if length.is_zero() {
        return Ok(()); // the apex
    }
    let turned = exact_normal.cross(&normal).length().f64() / length.f64();
    // The normal turns with the local point, whose error does not depend on where the shape is.
    let reach =
        (right.spread + right.t.abs().f64()) * local.d.length().f64() + exact.length().f64();
    let bend = match (subject, hit.face) {
        (Subject::Sphere { .. }, _) => reach / local.r.f64(),
        (Subject::Cylinder { .. } | Subject::Cone { .. }, 0) => reach / radial(&exact).0.f64(),
        _ => 0.0,
    };
    let bend = 16.0 * UNIT * bend;
    if turned > 16.0 * UNIT + bend || exact_normal.dot(&normal).is_negative() && bend < 0.1 {
        return Err(format!("normal turned by {turned:e}, where {bend:e} is explained"));
    }
    Ok(())
}
