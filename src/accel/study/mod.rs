//! For `benches/precision.rs` alone, behind the feature `leaf-study`: the same searches with the textbook's leaf tests
//! in single precision, so that what the robust tests cost can be measured, and counts of the robust ones.
//!
//! Everything here is what the program itself does *not* do: it accepts what a single-precision test says, and
//! ignores whatever is nearer than a fixed epsilon.

mod blocks;
mod shapes;

use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

use super::{
    Accel, Isa,
    node::Content,
    simd::{Instructions, Kernel, Simd},
};
use crate::geometry::{Crossing, Ray, Shape, hit::Crossings};
pub(super) use blocks::{Textbook, leaf};
pub(super) use shapes::NaiveShape;

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

/// How many tests there were: see [`COUNTED`].
pub type Counts = [u64; COUNTED.len()];

/// What is counted: tests of shapes in double precision; of leaves, and of nodes, by one ray; and of a packet's leaves
/// (eight of its rays against one box; eight triangles seen, eight rays against one of them) and nodes (its beam).
pub const COUNTED: [&str; 13] = [
    "sphere",
    "cylinder",
    "cone",
    "quad",
    "triangle",
    "polygon",
    "8 spheres",
    "8 triangles",
    "node",
    "8 rays",
    "beam",
    "8 triangles seen",
    "8 rays at one",
];

static COUNTS: [AtomicU64; COUNTED.len()] = [const { AtomicU64::new(0) }; COUNTED.len()];

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
        Shape::Inward(inward) => return count_test(inward.shape()),
    });
}

/// Counts the test of a triangle in double precision.
#[inline(always)]
pub(super) fn count_triangle() {
    count(4);
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

/// Counts the test of a node.
#[inline(always)]
pub(super) fn count_node() {
    count(8);
}

/// Counts the test of eight rays of a packet against one box.
#[inline(always)]
pub(super) fn count_eight() {
    count(9);
}

/// Counts the test of a node by a beam.
#[inline(always)]
pub(super) fn count_beam() {
    count(10);
}

/// Counts the look of a packet at a leaf of triangles.
#[inline(always)]
pub(super) fn count_eye() {
    count(11);
}

/// Counts the test of eight rays of a packet against one triangle that is seen.
#[inline(always)]
pub(super) fn count_seen() {
    count(12);
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
    Instructions::of(isa).run(Run(work));
}

/// What is nearer is ignored; the scene's size is about 1.
const EPSILON: f32 = 1e-4;

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
