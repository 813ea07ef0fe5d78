//! The shapes under test: how to make one, how to ask the oracle about it, how to print it as code.

use std::fmt::{self, Display, Formatter};

use glam::DVec3;
use whitted::geometry::{Cone, Cylinder, Ends, Polygon, Quad, Ray, Shape, Sphere, Triangle};

use super::big::{Big, BigVec, big, big_vec};
use super::oracle::{self, Answer};
use super::round::{self, Local};

/// A shape by its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Subject {
    Sphere { center: DVec3, radius: f64 },
    Cylinder { base: DVec3, top: DVec3, radius: f64, ends: Ends },
    Cone { base: DVec3, apex: DVec3, radius: f64, ends: Ends },
    Quad { corner: DVec3, edge1: DVec3, edge2: DVec3 },
    Triangle { vertices: [DVec3; 3] },
    Polygon { vertices: Vec<DVec3> },
}

/// A ray in the coordinates of a subject, scaled by powers of two to ordinary size.
pub(crate) struct Question {
    pub(crate) local: Local,
    /// The axes of the local frame, unless they are the world's.
    pub(crate) axes: Option<[BigVec; 3]>,
    /// Exponent of the scale of lengths.
    pub(crate) lengths: i32,
    /// Exponent of the scale of the direction.
    pub(crate) dirs: i32,
}

impl Question {
    /// The scaled ray's parameter, given the ray's.
    pub(crate) fn parameter(&self, t: f64) -> Big {
        big(t).shifted(self.lengths - self.dirs)
    }
}

/// The exponent that brings `size` near 1.
fn exponent_to_unit(size: f64) -> i32 {
    if size > 0.0 { -(size.log2().floor() as i32) } else { 0 }
}

fn max_abs(v: &BigVec) -> f64 {
    v.f64().abs().max_element()
}

/// The axes of the frame about an axis, worked out anew: y is the axis; z is at right angles to it and to the coordinate axis
/// that is furthest from it, of equally far ones x before z before y.
pub(crate) fn axes_about(axis: &BigVec) -> [BigVec; 3] {
    let far = |k: usize, than: usize| axis.0[k].abs() <= axis.0[than].abs();
    let helper = if far(0, 1) && far(0, 2) {
        DVec3::X
    } else if far(2, 1) {
        DVec3::Z
    } else {
        DVec3::Y
    };
    let unit = |v: &BigVec| v.scaled(&(big(1.0) / v.length()));
    let (y, z) = (unit(axis), unit(&big_vec(helper).cross(axis)));
    [y.cross(&z), y, z]
}

impl Subject {
    pub(crate) fn shape(&self) -> Shape {
        match self.clone() {
            Self::Sphere { center, radius } => Sphere::try_new(center, radius).map(Into::into),
            Self::Cylinder { base, top, radius, ends } => {
                Cylinder::try_new(base, top, radius, ends).map(Into::into)
            }
            Self::Cone { base, apex, radius, ends } => {
                Cone::try_new(base, apex, radius, ends).map(Into::into)
            }
            Self::Quad { corner, edge1, edge2 } => {
                Quad::try_new(corner, edge1, edge2).map(Into::into)
            }
            Self::Triangle { vertices } => Triangle::try_new(vertices).map(Into::into),
            Self::Polygon { vertices } => Polygon::try_new(vertices).map(Into::into),
        }
        .unwrap_or_else(|error| panic!("{error}: {self}"))
    }

    /// The corners of a flat shape.
    pub(crate) fn vertices(&self) -> Vec<DVec3> {
        match self {
            Self::Quad { corner, edge1, edge2 } => {
                vec![*corner, corner + edge1, corner + edge1 + edge2, corner + edge2]
            }
            Self::Triangle { vertices } => vertices.to_vec(),
            Self::Polygon { vertices } => vertices.clone(),
            _ => vec![],
        }
    }

