//! The tree over the primitives that have one.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    build::{self, Division},
    collapse::{Kind, Run, collapse},
    frame::Frame,
    leaf::{Spheres, Triangles},
    node::{Child, Content, Node},
    walk::MAX_DEPTH,
};
use crate::geometry::Shape;

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
    /// Builds the tree over `inside`; also returns its primitives in the order of the leaves.
    pub(super) fn build(shapes: &[Shape], division: &Division) -> Option<(Self, Vec<u32>)> {
        let (frame, inside) = (division.frame?, &division.inside);
        let kind = |k: u32| match &shapes[inside[k as usize] as usize] {
            Shape::Sphere(_) => Kind::Sphere,
            Shape::Triangle(_) | Shape::Face(_) => Kind::Triangle,
            _ => Kind::Other,
        };
        let boxes = build::boxes(shapes, inside, &frame);
        let meshes = (0..inside.len().min(64) as u32).any(|k| kind(k) == Kind::Triangle);
        let mut wide = collapse(&build::binary(&boxes, meshes), kind);
        if wide.depth > MAX_DEPTH {
            wide = collapse(&build::balanced(&boxes), kind);
        }
        drop(boxes);
        let order: Vec<u32> = wide.order.iter().map(|k| inside[*k as usize]).collect();
        let leaves = Leaves { shapes, order: &order, frame: &frame };
        let mut starts = vec![0];
        starts.extend(wide.triangle_runs.iter().scan(0, |end, run| {
            *end += run.count;
            Some(*end)
        }));
        let triangles = wide.triangle_runs.par_iter().zip(&starts);
        let of_triangles = wide.triangle_runs.par_iter().map(|run| leaves.shapes_of(*run));
        let tree = Self {
            frame,
            root: wide.root,
            nodes: wide.nodes,
            spheres: wide.sphere_runs.par_iter().map(|run| leaves.spheres(*run)).collect(),
            triangles: triangles.map(|(run, start)| leaves.triangles(*run, *start)).collect(),
            corners: of_triangles.flat_map_iter(|shapes| shapes.map(corners_of)).collect(),
        };
        Some((tree, order))
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
    shapes: &'a [Shape],
    order: &'a [u32],
    frame: &'a Frame,
}

impl Leaves<'_> {
    fn shapes_of(&self, run: Run) -> impl Iterator<Item = &Shape> {
        let places = run.first as usize..(run.first + run.count) as usize;
        self.order[places].iter().map(|k| &self.shapes[*k as usize])
    }

    fn spheres(&self, run: Run) -> Spheres {
        let mut block = Spheres::new(run.first);
        for shape in self.shapes_of(run) {
            if let Shape::Sphere(s) = shape {
                let (center, radius) =
                    (self.frame.point(s.center()), self.frame.length(s.radius()));
                block.push(center.to_array(), radius, self.frame.pad());
            }
        }
        block
    }

    fn triangles(&self, run: Run, corners: u32) -> Triangles {
        let mut block = Triangles::new(run.first, corners);
        for shape in self.shapes_of(run) {
            let corners = corners_of(shape).map(|v| self.frame.point(v));
            block.push(corners, self.frame.coarseness());
        }
        block
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
