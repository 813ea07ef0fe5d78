//! For `benches/precision.rs` alone, behind the feature `leaf-study`: the same searches with the textbook's leaf tests in single
//! precision, so that what the robust tests cost can be measured, and counts of the robust ones.
//!
//! Everything here is what the program itself does *not* do: it accepts what a single-precision test says, and
//! ignores whatever is nearer than a fixed epsilon.

use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

use glam::{DVec3, Vec3};

use super::{
    Accel, Isa,
    crossed::Visit,
    frame::{Entry, TreeRay},
    leaf::{LeafRay, Spheres, Triangles, cross, dot, load, splat, sub},
    node::Content,
    simd::{Kernel, Lanes, Simd, dispatch},
    tree::Tree,
    walk::{Visitor, walk},
};
use crate::geometry::{Crossing, Ends, Hit, Ray, Shape};

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
pub(super) fn count_test(shape: &Shape) {
    count(match shape {
        Shape::Sphere(_) => 0,
        Shape::Cylinder(_) => 1,
        Shape::Cone(_) => 2,
        Shape::Quad(_) => 3,
        Shape::Triangle(_) => 4,
        Shape::Polygon(_) => 5,
    });
}

/// Counts the test of a leaf in single precision.
#[inline(always)]
pub(super) fn count_leaf(leaf: Content) {
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
            Shape::Triangle(s) => {
                let [corner, b, c] = s.vertices().map(single);
                Self::Triangle { corner, edge1: b - corner, edge2: c - corner }
            }
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

/// What is done with a crossing: its `t` in the tree's frame (or the world's, outside the tree), place and face. Returns
/// whether to stop.
trait Take {
    /// What is beyond is of no interest.
    fn limit(&self) -> f32;
    fn take(&mut self, t: f32, place: u32, face: u8) -> bool;
}

/// The crossings of a ray with leaves, or with what is outside the tree.
struct Search<'a, T> {
    accel: &'a Accel,
    tree: &'a Tree,
    origin: Vec3,
    dir: Vec3,
    leaf_ray: LeafRay,
    rate: f32,
    arrival: f32,
    start: f32,
    taker: T,
}

impl<T: Take> Search<'_, T> {
    #[inline(always)]
    fn one(&mut self, place: usize) -> bool {
        let found = self.accel.naive[place].crossings(self.origin, self.dir);
        for (t, face) in found {
            let t = t * self.rate - self.arrival;
            if t > self.start && t < self.taker.limit() && self.taker.take(t, place as u32, face) {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn lanes(&mut self, mut hit: u32, t: Lanes, first: u32) -> bool {
        while hit != 0 {
            let lane = hit.trailing_zeros() & 7;
            hit &= hit - 1;
            let t = t.0[lane as usize];
            if t < self.taker.limit() && self.taker.take(t, first + lane, 0) {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn ahead<S: Simd>(&self, simd: S, t: S::F) -> u32 {
        simd.le(simd.splat(self.start), t) & simd.le(t, simd.splat(self.taker.limit()))
    }
}

impl<S: Simd, T: Take> Visitor<S> for Search<'_, T> {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.taker.limit()
    }

    #[inline(always)]
    fn leaf(&mut self, simd: S, leaf: Content) -> bool {
        let tree = self.tree;
        match leaf {
            Content::Spheres(k) => {
                let block = &tree.spheres[k];
                let [t0, t1] = block.naive(simd, &self.leaf_ray);
                let (near, far) = (self.ahead(simd, t0), self.ahead(simd, t1));
                near != 0 && self.lanes(near, simd.store(t0), block.first)
                    || far != 0 && self.lanes(far, simd.store(t1), block.first)
            }
            Content::Triangles(k) => {
                let block = &tree.triangles[k];
                let (hit, t) = block.naive(simd, &self.leaf_ray);
                let hit = hit & self.ahead(simd, t);
                hit != 0 && self.lanes(hit, simd.store(t), block.first)
            }
            Content::One(place) => self.one(place),
            Content::Node(_) => false,
        }
    }
}

/// Looks through everything; the parameters of `taker` are the tree's.
#[inline(always)]
fn search<S: Simd, const SORTED: bool, T: Take>(
    simd: S,
    accel: &Accel,
    ray: &Ray,
    make: impl FnOnce(&TreeRay) -> T,
) -> Option<(T, TreeRay)> {
    let tree = accel.tree.as_ref()?;
    let Entry::Ray(tree_ray) = tree.frame.enter(ray) else { return None };
    let leaf_ray = LeafRay::new(&tree_ray, 1.0);
    let (rate, arrival) = (tree_ray.rate as f32, tree_ray.arrival as f32);
    let start = EPSILON * rate - arrival;
    let (origin, dir) = (ray.origin.as_vec3(), ray.dir.as_vec3());
    let taker = make(&tree_ray);
    let mut search = Search { accel, tree, origin, dir, leaf_ray, rate, arrival, start, taker };
    for place in accel.outside() {
        if search.one(place) {
            return Some((search.taker, tree_ray));
        }
    }
    walk::<S, SORTED>(simd, &tree.nodes, tree.root, &tree_ray, &mut search);
    Some((search.taker, tree_ray))
}

struct Nearest {
    t: f32,
    place: u32,
    face: u8,
}

impl Take for Nearest {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.t
    }

    #[inline(always)]
    fn take(&mut self, t: f32, place: u32, face: u8) -> bool {
        *self = Self { t, place, face };
        false
    }
}

/// The nearest hit.
#[inline(always)]
pub(super) fn nearest<S: Simd>(simd: S, accel: &Accel, ray: &Ray, end: f64) -> Option<Hit> {
    let make =
        |tree_ray: &TreeRay| Nearest { t: tree_ray.end_above(end), place: u32::MAX, face: 0 };
    let (found, tree_ray) = search::<S, true, _>(simd, accel, ray, make)?;
    let t = (f64::from(found.t) + tree_ray.arrival) / tree_ray.rate;
    let primitive = *accel.numbers.get(found.place as usize)?;
    Some(Hit { t, primitive, face: found.face })
}

struct Crossed<'a, B, V> {
    accel: &'a Accel,
    limit: f32,
    rate: f64,
    arrival: f64,
    opaque: B,
    visit: V,
    stopped: bool,
}

impl<B, V> Take for Crossed<'_, B, V>
where
    B: Fn(u32) -> bool,
    V: Visit,
{
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn take(&mut self, t: f32, place: u32, face: u8) -> bool {
        let number = self.accel.numbers[place as usize];
        let t = (f64::from(t) + self.arrival) / self.rate;
        self.stopped =
            (self.opaque)(number) || self.visit.visit(number, Crossing { t, face }).is_break();
        self.stopped
    }
}

/// Whether something stops the ray on its way.
#[inline(always)]
pub(super) fn is_blocked<S: Simd>(
    simd: S,
    accel: &Accel,
    ray: &Ray,
    end: f64,
    opaque: impl Fn(u32) -> bool,
    visit: impl Visit,
) -> bool {
    let make = |tree_ray: &TreeRay| {
        let (limit, rate, arrival) = (tree_ray.end_below(end), tree_ray.rate, tree_ray.arrival);
        Crossed { accel, limit, rate, arrival, opaque, visit, stopped: false }
    };
    search::<S, false, _>(simd, accel, ray, make).is_some_and(|(taker, _)| taker.stopped)
}