    /// The local origin, the axis from base to top, radius.
    fn round_parts(&self) -> (DVec3, BigVec, f64) {
        match self {
            Self::Sphere { center, radius } => (*center, big_vec(DVec3::Y), *radius),
            Self::Cylinder { base, top, radius, .. } => {
                (*base, big_vec(*top).minus(&big_vec(*base)), *radius)
            }
            Self::Cone { base, apex, radius, .. } => {
                (*apex, big_vec(*apex).minus(&big_vec(*base)), *radius)
            }
            _ => {
                let vertices = self.vertices();
                let edge = big_vec(vertices[1]).minus(&big_vec(vertices[0]));
                (vertices[0], edge, 0.0)
            }
        }
    }

    /// The origin of the shape's own frame.
    pub(crate) fn anchor(&self) -> BigVec {
        big_vec(self.round_parts().0)
    }

    /// The largest length of the shape.
    pub(crate) fn size(&self) -> f64 {
        match self {
            Self::Sphere { radius, .. } => *radius,
            Self::Cylinder { base, top: end, radius, .. }
            | Self::Cone { base, apex: end, radius, .. } => radius.max((end - base).length()),
            _ => {
                let vertices = self.vertices();
                vertices.iter().map(|v| (v - vertices[0]).length()).fold(0.0, f64::max)
            }
        }
    }

    /// A ray in the frame of the shape, from `f` relative to the anchor.
    pub(crate) fn question(&self, f: &BigVec, dir: &BigVec) -> Question {
        let (_, axis, radius) = self.round_parts();
        let lengths = exponent_to_unit(max_abs(f).max(radius).max(max_abs(&axis)));
        let dirs = exponent_to_unit(max_abs(dir));
        let axis = axis.shifted(lengths);
        let (f, d) = (f.shifted(lengths), dir.shifted(dirs));
        let (r, h) = (big(radius).shifted(lengths), axis.length());
        let has_axis = matches!(self, Self::Cylinder { .. } | Self::Cone { .. });
        if !has_axis {
            let sizes = [f.f64(), d.f64()].map(|v| v.to_array());
            let sizes = [sizes[0], sizes[1]].concat().try_into().expect("six");
            let local = Local { f, d, sizes, r, h };
            return Question { local, axes: None, lengths, dirs };
        }
        let axes = axes_about(&axis);
        let turn = |v: &BigVec| BigVec([0, 1, 2].map(|k| axes[k].dot(v)));
        let exact = axis.0.iter().filter(|x| !x.is_zero()).count() == 1;
        let (f, d) = (turn(&f), turn(&d));
        let [sf, sd] = [&f, &d].map(|v| {
            // A rounded turn mixes the components, so each is as uncertain as the longest.
            if exact { v.f64().to_array() } else { [v.f64().length(); 3] }
        });
        let sizes = [sf[0], sf[1], sf[2], sd[0], sd[1], sd[2]];
        Question { local: Local { f, d, sizes, r, h }, axes: Some(axes), lengths, dirs }
    }

    /// The oracle's answer, with `t` as [`Question::parameter`] scales it.
    pub(crate) fn answer(&self, ray: &Ray) -> (Answer, Question) {
        let f = big_vec(ray.origin).minus(&self.anchor());
        let question = self.question(&f, &big_vec(ray.dir));
        (self.answer_to(&question), question)
    }

    /// The oracle's answer to a question of this shape.
    pub(crate) fn answer_to(&self, question: &Question) -> Answer {
        let local = &question.local;
        match self {
            Self::Sphere { .. } => round::sphere(local),
            Self::Cylinder { ends, .. } => round::cylinder(local, *ends == Ends::Closed),
            Self::Cone { ends, .. } => round::cone(local, *ends == Ends::Closed),
            _ => {
                let (vertices, anchor) = (self.vertices(), self.anchor());
                let from_anchor = |v: &DVec3| big_vec(*v).minus(&anchor).shifted(question.lengths);
                let seen = |v: &DVec3| from_anchor(v).minus(&local.f);
                let seen: Vec<BigVec> = vertices.iter().map(seen).collect();
                oracle::flat(&seen, [1, vertices.len() - 1], &local.d)
            }
        }
    }

