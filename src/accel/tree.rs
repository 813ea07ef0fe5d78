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
use crate::geometry::{Shape, triangle::Plane};

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

/// A triangle. If a ray certainly crosses it, what is needed is in one line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Flat {
    pub(super) plane: Plane,
    /// The number of the primitive.
    pub(super) number: u32,
    corners: [DVec3; 2],
}

impl Flat {
    /// The corners.
    #[inline(always)]
    pub(super) fn corners(&self) -> [DVec3; 3] {
        [self.plane.vertex, self.corners[0], self.corners[1]]
    }
}

/// Nodes and leaves, and the frame in which their boxes are.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) frame: Frame,
    pub(super) root: Child,
    pub(super) nodes: Vec<Node>,
    pub(super) spheres: Spheres,
    pub(super) triangles: Triangles,
    /// The triangles of leaves, in the order of these.
    flats: Vec<Flat>,
}

impl Tree {
    /// The tree whose nodes are those of `wide`, over `shapes` in its order, whose numbers are `numbers`.
    pub(super) fn new(wide: Wide, frame: Frame, shapes: &[Shape], numbers: &[u32]) -> Self {
        let spheres = Spheres::new(&wide.sphere_runs, frame.pad(), |place| {
            let Shape::Sphere(s) = &shapes[place as usize] else {
                unreachable!("a leaf of spheres")
            };
            (frame.point(s.center()), frame.length(s.radius()))
        });
        let places = wide.triangle_runs.first().zip(wide.triangle_runs.last());
        let places = places.map_or(0..0, |(a, b)| a.places().start..b.places().end);
        let (base, mut flats) = (places.start, huge::vec_with_capacity(places.len()));
        let flat = |(shape, number): (&Shape, &u32)| {
            let corners = corners_of(shape);
            let plane = Plane::through(&corners);
            Flat { plane, number: *number, corners: [corners[1], corners[2]] }
        };
        let numbers = &numbers[places.clone()];
        shapes[places].par_iter().zip(numbers).map(flat).collect_into_vec(&mut flats);
        let triangles = Triangles::new(&wide.triangle_runs, frame.coarseness(), |place| {
            flats[place as usize - base].corners().map(|v| frame.point(v))
        });
        Self { frame, root: wide.root, nodes: wide.nodes, spheres, triangles, flats }
    }

    /// The memory of nodes and leaves, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let leaves = self.spheres.rows.bytes() + self.triangles.rows.bytes();
        size_of_val(self.nodes.as_slice()) + leaves + size_of_val(self.flats.as_slice())
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
        !self.flats.is_empty()
    }

    /// The primitive in `place`, if it is a triangle.
    #[inline(always)]
    pub(super) fn flat(&self, place: u32) -> Option<&Flat> {
        self.flats.get(place.wrapping_sub(self.triangles.rows.base) as usize)
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
