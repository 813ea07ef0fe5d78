//! The picture is a function of the scene and the options alone.

use std::num::NonZeroUsize;

use whitted::{
    accel::Preset,
    render::RenderOptions,
    scene::{Scene, builtin::builtin, load_builtin_of},
};

use super::support::rendering;

/// Scenes of few things and of many; with more threads, fewer of the many are sampled together.
#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    for (name, objects, size, mode) in [
        ("assignment", None, [203, 151], "adaptive"),
        ("spheres", Some(10_000), [150, 150], "none"),
        ("spheres", Some(10_000), [80, 80], "grid:2"),
        ("spheres", Some(10_000), [150, 150], "adaptive:8"),
    ] {
        let scene = load_builtin_of(name, objects).expect("a built-in scene");
        let aa = mode.parse().expect("a mode");
        let with_threads = |threads| {
            let threads = NonZeroUsize::new(threads);
            let options = RenderOptions { size: Some(size), aa, threads, ..Default::default() };
            rendering(&scene, &options)
        };
        let one = with_threads(1);
        for threads in [2, 3, 7] {
            let many = with_threads(threads);
            assert_eq!(many.threads, threads);
            let same = |a: &[f32; 3], b: &[f32; 3]| a.map(f32::to_bits) == b.map(f32::to_bits);
            let pairs = one.film.pixels().iter().zip(many.film.pixels());
            assert!(
                pairs.into_iter().all(|(a, b)| same(&a.to_array(), &b.to_array())),
                "{name} {mode}: {threads} threads"
            );
            assert_eq!(one.rays, many.rays, "{name} {mode}: {threads} threads");
        }
    }
}

/// However long the tree's build may take, it never changes an answer.
#[test]
fn any_build_of_the_tree_gives_the_same_bytes() {
    let [fast, auto, thorough] = Preset::ALL.map(|preset| {
        let scene = load_builtin_of("spheres", Some(3_000)).expect("a built-in scene");
        let scene = scene.rebuilt(preset);
        let options = RenderOptions { size: Some([150, 150]), ..Default::default() };
        let rendering = rendering(&scene, &options);
        let pixels = rendering.film.pixels().iter().map(|p| p.to_array().map(f32::to_bits));
        (scene.bvh_stats().nodes, pixels.collect::<Vec<_>>(), rendering.rays)
    });
    assert!(fast.0 != auto.0 && auto.0 != thorough.0, "the trees are the same");
    for (other, name) in [(fast, "fast"), (thorough, "thorough")] {
        assert!((&other.1, other.2) == (&auto.1, auto.2), "{name}");
    }
}

/// Spheres of all materials over a floor, in the order given and in others: the tree, its leaves and the numbers all differ.
#[test]
fn any_order_of_the_primitives_gives_the_same_bytes() {
    let picture = |order: &dyn Fn(usize, usize) -> usize| {
        let parts = builtin("spheres").and_then(|scene| scene.parts(Some(2_000)));
        let mut parts = parts.expect("a built-in scene");
        let count = parts.shapes.len();
        parts.shapes = (0..count).map(|k| parts.shapes[order(k, count)].clone()).collect();
        parts.material_of = (0..count).map(|k| parts.material_of[order(k, count)]).collect();
        let scene = Scene::assemble("spheres", parts).expect("a scene");
        let rendering =
            rendering(&scene, &RenderOptions { size: Some([150, 150]), ..Default::default() });
        let bits = rendering
            .film
            .pixels()
            .iter()
            .map(|p| p.to_array().map(f32::to_bits))
            .collect::<Vec<_>>();
        (bits, rendering.rays)
    };
    let given = picture(&|k, _| k);
    assert!(given == picture(&|k, count| count - 1 - k), "backward");
    assert!(given == picture(&|k, count| k * 1_009 % count), "shuffled");
}