    /// The axis of a cylinder or cone, from base to top.
    pub(crate) fn axis(&self) -> Option<BigVec> {
        matches!(self, Self::Cylinder { .. } | Self::Cone { .. }).then(|| self.round_parts().1)
    }

    /// Whether the shape bounds a solid.
    pub(crate) fn is_closed(&self) -> bool {
        matches!(
            self,
            Self::Sphere { .. }
                | Self::Cylinder { ends: Ends::Closed, .. }
                | Self::Cone { ends: Ends::Closed, .. }
        )
    }

    /// This shape moved by `shift` and scaled by `scale`.
    pub(crate) fn placed(&self, shift: DVec3, scale: f64) -> Self {
        let point = |p: &DVec3| (p + shift) * scale;
        let s = scale;
        match self {
            Self::Sphere { center, radius } => {
                Self::Sphere { center: point(center), radius: radius * s }
            }
            Self::Cylinder { base, top, radius, ends } => Self::Cylinder {
                base: point(base),
                top: point(top),
                radius: radius * s,
                ends: *ends,
            },
            Self::Cone { base, apex, radius, ends } => {
                Self::Cone { base: point(base), apex: point(apex), radius: radius * s, ends: *ends }
            }
            Self::Quad { corner, edge1, edge2 } => {
                Self::Quad { corner: point(corner), edge1: edge1 * s, edge2: edge2 * s }
            }
            Self::Triangle { vertices } => Self::Triangle { vertices: vertices.map(|v| point(&v)) },
            Self::Polygon { vertices } => {
                Self::Polygon { vertices: vertices.iter().map(point).collect() }
            }
        }
    }
}

/// A number as code.
pub(crate) fn number(x: f64) -> String {
    if x.is_finite() { format!("{x:?}") } else { format!("f64::from_bits({:#x})", x.to_bits()) }
}

/// A vector as code.
pub(crate) fn vector(v: DVec3) -> String {
    format!("DVec3::new({}, {}, {})", number(v.x), number(v.y), number(v.z))
}

fn vectors(vs: &[DVec3]) -> String {
    vs.iter().map(|v| vector(*v)).collect::<Vec<_>>().join(", ")
}

impl Display for Subject {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sphere { center, radius } => {
                let (center, radius) = (vector(*center), number(*radius));
                write!(out, "Subject::Sphere {{ center: {center}, radius: {radius} }}")
            }
            Self::Cylinder { base, top, radius, ends } => {
                let (base, top, radius) = (vector(*base), vector(*top), number(*radius));
                write!(
                    out,
                    "Subject::Cylinder {{ base: {base}, top: {top}, radius: {radius}, ends: Ends::{ends:?} }}"
                )
            }
            Self::Cone { base, apex, radius, ends } => {
                let (base, apex, radius) = (vector(*base), vector(*apex), number(*radius));
                write!(
                    out,
                    "Subject::Cone {{ base: {base}, apex: {apex}, radius: {radius}, ends: Ends::{ends:?} }}"
                )
            }
            Self::Quad { corner, edge1, edge2 } => {
                let [corner, edge1, edge2] = [corner, edge1, edge2].map(|v| vector(*v));
                write!(out, "Subject::Quad {{ corner: {corner}, edge1: {edge1}, edge2: {edge2} }}")
            }
            Self::Triangle { vertices } => {
                write!(out, "Subject::Triangle {{ vertices: [{}] }}", vectors(vertices))
            }
            Self::Polygon { vertices } => {
                write!(out, "Subject::Polygon {{ vertices: vec![{}] }}", vectors(vertices))
            }
        }
    }
}
