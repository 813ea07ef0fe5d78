//! The four forms of a test side by side: textbook and robust, in single and in double precision.

use glam::{DVec3, Vec3};
use whitted::geometry::{Crossings, Ends, Ray, Shape};

use super::numerics::subject::Subject;
use super::{naive, robust};

/// One of the four.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    SingleNaive,
    DoubleNaive,
    SingleRobust,
    /// The library's.
    DoubleRobust,
}

impl Form {
    pub(crate) const ALL: [Self; 4] =
        [Self::SingleNaive, Self::DoubleNaive, Self::SingleRobust, Self::DoubleRobust];

    pub(crate) fn name(self) -> &'static str {
        ["f32 naive", "f64 naive", "f32 robust", "f64 robust"][self as usize]
    }

    pub(crate) fn is_single(self) -> bool {
        matches!(self, Self::SingleNaive | Self::SingleRobust)
    }
}

/// A primitive that all forms know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Primitive {
    Sphere,
    Cylinder,
    Cone,
    Quad,
    Triangle,
}

impl Primitive {
    pub(crate) const ALL: [Self; 5] =
        [Self::Sphere, Self::Cylinder, Self::Cone, Self::Quad, Self::Triangle];

    pub(crate) fn name(self) -> &'static str {
        ["sphere", "cylinder", "cone", "quad", "triangle"][self as usize]
    }
}

/// A test of one primitive, ready to be run in every form.
pub(crate) trait Quartet {
    fn single_naive(&self, origin: Vec3, dir: Vec3) -> f32;
    fn double_naive(&self, origin: DVec3, dir: DVec3) -> f64;
    fn single_robust(&self, origin: Vec3, dir: Vec3) -> f32;
    fn double_robust(&self, ray: &Ray) -> f64;
}

/// The first parameter ahead, or NaN, as the other forms return it.
#[inline(always)]
fn first(crossings: &Crossings) -> f64 {
    let [a, b] = crossings;
    if a.t > 0.0 {
        a.t
    } else if b.t > 0.0 {
        b.t
    } else {
        f64::NAN
    }
}

macro_rules! quartet {
    ($name:ident: $single:ty, $double:ty, $robust:ty, $library:ty) => {
        pub(crate) struct $name {
            single: $single,
            double: $double,
            robust: $robust,
            library: $library,
        }

        impl Quartet for $name {
            #[inline(always)]
            fn single_naive(&self, origin: Vec3, dir: Vec3) -> f32 {
                self.single.test(origin, dir)
            }

            #[inline(always)]
            fn double_naive(&self, origin: DVec3, dir: DVec3) -> f64 {
                self.double.test(origin, dir)
            }

            #[inline(always)]
            fn single_robust(&self, origin: Vec3, dir: Vec3) -> f32 {
                self.robust.test(origin, dir)
            }

            #[inline(always)]
            fn double_robust(&self, ray: &Ray) -> f64 {
                first(&self.library.crossings(ray))
            }
        }
    };
}

quartet!(Sphere: naive::single::Sphere, naive::double::Sphere, robust::Sphere, whitted::geometry::Sphere);
quartet!(Cylinder: naive::single::Cylinder, naive::double::Cylinder, robust::Cylinder, whitted::geometry::Cylinder);
quartet!(Cone: naive::single::Cone, naive::double::Cone, robust::Cone, whitted::geometry::Cone);
quartet!(Quad: naive::single::Quad, naive::double::Quad, robust::Flat<4>, whitted::geometry::Quad);
quartet!(Triangle: naive::single::Triangle, naive::double::Triangle, robust::Flat<3>, whitted::geometry::Triangle);

const REFUSED: &str = "a shape the library accepts";

impl Sphere {
    pub(crate) fn new(center: DVec3, radius: f64) -> Self {
        let (c, r) = (center.as_vec3(), radius as f32);
        Self {
            single: naive::single::Sphere { center: c, radius: r },
            double: naive::double::Sphere { center, radius },
            robust: robust::Sphere { center: c, radius: r },
            library: whitted::geometry::Sphere::try_new(center, radius).expect(REFUSED),
        }
    }
}

impl Cylinder {
    pub(crate) fn new(base: DVec3, top: DVec3, radius: f64) -> Self {
        let height = top.y - base.y;
        let (b, h, r) = (base.as_vec3(), height as f32, radius as f32);
        Self {
            single: naive::single::Cylinder { base: b, height: h, radius: r },
            double: naive::double::Cylinder { base, height, radius },
            robust: robust::Cylinder { base: b, height: h, radius: r },
            library: whitted::geometry::Cylinder::try_new(base, top, radius, Ends::Open)
                .expect(REFUSED),
        }
    }
}

impl Cone {
    pub(crate) fn new(base: DVec3, apex: DVec3, radius: f64) -> Self {
        let height = apex.y - base.y;
        let (a, h, r) = (apex.as_vec3(), height as f32, radius as f32);
        Self {
            single: naive::single::Cone { apex: a, height: h, radius: r },
            double: naive::double::Cone { apex, height, radius },
            robust: robust::Cone { apex: a, height: h, radius: r },
            library: whitted::geometry::Cone::try_new(base, apex, radius, Ends::Open)
                .expect(REFUSED),
        }
    }
}

