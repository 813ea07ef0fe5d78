//! Which primitive does a ray meet first, and which does it cross on its way to a light?
//!
//! Candidates are found in single precision, by a tree of boxes that are a little too large (`frame`, `walk`); what is
//! hit is decided by the shapes themselves in double precision, so that every answer is, to the bit, the one of
//! [`brute`], whatever the machine's instructions.

mod beam;
pub mod brute;
mod build;
mod collapse;
mod crossed;
mod decide;
mod division;
mod extreme;
mod frame;
pub(crate) mod huge;
mod leaf;
mod node;
mod packet;
mod plan;
mod query;
mod rows;
mod simd;
#[cfg(target_arch = "x86_64")]
mod simd_x86;
#[cfg(feature = "leaf-study")]
pub mod study;
mod target;
#[cfg(test)]
mod tests;
mod tree;
mod walk;

use std::{
    mem,
    ops::{ControlFlow, Range},
};

use glam::DVec3;

use crate::geometry::{
    Bounds, Crossing, Hit, Ray, Shape,
    hit::Crossings,
    lanes::{HitLanes, RayLanes, lanes},
};
pub use build::Preset;
use crossed::Crossed;
use division::Division;
use packet::{BlockedPacket, NearestPacket};
use query::Nearest;
pub use simd::Isa;
use simd::{Instructions, Kernel, Simd};
use tree::{Tree, arrange};
use walk::MAX_DEPTH;

/// From so many primitives on, building takes memory that is worth giving back.
const LARGE: usize = 1 << 16;

/// What [`Accel::run`] runs.
pub(crate) trait Work {
    /// Must be `#[inline(always)]`, and so must what it calls; else that is compiled for the baseline.
    fn run(self);
}

/// Work as a kernel that needs no lanes.
struct Run<W>(W);

impl<W: Work> Kernel for Run<W> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.0.run();
    }
}

/// The memory of these is needed soon.
struct Prefetch<I>(I);

impl<'t, T: 't, I: Iterator<Item = &'t T>> Kernel for Prefetch<I> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for thing in self.0 {
            simd.prefetch(thing);
        }
    }
}

/// The primitives of a scene, arranged so that a ray finds those it meets without trying all.
#[derive(Debug)]
pub struct Accel {
    tree: Option<Tree>,
    /// The primitives: those of the tree in the order of its leaves, then those outside it.
    shapes: Vec<Shape>,
    /// The number of the primitive in each place, and the place of each.
    numbers: Vec<u32>,
    places: Vec<u32>,
    /// How many are in the tree.
    inside: usize,
    bounds: Bounds,
    instructions: Instructions,
    /// How often a query ran, by instructions.
    #[cfg(test)]
    ran: tests::pictures::Ran,
    /// The shapes as the textbook has them, in their places.
    #[cfg(feature = "leaf-study")]
    naive: Vec<study::NaiveShape>,
}

impl Accel {
    /// Arranges `shapes`; a primitive's number is its place in them.
    ///
    /// The tree holds at most 2²⁷ − 2 primitives. Of more, none is put into it, and every ray tests all of them: the
    /// answers are the same, but slow.
    pub fn build(shapes: Vec<Shape>) -> Self {
        Self::with_preset(shapes, Preset::Auto)
    }

    /// As [`Accel::build`], with queries by the instructions of `isa`, or the portable ones where the machine lacks
    /// them.
    pub fn with_isa(shapes: Vec<Shape>, isa: Isa) -> Self {
        let mut accel = Self::build(shapes);
        accel.set_isa(isa);
        accel
    }

    /// As [`Accel::build`], but in the time that `preset` allows.
    pub fn with_preset(shapes: Vec<Shape>, preset: Preset) -> Self {
        Self::with_depth(shapes, preset, MAX_DEPTH)
    }

    /// As [`Accel::with_preset`], with a balanced tree if the usual one is deeper than `deepest`.
    fn with_depth(shapes: Vec<Shape>, preset: Preset, deepest: usize) -> Self {
        let Division { inside, outside, frame, bounds } = Division::of(&shapes);
        let mut wide =
            frame.map(|frame| (arrange(&shapes, &inside, &frame, (preset, deepest)), frame));
        drop(inside);
        let mut numbers =
            wide.as_mut().map_or_else(Vec::new, |(wide, _)| mem::take(&mut wide.order));
        let inside = numbers.len();
        numbers.reserve_exact(outside.len());
        numbers.extend(outside);
        let mut places = vec![0; numbers.len()];
        for (place, number) in (0..).zip(&numbers) {
            places[*number as usize] = place;
        }
        let shapes = in_order(shapes, &numbers);
        let tree = wide.map(|(wide, frame)| Tree::new(wide, frame, &shapes, &numbers));
        if shapes.len() >= LARGE {
            huge::give_back();
        }
        Self {
            tree,
            #[cfg(feature = "leaf-study")]
            naive: shapes.iter().map(study::NaiveShape::new).collect(),
            shapes,
            numbers,
            places,
            inside,
            bounds,
            instructions: Instructions::of(Isa::detect()),
            #[cfg(test)]
            ran: tests::pictures::Ran::default(),
        }
    }

    /// The primitives, in the order of their numbers.
    pub fn into_shapes(self) -> Vec<Shape> {
        in_order(self.shapes, &self.places)
    }

    /// Has queries use the instructions of `isa`, or the portable ones where the machine lacks them.
    pub fn set_isa(&mut self, isa: Isa) {
        self.instructions = Instructions::of(isa);
    }

