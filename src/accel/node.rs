//! The nodes of the tree: eight boxes side by side, so that one instruction tests a plane of each.

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

/// What a box holds: a kind in the upper two bits and where it is in the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct Child(u32);

/// A [`Child`] taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// A node.
    Node(usize),
    /// A block of spheres.
    Spheres(usize),
    /// A block of triangles.
    Triangles(usize),
    /// One primitive of any kind, by its place in the tree's order.
    One(usize),
}

impl Child {
    const INDEX: u32 = (1 << 30) - 1;

    /// The most things that can be told apart.
    pub(super) const LIMIT: usize = Self::INDEX as usize;

    /// Nothing; never met.
    pub(super) const NONE: Self = Self(Self::INDEX);

    pub(super) fn new(content: Content) -> Self {
        let (tag, index) = match content {
            Content::Node(k) => (0, k),
            Content::Spheres(k) => (1, k),
            Content::Triangles(k) => (2, k),
            Content::One(k) => (3, k),
        };
        debug_assert!(index < Self::LIMIT, "the builder limits the number of primitives");
        Self(tag << 30 | index as u32 & Self::INDEX)
    }

    #[inline(always)]
    pub(super) fn content(self) -> Content {
        let index = (self.0 & Self::INDEX) as usize;
        match self.0 >> 30 {
            0 => Content::Node(index),
            1 => Content::Spheres(index),
            2 => Content::Triangles(index),
            _ => Content::One(index),
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
