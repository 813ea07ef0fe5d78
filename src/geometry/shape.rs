//! Every shape behind one type, with one `match` for each operation.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

use super::{
    Bounds, Cone, Cylinder, Face, Inward, Polygon, Quad, Similarity, Sphere, Triangle, flat,
    hit::{Crossing, Crossings, Hit, NO_CROSSINGS, Surface, first_ahead},
    lanes::{Column, LANES, MetLanes, RayLanes, SurfaceLanes, Vectors, hull, lanes},
    ray::{Departure, Ray},
    triangle,
};

/// A surface that a ray can meet. The larger shapes are boxed, so that a million spheres or faces of a mesh stay small.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// A circular cylinder.
    Cylinder(Box<Cylinder>),
    /// A circular cone.
    Cone(Box<Cone>),
    /// A parallelogram.
    Quad(Box<Quad>),
    /// A triangle.
    Triangle(Box<Triangle>),
    /// A convex polygon.
    Polygon(Box<Polygon>),
    /// A triangle of a mesh.
    Face(Face),
    /// Any of them, seen from inside only.
    Inward(Box<Inward>),
}

impl Shape {
    /// The smallest axis-aligned box about the shape, up to rounding.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Sphere(s) => s.bounds(),
            Self::Cylinder(s) => s.bounds(),
            Self::Cone(s) => s.bounds(),
            Self::Quad(s) => s.bounds(),
            Self::Triangle(s) => s.bounds(),
            Self::Polygon(s) => s.bounds(),
            Self::Face(s) => s.bounds(),
            Self::Inward(s) => s.bounds(),
        }
    }

    /// The image of the shape under a change of coordinates.
    #[must_use]
    pub fn mapped(&self, map: &Similarity) -> Self {
        match self {
            Self::Sphere(s) => s.mapped(map).into(),
            Self::Cylinder(s) => s.mapped(map).into(),
            Self::Cone(s) => s.mapped(map).into(),
            Self::Quad(s) => s.mapped(map).into(),
            Self::Triangle(s) => s.mapped(map).into(),
            Self::Polygon(s) => s.mapped(map).into(),
            Self::Face(s) => s.mapped(map).into(),
            Self::Inward(s) => s.mapped(map).into(),
        }
    }

    /// Where the line of `ray` crosses the surface, whatever surface it leaves.
    #[inline(always)]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        match self {
            Self::Sphere(s) => s.crossings(ray),
            Self::Cylinder(s) => s.crossings(ray),
            Self::Cone(s) => s.crossings(ray),
            Self::Quad(s) => s.crossings(ray),
            Self::Triangle(s) => s.crossings(ray),
            Self::Polygon(s) => s.crossings(ray),
            Self::Face(s) => s.crossings(ray),
            Self::Inward(s) => s.crossings(ray),
        }
    }

    /// Where a ray that leaves this very shape crosses it again.
    ///
    /// A flat face is not met again; a convex solid only by a ray that goes inward, where its own root of the
    /// equation is known to be zero and the other one needs no subtraction.
    #[inline(always)]
    pub fn crossings_from(&self, ray: &Ray, from: &Departure) -> Crossings {
        match self {
            Self::Sphere(_) => Sphere::crossings_from(ray, from),
            Self::Cylinder(s) => s.crossings_from(ray, from),
            Self::Cone(s) => s.crossings_from(ray, from),
            Self::Inward(s) => s.crossings_from(ray, from),
            Self::Quad(_) | Self::Triangle(_) | Self::Polygon(_) | Self::Face(_) => NO_CROSSINGS,
        }
    }

    /// Where `ray` crosses this shape, if that is number `primitive`, minding where the ray comes from.
    #[inline(always)]
    pub(crate) fn crossings_of(&self, ray: &Ray, primitive: u32) -> Crossings {
        match &ray.from {
            Some(from) if from.primitive == primitive => self.crossings_from(ray, from),
            _ => self.crossings(ray),
        }
    }

    /// The parameters at which the lines of some `lanes` of rays cross the surface, in ascending order, NaN where they
    /// do not, whatever surface they leave.
    ///
    /// Returns false, and does nothing, for shapes that are made for single rays.
    #[inline(always)]
    pub(crate) fn cross_lanes(
        &self,
        rays: &RayLanes,
        lanes: Range<usize>,
        crossed: &mut [Column; 2],
    ) -> bool {
        let lanes = lanes.start.min(LANES)..lanes.end.min(LANES);
        match self {
            Self::Sphere(s) => {
                let ((origin, dir), [first, second]) = ((rays.origin, rays.dir), crossed);
                for k in lanes {
                    (first[k], second[k]) = s.parameters(origin.get(k), dir.get(k));
                }
            }
            Self::Quad(s) => s.cross_lanes(rays, lanes, crossed),
            Self::Triangle(s) => triangle::cross_lanes(&s.vertices(), rays, lanes, crossed),
            Self::Face(s) => triangle::cross_lanes(&s.vertices(), rays, lanes, crossed),
            _ => return false,
        }
        true
    }

    /// The surfaces where the rays of the lanes `met`, from free space or other shapes, meet this shape; their own
    /// coordinates only `with_uv`.
    ///
    /// Returns false, and does nothing, for shapes that are made for single rays.
    #[inline(always)]
    pub(crate) fn surface_lanes(
        &self,
        rays: &MetLanes,
        met: u64,
        with_uv: bool,
        surfaces: &mut SurfaceLanes,
    ) -> bool {
        let MetLanes { origin, rest, dir, t } = rays;
        let plane = match self {
            Self::Sphere(s) => {
                for k in hull(met) {
                    let q = origin.get(k) - s.center() + dir.get(k) * t[k];
                    surfaces.set_if(k, met >> k & 1 != 0, &s.surface_at(q), dir.get(k));
                }
                None
            }
            Self::Quad(s) => Some(s.plane()),
            Self::Triangle(s) => Some(s.plane()),
            _ => return false,
        };
        if let Some(plane) = plane {
            for k in hull(met) {
                let surface = flat::surface(plane, origin.get(k), dir.get(k), t[k], rest.get(k));
                surfaces.set_if(k, met >> k & 1 != 0, &surface, dir.get(k));
            }
        }
        // Lanes keep what was there before, which may be a mesh's.
        for k in lanes(met) {
            surfaces.tint[k] = Vec3::ONE;
            if with_uv {
                surfaces.uv[k] = match self {
                    Self::Sphere(_) => Sphere::uv(surfaces.shading(k)),
                    Self::Quad(s) => s.uv(surfaces.local.get(k)),
                    _ => DVec2::ZERO,
                };
            }
        }
        true
    }

    /// The surface where `ray` meets this shape in `hit`.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let own = ray.from.as_ref().filter(|from| from.primitive == hit.primitive);
        if let (Some(from), None) = (&ray.from, own)
            && let (direct, Some(t)) = self.met_directly(ray, from, hit)
        {
            return self.surface_at(&direct, &Hit { t, ..*hit }, None, from.point_rest);
        }
        self.surface_at(ray, hit, own, DVec3::ZERO)
    }

    /// As [`surface`](Self::surface), for a ray from this shape (`own`) or from its origin plus `rest`.
    #[inline(always)]
    pub(super) fn surface_at(
        &self,
        ray: &Ray,
        hit: &Hit,
        own: Option<&Departure>,
        rest: DVec3,
    ) -> Surface {
        match self {
            Self::Sphere(s) => s.surface(ray, hit.t, own),
            Self::Cylinder(s) => s.surface(ray, hit.t, hit.face, own),
            Self::Cone(s) => s.surface(ray, hit.t, hit.face, own),
            Self::Quad(s) => s.surface(ray, hit.t, rest),
            Self::Triangle(s) => s.surface(ray, hit.t, rest),
            Self::Polygon(s) => s.surface(ray, hit.t, rest),
            Self::Face(s) => s.surface(ray, hit.t, rest),
            Self::Inward(s) => s.surface(ray, hit, own, rest),
        }
    }

    /// The ray from the very point that `ray` leaves, and where it crosses this shape in place of `hit`.
    ///
    /// Nowhere, if the step aside that `ray` starts with makes the difference between hit and miss.
    #[inline(always)]
    fn met_directly(&self, ray: &Ray, from: &Departure, hit: &Hit) -> (Ray, Option<f64>) {
        let direct = Ray::new(from.point, ray.dir);
        let near = |a: &Crossing, b: &Crossing| (a.t - hit.t).abs().total_cmp(&(b.t - hit.t).abs());
        let crossings = self.crossings(&direct);
        let same = crossings.iter().filter(|c| c.face == hit.face && c.t.is_finite());
        (direct, same.min_by(|a, b| near(a, b)).map(|c| c.t))
    }

    /// As [`met_directly`](Self::met_directly), for lanes of rays that start in the very points that they leave: those of
    /// the lanes `met` that do not meet the shape from there are made to start `beside`, where they are known to.
    ///
    /// Returns false, and does nothing, for shapes that are made for single rays.
    #[inline(always)]
    pub(crate) fn meet_directly(&self, rays: &mut MetLanes, beside: &Vectors, met: u64) -> bool {
        let mut crossed = [[f64::NAN; LANES]; 2];
        let direct = RayLanes { origin: &rays.origin, dir: &rays.dir, from: None, used: met };
        if !self.cross_lanes(&direct, hull(met), &mut crossed) {
            return false;
        }
        let [first, second] = &crossed;
        for k in hull(met) {
            let (a, b) = (first[k], second[k]);
            let is_first_nearer = (a - rays.t[k]).abs() <= (b - rays.t[k]).abs();
            let t = if b.is_finite() & !(a.is_finite() & is_first_nearer) { b } else { a };
            let (is_met, is_direct) = (met >> k & 1 != 0, t.is_finite());
            rays.t[k] = if is_met & is_direct { t } else { rays.t[k] };
            rays.origin.set_if(k, is_met & !is_direct, beside.get(k));
            rays.rest.set_if(k, is_met & !is_direct, DVec3::ZERO);
        }
        true
    }

    /// The shape as it is seen from both sides.
    pub(crate) fn both_sided(&self) -> &Self {
        if let Self::Inward(s) = self { s.shape().both_sided() } else { self }
    }

    /// Whether [`Surface::uv`] means anything on this shape.
    pub fn has_uv(&self) -> bool {
        match self.both_sided() {
            Self::Sphere(_) | Self::Quad(_) => true,
            Self::Face(s) => s.has_uv(),
            _ => false,
        }
    }

    /// How the surface coordinates change, per unit of length; not at all on shapes without them. Along the normal that
    /// means nothing.
    #[inline(always)]
    pub(crate) fn uv_gradients(&self) -> [DVec3; 2] {
        match self.both_sided() {
            Self::Sphere(s) => s.uv_gradients(),
            Self::Quad(s) => s.uv_gradients(),
            Self::Face(s) => s.uv_gradients(),
            _ => [DVec3::ZERO; 2],
        }
    }

    /// Where a shadow ray from `surface` should start, measured from the flat point: see [`Face::shadow_offset`].
    #[inline]
    pub(crate) fn shadow_offset(&self, surface: &Surface, inward: bool) -> DVec3 {
        match self.both_sided() {
            Self::Face(s) => s.shadow_offset(surface, inward),
            _ => DVec3::ZERO,
        }
    }

    /// The ends of the axis of a round shape, and the radii there, between which it is within a radius that changes
    /// evenly; flat shapes have none.
    pub(crate) fn axis(&self) -> Option<([DVec3; 2], [f64; 2])> {
        match self.both_sided() {
            Self::Sphere(s) => Some(([s.center(); 2], [s.radius(); 2])),
            Self::Cylinder(s) => Some((s.axis_points(), [s.radius(); 2])),
            Self::Cone(s) => {
                let (top, top_radius) = s.top();
                Some(([s.axis_points()[0], top], [s.radius(), top_radius]))
            }
            _ => None,
        }
    }

    /// Whether the shape is flat and not one of the faces of a mesh.
    pub(crate) fn is_flat_alone(&self) -> bool {
        matches!(self.both_sided(), Self::Quad(_) | Self::Triangle(_) | Self::Polygon(_))
    }

    /// Calls `visit` with every point that defines the shape, whose coordinates a change of origin must carry.
    pub(crate) fn for_each_point(&self, mut visit: impl FnMut(DVec3)) {
        match self {
            Self::Sphere(s) => visit(s.center()),
            Self::Cylinder(s) => s.axis_points().into_iter().for_each(visit),
            Self::Cone(s) => s.axis_points().into_iter().for_each(visit),
            Self::Quad(s) => s.vertices().into_iter().for_each(visit),
            Self::Triangle(s) => s.vertices().into_iter().for_each(visit),
            Self::Polygon(s) => s.vertices().iter().copied().for_each(visit),
            Self::Face(s) => s.vertices().into_iter().for_each(visit),
            Self::Inward(s) => s.shape().for_each_point(visit),
        }
    }

    /// The first hit of a ray with this one shape, both of any scale, and the surface there.
    ///
    /// The direction may have any length; `t` counts it. The shape's number is `primitive`, by which a ray knows
    /// the shape it leaves.
    pub fn first_hit(&self, primitive: u32, ray: &Ray) -> Option<(Hit, Surface)> {
        let reach = self.bounds().largest_coordinate().max(ray.origin.abs().max_element());
        let map = Similarity::scaling(reach);
        let (shape, (ray, rescale)) = (self.mapped(&map), map.ray(ray));
        let crossing = first_ahead(&shape.crossings_of(&ray, primitive), f64::INFINITY)?;
        let hit = Hit { t: crossing.t, primitive, face: crossing.face };
        let surface = map.surface_back(&shape.surface(&ray, &hit));
        Some((Hit { t: rescale.of_hit(hit.t), ..hit }, surface))
    }
}

macro_rules! into_shape {
    ($($shape:ident),*) => { $(
        impl From<$shape> for Shape {
            fn from(shape: $shape) -> Self {
                Self::$shape(shape.into())
            }
        }
    )* };
}
into_shape!(Sphere, Cylinder, Cone, Quad, Triangle, Polygon, Face, Inward);
