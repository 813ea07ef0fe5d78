//! From a binary tree to one of eight children a node.
//!
//! What becomes a node and what a leaf is decided by the [`plan`](super::plan), whose choices are read back here.

use rayon::prelude::*;

use super::{
    build::{Binary, corners},
    node::{Child, Content, Node, Run, WIDTH},
    plan::{Plans, split},
};
use crate::geometry::Shape;

/// How a primitive may share a leaf: with others of its kind, or not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// In blocks of spheres.
    Sphere,
    /// In blocks of triangles.
    Triangle,
    /// Alone.
    Other,
}

impl Kind {
    pub(super) fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Sphere(_) => Self::Sphere,
            Shape::Triangle(_) | Shape::Face(_) => Self::Triangle,
            _ => Self::Other,
        }
    }
}

/// The wide tree.
pub(super) struct Wide {
    /// The nodes.
    pub(super) nodes: Vec<Node>,
    /// Where to start.
    pub(super) root: Child,
    /// The primitives in the tree's order, as indices of the binary tree: first all spheres, then all triangles, then the
    /// others, and the primitives of a leaf side by side.
    pub(super) order: Vec<u32>,
    /// The leaves of spheres, in that order.
    pub(super) sphere_runs: Vec<Run>,
    /// The leaves of triangles.
    pub(super) triangle_runs: Vec<Run>,
    /// The number of nodes on the longest way down.
    pub(super) depth: usize,
}

/// Plans and builds the wide tree; `kinds` are those of the primitives.
pub(super) fn collapse(binary: Binary, kinds: &[Kind]) -> Wide {
    let plans = Plans::of(&binary, kinds);
    let count = |kind: Kind| kinds.par_iter().filter(|k| **k == kind).count();
    let (spheres, triangles) = (count(Kind::Sphere), count(Kind::Triangle));
    Collapse { binary, plans, next: [0, spheres, spheres + triangles] }.build()
}

struct Collapse {
    binary: Binary,
    plans: Plans,
    /// Where the next sphere, triangle and other primitive goes in the order.
    next: [usize; 3],
}

impl Collapse {
    fn build(mut self) -> Wide {
        let mut wide = Wide {
            nodes: Vec::new(),
            root: Child::NONE,
            order: vec![0; self.binary.indices.len()],
            sphere_runs: Vec::new(),
            triangle_runs: Vec::new(),
            depth: 1,
        };
        if self.plans.get(0).is_leaf {
            wide.root = self.leaf(0, &mut wide);
            return wide;
        }
        wide.root = Child::new(Content::Node(0));
        wide.nodes.push(Node::EMPTY);
        let mut todo = vec![(0_u32, 0_usize, 1_usize)]; // binary node, wide node, depth
        let mut slots = Vec::with_capacity(WIDTH);
        while let Some((from, to, depth)) = todo.pop() {
            wide.depth = wide.depth.max(depth);
            slots.clear();
            self.slots_of(from, &mut slots);
            for (slot, child) in slots.iter().copied().enumerate() {
                let content = if self.plans.get(child).is_leaf {
                    self.leaf(child, &mut wide)
                } else {
                    wide.nodes.push(Node::EMPTY);
                    let place = wide.nodes.len() - 1;
                    todo.push((child, place, depth + 1));
                    Child::new(Content::Node(place))
                };
                let corners = corners(&self.binary.nodes[child as usize]);
                wide.nodes[to].set(slot, corners, content);
            }
        }
        wide
    }

    /// The binary nodes that become the children of the wide node made from `node`.
    fn slots_of(&self, node: u32, slots: &mut Vec<u32>) {
        let mut todo = vec![(node, WIDTH)];
        while let Some((k, mut budget)) = todo.pop() {
            let (node, plan) = (&self.binary.nodes[k as usize], self.plans.get(k));
            if budget < WIDTH {
                while budget > 1 && plan.cost[budget - 1] == plan.cost[budget - 2] {
                    budget -= 1;
                }
            }
            if budget == 1 || node.is_leaf() {
                slots.push(k);
                continue;
            }
            let left = node.first_index;
            let (l, r) = (self.plans.get(left), self.plans.get(left + 1));
            let (_, given) = split(&l, &r, budget);
            todo.push((left + 1, budget - given));
            todo.push((left, given));
        }
    }

    /// Puts the primitives of `node` next in the order, and returns the leaf that holds them.
    fn leaf(&mut self, node: u32, wide: &mut Wide) -> Child {
        let kind = self.plans.get(node).kind;
        let next = &mut self.next[kind as usize];
        let first = *next;
        let mut todo = vec![node];
        while let Some(k) = todo.pop() {
            let node = &self.binary.nodes[k as usize];
            if node.is_leaf() {
                wide.order[*next] = self.binary.indices[node.first_index as usize];
                *next += 1;
            } else {
                todo.extend([node.first_index + 1, node.first_index]);
            }
        }
        let run = Run { first: first as u32, count: (*next - first) as u32 };
        Child::new(match kind {
            Kind::Sphere => {
                wide.sphere_runs.push(run);
                Content::Spheres(run)
            }
            Kind::Triangle => {
                wide.triangle_runs.push(run);
                Content::Triangles(run)
            }
            Kind::Other => Content::One(first),
        })
    }
}
