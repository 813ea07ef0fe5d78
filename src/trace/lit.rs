//! The hits of a batch that show their own colour, while the lights are added; a lane for each.

use glam::{DVec2, DVec3};

use super::{
    Batch, shadow,
    shadow::Passed,
    signature::{self, Path},
};
use crate::{
    aa::detail::Detail,
    color::Rgb,
    geometry::lanes::{
        Column, Departures, HitLanes, LANES, RayLanes, SurfaceLanes, Vectors, hull, lanes,
    },
    light::Light,
    material::Material,
    scene::Scene,
    texture::TexturePoint,
};

/// A number in single precision for each lane.
type Singles = [f32; LANES];

/// The inner part of a highlight is at least so bright, its middle being 1.
const INNER: f32 = 0.5;

/// What a hit asks of a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    /// The part of what arrives that is to be scattered.
    pub(super) scattered: f32,
    /// The part that is mirrored to where the hit is seen from.
    pub(super) shine: f32,
    /// Whether that is the inner part of a highlight, of which signatures tell.
    pub(super) is_inner: bool,
}

/// Hits and the light that they get.
#[derive(Debug)]
pub(super) struct Lit {
    /// Whether signatures tell the inner part of a highlight.
    tells_highlights: bool,
    /// The lanes in use.
    lanes: u64,
    pub(super) surfaces: SurfaceLanes,
    path: [u32; LANES],
    /// The light that the texture scatters, and the highlights, channel by channel.
    diffuse: [Singles; 3],
    specular: [Singles; 3],
    /// The materials' weights of the two, and the exponent of the highlights.
    scatter: Singles,
    shine: Singles,
    exponent: Column,
    /// Towards the light at hand: the way from where rays start, the cosine of its angle to the normal, and to the
    /// mirror direction.
    pub(super) toward: Vectors,
    cosine: Column,
    mirrored: Column,
    passed: Passed,
}

impl Lit {
    pub(super) fn new(tells_highlights: bool) -> Self {
        let zero = [0.0; LANES];
        Self {
            tells_highlights,
            lanes: 0,
            surfaces: SurfaceLanes::NONE,
            path: [0; LANES],
            diffuse: [zero; 3],
            specular: [zero; 3],
            scatter: zero,
            shine: zero,
            exponent: [0.0; LANES],
            toward: Vectors::ZERO,
            cosine: [0.0; LANES],
            mirrored: [0.0; LANES],
            passed: Passed::default(),
        }
    }

    pub(super) fn lanes(&self) -> u64 {
        self.lanes
    }

    pub(super) fn clear(&mut self) {
        self.lanes = 0;
    }

    /// Adds the hits of one primitive, whose surfaces are known.
    #[inline(always)]
    pub(super) fn take(&mut self, same: u64, batch: &Batch, material: &Material) {
        self.lanes |= same;
        let shine = if material.specular > 0.0 { material.specular } else { 0.0 };
        for k in lanes(same) {
            let (hits, inside) = (&batch.hits, self.surfaces.is_inside(k));
            self.path[k] =
                batch.tasks[k].path.hit(hits.primitive[k], hits.face[k], inside).signature();
            self.scatter[k] = material.diffuse;
            self.shine[k] = shine;
            self.exponent[k] = material.shininess;
            for channel in 0..3 {
                self.diffuse[channel][k] = material.ambient;
                self.specular[channel][k] = 0.0;
            }
        }
    }

    /// Takes out the hit of a lane.
    pub(super) fn leave_out(&mut self, k: usize) {
        self.lanes &= !(1 << k);
    }

    /// The signature of the hit of a lane so far.
    pub(super) fn signature(&self, k: usize) -> u32 {
        self.path[k]
    }

    /// The corners of the box about where the shadow rays start.
    #[inline(always)]
    pub(super) fn starts(&self) -> [DVec3; 2] {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for axis in 0..3 {
            let column = self.surfaces.start.axis(axis);
            for k in hull(self.lanes) {
                let is_in = self.lanes >> k & 1 != 0;
                let (low, high) = (min[axis], max[axis]);
                min[axis] = if is_in & (column[k] < low) { column[k] } else { low };
                max[axis] = if is_in & (column[k] > high) { column[k] } else { high };
            }
        }
        [min, max].map(DVec3::from_array)
    }

    /// Turns to a light; returns the lanes that face it, hit by rays along `dir`.
    #[inline(always)]
    pub(super) fn face(&mut self, light: &Light, dir: &Vectors) -> u64 {
        let range = hull(self.lanes);
        for k in range.clone() {
            let to_light = (light.position - self.surfaces.point.get(k)).normalize();
            let (facing, dir) = (self.surfaces.facing.get(k), dir.get(k));
            let cosine = facing.dot(to_light);
            self.cosine[k] = cosine;
            // The mirror direction, d − 2 (d·n) n, against the direction of the light.
            self.mirrored[k] = dir.dot(to_light) - 2.0 * dir.dot(facing) * cosine;
            // So that the light is at t = 1.
            self.toward.set(k, light.position - self.surfaces.start.get(k));
        }
        let faces = |k: usize| u64::from(self.cosine[k] > 0.0) << k;
        range.fold(0, |all, k| all | faces(k)) & self.lanes
    }