impl Quad {
    pub(crate) fn new(corner: DVec3, edge1: DVec3, edge2: DVec3) -> Self {
        let library = whitted::geometry::Quad::try_new(corner, edge1, edge2).expect(REFUSED);
        let [c, e1, e2] = [corner, edge1, edge2].map(single);
        Self {
            single: naive::single::Quad::new(c, e1, e2),
            double: naive::double::Quad::new(corner, edge1, edge2),
            robust: robust::Flat::new(library.vertices().map(single)),
            library,
        }
    }
}

impl Triangle {
    pub(crate) fn new(vertices: [DVec3; 3]) -> Self {
        let v = vertices.map(single);
        Self {
            single: naive::single::Triangle { vertices: v },
            double: naive::double::Triangle { vertices },
            robust: robust::Flat::new(v),
            library: whitted::geometry::Triangle::try_new(vertices).expect(REFUSED),
        }
    }
}

/// Runs `$body` with `$made` for the quartet of a subject, whichever it is.
macro_rules! with_quartet {
    ($subject:expr, $made:ident => $body:expr) => {
        match $subject {
            Subject::Sphere { center, radius } => {
                let $made = Sphere::new(*center, *radius);
                $body
            }
            Subject::Cylinder { base, top, radius, .. } => {
                let $made = Cylinder::new(*base, *top, *radius);
                $body
            }
            Subject::Cone { base, apex, radius, .. } => {
                let $made = Cone::new(*base, *apex, *radius);
                $body
            }
            Subject::Quad { corner, edge1, edge2 } => {
                let $made = Quad::new(*corner, *edge1, *edge2);
                $body
            }
            Subject::Triangle { vertices } => {
                let $made = Triangle::new(*vertices);
                $body
            }
            Subject::Polygon { .. } => unreachable!("no form but the library's knows polygons"),
        }
    };
}

/// The first `t > 0` of `form`, or NaN, for inputs that are single-precision numbers if the form is.
///
/// The robust forms are used as in a scene: lengths scaled by a power of two to ordinary size.
pub(crate) fn answer(form: Form, subject: &Subject, shape: &Shape, ray: &Ray) -> f64 {
    match form {
        Form::DoubleRobust => shape.first_hit(0, ray).map_or(f64::NAN, |(hit, _)| hit.t),
        Form::SingleRobust => {
            let reach = shape.bounds().largest_coordinate().max(ray.origin.abs().max_element());
            let scale = 2.0_f64.powi(-reach.log2().floor() as i32);
            let stretch = 2.0_f64.powi(-ray.dir.abs().max_element().log2().floor() as i32);
            let origin = (ray.origin * scale).as_vec3();
            let dir = (ray.dir * stretch).as_vec3();
            let subject = subject.placed(DVec3::ZERO, scale);
            let t = with_quartet!(&subject, made => made.single_robust(origin, dir));
            f64::from(t) / scale * stretch
        }
        Form::SingleNaive => {
            let (origin, dir) = (ray.origin.as_vec3(), ray.dir.as_vec3());
            f64::from(with_quartet!(subject, made => made.single_naive(origin, dir)))
        }
        Form::DoubleNaive => {
            with_quartet!(subject, made => made.double_naive(ray.origin, ray.dir))
        }
    }
}

fn single(v: DVec3) -> Vec3 {
    v.as_vec3()
}

/// `v` rounded to single precision.
pub(crate) fn rounded(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// The subject with its parameters rounded to single precision; `None` if nothing is left of it.
pub(crate) fn rounded_subject(subject: &Subject) -> Option<Subject> {
    let length = |x: f64| f64::from(x as f32);
    let rounded = match *subject {
        Subject::Sphere { center, radius } => {
            Subject::Sphere { center: rounded(center), radius: length(radius) }
        }
        Subject::Cylinder { base, top, radius, ends } => Subject::Cylinder {
            base: rounded(base),
            top: rounded(top),
            radius: length(radius),
            ends,
        },
        Subject::Cone { base, apex, radius, ends } => {
            Subject::Cone { base: rounded(base), apex: rounded(apex), radius: length(radius), ends }
        }
        Subject::Quad { corner, edge1, edge2 } => {
            Subject::Quad { corner: rounded(corner), edge1: rounded(edge1), edge2: rounded(edge2) }
        }
        Subject::Triangle { vertices } => Subject::Triangle { vertices: vertices.map(rounded) },
        Subject::Polygon { .. } => return None,
    };
    let made: Option<Shape> = match rounded.clone() {
        Subject::Sphere { center, radius } => {
            whitted::geometry::Sphere::try_new(center, radius).ok().map(Into::into)
        }
        Subject::Cylinder { base, top, radius, ends } => {
            whitted::geometry::Cylinder::try_new(base, top, radius, ends).ok().map(Into::into)
        }
        Subject::Cone { base, apex, radius, ends } => {
            whitted::geometry::Cone::try_new(base, apex, radius, ends).ok().map(Into::into)
        }
        Subject::Quad { corner, edge1, edge2 } => {
            whitted::geometry::Quad::try_new(corner, edge1, edge2).ok().map(Into::into)
        }
        Subject::Triangle { vertices } => {
            whitted::geometry::Triangle::try_new(vertices).ok().map(Into::into)
        }
        Subject::Polygon { .. } => None,
    };
    made.map(|_| rounded)
}
