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

/// Rays side by side, each of which meets a shape.
#[derive(Clone, Debug)]
pub struct MetLanes {
    /// Where they start.
    pub origin: Vectors,
    /// What rounding took from `origin`.
    pub rest: Vectors,
    /// Where they go.
    pub dir: Vectors,
    /// The parameter where they meet it.
    pub t: Column,
}

impl MetLanes {
    /// None yet.
    pub const NONE: Self =
        Self { origin: Vectors::ZERO, rest: Vectors::ZERO, dir: Vectors::ZERO, t: [0.0; LANES] };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Quad, Sphere, Triangle, hit::first_ahead};
    use crate::math::random::SplitMix64;

    /// Oracle: the surfaces of single rays. A step aside as long as these decides between hit and miss for some.
    #[test]
    fn surfaces_that_are_met_from_others_are_those_of_single_rays() {
        let [a, b] = [DVec3::new(1.0, 0.2, 0.1), DVec3::new(-0.3, 0.4, 1.0)];
        let shapes: [Shape; 3] = [
            Sphere::try_new(DVec3::splat(0.1), 0.7).expect("a sphere").into(),
            Quad::try_new(DVec3::splat(-0.4), a, b).expect("a quad").into(),
            Triangle::try_new([DVec3::splat(-0.4), a, b]).expect("a triangle").into(),
        ];
        let mut random = SplitMix64::new(5);
        let mut vector =
            || DVec3::from_array(std::array::from_fn(|_| 2.0 * random.uniform() - 1.0));
        for shape in &shapes {
            let (mut met, mut beside, mut lanes) = (MetLanes::NONE, Vectors::ZERO, 0_u64);
            let mut expected = Vec::new();
            while expected.len() < LANES / 2 {
                let (point, aside) = (vector() * 4.0, vector() * 0.8);
                let (primitive, local, point_rest) = (1, point, vector() * 1e-17);
                let from =
                    Departure { primitive, face: 0, inward: false, local, point, point_rest };
                let ray =
                    Ray { from: Some(from), ..Ray::new(point + aside, vector() * 0.8 - point) };
                let Some(crossing) = first_ahead(&shape.crossings_of(&ray, 0), f64::INFINITY)
                else {
                    continue;
                };
                let hit = Hit { t: crossing.t, primitive: 0, face: crossing.face };
                let k = 2 * expected.len(); // every second lane
                (met.t[k], lanes) = (hit.t, lanes | 1 << k);
                met.origin.set(k, point);
                met.rest.set(k, point_rest);
                met.dir.set(k, ray.dir);
                beside.set(k, ray.origin);
                let is_direct = shape.crossings(&Ray::new(point, ray.dir))[0].t.is_finite();
                expected.push((is_direct, shape.surface(&ray, &hit), ray.dir));
            }
            assert!(expected.iter().any(|one| one.0) && !expected.iter().all(|one| one.0));
            let mut surfaces = SurfaceLanes::NONE;
            assert!(shape.meet_directly(&mut met, &beside, lanes));
            assert!(shape.surface_lanes(&met, lanes, true, &mut surfaces));
            for (k, (_, surface, dir)) in expected.iter().enumerate() {
                let mut single = SurfaceLanes::NONE;
                single.set(2 * k, shape, surface, *dir);
                let of = |surfaces: &SurfaceLanes| {
                    let SurfaceLanes { point, local, facing, start, side, uv, .. } = surfaces;
                    let vectors = [point, local, facing, start].map(|v| v.get(2 * k));
                    (vectors, side[2 * k], uv[2 * k])
                };
                assert_eq!(of(&surfaces), of(&single), "{shape:?}, lane {k}");
            }
        }
    }
}
