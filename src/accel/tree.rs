//! The tree over the primitives that have one.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    build::{self, Division},
    collapse::{Kind, collapse},
    frame::Frame,
    huge,
    leaf::{Spheres, Triangles},
    node::{Child, Content, Node},
    simd::Simd,
    walk::MAX_DEPTH,
};
use crate::geometry::Shape;

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
    /// Builds the tree over `inside`; also returns its primitives in the order of the leaves.
    pub(super) fn build(shapes: &[Shape], division: &Division) -> Option<(Self, Vec<u32>)> {
        let (frame, inside) = (division.frame?, &division.inside);
        let boxes = || build::boxes(shapes, inside, &frame);
        let kinds: Vec<Kind> = inside.par_iter().map(|k| Kind::of(&shapes[*k as usize])).collect();
        let meshes = kinds.iter().take(64).any(|kind| *kind == Kind::Triangle);
        let mut wide = collapse(build::binary(boxes(), meshes), &kinds);
        if wide.depth > MAX_DEPTH {
            wide = collapse(build::balanced(&boxes()), &kinds);
        }
        let order: Vec<u32> = wide.order.iter().map(|k| inside[*k as usize]).collect();
        let shape = |place: u32| &shapes[order[place as usize] as usize];
        let spheres = Spheres::new(&wide.sphere_runs, frame.pad(), |place| {
            let Shape::Sphere(s) = shape(place) else { unreachable!("a leaf of spheres") };
            (frame.point(s.center()), frame.length(s.radius()))
        });
        let triangles = Triangles::new(&wide.triangle_runs, frame.coarseness(), |place| {
            corners_of(shape(place)).map(|v| frame.point(v))
        });
        let places = wide.triangle_runs.first().zip(wide.triangle_runs.last());
        let places = places.map_or(0..0, |(a, b)| a.places().start..b.places().end);
        let mut corners = huge::vec_with_capacity(places.len());
        let numbers = order[places].par_iter();
        numbers.map(|k| corners_of(&shapes[*k as usize])).collect_into_vec(&mut corners);
        let mut nodes = huge::vec_with_capacity(wide.nodes.len());
        nodes.append(&mut wide.nodes);
        let tree = Self { frame, root: wide.root, nodes, spheres, triangles, corners };
        Some((tree, order))
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

    /// Asks for the memory of a child that is visited later, if it is a node; for a single ray, to do so for leaves, too, was slower.
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
