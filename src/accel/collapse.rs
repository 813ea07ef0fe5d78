//! From a binary tree to one of eight children a node.
//!
//! What becomes a node and what a leaf is decided by the [`plan`](super::plan), whose choices are read back here.

use std::{collections::VecDeque, iter};

use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::{
    build::corners,
    huge,
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
    /// The primitives in the tree's order, as the binary tree's leaves count them: first all spheres, then all
    /// triangles, then the others, and the primitives of a leaf side by side.
    pub(super) order: Vec<u32>,
    /// The leaves of spheres, in that order.
    pub(super) sphere_runs: Vec<Run>,
    /// The leaves of triangles.
    pub(super) triangle_runs: Vec<Run>,
    /// The number of nodes on the longest way down.
    pub(super) depth: usize,
}

/// A part of the wide tree, whose numbers count from 0 in it.
struct Part {
    nodes: Vec<Node>,
    root: Child,
    /// The primitives of each kind, as the binary tree's leaves count them.
    order: [Vec<u32>; 3],
    /// The leaves of each kind but the last, by their places among the primitives of that kind.
    runs: [Vec<Run>; 3],
    depth: usize,
    /// Binary nodes that are to be looked at, and the slots that they may take; only while a node or a leaf is made.
    todo: Vec<(u32, usize)>,
}

