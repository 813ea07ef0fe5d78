//! The tree over the primitives that have one.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    build,
    collapse::{Kind, Run, Wide, collapse},
    frame::Frame,
    huge,
    leaf::{Spheres, Triangles},
    node::{Child, Content, Node},
    walk::MAX_DEPTH,
};
use crate::geometry::Shape;

/// The nodes of the tree over the primitives `inside`, and their order.
pub(super) fn arrange(shapes: &[Shape], inside: &[u32], frame: &Frame) -> Wide {
    let boxes = || build::boxes(shapes, inside, frame);
    let kinds: Vec<Kind> = inside.par_iter().map(|k| Kind::of(&shapes[*k as usize])).collect();
    let meshes = kinds.iter().take(64).any(|kind| *kind == Kind::Triangle);
    let wide = collapse(&build::binary(boxes(), meshes), &kinds);
    let mut wide =
        if wide.depth > MAX_DEPTH { collapse(&build::balanced(&boxes()), &kinds) } else { wide };
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
    pub(super) spheres: Vec<Spheres>,
    pub(super) triangles: Vec<Triangles>,
    /// The corners of the triangles, exactly, in the order of the leaves.
    pub(super) corners: Vec<[DVec3; 3]>,
}

impl Tree {
    /// The tree whose nodes are those of `wide`, over `shapes` in its order.
    pub(super) fn new(wide: Wide, frame: Frame, shapes: &[Shape]) -> Self {
        let leaves = Leaves { shapes, frame: &frame };
        let corners = leaves.corners(&wide.triangle_runs);
        Self {
            spheres: leaves.spheres(&wide.sphere_runs),
            triangles: leaves.triangles(&wide.triangle_runs, &corners),
            corners,
            frame,
            root: wide.root,
            nodes: wide.nodes,
        }
    }

    /// The memory of nodes and leaves, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let leaves = size_of_val(self.spheres.as_slice()) + size_of_val(self.triangles.as_slice());
        size_of_val(self.nodes.as_slice()) + leaves + size_of_val(self.corners.as_slice())
    }

    /// The places of a leaf's primitives.
    pub(super) fn places(&self, leaf: Content) -> Range<usize> {
        let (first, count) = match leaf {
            Content::Node(_) => (0, 0),
            Content::Spheres(k) => (self.spheres[k].first, self.spheres[k].count),
            Content::Triangles(k) => (self.triangles[k].first, self.triangles[k].count),
            Content::One(k) => (k as u32, 1),
        };
        first as usize..(first + count) as usize
    }
}

/// What the leaves are made from.
struct Leaves<'a> {
    /// The primitives in the tree's order.
    shapes: &'a [Shape],
    frame: &'a Frame,
}

impl Leaves<'_> {
    fn spheres(&self, runs: &[Run]) -> Vec<Spheres> {
        let mut blocks = huge::vec_with_capacity(runs.len());
        runs.par_iter().map(|run| self.sphere_block(*run)).collect_into_vec(&mut blocks);
        blocks
    }

    fn sphere_block(&self, run: Run) -> Spheres {
        let mut block = Spheres::new(run.first);
        for shape in &self.shapes[run.places()] {
            if let Shape::Sphere(s) = shape {
                let (center, radius) =
                    (self.frame.point(s.center()), self.frame.length(s.radius()));
                block.push(center.to_array(), radius, self.frame.pad());
            }
        }
        block
    }

    /// The corners of the triangles of all runs.
    fn corners(&self, runs: &[Run]) -> Vec<[DVec3; 3]> {
        let places: Vec<u32> = runs.iter().flat_map(|run| run.places()).map(|k| k as u32).collect();
        let mut corners = huge::vec_with_capacity(places.len());
        places
            .par_iter()
            .map(|place| corners_of(&self.shapes[*place as usize]))
            .collect_into_vec(&mut corners);
        corners
    }

    /// The blocks of all runs, whose triangles have these `corners`.
    fn triangles(&self, runs: &[Run], corners: &[[DVec3; 3]]) -> Vec<Triangles> {
        let block = |run: &Run, start: u32| {
            let mut block = Triangles::new(run.first, start);
            for corners in &corners[start as usize..][..run.count as usize] {
                block.push(corners.map(|v| self.frame.point(v)), self.frame.coarseness());
            }
            block
        };
        let starts = runs.iter().scan(0, |end, run| {
            let start = *end;
            *end += run.count;
            Some(start)
        });
        let starts: Vec<u32> = starts.collect();
        let mut blocks = huge::vec_with_capacity(runs.len());
        runs.par_iter()
            .zip(&starts)
            .map(|(run, start)| block(run, *start))
            .collect_into_vec(&mut blocks);
        blocks
    }
}

/// The corners of a triangle.
fn corners_of(shape: &Shape) -> [DVec3; 3] {
    match shape {
        Shape::Triangle(t) => t.vertices(),
        Shape::Face(f) => f.vertices(),
        _ => unreachable!("blocks of triangles hold nothing else"),
    }
}
