//! Hits that wait for the lights until they are many.
//!
//! Where many small things are in sight, neighbours in the picture are far from each other in space, and their rays
//! towards a light share no nodes. Among thousands of hits, though, each has others that the light sees in nearly the
//! same direction. So hits are kept, their rays towards each light are brought into the order of a Hilbert curve over
//! the directions from that light (module `order`), and neighbours on it are traced together.
//!
//! What becomes of a hit is, to the bit, what it would be at once.
//!
//! Source: that keeping rays until they are many makes incoherent ones coherent is the idea of Pharr, Kolb, Gershbein &
//! Hanrahan, "Rendering complex scenes with memory-coherent ray tracing", *SIGGRAPH* (1997).

use glam::DVec3;

use super::{
    lit::{Lit, Pigment, Wish, shown},
    order::{Bearing, put_in_order},
    shadow::{self, Passed},
    signature::Path,
    task::{Gathered, Task},
};
use crate::{
    color::Rgb,
    geometry::lanes::{Departures, HitLanes, LANES, RayLanes, SurfaceLanes, Vectors, lanes},
    light::Light,
    scene::Scene,
};

/// About so much memory do hits that wait and their rays take at most.
const MOST_BYTES: usize = 24 << 20;

/// A hit and the light that it got so far.
#[derive(Debug)]
struct Waiting {
    task: Task,
    /// What the surface is, and where shadow rays leave it.
    primitive: u32,
    face: u8,
    inside: bool,
    start: DVec3,
    local: DVec3,
    path: u32,
    diffuse: Rgb,
    specular: Rgb,
    pigment: Option<Pigment>,
}

/// A ray from a hit to a light.
#[derive(Clone, Copy, Debug)]
struct Ask {
    /// Which hit.
    hit: u32,
    wish: Wish,
    /// Where it comes from, seen from the light.
    from: Bearing,
}

/// Hits, and the rays from them to each light.
#[derive(Debug)]
pub(super) struct Wavefront {
    hits: Vec<Waiting>,
    /// The rays to each light.
    asks: Vec<Vec<Ask>>,
    /// The bytes that all these take, and how many make it full.
    bytes: usize,
    most: usize,
    /// Those to one light in the order in which they are traced: the place on the curve, and below it which ray.
    order: Vec<u64>,
    passed: Passed,
    together: Option<Box<Together>>,
}

/// The rays that are traced together, a lane for each.
#[derive(Debug)]
struct Together {
    dir: Vectors,
    hits: HitLanes,
    surfaces: SurfaceLanes,
}

impl Together {
    const NONE: Self =
        Self { dir: Vectors::ZERO, hits: HitLanes::NONE, surfaces: SurfaceLanes::NONE };
}

impl Wavefront {
    pub(super) fn new() -> Self {
        Self {
            hits: Vec::new(),
            asks: Vec::new(),
            bytes: 0,
            most: MOST_BYTES,
            order: Vec::new(),
            passed: Passed::default(),
            together: None,
        }
    }

    /// Whether hits are to be lit before there are more.
    pub(super) fn is_full(&self) -> bool {
        self.bytes >= self.most
    }

    /// How many hits wait.
    pub(super) fn len(&self) -> usize {
        self.hits.len()
    }

