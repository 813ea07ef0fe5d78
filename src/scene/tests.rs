//! A ray reaches every primitive through the tree, and finds there what trying all of them finds.

use std::ops::ControlFlow;

use glam::DVec3;

use super::load_builtin;
use crate::{
    accel::brute,
    geometry::{Crossing, Ray, Shape},
    math::random::SplitMix64,
};

/// Oracle: brute force. Two million questions: the nearest hit of a random ray and, from where it hits or ends, what
/// lies on the way to a light.
#[test]
fn the_tree_of_the_assignment_agrees_with_brute_force() {
    let scene = load_builtin("assignment").expect("a built-in scene");
    let shapes: Vec<Shape> = (0..17).map(|number| scene.shape(number).clone()).collect();
    assert_eq!(scene.primitive_count(), shapes.len());
    let mut random = SplitMix64::new(17);
    let mut vector = || DVec3::from_array([0; 3].map(|_| 2.0 * random.uniform() - 1.0));
    let mut hits = 0;
    for number in 0..1_000_000 {
        let ray = Ray::new(vector(), vector());
        let hit = scene.accel().nearest(&ray, f64::INFINITY);
        assert_eq!(hit, brute::nearest(&shapes, &ray, f64::INFINITY), "ray {number}: {ray:?}");

        let light = scene.lights()[number % 2].position;
        let shadow = match hit {
            Some(hit) => {
                hits += 1;
                let surface = scene.surface(&ray, &hit);
                let to_light = light - surface.point;
                surface.leave(&hit, to_light, surface.normal.dot(to_light) < 0.0)
            }
            None => Ray::new(ray.origin, light - ray.origin),
        };
        let crossed =
            |question: &dyn Fn(&mut dyn FnMut(u32, Crossing) -> ControlFlow<()>) -> bool| {
                let mut crossed = Vec::new();
                let broken = question(&mut |primitive, crossing| {
                    crossed.push((primitive, crossing.face, crossing.t.to_bits()));
                    ControlFlow::Continue(())
                });
                assert!(!broken);
                crossed.sort_unstable();
                crossed
            };
        let by_tree = crossed(&|visit| scene.accel().any_crossing(&shadow, 1.0, visit));
        let by_all = crossed(&|visit| brute::any_crossing(&shapes, &shadow, 1.0, visit));
        assert_eq!(by_tree, by_all, "shadow {number}: {shadow:?}");
    }
    assert!((200_000..900_000).contains(&hits), "{hits} rays hit");
}
