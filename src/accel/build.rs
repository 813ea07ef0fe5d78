//! From primitives to a binary tree of boxes.
//!
//! obvhs merges neighbouring boxes along a space-filling curve (PLOC) and improves the result by reinsertion. It takes
//! quadratic time where many merges cost exactly the same (equal boxes, or a row of them), so every box it is shown is
//! a little larger than it must be, by a different amount.
//!
//! Sources: Meister & Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction", *IEEE
//! TVCG* 24(3), 2018; "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", *Computer Graphics Forum*
//! 37(2), 2018.

use std::fmt::{self, Display, Formatter};

use glam::{Vec3, Vec3A};
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
    ploc::{PlocBuilder, PlocSearchDistance, SortPrecision},
};
use rayon::prelude::*;

use super::{frame::Frame, huge};
use crate::{geometry::Shape, math::random::SplitMix64};

/// By how much a box may be larger than it must be, relative to its size.
const JITTER: f32 = 1.0 / 1024.0;

/// The boxes of the primitives `inside`, in the frame of the tree.
pub(super) fn boxes(shapes: &[Shape], inside: &[u32], frame: &Frame) -> Vec<Aabb> {
    let mut boxes = huge::vec_with_capacity(inside.len());
    inside
        .par_iter()
        .map(|k| {
            let (min, max) = frame.outer_box(&shapes[*k as usize].bounds());
            let (min, max) = (Vec3A::from_array(min), Vec3A::from_array(max));
            let reach = (max - min).max_element() * JITTER;
            let mut random = SplitMix64::new(u64::from(*k));
            Aabb {
                min: min - point_of_unit_cube(&mut random) * reach,
                max: max + point_of_unit_cube(&mut random) * reach,
            }
        })
        .collect_into_vec(&mut boxes);
    boxes
}

/// Three numbers in `[0, 1)`, of 21 bits each.
fn point_of_unit_cube(random: &mut SplitMix64) -> Vec3A {
    let z = random.next_u64();
    let part = |shift: u32| ((z >> shift) & 0x1f_ffff) as f32 / 2_097_152.0;
    Vec3A::new(part(0), part(21), part(42))
}

/// How much time the build of a tree may take. Every answer is the same; whether a tree that took longer is faster to
/// trace depends on the scene: `whitted study` shows that spheres strewn at random gain nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The least time: a tree as it comes, not improved.
    Fast,
    /// What a picture or two gain by: more, the fewer primitives there are.
    #[default]
    Auto,
    /// As if there were fewer primitives: more than a single picture gives back.
    Thorough,
}

impl Preset {
    /// All there are, from the fastest build to the slowest.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Auto, Self::Thorough];
}

impl Display for Preset {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Fast => "fast",
            Self::Auto => "auto",
            Self::Thorough => "thorough",
        })
    }
}

/// How much obvhs does for a tree.
struct Effort {
    /// How far along the curve each box looks for a partner, after the first passes, which take the next one.
    reach: PlocSearchDistance,
    first_passes: usize,
    /// The share of the nodes that are taken out and put in again where they cost least, in each round.
    reinsertion: &'static [f32],
}

impl Effort {
    /// By [`Preset::Auto`] more for a scene of `meshes` or of few primitives, as long as it takes less time than the
    /// rays of a small picture.
    fn new(preset: Preset, count: usize, meshes: bool) -> Self {
        use Preset::{Auto, Fast, Thorough};
        let (reach, first_passes, reinsertion): (_, _, &[f32]) = match (preset, count) {
            (Fast, _) => (PlocSearchDistance::Minimum, 0, &[]),
            (Auto, 0..=2_000) | (Thorough, 0..=20_000) => {
                (PlocSearchDistance::Medium, 1, &[1.0, 1.0])
            }
            (Auto, 2_001..=20_000) | (Thorough, _) => (PlocSearchDistance::Medium, 3, &[0.05, 0.1]),
            (Auto, _) if meshes => (PlocSearchDistance::Medium, 3, &[0.02]),
            (Auto, _) => (PlocSearchDistance::Minimum, 0, &[0.01]),
        };
        Self { reach, first_passes, reinsertion }
    }
}

/// The binary tree that obvhs builds over `boxes` by `preset`, of a scene of `meshes` or not; the two children of a
/// node are next to each other, the root is first, and a leaf's index is that of its one box.
pub(super) fn binary(boxes: Vec<Aabb>, meshes: bool, preset: Preset) -> Vec<Bvh2Node> {
    let Effort { reach, first_passes, reinsertion } = Effort::new(preset, boxes.len(), meshes);
    let precision = if boxes.len() <= 2_000 { SortPrecision::U128 } else { SortPrecision::U64 };
    let indices = (0..boxes.len() as u32).collect();
    let mut bvh = Bvh2::zeroed(boxes.len());
    let mut builder = PlocBuilder::with_capacity(boxes.len());
    huge::advise(&bvh.nodes);
    huge::advise(&builder.mortons);
    huge::advise(&builder.current_nodes);
    huge::advise(&builder.next_nodes);
    builder.build_with_bvh(&mut bvh, reach, &boxes, indices, precision, first_passes);
    drop((boxes, builder));
    let mut optimizer = ReinsertionOptimizer::default();
    for share in reinsertion {
        optimizer.run(&mut bvh, *share, None);
    }
    bvh.nodes
}

/// A balanced tree over `boxes`, for those of which obvhs makes too deep a tree: each node is cut in the middle of its
/// primitives along its longest side.
pub(super) fn balanced(boxes: &[Aabb]) -> Vec<Bvh2Node> {
    let mut indices: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut todo = vec![(0, 0, boxes.len())];
    while let Some((node, start, end)) = todo.pop() {
        let range = &mut indices[start..end];
        let bounds = range.iter().fold(Aabb::empty(), |all, k| all.union(&boxes[*k as usize]));
        if let [index] = range {
            nodes[node] = Bvh2Node::new(bounds, 1, *index);
            continue;
        }
        let axis = bounds.largest_axis();
        let middle = range.len() / 2;
        let center = |k: &u32| boxes[*k as usize].center()[axis];
        range.select_nth_unstable_by(middle, |a, b| center(a).total_cmp(&center(b)));
        let first = nodes.len();
        nodes.extend([Bvh2Node::default(); 2]);
        nodes[node] = Bvh2Node::new(bounds, 0, first as u32);
        todo.push((first, start, start + middle));
        todo.push((first + 1, start + middle, end));
    }
    nodes
}

/// The corners of a node's box.
pub(super) fn corners(node: &Bvh2Node) -> ([f32; 3], [f32; 3]) {
    (Vec3::to_array(&node.min), Vec3::to_array(&node.max))
}
