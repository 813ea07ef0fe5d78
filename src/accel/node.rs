//! The nodes of the tree: eight boxes side by side, so that one instruction tests a plane of each.

use std::ops::Range;

/// The most children of a node, and the most primitives of a leaf.
pub(super) const WIDTH: usize = 8;

/// Eight boxes in single precision and what is in them.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// The smallest x, y, z, then the largest, of each child. A child that is not there has an inside-out box, which no
    /// ray meets.
    pub(super) planes: [[f32; WIDTH]; 6],
    /// What the boxes hold.
    pub(super) children: [Child; WIDTH],
}

/// What a box holds: a kind in the upper two bits, for a leaf of several how many in the next three, and where in the
/// others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct Child(u32);

/// Some consecutive primitives, at least one and at most [`WIDTH`], in the order of the leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    /// The place of the first.
    pub(super) first: u32,
    /// How many.
    pub(super) count: u32,
}

impl Run {
    pub(super) fn places(self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// A [`Child`] taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// A node.
    Node(usize),
    /// Spheres.
    Spheres(Run),
    /// Triangles.
    Triangles(Run),
    /// One primitive of any kind, by its place.
    One(usize),
}

impl Child {
    const PLACE_BITS: u32 = 27;
    const PLACE: u32 = (1 << Self::PLACE_BITS) - 1;

    /// The most things that can be told apart.
    pub(super) const LIMIT: usize = Self::PLACE as usize;

    /// Nothing; never met.
    pub(super) const NONE: Self = Self(Self::PLACE);

    pub(super) fn new(content: Content) -> Self {
        let (tag, count, place) = match content {
            Content::Node(k) => (0, 1, k as u32),
            Content::Spheres(Run { first, count }) => (1, count, first),
            Content::Triangles(Run { first, count }) => (2, count, first),
            Content::One(k) => (3, 1, k as u32),
        };
        debug_assert!(place < Self::PLACE, "the builder limits the number of primitives");
        Self(tag << 30 | (count - 1) << Self::PLACE_BITS | place)
    }

    #[inline(always)]
    pub(super) fn content(self) -> Content {
        let first = self.0 & Self::PLACE;
        let run = Run { first, count: (self.0 >> Self::PLACE_BITS & 7) + 1 };
        match self.0 >> 30 {
            0 => Content::Node(first as usize),
            1 => Content::Spheres(run),
            2 => Content::Triangles(run),
            _ => Content::One(first as usize),
        }
    }

    /// As a word for the traversal stack.
    #[inline(always)]
    pub(super) fn word(self) -> u32 {
        self.0
    }

    /// The child with this word.
    #[inline(always)]
    pub(super) fn from_word(word: u32) -> Self {
        Self(word)
    }
}

impl Node {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Child::NONE; WIDTH],
    };

    /// Puts `child` with its box into a slot.
    pub(super) fn set(&mut self, slot: usize, (min, max): ([f32; 3], [f32; 3]), child: Child) {
        for axis in 0..3 {
            self.planes[axis][slot] = min[axis];
            self.planes[axis + 3][slot] = max[axis];
        }
        self.children[slot] = child;
    }
}
