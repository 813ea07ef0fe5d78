//! Rays side by side: up to 64 in columns, one for each component, so that a loop over the lanes is one over vectors.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

use super::{
    hit::{Hit, Surface},
    ray::{Departure, Ray},
    shape::Shape,
};

/// The most rays side by side.
pub const LANES: usize = 64;

/// A number for each lane.
pub type Column = [f64; LANES];

/// A vector for each lane, component by component.
#[derive(Clone, Debug)]
pub struct Vectors([Column; 3]);

impl Vectors {
    /// Zero in all lanes.
    pub const ZERO: Self = Self([[0.0; LANES]; 3]);

    /// The vector of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> DVec3 {
        let [x, y, z] = &self.0;
        DVec3::new(x[lane], y[lane], z[lane])
    }

    /// Replaces the vector of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: DVec3) {
        let [x, y, z] = &mut self.0;
        (x[lane], y[lane], z[lane]) = (v.x, v.y, v.z);
    }

    /// Replaces the vector of a lane if it `is_wanted`; without a branch, for loops over lanes.
    #[inline(always)]
    pub(super) fn set_if(&mut self, lane: usize, is_wanted: bool, v: DVec3) {
        let [x, y, z] = &mut self.0;
        x[lane] = if is_wanted { v.x } else { x[lane] };
        y[lane] = if is_wanted { v.y } else { y[lane] };
        z[lane] = if is_wanted { v.z } else { z[lane] };
    }

    /// The components along an axis.
    #[inline(always)]
    pub fn axis(&self, axis: usize) -> &Column {
        &self.0[axis]
    }
}

/// The surfaces that the rays of all lanes leave, on the sides that other rays came from.
#[derive(Clone, Copy, Debug)]
pub struct Departures<'a> {
    /// Which they are.
    pub hits: &'a HitLanes,
    /// Where they are left.
    pub surfaces: &'a SurfaceLanes,
}

/// Rays side by side, some lanes of which are in use.
#[derive(Clone, Copy, Debug)]
pub struct RayLanes<'a> {
    /// Where they start.
    pub origin: &'a Vectors,
    /// Where they go.
    pub dir: &'a Vectors,
    /// The surfaces that they leave, if they do.
    pub from: Option<Departures<'a>>,
    /// A bit for each lane that is in use; the others may hold anything.
    pub used: u64,
}

impl RayLanes<'_> {
    /// The ray of a lane, as far as crossings depend on it: a departure has no more than its local point.
    #[inline(always)]
    pub fn ray(&self, lane: usize) -> Ray {
        let from = self.from.map(|from| Departure {
            primitive: from.hits.primitive[lane],
            face: from.hits.face[lane],
            inward: from.surfaces.is_inside(lane),
            local: from.surfaces.local.get(lane),
            point: DVec3::ZERO,
            point_rest: DVec3::ZERO,
        });
        Ray { origin: self.origin.get(lane), dir: self.dir.get(lane), from }
    }

    /// The ray of a lane as if it left no surface.
    #[inline(always)]
    pub fn plain_ray(&self, lane: usize) -> Ray {
        Ray { origin: self.origin.get(lane), dir: self.dir.get(lane), from: None }
    }

    /// The lanes whose rays leave `primitive`, a bit for each.
    #[inline(always)]
    pub fn leaving(&self, primitive: u32) -> u64 {
        let Some(from) = self.from else { return 0 };
        let leave = |k: usize| u64::from(from.hits.primitive[k] == primitive) << k;
        (0..LANES).fold(0, |lanes, k| lanes | leave(k)) & self.used
    }
}

