//! From a binary tree to one of eight children a node.
//!
//! The expected work of a ray is the sum over all nodes and leaves of their surface area times their cost. For each
//! binary node and each number of slots up to seven, the cheapest way to put its primitives into so many slots follows
//! from that of its two children; a second pass reads the choices back.
//!
//! Source: Ylitie, Karras & Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", *High-
//! Performance Graphics* (2017), section 3.1.

use obvhs::bvh2::node::Bvh2Node;

use super::{
    build::{Binary, corners},
    node::{Child, Content, Node, WIDTH},
};

/// The cost of a node's test in units of a leaf's.
const NODE_COST: f32 = 1.0;

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

/// The wide tree.
pub(super) struct Wide {
    /// The nodes.
    pub(super) nodes: Vec<Node>,
    /// Where to start.
    pub(super) root: Child,
    /// The primitives in the tree's order, as indices of the binary tree.
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

/// What the plan knows of a binary node.
#[derive(Clone, Copy)]
struct Plan {
    /// The least cost of the node's primitives in at most k + 1 slots.
    cost: [f32; WIDTH - 1],
    /// The number of primitives if they may share a leaf, else 0.
    shareable: u8,
    /// What they are if so.
    kind: Kind,
    /// Whether a single slot holds a leaf.
    is_leaf: bool,
}

/// Plans and builds the wide tree; `kind(i)` is the kind of primitive i.
pub(super) fn collapse(binary: &Binary, kind: impl Fn(u32) -> Kind) -> Wide {
    let plans = plan(binary, kind);
    Collapse { binary, plans }.build()
}

fn plan(Binary { nodes, indices }: &Binary, kind: impl Fn(u32) -> Kind) -> Vec<Plan> {
    let unknown = Plan { cost: [0.0; WIDTH - 1], shareable: 0, kind: Kind::Other, is_leaf: false };
    let mut plans = vec![unknown; nodes.len()];
    // After reinsertion children may come before their parents, so they are visited in an order of its own.
    let mut order = Vec::with_capacity(nodes.len());
    let mut todo = vec![0_u32];
    while let Some(k) = todo.pop() {
        order.push(k);
        let node = &nodes[k as usize];
        if !node.is_leaf() {
            todo.extend([node.first_index, node.first_index + 1]);
        }
    }
    for k in order.into_iter().rev() {
        let node = &nodes[k as usize];
        let area = half_area(node);
        plans[k as usize] = if node.is_leaf() {
            let kind = kind(indices[node.first_index as usize]);
            Plan { cost: [area; WIDTH - 1], shareable: 1, kind, is_leaf: true }
        } else {
            let child = node.first_index as usize;
            joined(&plans[child], &plans[child + 1], area)
        };
    }
    plans
}

/// The plan of a node of this area with these children.
fn joined(left: &Plan, right: &Plan, area: f32) -> Plan {
    let together = left.shareable + right.shareable;
    let fits = left.shareable > 0 && right.shareable > 0 && together <= WIDTH as u8;
    let shared = fits && left.kind == right.kind && left.kind != Kind::Other;
    let leaf = if shared { area } else { f32::INFINITY };
    let inner = area * NODE_COST + split(left, right, WIDTH).0;
    let mut cost = [leaf.min(inner); WIDTH - 1];
    for slots in 2..WIDTH {
        cost[slots - 1] = cost[slots - 2].min(split(left, right, slots).0);
    }
    let shareable = if shared { together } else { 0 };
    Plan { cost, shareable, kind: left.kind, is_leaf: leaf <= inner }
}

/// The least cost of two subtrees in `slots` slots, and how many of them go to the left.
fn split(left: &Plan, right: &Plan, slots: usize) -> (f32, usize) {
    (1..slots)
        .map(|k| (left.cost[k - 1] + right.cost[slots - k - 1], k))
        .fold((f32::INFINITY, 1), |best, next| if next.0 < best.0 { next } else { best })
}

fn half_area(node: &Bvh2Node) -> f32 {
    let e = node.max - node.min;
    e.x * e.y + e.y * e.z + e.z * e.x
}

struct Collapse<'a> {
    binary: &'a Binary,
    plans: Vec<Plan>,
}

impl Collapse<'_> {
    fn build(&self) -> Wide {
        let mut wide = Wide {
            nodes: Vec::new(),
            root: Child::NONE,
            order: Vec::with_capacity(self.binary.indices.len()),
            sphere_runs: Vec::new(),
            triangle_runs: Vec::new(),
            depth: 1,
        };
        if self.plans[0].is_leaf {
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
                let content = if self.plans[child as usize].is_leaf {
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
            let (node, plan) = (&self.binary.nodes[k as usize], &self.plans[k as usize]);
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
            let (l, r) = (&self.plans[left as usize], &self.plans[left as usize + 1]);
            let (_, given) = split(l, r, budget);
            todo.push((left + 1, budget - given));
            todo.push((left, given));
        }
    }

    /// Puts the primitives of `node` next in the order, and returns the leaf that holds them.
    fn leaf(&self, node: u32, wide: &mut Wide) -> Child {
        let first = wide.order.len();
        let mut todo = vec![node];
        while let Some(k) = todo.pop() {
            let node = &self.binary.nodes[k as usize];
            if node.is_leaf() {
                wide.order.push(self.binary.indices[node.first_index as usize]);
            } else {
                todo.extend([node.first_index + 1, node.first_index]);
            }
        }
        let run = Run { first: first as u32, count: (wide.order.len() - first) as u32 };
        let (content, runs): (fn(usize) -> Content, _) = match self.plans[node as usize].kind {
            Kind::Other => return Child::new(Content::One(first)),
            Kind::Sphere => (Content::Spheres, &mut wide.sphere_runs),
            Kind::Triangle => (Content::Triangles, &mut wide.triangle_runs),
        };
        runs.push(run);
        Child::new(content(runs.len() - 1))
    }
}
