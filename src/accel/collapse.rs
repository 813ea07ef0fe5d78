//! From a binary tree to one of eight children a node.
//!
//! What becomes a node and what a leaf is decided by the [`plan`](super::plan), whose choices are read back here.

use std::{collections::VecDeque, ops::Range};

use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::{
    build::corners,
    huge,
    node::{Child, Content, Node, WIDTH},
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
    /// The primitives in the tree's order, as the binary tree's leaves count them.
    pub(super) order: Vec<u32>,
    /// Where each block of spheres starts in the order, and how many there are.
    pub(super) sphere_runs: Vec<Run>,
    /// The same of triangles.
    pub(super) triangle_runs: Vec<Run>,
    /// The number of nodes on the longest way down.
    pub(super) depth: usize,
}

/// Some consecutive primitives in the tree's order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// The first.
    pub(super) first: u32,
    /// How many.
    pub(super) count: u32,
}

impl Wide {
    const NONE: Self = Self {
        nodes: Vec::new(),
        root: Child::NONE,
        order: Vec::new(),
        sphere_runs: Vec::new(),
        triangle_runs: Vec::new(),
        depth: 1,
    };
}

impl Run {
    pub(super) fn places(self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// Plans and builds the wide tree over a binary one, whose primitives are of these `kinds`.
pub(super) fn collapse(binary: &[Bvh2Node], kinds: &[Kind]) -> Wide {
    Collapse { binary, plans: Plans::of(binary, kinds) }.build()
}

/// How many subtrees are built side by side.
const SUBTREES: usize = 64;

struct Collapse<'a> {
    binary: &'a [Bvh2Node],
    plans: Plans,
}

/// A wide node to be made.
#[derive(Clone, Copy)]
struct Task {
    /// The binary node that it is made from.
    from: u32,
    /// Its place.
    to: usize,
    /// The number of nodes on the way down to it, itself included.
    depth: usize,
}

impl Collapse<'_> {
    fn build(&self) -> Wide {
        let mut top = Wide::NONE;
        if self.plans.get(0).is_leaf {
            top.root = self.leaf(0, &mut top);
            return top;
        }
        top.root = Child::new(Content::Node(0));
        top.nodes.push(Node::EMPTY);
        let mut todo = VecDeque::from([Task { from: 0, to: 0, depth: 1 }]);
        while todo.len() < SUBTREES
            && let Some(task) = todo.pop_front()
        {
            self.make(task, &mut top, |task| todo.push_back(task));
        }
        let todo = Vec::from(todo);
        let subtrees = todo.par_iter().map(|task| self.subtree(*task)).collect();
        joined(top, &todo, subtrees)
    }

    /// The tree below a node to be made, which is the first of it.
    fn subtree(&self, task: Task) -> Wide {
        // Room for more than a subtree mostly needs; what is not used is never there.
        let usual = self.binary.len() / (8 * SUBTREES);
        let mut wide = Wide { nodes: Vec::with_capacity(usual), ..Wide::NONE };
        wide.nodes.push(Node::EMPTY);
        let mut todo = vec![Task { to: 0, ..task }];
        while let Some(task) = todo.pop() {
            self.make(task, &mut wide, |task| todo.push(task));
        }
        wide
    }

    /// Makes a node, and tells `next` which ones to make for its children.
    fn make(&self, task: Task, wide: &mut Wide, mut next: impl FnMut(Task)) {
        wide.depth = wide.depth.max(task.depth);
        let mut slots = Vec::with_capacity(WIDTH);
        self.slots_of(task.from, &mut slots);
        for (slot, child) in slots.iter().copied().enumerate() {
            let content = if self.plans.get(child).is_leaf {
                self.leaf(child, wide)
            } else {
                wide.nodes.push(Node::EMPTY);
                let to = wide.nodes.len() - 1;
                next(Task { from: child, to, depth: task.depth + 1 });
                Child::new(Content::Node(to))
            };
            let corners = corners(&self.binary[child as usize]);
            wide.nodes[task.to].set(slot, corners, content);
        }
    }

