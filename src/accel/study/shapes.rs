//! Every shape as the textbook has it, in single precision.

use glam::{DVec3, Vec3};

use crate::geometry::{Ends, Shape};

fn single(v: DVec3) -> Vec3 {
    v.as_vec3()
}

/// A shape as the textbook has it.
#[derive(Debug)]
pub(in crate::accel) enum NaiveShape {
    Sphere { center: Vec3, radius: f32 },
    Cylinder(Round),
    Cone(Round),
    Quad { corner: Vec3, edge1: Vec3, edge2: Vec3, normal: Vec3, w: Vec3 },
    Triangle { corner: Vec3, edge1: Vec3, edge2: Vec3 },
    Polygon { vertices: Box<[Vec3]>, normal: Vec3 },
}

/// A cylinder or cone: its base, three axes of which the second goes up, and whether discs close it.
#[derive(Debug)]
pub(in crate::accel) struct Round {
    base: Vec3,
    axes: [Vec3; 3],
    height: f32,
    radius: f32,
    closed: bool,
}

impl Round {
    fn new([base, top]: [DVec3; 2], radius: f64, ends: Ends) -> Self {
        let up = (top - base).normalize();
        let (x, z) = up.any_orthonormal_pair();
        Self {
            base: base.as_vec3(),
            axes: [x, up, z].map(single),
            height: (top - base).length() as f32,
            radius: radius as f32,
            closed: ends == Ends::Closed,
        }
    }

    #[inline(always)]
    fn turned(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.axes[0].dot(v), self.axes[1].dot(v), self.axes[2].dot(v))
    }

    /// The roots `t` at a height between the ends, and the discs.
    #[inline(always)]
    fn crossings(&self, f: Vec3, d: Vec3, roots: [f32; 2], discs: &[(f32, u8)]) -> Naive {
        let on_side = |t: f32| {
            let y = f.y + t * d.y;
            if y >= 0.0 && y <= self.height { (t, 0) } else { MISS }
        };
        let [side0, side1] = roots.map(on_side);
        let mut found = sorted(side0, side1);
        if self.closed {
            for &(y, face) in discs {
                let t = (y - f.y) / d.y;
                let (x, z) = (f.x + t * d.x, f.z + t * d.z);
                if x * x + z * z <= self.radius * self.radius {
                    let [near, far] = found;
                    found = if near.0.is_nan() {
                        sorted((t, face), far)
                    } else {
                        sorted(near, (t, face))
                    };
                }
            }
        }
        found
    }
}

/// Up to two crossings in ascending order, each with its face; NaN where there is none.
pub(super) type Naive = [(f32, u8); 2];

const MISS: (f32, u8) = (f32::NAN, 0);

#[inline(always)]
fn sorted(a: (f32, u8), b: (f32, u8)) -> Naive {
    if b.0 < a.0 { [b, a] } else { [a, b] }
}

/// The roots of a t² + 2 b t + c.
#[inline(always)]
fn roots(a: f32, b: f32, c: f32) -> [f32; 2] {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return [f32::NAN; 2];
    }
    let (root, inverse) = (discriminant.sqrt(), 1.0 / a);
    [(-b - root) * inverse, (-b + root) * inverse]
}

impl NaiveShape {
    fn triangle(vertices: [DVec3; 3]) -> Self {
        let [corner, b, c] = vertices.map(single);
        Self::Triangle { corner, edge1: b - corner, edge2: c - corner }
    }

    pub(in crate::accel) fn new(shape: &Shape) -> Self {
        match shape {
            Shape::Sphere(s) => {
                Self::Sphere { center: s.center().as_vec3(), radius: s.radius() as f32 }
            }
            Shape::Cylinder(s) => Self::Cylinder(Round::new(s.axis_points(), s.radius(), s.ends())),
            Shape::Cone(s) => Self::Cone(Round::new(s.axis_points(), s.radius(), s.ends())),
            Shape::Quad(s) => {
                let [q, b, _, d] = s.vertices().map(single);
                let (edge1, edge2) = (b - q, d - q);
                let normal = edge1.cross(edge2);
                Self::Quad { corner: q, edge1, edge2, normal, w: normal / normal.dot(normal) }
            }
            Shape::Triangle(s) => Self::triangle(s.vertices()),
            Shape::Face(s) => Self::triangle(s.vertices()),
            Shape::Polygon(s) => {
                let vertices: Box<[Vec3]> = s.vertices().iter().copied().map(single).collect();
                let normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
                Self::Polygon { vertices, normal }
            }
            Shape::Inward(s) => Self::new(s.shape()),
        }
    }

    #[inline(always)]
    pub(super) fn crossings(&self, o: Vec3, d: Vec3) -> Naive {
        match self {
            Self::Sphere { center, radius } => {
                let f = o - *center;
                let [t0, t1] = roots(d.dot(d), f.dot(d), f.dot(f) - radius * radius);
                [(t0, 0), (t1, 0)]
            }
            Self::Cylinder(s) => {
                let (f, d) = (s.turned(o - s.base), s.turned(d));
                let c = f.x * f.x + f.z * f.z - s.radius * s.radius;
                let roots = roots(d.x * d.x + d.z * d.z, f.x * d.x + f.z * d.z, c);
                s.crossings(f, d, roots, &[(0.0, 1), (s.height, 2)])
            }
            Self::Cone(s) => {
                let (f, d) = (s.turned(o - s.base), s.turned(d));
                let (slope, y) = (s.radius / s.height, f.y - s.height);
                let k = slope * slope;
                let a = d.x * d.x + d.z * d.z - k * d.y * d.y;
                let b = f.x * d.x + f.z * d.z - k * y * d.y;
                let roots = roots(a, b, f.x * f.x + f.z * f.z - k * y * y);
                s.crossings(f, d, roots, &[(0.0, 1)])
            }
            Self::Quad { corner, edge1, edge2, normal, w } => {
                let t = normal.dot(*corner - o) / normal.dot(d);
                let p = o + d * t - *corner;
                let (u, v) = (w.dot(p.cross(*edge2)), w.dot(edge1.cross(p)));
                let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
                [if inside { (t, 0) } else { MISS }, MISS]
            }
            Self::Triangle { corner, edge1, edge2 } => {
                let p = d.cross(*edge2);
                let inverse = 1.0 / edge1.dot(p);
                let s = o - *corner;
                let (u, q) = (s.dot(p) * inverse, s.cross(*edge1));
                let v = d.dot(q) * inverse;
                let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
                [if inside { (edge2.dot(q) * inverse, 0) } else { MISS }, MISS]
            }
            Self::Polygon { vertices, normal } => {
                let t = normal.dot(vertices[0] - o) / normal.dot(d);
                let p = o + d * t;
                let mut last = vertices[vertices.len() - 1];
                for v in vertices {
                    if normal.dot((*v - last).cross(p - last)) < 0.0 {
                        return [MISS; 2];
                    }
                    last = *v;
                }
                [(t, 0), MISS]
            }
        }
    }
}