    /// Takes the hit of a lane.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        lit: &Lit,
        k: usize,
        task: &Task,
        (primitive, face): (u32, u8),
        pigment: Option<Pigment>,
    ) {
        let surfaces = &lit.surfaces;
        let (diffuse, specular) = lit.so_far(k);
        self.bytes += size_of::<Waiting>();
        self.hits.push(Waiting {
            task: *task,
            primitive,
            face,
            inside: surfaces.is_inside(k),
            start: surfaces.start.get(k),
            local: surfaces.local.get(k),
            path: lit.signature(k),
            diffuse,
            specular,
            pigment,
        });
    }

    /// Has a hit that waits ask for a light, the way to which is `toward`.
    #[inline(always)]
    pub(super) fn ask(&mut self, light: usize, hit: usize, toward: DVec3, wish: Wish) {
        if self.asks.len() <= light {
            self.asks.resize_with(light + 1, Vec::new);
        }
        self.bytes += size_of::<Ask>();
        self.asks[light].push(Ask { hit: hit as u32, wish, from: Bearing::of(-toward) });
    }

    /// Lights all hits that wait, and gives what they show to their samples.
    #[inline(always)]
    pub(super) fn finish(&mut self, scene: &Scene, gathered: &mut [Gathered]) {
        for (number, light) in scene.lights().iter().enumerate() {
            let Some(asks) = self.asks.get_mut(number) else { break };
            let (asks, mut order) = (std::mem::take(asks), std::mem::take(&mut self.order));
            put_in_order(&asks, |ask| &ask.from, &mut order);
            let mut chunks = order.chunks(LANES).peekable();
            while let Some(some) = chunks.next() {
                let next = chunks.peek().into_iter().flat_map(|next| next.iter());
                scene.accel().prefetch(next.map(|entry| asking(&self.hits, &asks, *entry)));
                self.light(scene, light, &asks, some);
            }
            (self.order, self.asks[number]) = (order, asks);
            self.asks[number].clear();
        }
        self.bytes = 0;
        for hit in self.hits.drain(..) {
            let Waiting { task, diffuse, specular, path, pigment, .. } = hit;
            let pigment = pigment.filter(|_| diffuse != Rgb::ZERO);
            let shown = shown(diffuse, specular, Path::of(path), pigment);
            gathered[task.sample as usize].add_hit(&task, &shown);
        }
    }

    /// Adds what arrives of a light at the hits that ask for it.
    #[inline(always)]
    fn light(&mut self, scene: &Scene, light: &Light, asks: &[Ask], order: &[u64]) {
        let Together { dir, hits, surfaces } =
            &mut **self.together.get_or_insert_with(|| Box::new(Together::NONE));
        let used = u64::MAX >> (LANES - order.len());
        for (k, entry) in order.iter().enumerate() {
            let hit = asking(&self.hits, asks, *entry);
            (hits.primitive[k], hits.face[k]) = (hit.primitive, hit.face);
            surfaces.start.set(k, hit.start);
            surfaces.local.set(k, hit.local);
            surfaces.side[k] = if hit.inside { -1.0 } else { 1.0 };
            dir.set(k, light.position - hit.start);
        }
        let from = Some(Departures { hits, surfaces });
        let rays = RayLanes { origin: &surfaces.start, dir, from, used };
        let seen = used & !shadow::cast(scene, &rays, light.position, &mut self.passed);
        for k in lanes(seen) {
            let Ask { hit, wish, .. } = &asks[order[k] as u32 as usize];
            let hit = &mut self.hits[*hit as usize];
            let Some((arriving, word)) = self.passed.arriving(scene, light, k) else { continue };
            let mut path = Path::of(hit.path).light(word);
            if wish.is_inner {
                path = path.highlight();
            }
            hit.path = path.signature();
            hit.diffuse += arriving * wish.scattered;
            hit.specular += arriving * wish.shine;
        }
    }
}

/// The hit that asks for a light by the ray that an entry of the order is of.
#[inline(always)]
fn asking<'h>(hits: &'h [Waiting], asks: &[Ask], entry: u64) -> &'h Waiting {
    &hits[asks[entry as u32 as usize].hit as usize]
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::{
        scene::{LoadOptions, load},
        trace::{BATCH, Tracer},
    };

    /// Oracle: the same rays in lists so short that no hit waits.
    #[test]
    fn hits_that_wait_show_what_they_show_at_once() {
        const SIDE: u32 = 48;
        let options = LoadOptions { objects: Some(20_000), ..LoadOptions::default() };
        let scene = load("spheres", &options).expect("a scene").scene;
        let view = scene.camera().view(SIDE, SIDE);
        let dirs: Vec<DVec3> = (0..SIDE * SIDE)
            .map(|k| view.direction(DVec2::new(f64::from(k % SIDE), f64::from(k / SIDE)) + 0.5))
            .collect();
        for tells_highlights in [false, true] {
            let trace = |at_once: usize, most: usize| {
                let mut tracer = Tracer::new(&scene, scene.depth(), None, tells_highlights);
                tracer.waiting.most = most;
                let mut all = Vec::new();
                for dirs in dirs.chunks(at_once) {
                    tracer.trace(view.eye(), dirs.iter().copied(), &mut all);
                }
                let waited = tracer.waiting.together.is_some();
                (waited, all, tracer.take_counts())
            };
            let (_, at_once, expected) = trace(BATCH, usize::MAX);
            // All at the end, and some whenever there is no more room.
            for most in [usize::MAX, 1 << 14] {
                let (waited, waiting, counts) = trace(dirs.len(), most);
                assert!(waited && counts.reflected > 0 && counts.refracted > 0);
                assert_eq!(counts, expected);
                let differ = waiting.iter().zip(&at_once).filter(|(a, b)| a != b).count();
                assert_eq!((waiting.len(), differ), (at_once.len(), 0), "{most}");
            }
        }
    }
}
