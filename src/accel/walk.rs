//! The way of a ray through the tree.
#![allow(
    unsafe_code,
    reason = "the stack is not initialised for every ray, which took a fifth of the time"
)]

use std::mem::MaybeUninit;

use super::{
    frame::TreeRay,
    node::{Child, Content, Node, WIDTH},
    simd::{Simd, bits},
    tree::Tree,
};

/// The most nodes from the root to a leaf; the builder keeps to it.
pub(super) const MAX_DEPTH: usize = 36;

/// Each node on the way down leaves at most all but one of its children to be visited later.
const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// What is to be done at the leaves.
pub(super) trait Visitor<S: Simd> {
    /// The parameter in the tree's frame beyond which nothing is of interest.
    fn limit(&self) -> f32;

    /// Tries the primitives of a leaf; returns whether to stop. Must be `#[inline(always)]`.
    fn leaf(&mut self, simd: S, leaf: Content) -> bool;
}

/// A ray made ready for the tests of boxes.
#[derive(Clone, Copy)]
struct Slabs<S: Simd> {
    inverse: [S::F; 3],
    /// The origin times that.
    offset: [S::F; 3],
    /// Whether the ray meets the larger coordinate first; as truth values, so that rows found by them are known to
    /// exist.
    backward: [bool; 3],
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(simd: S, ray: &TreeRay) -> Self {
        let inverse = ray.inverse();
        let [o, i] = [ray.origin, inverse];
        let backward = i.map(f32::is_sign_negative);
        let offset = [simd.splat(o[0] * i[0]), simd.splat(o[1] * i[1]), simd.splat(o[2] * i[2])];
        let inverse = [simd.splat(i[0]), simd.splat(i[1]), simd.splat(i[2])];
        Self { inverse, offset, backward }
    }

    /// Which children of `node` the ray may meet before `limit`, and where it enters each.
    ///
    /// A product and a difference with one rounding (or two, in the portable version), of numbers whose error the pads
    /// cover; the inverse is finite, so nothing here is NaN.
    #[inline(always)]
    fn test(&self, simd: S, node: &Node, limit: f32) -> (u32, S::F) {
        let (planes, i, o) = (&node.planes, &self.inverse, &self.offset);
        let [x, y, z] = self.backward.map(|b| if b { 3 } else { 0 });
        let enter_x = simd.mul_sub(simd.load(&planes[x]), i[0], o[0]);
        let enter_y = simd.mul_sub(simd.load(&planes[1 + y]), i[1], o[1]);
        let enter_z = simd.mul_sub(simd.load(&planes[2 + z]), i[2], o[2]);
        let leave_x = simd.mul_sub(simd.load(&planes[3 - x]), i[0], o[0]);
        let leave_y = simd.mul_sub(simd.load(&planes[4 - y]), i[1], o[1]);
        let leave_z = simd.mul_sub(simd.load(&planes[5 - z]), i[2], o[2]);
        let enter = simd.max(simd.max(enter_x, enter_y), simd.max(enter_z, simd.splat(0.0)));
        let leave = simd.min(simd.min(leave_x, leave_y), simd.min(leave_z, simd.splat(limit)));
        (simd.le(enter, leave), enter)
    }
}

/// Children still to be visited, each with the parameter at which the ray enters it: the parameter's bits above the
/// child's word, so that of two (not negative) entries the nearer is the smaller number.
///
/// How many they are is a variable by itself, which the compiler keeps in a register; beside the slots it would be in memory.
struct Stack<'s> {
    slots: &'s mut [MaybeUninit<u64>; STACK],
    len: usize,
}

impl Stack<'_> {
    #[inline(always)]
    fn push(&mut self, key: u64) {
        self.slots[self.len].write(key);
        self.len += 1;
    }

    #[inline(always)]
    fn get(&self, k: usize) -> u64 {
        assert!(k < self.len);
        // SAFETY: every slot below `len` has been written, by `push` alone does `len` grow.
        unsafe { self.slots[k].assume_init() }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<u64> {
        let last = self.len.checked_sub(1)?;
        let key = self.get(last);
        self.len = last;
        Some(key)
    }

    /// Moves the key at the top down past the smaller ones that were pushed since the stack had `base` keys.
    #[inline(always)]
    fn sink(&mut self, base: usize) {
        let mut k = self.len - 1;
        let key = self.get(k);
        while k > base && self.get(k - 1) < key {
            self.slots[k].write(self.get(k - 1));
            k -= 1;
        }
        self.slots[k].write(key);
    }
}

#[inline(always)]
fn key(enter: f32, child: Child) -> u64 {
    u64::from(enter.to_bits()) << 32 | u64::from(child.word())
}

/// Shows `visitor` the leaves that `ray` may meet; with `SORTED`, nearer ones first as far as the boxes tell.
#[inline(always)]
pub(super) fn walk<S: Simd, const SORTED: bool>(
    simd: S,
    tree: &Tree,
    ray: &TreeRay,
    visitor: &mut impl Visitor<S>,
) {
    if !(visitor.limit() >= 0.0) {
        return;
    }
    let slabs = Slabs::new(simd, ray);
    let mut slots = [const { MaybeUninit::uninit() }; STACK];
    let mut stack = Stack { slots: &mut slots, len: 0 };
    let mut child = tree.root;
    loop {
        if let Content::Node(k) = child.content() {
            let node = &tree.nodes[k];
            #[cfg(feature = "leaf-study")]
            super::study::count_node();
            let (mut met, enter) = slabs.test(simd, node, visitor.limit());
            if met != 0 {
                let first = (met.trailing_zeros() & 7) as usize;
                met &= met - 1;
                if met == 0 {
                    child = node.children[first];
                    continue;
                }
                let enter = simd.store(enter).0;
                let second = (met.trailing_zeros() & 7) as usize;
                met &= met - 1;
                let a = key(enter[first], node.children[first]);
                let b = key(enter[second], node.children[second]);
                if met == 0 {
                    stack.push(a.max(b));
                    tree.prefetch_node(simd, Child::from_word(a.max(b) as u32));
                    child = Child::from_word(a.min(b) as u32);
                    continue;
                }
                let base = stack.len;
                stack.push(a.max(b));
                stack.push(a.min(b));
                tree.prefetch_node(simd, node.children[first]);
                tree.prefetch_node(simd, node.children[second]);
                for next in bits(met) {
                    stack.push(key(enter[next], node.children[next]));
                    tree.prefetch_node(simd, node.children[next]);
                    if SORTED {
                        stack.sink(base);
                    }
                }
            }
        } else if visitor.leaf(simd, child.content()) {
            return;
        }
        loop {
            let Some(key) = stack.pop() else { return };
            if f32::from_bits((key >> 32) as u32) <= visitor.limit() {
                child = Child::from_word(key as u32);
                break;
            }
        }
    }
}
