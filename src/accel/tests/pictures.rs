//! Whole pictures are the same bytes by every instruction set, and it is that set that made them.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::super::simd::{Isa, Kernel, Simd};
use crate::{
    aa::AntiAliasing,
    render::{RenderOptions, Rendering, render},
    scene::{LoadOptions, Scene, load, load_builtin, load_builtin_of},
};

/// How often a query ran, for each of [`Isa::ALL`].
#[derive(Debug, Default)]
pub(in crate::accel) struct Ran([AtomicU64; Isa::ALL.len()]);

/// A kernel that notes by which instructions it runs.
pub(in crate::accel) struct Noted<'a, K> {
    pub(in crate::accel) kernel: K,
    pub(in crate::accel) ran: &'a Ran,
}

impl<K: Kernel> Kernel for Noted<'_, K> {
    type Output = K::Output;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> K::Output {
        let counts = Isa::ALL.iter().zip(&self.ran.0);
        counts.filter(|(isa, _)| **isa == S::ISA).for_each(|(_, count)| {
            count.fetch_add(1, Relaxed);
        });
        self.kernel.run(simd)
    }
}

/// Makes a scene.
type Make = Box<dyn Fn() -> Scene>;

/// How often each of [`Isa::ALL`] ran.
fn counts(ran: &Ran) -> [u64; Isa::ALL.len()] {
    ran.0.each_ref().map(|count| count.load(Relaxed))
}

/// Everything a picture has, bit for bit.
fn bits(rendering: &Rendering) -> (Vec<[u32; 3]>, Option<u64>) {
    let pixels = rendering.film.pixels().iter().map(|p| p.to_array().map(f32::to_bits));
    (pixels.collect(), rendering.estimated_rmse.map(f64::to_bits))
}

/// Oracle: the portable arithmetic. Without the adaptive mode every pixel has one ray; with it, what is refined follows
/// from the colours, so that a difference would spread.
#[test]
fn pictures_are_the_same_by_all_instructions() {
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/models/crate/crate.obj");
    let open = || load(model, &LoadOptions::default()).expect("a model").scene;
    let scenes: [(&str, Make); 3] = [
        ("assignment", Box::new(|| load_builtin("assignment").expect("a scene"))),
        ("spheres", Box::new(|| load_builtin_of("spheres", Some(200)).expect("a scene"))),
        ("a mesh", Box::new(open)),
    ];
    for (name, scene) in &scenes {
        for aa in [AntiAliasing::None, AntiAliasing::ADAPTIVE] {
            let options = RenderOptions { size: Some([90, 70]), aa, ..Default::default() };
            let mut first = None;
            for (k, isa) in Isa::ALL.into_iter().enumerate().filter(|(_, isa)| isa.is_available()) {
                let scene = scene().with_isa(isa);
                let rendering = render(&scene, &options, &|_| ()).expect("a picture");
                let ran = counts(&scene.accel().ran);
                assert!(ran[k] > 0, "{name}, {aa:?}: {isa:?} never ran");
                assert_eq!(ran.iter().sum::<u64>(), ran[k], "{name}, {aa:?}: others than {isa:?}");
                let (picture, rays) = (bits(&rendering), rendering.rays);
                let (expected, as_many) = first.get_or_insert_with(|| (picture.clone(), rays));
                assert!(picture == *expected, "{name}, {aa:?}: {isa:?} makes another picture");
                assert_eq!(rays, *as_many, "{name}, {aa:?}: {isa:?} casts other rays");
            }
        }
    }
}
