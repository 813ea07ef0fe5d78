//! Rays that single precision cannot take: from further than 2²⁸ sizes of the tree, or with a direction that is
//! subnormal or not finite.
//!
//! They walk the same boxes in double precision, with room for the rounding of "origin − centre" that the primitives'
//! own tests make. Rare, so simple rather than fast.

use glam::DVec3;

use super::node::{Child, Content, Node, WIDTH};
use crate::{geometry::Ray, math::scale};

/// The room for roundings, relative to the largest coordinate of the origin.
const ROOM: f64 = 16.0 * f64::EPSILON;

/// Calls `leaf` for every leaf that the ray may meet, until it returns true. `origin` is the ray's in the tree's frame.
pub(super) fn walk(
    nodes: &[Node],
    root: Child,
    ray: &Ray,
    origin: DVec3,
    mut leaf: impl FnMut(Content) -> bool,
) {
    let (dir, _) = scale::normalized(ray.dir);
    let room = origin.abs().max_element() * ROOM;
    // What is not finite finds its answer (a miss) in every primitive.
    let certain = dir.is_finite() && room.is_finite();
    let mut stack = vec![root];
    while let Some(child) = stack.pop() {
        let Content::Node(k) = child.content() else {
            if leaf(child.content()) {
                return;
            }
            continue;
        };
        let node = &nodes[k];
        for slot in (0..WIDTH).filter(|s| node.children[*s] != Child::NONE) {
            let corner = |row: usize| {
                DVec3::from_array([0, 1, 2].map(|a| node.planes[row + a][slot].into()))
            };
            if !certain || may_meet(corner(0) - room - origin, corner(3) + room - origin, dir) {
                stack.push(node.children[slot]);
            }
        }
    }
}

/// Whether the half-line from 0 along `dir` may meet the box.
fn may_meet(min: DVec3, max: DVec3, dir: DVec3) -> bool {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        if dir[axis] == 0.0 {
            if min[axis] > 0.0 || max[axis] < 0.0 {
                return false;
            }
        } else {
            let (a, b) = (min[axis] / dir[axis], max[axis] / dir[axis]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    enter <= leave * (1.0 + ROOM)
}
