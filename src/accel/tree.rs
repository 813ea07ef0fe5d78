//! The tree over the primitives that have one.

use std::ops::Range;

use super::{
    build::{self, Division},
    collapse::{Kind, Run, collapse},
    frame::Frame,
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
    spheres: Vec<Run>,
    triangles: Vec<Run>,
}

impl Tree {
    /// Builds the tree over `inside`; also returns its primitives in the order of the leaves.
    pub(super) fn build(shapes: &[Shape], division: &Division) -> Option<(Self, Vec<u32>)> {
        let (frame, inside) = (division.frame?, &division.inside);
        let kind = |k: u32| match &shapes[inside[k as usize] as usize] {
            Shape::Sphere(_) => Kind::Sphere,
            Shape::Triangle(_) => Kind::Triangle,
            _ => Kind::Other,
        };
        let boxes = build::boxes(shapes, inside, &frame);
        let meshes = (0..inside.len().min(64) as u32).any(|k| kind(k) == Kind::Triangle);
        let mut wide = collapse(&build::binary(&boxes, meshes), kind);
        if wide.depth > MAX_DEPTH {
            wide = collapse(&build::balanced(&boxes), kind);
        }
        let order = wide.order.iter().map(|k| inside[*k as usize]).collect();
        let tree = Self {
            frame,
            root: wide.root,
            nodes: wide.nodes,
            spheres: wide.sphere_runs,
            triangles: wide.triangle_runs,
        };
        Some((tree, order))
    }

    /// The places of a leaf's primitives.
    #[inline(always)]
    pub(super) fn places(&self, leaf: Content) -> Range<usize> {
        let run = match leaf {
            Content::Node(_) => Run { first: 0, count: 0 },
            Content::Spheres(k) => self.spheres[k],
            Content::Triangles(k) => self.triangles[k],
            Content::One(k) => Run { first: k as u32, count: 1 },
        };
        run.first as usize..(run.first + run.count) as usize
    }
}
