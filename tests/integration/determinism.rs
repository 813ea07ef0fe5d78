//! The picture is a function of the scene and the options alone.

use std::num::NonZeroUsize;

use whitted::{render::RenderOptions, scene::load_builtin};

use super::support::rendering;

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let scene = load_builtin("assignment").expect("a built-in scene");
    let with_threads = |threads| {
        let threads = NonZeroUsize::new(threads);
        rendering(&scene, &RenderOptions { size: Some([203, 151]), threads, ..Default::default() })
    };
    let one = with_threads(1);
    for threads in [2, 3, 7] {
        let many = with_threads(threads);
        assert_eq!(many.threads, threads);
        let same = |a: &[f32; 3], b: &[f32; 3]| a.map(f32::to_bits) == b.map(f32::to_bits);
        let pairs = one.film.pixels().iter().zip(many.film.pixels());
        assert!(
            pairs.into_iter().all(|(a, b)| same(&a.to_array(), &b.to_array())),
            "{threads} threads"
        );
        assert_eq!(one.rays, many.rays, "{threads} threads");
    }
}