    /// Adds what arrives of a light at the hits that face it, if nothing opaque is between.
    #[inline(always)]
    pub(super) fn add(&mut self, scene: &Scene, light: &Light, hits: &HitLanes, asked: u64) {
        let from = Some(Departures { hits, surfaces: &self.surfaces });
        let origin = &self.surfaces.start;
        let rays = RayLanes { origin, dir: &self.toward, from, used: asked };
        let seen = asked & !shadow::cast(scene, &rays, light.position, &mut self.passed);
        let clear = seen & !self.passed.lanes();
        let word = signature::light_word(light, 0);
        for k in hull(clear) {
            let is_clear = clear >> k & 1 != 0;
            let path = Path::of(self.path[k]).light(word).signature();
            self.path[k] = if is_clear { path } else { self.path[k] };
            let scattered = self.scatter[k] * self.cosine[k] as f32;
            for (channel, intensity) in self.diffuse.iter_mut().zip(light.intensity.to_array()) {
                let sum = channel[k] + intensity * scattered;
                channel[k] = if is_clear { sum } else { channel[k] };
            }
        }
        for k in lanes(clear) {
            self.add_highlight(k, light.intensity);
        }
        for k in lanes(seen & self.passed.lanes()) {
            let Some((arriving, word)) = self.passed.arriving(scene, light, k) else { continue };
            self.path[k] = Path::of(self.path[k]).light(word).signature();
            let scattered = self.scatter[k] * self.cosine[k] as f32;
            for (channel, arriving) in self.diffuse.iter_mut().zip(arriving.to_array()) {
                channel[k] += arriving * scattered;
            }
            self.add_highlight(k, arriving);
        }
    }

    #[inline(always)]
    fn add_highlight(&mut self, k: usize, arriving: Rgb) {
        let (shine, is_inner) = self.highlight(k);
        if is_inner {
            self.path[k] = Path::of(self.path[k]).highlight().signature();
        }
        if shine > 0.0 {
            for (channel, arriving) in self.specular.iter_mut().zip(arriving.to_array()) {
                channel[k] += arriving * shine;
            }
        }
    }

    /// The part of the light at hand that the hit of a lane mirrors to where it is seen from, if that arrives, and
    /// whether signatures tell that it does.
    #[inline(always)]
    fn highlight(&self, k: usize) -> (f32, bool) {
        if !(self.shine[k] > 0.0 && self.mirrored[k] > 0.0) {
            return (0.0, false);
        }
        let share = self.mirrored[k].powf(self.exponent[k]) as f32;
        (self.shine[k] * share, self.tells_highlights && share > INNER)
    }

    /// The light that the hit of a lane got so far, to be scattered and mirrored.
    #[inline(always)]
    pub(super) fn so_far(&self, k: usize) -> (Rgb, Rgb) {
        let lane = |channels: &[Singles; 3]| Rgb::from_array(channels.each_ref().map(|c| c[k]));
        (lane(&self.diffuse), lane(&self.specular))
    }

    /// What the hit of a lane asks of the light at hand.
    #[inline(always)]
    pub(super) fn wish(&self, k: usize) -> Wish {
        let (shine, is_inner) = self.highlight(k);
        Wish { scattered: self.scatter[k] * self.cosine[k] as f32, shine, is_inner }
    }

    /// What the hit of a lane shows; `uv_across` is how much the surface coordinates change across
    /// what its ray stands for, squared, if that is wanted.
    #[inline(always)]
    pub(super) fn show(&self, k: usize, material: &Material, uv_across: Option<DVec2>) -> Shown {
        let (diffuse, specular) = self.so_far(k);
        let pigment =
            if diffuse == Rgb::ZERO { None } else { self.pigment(k, material, uv_across) };
        shown(diffuse, specular, Path::of(self.path[k]), pigment)
    }

    /// How the hit of a lane scatters light; `None` if all goes through.
    #[inline(always)]
    pub(super) fn pigment(
        &self,
        k: usize,
        material: &Material,
        uv_across: Option<DVec2>,
    ) -> Option<Pigment> {
        if !(material.opacity > 0.0) {
            return None;
        }
        let at = TexturePoint { uv: self.surfaces.uv[k], point: self.surfaces.point.get(k) };
        let (texture, part) = (&material.texture, self.surfaces.tint[k] * material.opacity);
        let (color, cell) = texture.at(&at);
        let mut detail = Detail::default();
        if let Some(across) = uv_across {
            detail = detail.and(texture.detail(at.uv, across) * part.max_element());
            if !material.sends_on() {
                detail = detail.whole();
            }
        }
        Some(Pigment { color: color * part, cell, detail })
    }
}

/// How a hit scatters light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pigment {
    /// The part that it gives back.
    color: Rgb,
    /// A number of the cell of its pattern.
    cell: u32,
    /// As in [`Shown`], if it gets light of 1.
    detail: Detail,
}

/// What a hit adds to its sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) light: Rgb,
    pub(super) signature: u32,
    /// A number of the cell of its pattern.
    pub(super) cell: u32,
    /// What it shows of a picture that is finer than its ray; whole if no ray goes on from it.
    pub(super) detail: Detail,
}

/// What a hit shows that gets so much light to scatter and mirrors so much.
#[inline(always)]
pub(super) fn shown(diffuse: Rgb, specular: Rgb, path: Path, pigment: Option<Pigment>) -> Shown {
    let Some(Pigment { color, cell, detail }) = pigment else {
        let (light, signature) = (specular, path.signature());
        return Shown { light, signature, cell: 0, detail: Detail::default() };
    };
    Shown {
        light: specular + diffuse * color,
        signature: path.cell(cell).signature(),
        cell,
        detail: detail.lit(diffuse),
    }
}