impl Part {
    fn new() -> Self {
        let (order, runs, todo) = Default::default();
        Self { nodes: Vec::new(), root: Child::NONE, order, runs, depth: 1, todo }
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
        let mut top = Part::new();
        if self.plans.get(0).is_leaf {
            top.root = self.leaf(0, &mut top);
            return joined(top, &[], Vec::new());
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
    fn subtree(&self, task: Task) -> Part {
        // Room for more than a subtree mostly needs; what is not used is never there.
        let usual = self.binary.len() / (8 * SUBTREES);
        let mut part = Part { nodes: Vec::with_capacity(usual), ..Part::new() };
        part.nodes.push(Node::EMPTY);
        let mut todo = vec![Task { to: 0, ..task }];
        while let Some(task) = todo.pop() {
            self.make(task, &mut part, |task| todo.push(task));
        }
        part
    }

    /// Makes a node, and tells `next` which ones to make for its children.
    fn make(&self, task: Task, part: &mut Part, mut next: impl FnMut(Task)) {
        part.depth = part.depth.max(task.depth);
        let mut slots = [0; WIDTH];
        let count = self.slots_of(task.from, &mut slots, &mut part.todo);
        for (slot, child) in slots.into_iter().take(count).enumerate() {
            let content = if self.plans.get(child).is_leaf {
                self.leaf(child, part)
            } else {
                part.nodes.push(Node::EMPTY);
                let to = part.nodes.len() - 1;
                next(Task { from: child, to, depth: task.depth + 1 });
                Child::new(Content::Node(to))
            };
            let corners = corners(&self.binary[child as usize]);
            part.nodes[task.to].set(slot, corners, content);
        }
    }

    /// Puts the binary nodes that become the children of the wide node made from `node` into `slots`, and returns how
    /// many they are.
    fn slots_of(&self, node: u32, slots: &mut [u32; WIDTH], todo: &mut Vec<(u32, usize)>) -> usize {
        let mut count = 0;
        todo.push((node, WIDTH));
        while let Some((k, mut budget)) = todo.pop() {
            let (node, plan) = (&self.binary[k as usize], self.plans.get(k));
            if budget < WIDTH {
                while budget > 1 && plan.cost[budget - 1] == plan.cost[budget - 2] {
                    budget -= 1;
                }
            }
            if budget == 1 || node.is_leaf() {
                slots[count] = k;
                count += 1;
                continue;
            }
            let left = node.first_index;
            let (l, r) = (self.plans.get(left), self.plans.get(left + 1));
            let (_, given) = split(&l, &r, budget);
            todo.push((left + 1, budget - given));
            todo.push((left, given));
        }
        count
    }

    /// Puts the primitives of `node` next in the order of their kind, and returns the leaf that holds them.
    fn leaf(&self, node: u32, part: &mut Part) -> Child {
        let kind = self.plans.get(node).kind;
        let order = &mut part.order[kind as usize];
        let first = order.len();
        part.todo.push((node, 1));
        while let Some((k, _)) = part.todo.pop() {
            let node = &self.binary[k as usize];
            if node.is_leaf() {
                order.push(node.first_index);
            } else {
                part.todo.extend([(node.first_index + 1, 1), (node.first_index, 1)]);
            }
        }
        let run = Run { first: first as u32, count: (order.len() - first) as u32 };
        if kind != Kind::Other {
            part.runs[kind as usize].push(run);
        }
        Child::new(match kind {
            Kind::Sphere => Content::Spheres(run),
            Kind::Triangle => Content::Triangles(run),
            Kind::Other => Content::One(first),
        })
    }
}

/// What the numbers of a part are moved by where it is joined to the others.
#[derive(Clone, Copy)]
struct Shift {
    nodes: usize,
    /// By kind.
    places: [usize; 3],
}

impl Shift {
    /// That of the part after `part`; the first node of each has a place in the first part already.
    fn after(self, part: &Part) -> Self {
        Self {
            nodes: self.nodes + part.nodes.len().saturating_sub(1),
            places: std::array::from_fn(|kind| self.places[kind] + part.order[kind].len()),
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
            Content::Spheres(run) => Content::Spheres(self.run(Kind::Sphere, run)),
            Content::Triangles(run) => Content::Triangles(self.run(Kind::Triangle, run)),
            Content::One(k) => Content::One(self.places[Kind::Other as usize] + k),
        })
    }

    fn run(self, kind: Kind, run: Run) -> Run {
        Run { first: run.first + self.places[kind as usize] as u32, ..run }
    }
}

/// The tree of `top` and the `subtrees` of its `tasks`, in their order.
fn joined(top: Part, tasks: &[Task], subtrees: Vec<Part>) -> Wide {
    let parts: Vec<Part> = iter::once(top).chain(subtrees).collect();
    let count = |kind: Kind| parts.iter().map(|part| part.order[kind as usize].len()).sum();
    let (spheres, triangles): (usize, usize) = (count(Kind::Sphere), count(Kind::Triangle));
    let start = Shift { nodes: 0, places: [0, spheres, spheres + triangles] };
    let shifts = parts.iter().scan(start, |next, part| {
        let own = *next;
        *next = own.after(part);
        Some(own)
    });
    let shifts: Vec<Shift> = shifts.collect();
    let runs = |kind: Kind| {
        let of_part = |(part, shift): (&Part, &Shift)| {
            let shift = *shift;
            let runs = part.runs[kind as usize].iter();
            runs.map(move |run| shift.run(kind, *run)).collect::<Vec<Run>>()
        };
        parts.iter().zip(&shifts).flat_map(of_part).collect()
    };
    let of_kind = |kind: usize| parts.iter().flat_map(move |part| part.order[kind].iter().copied());
    Wide {
        nodes: joined_nodes(&parts, &shifts, tasks),
        root: start.child(parts[0].root),
        order: (0..3).flat_map(of_kind).collect(),
        sphere_runs: runs(Kind::Sphere),
        triangle_runs: runs(Kind::Triangle),
        depth: parts.iter().map(|part| part.depth).max().unwrap_or(1),
    }
}

/// The nodes of all parts: those of the first, then those of the others but for their first, which takes its task's
/// place.
fn joined_nodes(parts: &[Part], shifts: &[Shift], tasks: &[Task]) -> Vec<Node> {
    let count = parts.iter().map(|part| part.nodes.len()).sum::<usize>() + 1 - parts.len();
    let mut nodes = huge::vec_with_capacity(count);
    (0..count).into_par_iter().map(|_| Node::EMPTY).collect_into_vec(&mut nodes);
    let (above, mut below) = nodes.split_at_mut(parts[0].nodes.len());
    for (from, to) in parts[0].nodes.iter().zip(&mut *above) {
        *to = shifts[0].node(from);
    }
    let mut copies = Vec::with_capacity(tasks.len());
    for ((part, shift), task) in parts[1..].iter().zip(&shifts[1..]).zip(tasks) {
        above[task.to] = shift.node(&part.nodes[0]);
        let (own, rest) = below.split_at_mut(part.nodes.len() - 1);
        copies.push((&part.nodes[1..], *shift, own));
        below = rest;
    }
    copies.into_par_iter().for_each(|(from, shift, to)| {
        for (from, to) in from.iter().zip(to) {
            *to = shift.node(from);
        }
    });
    nodes
}
