//! The right answer to "where does this line cross this shape?", how sure it is, and how exactly a distance can be
//! asked for.

use std::cmp::Ordering;

use super::big::{Big, BigVec};

/// Unit roundoff of `f64`.
pub(crate) const UNIT: f64 = f64::EPSILON / 2.0;

/// Where a line crosses a shape.
#[derive(Clone)]
pub(crate) struct Crossing {
    pub(crate) t: Big,
    /// Σ |xᵢ ∂t/∂xᵢ| over the local inputs.
    pub(crate) spread: f64,
    /// The faces that may be reported, the right one first.
    pub(crate) faces: Vec<u8>,
}

impl Crossing {
    /// The error of a computed `t` in units of what one last place of every input explains.
    pub(crate) fn k(&self, t: &Big) -> f64 {
        let error = (t - &self.t).abs().f64();
        if error == 0.0 { 0.0 } else { error / (UNIT * (self.spread + self.t.abs().f64())) }
    }

    /// How many units of roundoff the inputs are from this crossing being at the ray's very start.
    pub(crate) fn margin(&self) -> f64 {
        let t = self.t.abs().f64();
        if self.spread > 0.0 { t / (UNIT * self.spread) } else { f64::INFINITY }
    }
}

/// All crossings of a line in ascending order, and how many units of roundoff the inputs are from another number of them.
pub(crate) struct Answer {
    pub(crate) margin: f64,
    pub(crate) crossings: Vec<Crossing>,
}

impl Answer {
    /// Answers with a smaller margin are not scored.
    pub(crate) const DECIDABLE: f64 = 16.0;

    pub(crate) fn is_decidable(&self) -> bool {
        self.margin >= Self::DECIDABLE
    }
}

/// The oracle of a flat convex outline; `vertices` are relative to the ray's start.
///
/// Which side of an edge the ray passes is the sign of d · (v × w), a polynomial in the inputs. `edges` are two
/// corners, next to the first, that span the plane.
pub(crate) fn flat(vertices: &[BigVec], edges: [usize; 2], d: &BigVec) -> Answer {
    let (mut left, mut right) = (0.0_f64, 0.0_f64);
    let mut weakest = f64::INFINITY;
    for (k, v) in vertices.iter().enumerate() {
        let w = &vertices[(k + 1) % vertices.len()];
        let normal = v.cross(w);
        let volume = normal.dot(d);
        let spread = d.dot_abs(&normal) + v.dot_abs(&w.cross(d)) + w.dot_abs(&d.cross(v));
        let margin = if spread > 0.0 { volume.f64().abs() / (UNIT * spread) } else { 0.0 };
        weakest = weakest.min(margin);
        match volume.sign() {
            Ordering::Greater => left = left.max(margin),
            Ordering::Less => right = right.max(margin),
            Ordering::Equal => {}
        }
    }
    if left > 0.0 && right > 0.0 {
        return Answer { margin: left.min(right), crossings: vec![] };
    }
    let (e1, e2) = (vertices[edges[0]].minus(&vertices[0]), vertices[edges[1]].minus(&vertices[0]));
    let normal = e1.cross(&e2);
    let slope = normal.dot(d);
    if slope.is_zero() {
        return Answer { margin: 0.0, crossings: vec![] };
    }
    let t = normal.dot(&vertices[0]) / &slope;
    let q = d.scaled(&t).minus(&vertices[0]);
    let along = t.abs().f64() * d.dot_abs(&normal) + vertices[0].dot_abs(&normal);
    let turning = e1.dot_abs(&e2.cross(&q)) + e2.dot_abs(&q.cross(&e1));
    let spread = (along + turning) / slope.abs().f64();
    Answer { margin: weakest, crossings: vec![Crossing { t, spread, faces: vec![0] }] }
}
