//! For `benches/precision.rs` alone, behind the feature `leaf-study`: the same searches with the textbook's leaf tests in single
//! precision, so that what the robust tests cost can be measured, and counts of the robust ones.
//!
//! Everything here is what the program itself does *not* do: it accepts what a single-precision test says, and
//! ignores whatever is nearer than a fixed epsilon.

use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

use glam::{DVec3, Vec3};

use super::{
    Accel, Isa,
    leaf::{LeafRay, Spheres, Triangles, cross, dot, load, splat, sub},
    node::Content,
    simd::{Kernel, Lanes, Simd, dispatch},
    tree::Tree,
};
use crate::geometry::{Crossing, Ends, Ray, Shape, hit::Crossings};

fn single(v: DVec3) -> Vec3 {
    v.as_vec3()
}

/// How leaves are tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaves {
    /// As everywhere: sorted out in single precision, decided in double precision.
    Robust,
    /// The same, counted.
    Counted,
    /// By the textbook in single precision.
    Naive,
}

static LEAVES: AtomicU8 = AtomicU8::new(Leaves::Robust as u8);

/// Tests the leaves of all searches from now on so.
pub fn set_leaves(leaves: Leaves) {
    LEAVES.store(leaves as u8, Ordering::Relaxed);
}

#[inline(always)]
fn leaves_are(leaves: Leaves) -> bool {
    LEAVES.load(Ordering::Relaxed) == leaves as u8
}

/// How many tests there were: of sphere, cylinder, cone, quad, triangle and polygon in double precision, of blocks of eight
/// spheres and of eight triangles.
pub type Counts = [u64; 8];

static COUNTS: [AtomicU64; 8] = [const { AtomicU64::new(0) }; 8];

/// The counts since the last call.
pub fn take_counts() -> Counts {
    std::array::from_fn(|k| COUNTS[k].swap(0, Ordering::Relaxed))
}

#[inline(always)]
fn count(kind: usize) {
    if leaves_are(Leaves::Counted) {
        COUNTS[kind].fetch_add(1, Ordering::Relaxed);
    }
}

/// Counts the test of a shape in double precision.
#[inline(always)]
fn count_test(shape: &Shape) {
    count(match shape {
        Shape::Sphere(_) => 0,
        Shape::Cylinder(_) => 1,
        Shape::Cone(_) => 2,
        Shape::Quad(_) => 3,
        Shape::Triangle(_) | Shape::Face(_) => 4,
        Shape::Polygon(_) => 5,
    });
}

/// Counts the test of a leaf in single precision.
#[inline(always)]
fn count_leaf(leaf: Content) {
    match leaf {
        Content::Spheres(_) => count(6),
        Content::Triangles(_) => count(7),
        Content::One(_) | Content::Node(_) => {}
    }
}

/// Something to be compiled for chosen instructions.
pub trait Work {
    /// Must be `#[inline(always)]`, and so must what it calls.
    fn run(self);
}

struct Run<W>(W);

impl<W: Work> Kernel for Run<W> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.0.run();
    }
}

/// Runs `work` compiled for `isa`.
pub fn run_compiled(isa: Isa, work: impl Work) {
    dispatch(isa, Run(work));
}

/// What is nearer is ignored; the scene's size is about 1.
const EPSILON: f32 = 1e-4;

/// A shape as the textbook has it.
#[derive(Debug)]
pub(super) enum NaiveShape {
    Sphere { center: Vec3, radius: f32 },
    Cylinder(Round),
    Cone(Round),
    Quad { corner: Vec3, edge1: Vec3, edge2: Vec3, normal: Vec3, w: Vec3 },
    Triangle { corner: Vec3, edge1: Vec3, edge2: Vec3 },
    Polygon { vertices: Box<[Vec3]>, normal: Vec3 },
}

/// A cylinder or cone: its base, three axes of which the second goes up, and whether discs close it.
#[derive(Debug)]
pub(super) struct Round {
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
type Naive = [(f32, u8); 2];

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

