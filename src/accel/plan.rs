//! The cheapest wide tree that a binary one can be collapsed into.
//!
//! The expected work of a ray is the sum over all nodes and leaves of their surface area times their cost. For each
//! binary node and each number of slots up to seven, the cheapest way to put its primitives into so many slots follows
//! from that of its two children. Subtrees are planned side by side; what comes out does not depend on how.
//!
//! Source: Ylitie, Karras & Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", *High-
//! Performance Graphics* (2017), section 3.1.

use std::{
    collections::VecDeque,
    sync::atomic::{AtomicU32, Ordering::Relaxed},
};

use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::{collapse::Kind, huge, node::WIDTH};

/// The cost of a node's test in units of a leaf's; half or twice of it changed no speed by more than chance.
const NODE_COST: f32 = 1.0;

/// How many subtrees are planned side by side.
const SUBTREES: usize = 64;

/// What the plan knows of a binary node.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    /// The least cost of the node's primitives in at most k + 1 slots.
    pub(super) cost: [f32; WIDTH - 1],
    /// The number of primitives if they may share a leaf, else 0.
    shareable: u8,
    /// What they are if so.
    pub(super) kind: Kind,
    /// Whether a single slot holds a leaf.
    pub(super) is_leaf: bool,
}

/// The plans of all nodes, as words so that subtrees can be planned side by side; each is written once.
pub(super) struct Plans(Vec<[AtomicU32; WIDTH]>);

impl Plans {
    /// Plans the tree; `kinds` are those of the primitives.
    pub(super) fn of(binary: &[Bvh2Node], kinds: &[Kind]) -> Self {
        let unknown = || std::array::from_fn(|_| AtomicU32::new(0));
        let mut plans = huge::vec_with_capacity(binary.len());
        (0..binary.len()).into_par_iter().map(|_| unknown()).collect_into_vec(&mut plans);
        let plans = Self(plans);
        let (top, subtrees) = divided(binary);
        subtrees.par_iter().for_each(|root| plans.plan_subtree(binary, kinds, *root));
        plans.plan(kinds, &top);
        plans
    }

    /// Plans a subtree.
    fn plan_subtree(&self, binary: &[Bvh2Node], kinds: &[Kind], root: u32) {
        // After reinsertion children may come before their parents, so they are visited in an order of its own.
        let (mut order, mut todo) = (Vec::new(), vec![root]);
        while let Some(k) = todo.pop() {
            let step = Step::of(binary, k);
            if !step.is_leaf {
                todo.extend([step.first, step.first + 1]);
            }
            order.push(step);
        }
        self.plan(kinds, &order);
    }

    /// Plans these nodes, the last first.
    fn plan(&self, kinds: &[Kind], steps: &[Step]) {
        for &Step { node, first, area, is_leaf } in steps.iter().rev() {
            let plan = if is_leaf {
                let kind = kinds[first as usize];
                Plan { cost: [area; WIDTH - 1], shareable: 1, kind, is_leaf }
            } else {
                joined(&self.get(first), &self.get(first + 1), area)
            };
            self.set(node, &plan);
        }
    }

    /// The plan of a node.
    pub(super) fn get(&self, node: u32) -> Plan {
        let words = &self.0[node as usize];
        let bits = words[WIDTH - 1].load(Relaxed);
        let kind = match bits >> 8 & 3 {
            0 => Kind::Sphere,
            1 => Kind::Triangle,
            _ => Kind::Other,
        };
        Plan {
            cost: std::array::from_fn(|k| f32::from_bits(words[k].load(Relaxed))),
            shareable: bits as u8,
            kind,
            is_leaf: bits >> 10 & 1 != 0,
        }
    }

    fn set(&self, node: u32, plan: &Plan) {
        let words = &self.0[node as usize];
        for (word, cost) in words.iter().zip(plan.cost) {
            word.store(cost.to_bits(), Relaxed);
        }
        let kind = match plan.kind {
            Kind::Sphere => 0,
            Kind::Triangle => 1,
            Kind::Other => 2,
        };
        let bits = u32::from(plan.shareable) | kind << 8 | u32::from(plan.is_leaf) << 10;
        words[WIDTH - 1].store(bits, Relaxed);
    }
}

/// What is needed of a node to plan it.
struct Step {
    node: u32,
    /// Its first child, or primitive.
    first: u32,
    area: f32,
    is_leaf: bool,
}

impl Step {
    fn of(nodes: &[Bvh2Node], node: u32) -> Self {
        let from = &nodes[node as usize];
        let e = from.max - from.min;
        let area = e.x * e.y + e.y * e.z + e.z * e.x;
        Self { node, first: from.first_index, area, is_leaf: from.is_leaf() }
    }
}

/// Some nodes from the root on, parents first, and the subtrees below them.
fn divided(nodes: &[Bvh2Node]) -> (Vec<Step>, Vec<u32>) {
    let (mut top, mut subtrees) = (Vec::new(), VecDeque::from([0]));
    while subtrees.len() < SUBTREES {
        let Some(k) = subtrees.pop_front() else { break };
        let step = Step::of(nodes, k);
        if !step.is_leaf {
            subtrees.extend([step.first, step.first + 1]);
        }
        top.push(step);
    }
    (top, subtrees.into())
}

/// The plan of a node of this area with these children.
fn joined(left: &Plan, right: &Plan, area: f32) -> Plan {
    let mut least = [f32::INFINITY; WIDTH + 1];
    for l in 1..WIDTH {
        for r in 1..=WIDTH - l {
            let cost = left.cost[l - 1] + right.cost[r - 1];
            least[l + r] = if cost < least[l + r] { cost } else { least[l + r] };
        }
    }
    let together = left.shareable + right.shareable;
    let fits = left.shareable > 0 && right.shareable > 0 && together <= WIDTH as u8;
    let shared = fits && left.kind == right.kind && left.kind != Kind::Other;
    let leaf = if shared { area } else { f32::INFINITY };
    let inner = area * NODE_COST + least[WIDTH];
    let mut cost = [leaf.min(inner); WIDTH - 1];
    for slots in 2..WIDTH {
        cost[slots - 1] = cost[slots - 2].min(least[slots]);
    }
    let shareable = if shared { together } else { 0 };
    Plan { cost, shareable, kind: left.kind, is_leaf: leaf <= inner }
}

/// The least cost of two subtrees in `slots` slots, and how many of them go to the left.
pub(super) fn split(left: &Plan, right: &Plan, slots: usize) -> (f32, usize) {
    (1..slots)
        .map(|k| (left.cost[k - 1] + right.cost[slots - k - 1], k))
        .fold((f32::INFINITY, 1), |best, next| if next.0 < best.0 { next } else { best })
}
