//! Which primitive does a ray meet first, and which does it cross on its way to a light?

pub mod brute;

use std::ops::ControlFlow;

use crate::geometry::{Bounds, Crossing, Hit, Ray, Shape};

/// The primitives of a scene, arranged so that a ray finds those it meets without trying all.
#[derive(Debug)]
pub struct Accel {
    shapes: Vec<Shape>,
}

impl Accel {
    /// Arranges `shapes`; a primitive's number is its place in them.
    pub fn build(shapes: Vec<Shape>) -> Self {
        Self { shapes }
    }

    /// The number of primitives.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there is no primitive.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The number of nodes of the tree.
    pub fn node_count(&self) -> usize {
        0
    }

    /// The memory of tree and primitives, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.shapes.as_slice())
    }

    /// The primitive with this number.
    pub fn shape(&self, primitive: u32) -> &Shape {
        &self.shapes[primitive as usize]
    }

    /// The smallest box about all primitives.
    pub fn bounds(&self) -> Bounds {
        self.shapes.iter().fold(Bounds::EMPTY, |b, s| b.union(s.bounds()))
    }

    /// The nearest hit with `0 < t < end`; of equal ones, that of the lowest primitive.
    pub fn nearest(&self, ray: &Ray, end: f64) -> Option<Hit> {
        brute::nearest(&self.shapes, ray, end)
    }

    /// Calls `visit(primitive, crossing)` for every crossing with `0 < t < end`, in no order, until it breaks.
    ///
    /// Returns whether it did.
    pub fn any_crossing(
        &self,
        ray: &Ray,
        end: f64,
        visit: impl FnMut(u32, Crossing) -> ControlFlow<()>,
    ) -> bool {
        brute::any_crossing(&self.shapes, ray, end, visit)
    }
}