    /// The binary nodes that become the children of the wide node made from `node`.
    fn slots_of(&self, node: u32, slots: &mut Vec<u32>) {
        let mut todo = vec![(node, WIDTH)];
        while let Some((k, mut budget)) = todo.pop() {
            let (node, plan) = (&self.binary[k as usize], self.plans.get(k));
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
    fn leaf(&self, node: u32, wide: &mut Wide) -> Child {
        let first = wide.order.len();
        let mut todo = vec![node];
        while let Some(k) = todo.pop() {
            let node = &self.binary[k as usize];
            if node.is_leaf() {
                wide.order.push(node.first_index);
            } else {
                todo.extend([node.first_index + 1, node.first_index]);
            }
        }
        let run = Run { first: first as u32, count: (wide.order.len() - first) as u32 };
        let (content, runs): (fn(usize) -> Content, _) = match self.plans.get(node).kind {
            Kind::Other => return Child::new(Content::One(first)),
            Kind::Sphere => (Content::Spheres, &mut wide.sphere_runs),
            Kind::Triangle => (Content::Triangles, &mut wide.triangle_runs),
        };
        runs.push(run);
        Child::new(content(runs.len() - 1))
    }
}

/// What the numbers of a subtree's parts are moved by where it is joined to the others.
#[derive(Clone, Copy)]
struct Shift {
    nodes: usize,
    places: usize,
    spheres: usize,
    triangles: usize,
}

impl Shift {
    /// That of the subtree after `wide`; the first node of each has a place already.
    fn after(self, wide: &Wide) -> Self {
        Self {
            nodes: self.nodes + wide.nodes.len() - 1,
            places: self.places + wide.order.len(),
            spheres: self.spheres + wide.sphere_runs.len(),
            triangles: self.triangles + wide.triangle_runs.len(),
        }
    }

    fn node(self, node: &Node) -> Node {
        Node { planes: node.planes, children: node.children.map(|child| self.child(child)) }
    }

    fn child(self, child: Child) -> Child {
        if child == Child::NONE {
            return child;
        }
        Child::new(match child.content() {
            Content::Node(k) => Content::Node(self.nodes + k),
            Content::Spheres(k) => Content::Spheres(self.spheres + k),
            Content::Triangles(k) => Content::Triangles(self.triangles + k),
            Content::One(k) => Content::One(self.places + k),
        })
    }

    fn run(self, run: Run) -> Run {
        Run { first: run.first + self.places as u32, ..run }
    }
}

/// The tree of `top` and the `subtrees` of its `tasks`, in their order.
fn joined(mut top: Wide, tasks: &[Task], subtrees: Vec<Wide>) -> Wide {
    let count = subtrees.iter().map(|wide| wide.nodes.len() - 1).sum::<usize>() + top.nodes.len();
    let mut nodes = huge::vec_with_capacity(count);
    (0..count).into_par_iter().map(|_| Node::EMPTY).collect_into_vec(&mut nodes);
    let mut shift = Shift { nodes: 0, places: 0, spheres: 0, triangles: 0 }.after(&top);
    let (above, mut below) = nodes.split_at_mut(top.nodes.len());
    above.clone_from_slice(&top.nodes);
    let mut copies = Vec::with_capacity(subtrees.len());
    for (wide, task) in subtrees.into_iter().zip(tasks) {
        let after = shift.after(&wide);
        above[task.to] = shift.node(&wide.nodes[0]);
        let (own, rest) = below.split_at_mut(wide.nodes.len() - 1);
        copies.push((wide.nodes, shift, own));
        top.order.extend(wide.order);
        top.sphere_runs.extend(wide.sphere_runs.into_iter().map(|run| shift.run(run)));
        top.triangle_runs.extend(wide.triangle_runs.into_iter().map(|run| shift.run(run)));
        top.depth = top.depth.max(wide.depth);
        (below, shift) = (rest, after);
    }
    copies.into_par_iter().for_each(|(from, shift, to)| {
        for (from, to) in from[1..].iter().zip(to) {
            *to = shift.node(from);
        }
    });
    Wide { nodes, ..top }
}