/// The lanes of a set of bits, in ascending order.
#[inline(always)]
pub fn lanes(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// The groups of eight lanes from the first to the last of a set.
#[inline(always)]
pub fn hull(bits: u64) -> Range<usize> {
    const GROUP: usize = 8;
    let first = (bits.trailing_zeros() as usize).min(LANES) / GROUP * GROUP;
    let last = LANES - bits.leading_zeros() as usize;
    first..last.next_multiple_of(GROUP).min(LANES)
}

/// The nearest hits of rays side by side.
#[derive(Clone, Debug)]
pub struct HitLanes {
    /// The ray's parameter; infinite where nothing is hit.
    pub t: Column,
    /// Which primitive.
    pub primitive: [u32; LANES],
    /// Which of its faces, as in [`Hit::face`](super::Hit::face).
    pub face: [u8; LANES],
}

impl HitLanes {
    /// No hit.
    pub const NONE: Self =
        Self { t: [f64::INFINITY; LANES], primitive: [0; LANES], face: [0; LANES] };

    /// The hit of a lane that has one.
    #[inline(always)]
    pub fn get(&self, k: usize) -> Hit {
        Hit { t: self.t[k], primitive: self.primitive[k], face: self.face[k] }
    }

    /// Replaces the hit of a lane.
    #[inline(always)]
    pub fn set(&mut self, k: usize, hit: &Hit) {
        (self.t[k], self.primitive[k], self.face[k]) = (hit.t, hit.primitive, hit.face);
    }

    /// The lanes that have a hit, and maybe some that are not in use.
    #[inline(always)]
    pub fn found(&self) -> u64 {
        (0..LANES).fold(0, |all, k| all | u64::from(self.t[k] < f64::INFINITY) << k)
    }

    /// The first of some lanes and those that hit the same primitive; it alone if the second does not.
    #[inline(always)]
    pub fn alike(&self, some: u64) -> u64 {
        let first = some & some.wrapping_neg();
        let others = some & !first;
        let primitive = |lane: u64| self.primitive[lane.trailing_zeros() as usize % LANES];
        let own = primitive(first);
        if others == 0 || primitive(others) != own {
            return first;
        }
        some & (0..LANES).fold(0, |all, k| all | u64::from(self.primitive[k] == own) << k)
    }
}

/// The surfaces that rays side by side hit, as far as rays that go on from there depend on them.
#[derive(Clone, Debug)]
pub struct SurfaceLanes {
    /// As in [`Surface`].
    pub point: Vectors,
    /// As in [`Surface`].
    pub local: Vectors,
    /// As [`Surface::shading`], but on the side that the ray came from.
    pub facing: Vectors,
    /// Where shadow rays start: beside the point, on the side that the ray came from; over a smooth face, on the curved
    /// surface that its normals describe.
    pub start: Vectors,
    /// 1 if the ray came from the outside, -1 if from the inside.
    pub side: Column,
    /// As in [`Surface`], for surfaces that are asked for them.
    pub uv: [DVec2; LANES],
    /// As in [`Surface`].
    pub tint: [Vec3; LANES],
}

impl SurfaceLanes {
    /// Nothing.
    pub const NONE: Self = Self {
        point: Vectors::ZERO,
        local: Vectors::ZERO,
        facing: Vectors::ZERO,
        start: Vectors::ZERO,
        side: [1.0; LANES],
        uv: [DVec2::ZERO; LANES],
        tint: [Vec3::ONE; LANES],
    };

    /// Whether the ray came from the inside.
    #[inline(always)]
    pub fn is_inside(&self, k: usize) -> bool {
        self.side[k] < 0.0
    }

    /// As [`Surface::shading`].
    #[inline(always)]
    pub(super) fn shading(&self, k: usize) -> DVec3 {
        self.facing.get(k) * self.side[k]
    }

    /// Replaces the surface of a lane, if it `is_wanted`, by one that a ray along `dir` met, but for its own
    /// coordinates and its tint.
    #[inline(always)]
    pub(super) fn set_if(&mut self, k: usize, is_wanted: bool, surface: &Surface, dir: DVec3) {
        let inside = surface.is_met_from_inside(dir);
        let side = if inside { -1.0 } else { 1.0 };
        self.point.set_if(k, is_wanted, surface.point);
        self.local.set_if(k, is_wanted, surface.local);
        self.facing.set_if(k, is_wanted, surface.shading * side);
        self.start.set_if(k, is_wanted, surface.beside(inside));
        self.side[k] = if is_wanted { side } else { self.side[k] };
    }

    /// Replaces the surface of a lane by one of `shape` that a ray along `dir` met.
    #[inline(always)]
    pub fn set(&mut self, k: usize, shape: &Shape, surface: &Surface, dir: DVec3) {
        self.set_if(k, true, surface, dir);
        let offset = shape.shadow_offset(surface, self.is_inside(k));
        if offset != DVec3::ZERO {
            self.start.set(k, self.start.get(k) + offset);
        }
        (self.uv[k], self.tint[k]) = (surface.uv, surface.tint);
    }
}