    /// Runs `kernel` with the instructions that queries use.
    #[cfg(not(test))]
    #[inline(always)]
    fn dispatch<K: Kernel>(&self, kernel: K) -> K::Output {
        self.instructions.run(kernel)
    }

    /// Runs `kernel` likewise, and notes by which instructions it really runs.
    #[cfg(test)]
    fn dispatch<K: Kernel>(&self, kernel: K) -> K::Output {
        self.instructions.run(tests::pictures::Noted { kernel, ran: &self.ran })
    }

    /// The number of primitives.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there is no primitive.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The number of nodes of the tree.
    pub fn node_count(&self) -> usize {
        self.tree.as_ref().map_or(0, |tree| tree.nodes.len())
    }

    /// The memory of tree and primitives, in bytes.
    pub fn bytes(&self) -> usize {
        let tree = self.tree.as_ref().map_or(0, Tree::bytes);
        let numbers = size_of_val(self.numbers.as_slice()) + size_of_val(self.places.as_slice());
        tree + numbers + size_of_val(self.shapes.as_slice())
    }

    /// The primitive with this number.
    pub fn shape(&self, primitive: u32) -> &Shape {
        &self.shapes[self.places[primitive as usize] as usize]
    }

    /// The smallest box about all primitives.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The instructions that queries use.
    pub fn isa(&self) -> Isa {
        self.instructions.isa()
    }

    /// Runs `work` compiled for the instructions that queries use, so that its fused multiply-adds are instructions
    /// too.
    #[inline(always)]
    pub(crate) fn run<W: Work>(&self, work: W) {
        self.dispatch(Run(work));
    }

    /// Asks for the memory of what is needed soon.
    pub(crate) fn prefetch<'t, T: 't>(&self, things: impl Iterator<Item = &'t T>) {
        self.dispatch(Prefetch(things));
    }

    /// The nearest hit with `0 < t < end`; of equal ones, that of the lowest primitive.
    pub fn nearest(&self, ray: &Ray, end: f64) -> Option<Hit> {
        self.dispatch(Nearest { accel: self, ray, end })
    }

    /// The nearest hits of rays that start in one point of free space, as [`Accel::nearest`] without an end finds them.
    pub fn nearest_packet(&self, rays: &RayLanes, hits: &mut HitLanes) {
        if self.dispatch(NearestPacket { accel: self, rays, hits }) {
            return;
        }
        *hits = HitLanes::NONE;
        for k in lanes(rays.used) {
            if let Some(hit) = self.nearest(&rays.ray(k), f64::INFINITY) {
                hits.set(k, &hit);
            }
        }
    }

    /// The lanes for which [`Accel::is_blocked`] is true, of rays that all end at `t = 1` in `target`;
    /// `visit(lane, primitive, crossing)` is told the lane too.
    pub fn blocked_packet(
        &self,
        rays: &RayLanes,
        target: DVec3,
        opaque: impl Fn(u32) -> bool,
        mut visit: impl FnMut(usize, u32, Crossing) -> ControlFlow<()>,
    ) -> u64 {
        let (opaque, visit) = (&opaque, &mut visit);
        let (blocked, alone) =
            self.dispatch(BlockedPacket { accel: self, rays, target, opaque, visit });
        let is_blocked = |k: usize| {
            let visit = |primitive, crossing| visit(k, primitive, crossing);
            u64::from(self.is_blocked(&rays.ray(k), 1.0, opaque, visit)) << k
        };
        lanes(alone).map(is_blocked).fold(blocked, |all, lane| all | lane)
    }

    /// Calls `visit(primitive, crossing)` for every crossing with `0 < t < end`, in no order, until it breaks.
    ///
    /// Returns whether it did.
    pub fn any_crossing(
        &self,
        ray: &Ray,
        end: f64,
        visit: impl FnMut(u32, Crossing) -> ControlFlow<()>,
    ) -> bool {
        self.is_blocked(ray, end, |_| false, visit)
    }

    /// Whether the ray is stopped before `end`: by crossing a primitive for which `opaque` is true, or because `visit`,
    /// called for crossings of the others in no particular order, breaks.
    pub fn is_blocked(
        &self,
        ray: &Ray,
        end: f64,
        opaque: impl Fn(u32) -> bool,
        visit: impl FnMut(u32, Crossing) -> ControlFlow<()>,
    ) -> bool {
        self.dispatch(Crossed { accel: self, ray, end, opaque, visit })
    }

    /// The crossings of `ray` with the primitive in `place`.
    #[inline(always)]
    fn crossings<S: Simd>(&self, simd: S, ray: &Ray, place: usize) -> Crossings {
        #[cfg(feature = "leaf-study")]
        if let Some(crossings) = study::crossings(self, ray, place) {
            return crossings;
        }
        decide::crossings(simd, &self.shapes[place], ray, self.numbers[place])
    }

    /// The places of the primitives that are not in the tree.
    #[inline(always)]
    fn outside(&self) -> Range<usize> {
        self.inside..self.shapes.len()
    }
}

/// The `shapes` in the order of `numbers`, which name each once.
fn in_order(shapes: Vec<Shape>, numbers: &[u32]) -> Vec<Shape> {
    let mut shapes: Vec<Option<Shape>> = shapes.into_iter().map(Some).collect();
    let mut ordered = huge::vec_with_capacity(shapes.len());
    ordered.extend(numbers.iter().filter_map(|k| shapes[*k as usize].take()));
    ordered
}