    pub(super) fn new(shape: &Shape) -> Self {
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
        }
    }

    #[inline(always)]
    fn crossings(&self, o: Vec3, d: Vec3) -> Naive {
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

impl Spheres {
    /// The two roots of each sphere, which are NaN where it is missed.
    #[inline(always)]
    fn naive<S: Simd>(&self, simd: S, ray: &LeafRay) -> [S::F; 2] {
        let (origin, dir) = (splat(simd, ray.origin), splat(simd, ray.dir));
        let inverse = simd.splat(ray.inverse);
        let f = sub(simd, load(simd, &self.center), origin);
        let b = dot(simd, f, dir);
        let c = simd.sub(dot(simd, f, f), simd.load(&self.outer));
        let a = dot(simd, dir, dir);
        let root = simd.sqrt(simd.mul_sub(b, b, simd.mul(a, c)));
        [simd.mul(simd.sub(b, root), inverse), simd.mul(simd.add(b, root), inverse)]
    }
}

impl Triangles {
    /// The parameter for each triangle, and which are hit.
    #[inline(always)]
    fn naive<S: Simd>(&self, simd: S, ray: &LeafRay) -> (u32, S::F) {
        let (origin, dir) = (splat(simd, ray.origin), splat(simd, ray.dir));
        let (edge1, edge2) = (load(simd, &self.edge1), load(simd, &self.edge2));
        let p = cross(simd, dir, edge2);
        let inverse = simd.div(simd.splat(1.0), dot(simd, edge1, p));
        let s = sub(simd, origin, load(simd, &self.corner));
        let q = cross(simd, s, edge1);
        let u = simd.mul(dot(simd, s, p), inverse);
        let v = simd.mul(dot(simd, dir, q), inverse);
        let zero = simd.splat(0.0);
        let hit = simd.le(zero, u) & simd.le(zero, v) & simd.le(simd.add(u, v), simd.splat(1.0));
        (hit & ((1 << self.count) - 1), simd.mul(dot(simd, edge2, q), inverse))
    }
}

/// Whether searches take the textbook's tests.
#[inline(always)]
pub(super) fn is_naive() -> bool {
    leaves_are(Leaves::Naive)
}

/// The textbook's crossings of the shape in `place`, where they are wanted; else that is counted.
#[inline(always)]
pub(super) fn crossings(accel: &Accel, ray: &Ray, place: usize) -> Option<Crossings> {
    if !is_naive() {
        count_test(&accel.shapes[place]);
        return None;
    }
    let found = accel.naive[place].crossings(ray.origin.as_vec3(), ray.dir.as_vec3());
    Some(found.map(
        |(t, face)| {
            if t > EPSILON { Crossing { t: f64::from(t), face } } else { Crossing::NONE }
        },
    ))
}

/// The hits of a ray in a leaf: the place of the first primitive, which of them are hit first and second, and where.
pub(super) struct Found {
    first: u32,
    hits: [u32; 2],
    t: [Lanes; 2],
}

impl Found {
    /// Calls `take(place, t)`, `t` being the tree's, for every hit, until it returns that it stops; returns whether it did.
    #[inline(always)]
    pub(super) fn for_each(&self, mut take: impl FnMut(u32, f32) -> bool) -> bool {
        for (mut hits, t) in self.hits.into_iter().zip(&self.t) {
            while hits != 0 {
                let lane = hits.trailing_zeros() & 7;
                hits &= hits - 1;
                if take(self.first + lane, t.0[lane as usize]) {
                    return true;
                }
            }
        }
        false
    }
}

impl LeafRay {
    /// The crossing at the tree's `t`.
    #[inline(always)]
    pub(super) fn crossing(&self, t: f32) -> Crossing {
        Crossing::at((f64::from(t) + self.ray.arrival) / self.ray.rate)
    }
}

/// What the textbook says of a leaf.
pub(super) enum Textbook {
    /// It is not asked; that is counted.
    Unwanted,
    /// Nothing is hit.
    Missed,
    /// Something is.
    Hit(Found),
}

/// The textbook's hits in a block of primitives.
#[inline(always)]
pub(super) fn leaf<S: Simd>(
    simd: S,
    tree: &Tree,
    leaf: Content,
    ray: &LeafRay,
    limit: f32,
) -> Textbook {
    if !is_naive() {
        count_leaf(leaf);
        return Textbook::Unwanted;
    }
    let start = simd.splat(EPSILON * ray.ray.rate as f32 - ray.ray.arrival as f32);
    let limit = simd.splat(limit);
    let ahead = |t: S::F| simd.le(start, t) & simd.le(t, limit);
    match leaf {
        Content::Spheres(k) => {
            let block = &tree.spheres[k];
            let [t0, t1] = block.naive(simd, ray);
            // Of a NaN, which is a miss, `min` and `max` hand on the second.
            if simd.le(simd.max(start, t0), simd.min(limit, t1)) == 0 {
                return Textbook::Missed;
            }
            let hits = [ahead(t0), ahead(t1)];
            let t = [simd.store(t0), simd.store(t1)];
            Textbook::Hit(Found { first: block.first, hits, t })
        }
        Content::Triangles(k) => {
            let block = &tree.triangles[k];
            let (hit, t) = block.naive(simd, ray);
            let hit = hit & ahead(t);
            if hit == 0 {
                return Textbook::Missed;
            }
            let t = simd.store(t);
            Textbook::Hit(Found { first: block.first, hits: [hit, 0], t: [t, t] })
        }
        Content::One(_) | Content::Node(_) => Textbook::Unwanted,
    }
}
