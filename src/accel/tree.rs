//! The tree over the primitives that have one.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    build::{self, Preset},
    collapse::{Kind, Wide, collapse},
    frame::Frame,
    huge,
    leaf::{Spheres, Triangles},
    node::{Child, Content, Node},
    simd::Simd,
};
use crate::geometry::Shape;

/// The nodes of the tree over the primitives `inside`, and their order; a balanced one where the other has more than `deepest` nodes
/// on a way down.
pub(super) fn arrange(
    shapes: &[Shape],
    inside: &[u32],
    frame: &Frame,
    (preset, deepest): (Preset, usize),
) -> Wide {
    let boxes = || build::boxes(shapes, inside, frame);
    let kinds: Vec<Kind> = inside.par_iter().map(|k| Kind::of(&shapes[*k as usize])).collect();
    let meshes = kinds.iter().take(64).any(|kind| *kind == Kind::Triangle);
    let wide = collapse(&build::binary(boxes(), meshes, preset), &kinds);
    let mut wide =
        if wide.depth > deepest { collapse(&build::balanced(&boxes()), &kinds) } else { wide };
    for place in &mut wide.order {
        *place = inside[*place as usize];
    }
    wide
}

/// Nodes and leaves, and the frame in which their boxes are.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) frame: Frame,
    pub(super) root: Child,
    pub(super) nodes: Vec<Node>,
    pub(super) spheres: Spheres,
    pub(super) triangles: Triangles,
    /// The corners of the triangles, exactly, in the order of the leaves.
    corners: Vec<[DVec3; 3]>,
}

impl Tree {
    /// The tree whose nodes are those of `wide`, over `shapes` in its order.
    pub(super) fn new(wide: Wide, frame: Frame, shapes: &[Shape]) -> Self {
        let spheres = Spheres::new(&wide.sphere_runs, frame.pad(), |place| {
            let Shape::Sphere(s) = &shapes[place as usize] else {
                unreachable!("a leaf of spheres")
            };
            (frame.point(s.center()), frame.length(s.radius()))
        });
        let places = wide.triangle_runs.first().zip(wide.triangle_runs.last());
        let places = places.map_or(0..0, |(a, b)| a.places().start..b.places().end);
        let (base, mut corners) = (places.start, huge::vec_with_capacity(places.len()));
        shapes[places].par_iter().map(corners_of).collect_into_vec(&mut corners);
        let triangles = Triangles::new(&wide.triangle_runs, frame.coarseness(), |place| {
            corners[place as usize - base].map(|v| frame.point(v))
        });
        Self { frame, root: wide.root, nodes: wide.nodes, spheres, triangles, corners }
    }

    /// The memory of nodes and leaves, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let leaves = self.spheres.rows.bytes() + self.triangles.rows.bytes();
        size_of_val(self.nodes.as_slice()) + leaves + size_of_val(self.corners.as_slice())
    }

    /// The places of a leaf's primitives.
    pub(super) fn places(leaf: Content) -> Range<usize> {
        match leaf {
            Content::Node(_) => 0..0,
            Content::Spheres(run) | Content::Triangles(run) => run.places(),
            Content::One(place) => place..place + 1,
        }
    }

    /// Asks for the memory of a child that is visited later, if it is a node; for a single ray, to do so for leaves,
    /// too, was slower.
    #[inline(always)]
    pub(super) fn prefetch_node<S: Simd>(&self, simd: S, child: Child) {
        if let Content::Node(k) = child.content() {
            simd.prefetch(&self.nodes[k]);
        }
    }

    /// Asks for the memory of a child that is visited later.
    #[inline(always)]
    pub(super) fn prefetch<S: Simd>(&self, simd: S, child: Child) {
        match child.content() {
            Content::Node(k) => simd.prefetch(&self.nodes[k]),
            Content::Spheres(run) => self.spheres.rows.prefetch(simd, run),
            Content::Triangles(run) => self.triangles.rows.prefetch(simd, run),
            Content::One(_) => {}
        }
    }

    /// Whether there are leaves of triangles.
    #[inline(always)]
    pub(super) fn has_triangles(&self) -> bool {
        !self.corners.is_empty()
    }

    /// The corners of the primitive in `place`, if it is a triangle.
    #[inline(always)]
    pub(super) fn corners(&self, place: u32) -> Option<&[DVec3; 3]> {
        self.corners.get(place.wrapping_sub(self.triangles.rows.base) as usize)
    }
}

/// The corners of a triangle.
fn corners_of(shape: &Shape) -> [DVec3; 3] {
    match shape {
        Shape::Triangle(t) => t.vertices(),
        Shape::Face(f) => f.vertices(),
        _ => unreachable!("a leaf of triangles"),
    }
}
