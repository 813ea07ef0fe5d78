//! The shapes' own tests in double precision, compiled once for each instruction set rather than into every search.

use std::ops::Range;

use glam::DVec3;

use super::simd::{Kernel, Simd};
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

/// [`triangle::crossing`], or, of a triangle that is certainly crossed, [`triangle::certain_crossing`].
#[inline(always)]
pub(super) fn triangle_crossing<S: Simd>(
    simd: S,
    corners: &[DVec3; 3],
    ray: &Ray,
    certain: bool,
) -> Crossing {
    #[cfg(feature = "leaf-study")]
    super::study::count_triangle();
    if certain {
        simd.vectorize(TriangleTest::<true> { corners, ray })
    } else {
        simd.vectorize(TriangleTest::<false> { corners, ray })
    }
}

struct TriangleTest<'a, const CERTAIN: bool> {
    corners: &'a [DVec3; 3],
    ray: &'a Ray,
}

impl<const CERTAIN: bool> Kernel for TriangleTest<'_, CERTAIN> {
    type Output = Crossing;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Crossing {
        if CERTAIN {
            triangle::certain_crossing(self.corners, self.ray)
        } else {
            triangle::crossing(self.corners, self.ray)
        }
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

/// [`triangle::cross_lanes`].
#[inline(always)]
pub(super) fn triangle_lanes<S: Simd>(
    simd: S,
    corners: &[DVec3; 3],
    rays: &RayLanes,
    lanes: Range<usize>,
    crossed: &mut [Column; 2],
) {
    simd.vectorize(TriangleLanes { corners, rays, lanes, crossed });
}

struct TriangleLanes<'a> {
    corners: &'a [DVec3; 3],
    rays: &'a RayLanes<'a>,
    lanes: Range<usize>,
    crossed: &'a mut [Column; 2],
}

impl Kernel for TriangleLanes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        triangle::cross_lanes(self.corners, self.rays, self.lanes, self.crossed);
    }
}
