//! The shapes' own tests in double precision, compiled once for each instruction set rather than into every search.

use std::ops::Range;

use super::{
    simd::{Kernel, Simd},
    tree::Flat,
};
use crate::geometry::{
    Crossing, Ray, Shape,
    hit::Crossings,
    lanes::{Column, RayLanes},
    triangle,
};

/// [`Shape::crossings_of`].
#[inline(always)]
pub(super) fn crossings<S: Simd>(simd: S, shape: &Shape, ray: &Ray, primitive: u32) -> Crossings {
    simd.vectorize(ShapeTest { shape, ray, primitive })
}

struct ShapeTest<'a> {
    shape: &'a Shape,
    ray: &'a Ray,
    primitive: u32,
}

impl Kernel for ShapeTest<'_> {
    type Output = Crossings;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Crossings {
        self.shape.crossings_of(self.ray, self.primitive)
    }
}

/// [`triangle::crossing`], or, of a triangle that is certainly crossed, what comes to the same.
#[inline(always)]
pub(super) fn flat_crossing<S: Simd>(simd: S, flat: &Flat, ray: &Ray, certain: bool) -> Crossing {
    #[cfg(feature = "leaf-study")]
    super::study::count_triangle();
    if certain {
        Crossing::at(flat.plane.parameter(ray.origin, ray.dir))
    } else {
        simd.vectorize(FlatTest { flat, ray })
    }
}

struct FlatTest<'a> {
    flat: &'a Flat,
    ray: &'a Ray,
}

impl Kernel for FlatTest<'_> {
    type Output = Crossing;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Crossing {
        triangle::crossing(&self.flat.corners(), self.ray)
    }
}

/// [`Shape::cross_lanes`].
#[inline(always)]
pub(super) fn cross_lanes<S: Simd>(
    simd: S,
    shape: &Shape,
    rays: &RayLanes,
    lanes: Range<usize>,
    crossed: &mut [Column; 2],
) -> bool {
    simd.vectorize(ShapeLanes { shape, rays, lanes, crossed })
}

struct ShapeLanes<'a> {
    shape: &'a Shape,
    rays: &'a RayLanes<'a>,
    lanes: Range<usize>,
    crossed: &'a mut [Column; 2],
}

impl Kernel for ShapeLanes<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> bool {
        self.shape.cross_lanes(self.rays, self.lanes, self.crossed)
    }
}
