//! The textbook's tests, in single and in double precision: each returns the first `t > 0`, or NaN.

macro_rules! textbook {
    ($module:ident, $float:ident, $vector:ident) => {
        pub(crate) mod $module {
            use glam::$vector as Vector;

            /// The first of two parameters in ascending order that is ahead and `counts`.
            #[inline(always)]
            fn first(t0: $float, t1: $float, counts: impl Fn($float) -> bool) -> $float {
                let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
                if near > 0.0 && counts(near) {
                    near
                } else if far > 0.0 && counts(far) {
                    far
                } else {
                    $float::NAN
                }
            }

            /// The roots of a t² + 2 b t + c, if they are real.
            #[inline(always)]
            fn roots(a: $float, b: $float, c: $float) -> ($float, $float) {
                let discriminant = b * b - a * c;
                if discriminant < 0.0 {
                    return ($float::NAN, $float::NAN);
                }
                let root = discriminant.sqrt();
                ((-b - root) / a, (-b + root) / a)
            }

            pub(crate) struct Sphere {
                pub(crate) center: Vector,
                pub(crate) radius: $float,
            }

            impl Sphere {
                #[inline(always)]
                pub(crate) fn test(&self, origin: Vector, dir: Vector) -> $float {
                    let f = origin - self.center;
                    let c = f.dot(f) - self.radius * self.radius;
                    let (t0, t1) = roots(dir.dot(dir), f.dot(dir), c);
                    first(t0, t1, |_| true)
                }
            }

            /// Upright and open.
            pub(crate) struct Cylinder {
                pub(crate) base: Vector,
                pub(crate) height: $float,
                pub(crate) radius: $float,
            }

            impl Cylinder {
                #[inline(always)]
                pub(crate) fn test(&self, origin: Vector, d: Vector) -> $float {
                    let f = origin - self.base;
                    let a = d.x * d.x + d.z * d.z;
                    let b = f.x * d.x + f.z * d.z;
                    let c = f.x * f.x + f.z * f.z - self.radius * self.radius;
                    let (t0, t1) = roots(a, b, c);
                    first(t0, t1, |t| (0.0..=self.height).contains(&(f.y + t * d.y)))
                }
            }

            /// Upright and open.
            pub(crate) struct Cone {
                pub(crate) apex: Vector,
                pub(crate) height: $float,
                pub(crate) radius: $float,
            }

            impl Cone {
                #[inline(always)]
                pub(crate) fn test(&self, origin: Vector, d: Vector) -> $float {
                    let f = origin - self.apex;
                    let slope = self.radius / self.height;
                    let k = slope * slope;
                    let a = d.x * d.x + d.z * d.z - k * d.y * d.y;
                    let b = f.x * d.x + f.z * d.z - k * f.y * d.y;
                    let c = f.x * f.x + f.z * f.z - k * f.y * f.y;
                    let (t0, t1) = roots(a, b, c);
                    first(t0, t1, |t| (-self.height..=0.0).contains(&(f.y + t * d.y)))
                }
            }

            pub(crate) struct Quad {
                corner: Vector,
                edge1: Vector,
                edge2: Vector,
                normal: Vector,
                /// The normal divided by its squared length.
                w: Vector,
            }

            impl Quad {
                pub(crate) fn new(corner: Vector, edge1: Vector, edge2: Vector) -> Self {
                    let normal = edge1.cross(edge2);
                    Self { corner, edge1, edge2, normal, w: normal / normal.dot(normal) }
                }

                /// The plane first, then where in it the point is.
                #[inline(always)]
                pub(crate) fn test(&self, origin: Vector, dir: Vector) -> $float {
                    let t = self.normal.dot(self.corner - origin) / self.normal.dot(dir);
                    let p = origin + dir * t - self.corner;
                    let u = self.w.dot(p.cross(self.edge2));
                    let v = self.w.dot(self.edge1.cross(p));
                    let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
                    if t > 0.0 && inside { t } else { $float::NAN }
                }
            }

            pub(crate) struct Triangle {
                pub(crate) vertices: [Vector; 3],
            }

            impl Triangle {
                /// Möller & Trumbore, "Fast, minimum storage ray/triangle intersection" (1997), without its epsilon.
                #[inline(always)]
                pub(crate) fn test(&self, origin: Vector, dir: Vector) -> $float {
                    let [a, b, c] = self.vertices;
                    let (edge1, edge2) = (b - a, c - a);
                    let p = dir.cross(edge2);
                    let inverse = 1.0 / edge1.dot(p);
                    let s = origin - a;
                    let u = s.dot(p) * inverse;
                    if !(0.0..=1.0).contains(&u) {
                        return $float::NAN;
                    }
                    let q = s.cross(edge1);
                    let v = dir.dot(q) * inverse;
                    let t = edge2.dot(q) * inverse;
                    if v >= 0.0 && u + v <= 1.0 && t > 0.0 { t } else { $float::NAN }
                }
            }
        }
    };
}

textbook!(single, f32, Vec3);
textbook!(double, f64, DVec3);
